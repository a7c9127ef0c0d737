//! Exact-SAH kd-trees over triangles, and the ray queries that such a tree allows.

pub mod build;
pub mod geometry;
mod memory;
pub mod trace;
pub mod tree;

pub use build::{BuildError, BuildOptions, BuildReport, Builder, Cost};
pub use geometry::{Aabb, Frame, Hit, Mesh, MeshError, Ray};
pub use trace::{ClosestPoint, Counts, Only, Tracer};
pub use tree::{FileError, Node, Stats, Tree, Violation};
