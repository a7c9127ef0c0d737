//! Trace rays through a tree.
//!
//! `wide` lays the tree out in nodes of eight boxes, `prepare` makes of a ray what traversal needs,
//! `traverse` visits the leaves along it from front to back by `step`s down, `block` filters the
//! triangles of a leaf eight at a time, and `intersect` says for one triangle what a hit is: it is
//! the definition that everything else is tested against. `hits` keeps what the queries want of the
//! hits. `near` visits the leaves around a point, for the queries of `proximity`.

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
