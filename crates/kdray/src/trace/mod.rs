//! Trace rays through a tree.
//!
//! [`prepare`] makes of a ray what traversal needs, [`traverse`] visits the leaves along it from
//! front to back, [`block`] tests the triangles of a leaf eight at a time, and [`intersect`] says
//! for one triangle what a hit is: it is the definition that everything else is tested against.

mod batch;
mod block;
mod intersect;
mod leaves;
mod prepare;
mod tracer;
mod traverse;

pub use intersect::intersect;
pub use tracer::{Counts, Tracer};
