//! Looks at meshes and their kd-trees.
//!
//! A [`Scene`] is a mesh with its tree; a [`Look`] says from where it is seen, how it is shaded, and
//! whether the cells of the tree are drawn. [`Scene::picture`] makes a picture of it, and with the
//! feature `window` a window shows it to somebody who goes around it.
//!
//! ```
//! use kdray::{BuildOptions, Mesh, Tree};
//! use kdray_render::{Camera, RenderOptions, Shading};
//! use kdray_view::{Look, Orbit, Scene};
//!
//! let mesh = Mesh::new(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]])?;
//! let tree = Tree::build(&mesh, &BuildOptions::default())?;
//! let orbit = Orbit::new(&Camera::framing(&mesh.bounds(), Camera::Y_UP, 1.0));
//! let scene = Scene::new(mesh, tree, 0.001);
//! let look = Look { orbit, shading: Shading::Normals, cells: Some(3), statistics: true };
//! let options = RenderOptions { width: 64, height: 64, ..RenderOptions::default() };
//! assert_eq!(scene.picture(&look, &options)?.pixels.len(), 64 * 64);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cells;
mod orbit;
mod scene;
#[cfg(feature = "window")]
mod window;

pub use cells::DEEPEST;
pub use orbit::Orbit;
pub use scene::{Look, Scene};
#[cfg(feature = "window")]
pub use window::{MakeScene, Start, WindowError, show};
