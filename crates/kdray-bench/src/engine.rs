//! What an engine has to do to be measured.
//!
//! An [`Engine`] is a library with options. It gives a [`Builder`] for a number of threads
//! (devices and thread pools are made there, outside every timing), which builds an
//! [`Index`] over a mesh. The runner owns the tracing threads and hands each a run of rays.

use anyhow::Result;
use kdray::{Mesh, Ray};

use crate::definition::Mode;
use crate::memory::Memory;

/// A library with its options.
pub(crate) trait Engine {
    /// A builder that uses exactly this many threads.
    fn builder(&self, threads: usize) -> Result<Box<dyn Builder>>;
}

/// Builds an index over a mesh.
pub(crate) trait Builder {
    /// An index that answers queries without the mesh; all of this call is timed.
    fn build(&self, mesh: &Mesh) -> Result<Box<dyn Index>>;
}

/// A built structure, ready for rays.
pub(crate) trait Index: Send + Sync {
    /// Writes to `hits[i]` the closest hit of `rays[i]`. The slices have one length.
    fn closest(&self, mode: Mode, rays: &[Ray], hits: &mut [Hit]);

    /// Writes to `occluded[i]` whether `rays[i]` hits anything. The slices have one length.
    fn any(&self, mode: Mode, rays: &[Ray], occluded: &mut [bool]);

    /// Memory of the build that Rust's allocator does not see.
    fn foreign_memory(&self) -> Memory {
        Memory::default()
    }
}

/// The closest hit of a ray, or [`Hit::MISS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    /// Ray parameter of the hit; infinite for a miss.
    pub(crate) t: f32,
    /// Index of the triangle.
    pub(crate) triangle: u32,
}

impl Hit {
    /// What a ray that hits nothing gets.
    pub(crate) const MISS: Hit = Hit { t: f32::INFINITY, triangle: u32::MAX };

    /// Whether this is a hit.
    pub(crate) fn is_hit(self) -> bool {
        self.triangle != u32::MAX
    }
}
