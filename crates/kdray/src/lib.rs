//! Exact-SAH kd-trees over triangles, and the ray queries that such a tree allows.

pub mod build;
pub mod geometry;
mod memory;
pub mod trace;
pub mod tree;
pub mod winding;

pub use build::{BuildError, BuildOptions, BuildReport, Builder, Cost};
pub use geometry::{Aabb, Frame, Hit, Mesh, MeshError, MeshFileError, Ray};
pub use trace::{
    Batch, BatchError, BatchOptions, ClosestPoint, Counts, Leaf, Lists, Only, Sign, Tracer,
};
pub use tree::{FileError, Node, Stats, Tree, Violation};
pub use winding::Winding;
