//! Boxes, triangles, meshes and rays: what a tree is built over and asked with.

mod aabb;
pub(crate) mod clip;
mod corner;
mod frame;
pub(crate) mod least;
mod mesh;
mod mesh_file;
pub(crate) mod nearest;
pub(crate) mod ordered;
pub(crate) mod overlap;
mod ray;
pub(crate) mod vector;

pub use aabb::Aabb;
pub use frame::Frame;
pub use mesh::{Mesh, MeshError};
pub use mesh_file::MeshFileError;
pub use ray::{Hit, Ray};
#[cfg(any(target_arch = "x86_64", test))]
pub(crate) use ray::{LEAST, MOST};

// For builders on other devices; not a stable interface.
#[doc(hidden)]
pub use {clip::clip, clip::overlap};
