//! Where meshes come from: files, and generators.
//!
//! [`load`] reads PLY, OBJ, STL, OFF, glTF and GLB files into a [`Loaded`] mesh; [`generate`] makes
//! scenes of any size that are the same, bit for bit, on every machine.
//!
//! What every loader keeps:
//! * **All of the surface.** A polygon of n corners gives n - 2 triangles and keeps each of its edges
//!   once, so a closed mesh of polygons stays closed. Degenerate and duplicate triangles are kept.
//! * **Bad input is an error**, which names the file, the place and the reason: never a panic, never a
//!   guess. What had to be left out without harm (lines, points, two-cornered faces) is in
//!   [`Loaded::notes`].
//! * **Memory follows the bytes of the file**, not the counts its header claims.
//!
//! ```
//! let scene = kdray_mesh::generate::showcase(20_000);
//! assert_eq!(scene.triangles.len(), 20_000);
//! let mesh = scene.mesh()?;
//! assert_eq!(mesh.triangles().len(), 20_000);
//! # Ok::<(), kdray::MeshError>(())
//! ```

mod error;
mod faces;
mod format;
pub mod generate;
mod gltf;
mod load;
mod loaded;
mod obj;
mod off;
mod ply;
mod polygon;
mod sequence;
mod stl;
mod text;

pub use error::{LoadError, Place, Reason};
pub use format::Format;
pub use load::{load, read, read_with};
pub use loaded::Loaded;
pub use sequence::Sequence;
