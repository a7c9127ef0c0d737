//! Trace rays through a tree.
//!
//! `wide` lays the tree out three levels to a cache line, `prepare` makes of a ray what
//! traversal needs, `traverse` visits the leaves along it from front to back by `step`s down,
//! `block` tests the triangles of a leaf eight at a time, and [`intersect`] says for one
//! triangle what a hit is: it is the definition that everything else is tested against.

mod batch;
mod block;
mod hits;
mod intersect;
mod near;
mod only;
mod prepare;
mod proximity;
mod stack;
mod step;
mod tracer;
mod traverse;
mod wide;

pub use intersect::intersect;
pub use only::Only;
pub use proximity::ClosestPoint;
pub use tracer::{Counts, Tracer};
