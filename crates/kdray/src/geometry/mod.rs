//! Boxes, triangles, meshes and rays: what a tree is built over and asked with.

mod aabb;
pub(crate) mod clip;
mod frame;
mod mesh;
pub(crate) mod nearest;
pub(crate) mod overlap;
mod ray;

pub use aabb::Aabb;
pub use frame::Frame;
pub use mesh::{Mesh, MeshError};
pub use ray::{Hit, Ray};
