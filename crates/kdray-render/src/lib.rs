//! Pictures of meshes, traced through kdray's trees.
//!
//! [`render`] shades what a [`Camera`] sees in one of four ways ([`Shading`]). The same mesh, camera
//! and options give the same picture on any number of threads: every random number is a hash of the
//! pixel, the sample and the dimension it is for.
//!
//! ```
//! use kdray::{BuildOptions, Mesh, Tracer, Tree};
//! use kdray_render::{Camera, RenderOptions, Shading, render};
//!
//! let mesh = Mesh::new(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]])?;
//! let tracer = Tracer::new(&mesh, &Tree::build(&mesh, &BuildOptions::default())?);
//! let options = RenderOptions { width: 32, height: 24, shading: Shading::Normals, ..RenderOptions::default() };
//! let camera = Camera::framing(&mesh.bounds(), Camera::Y_UP, options.aspect());
//! let picture = render(&tracer, &mesh, &camera, &options)?;
//! assert_eq!(picture.pixels.len(), 32 * 24);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod camera;
mod components;
mod corners;
mod denoise;
mod film;
#[cfg(feature = "gpu")]
pub mod gpu;
mod ground;
mod legend;
mod options;
mod palette;
mod picture;
mod pixel;
mod point;
mod probe;
mod sampler;
mod scene;
mod shade;
mod sky;
mod text;
mod tone;
mod warp;
mod weld;

pub use camera::Camera;
pub use options::{Cancelled, RenderOptions, Shading};
pub use picture::Picture;
pub use shade::render;
pub use sky::{Sky, Sun};
