//! What a device knows for queries, and batches of them.

use kdray::{Mesh, Tree};

use super::batch::{Batch, TraceOptions};
use super::kernels::{ANY, CLOSEST, LOCATE, Rays};
use super::scene::Scene;
use crate::device::{Buffer, Device};
use crate::error::GpuError;
use crate::record::Recording;

/// Answers queries over a mesh and its tree on a device, with the bits of [`kdray::Tracer`].
#[derive(Debug)]
pub struct Tracer<'a> {
    pub(super) device: &'a Device,
    pub(super) scene: Scene,
}

impl<'a> Tracer<'a> {
    /// Brings `mesh` and its `tree` to the device.
    ///
    /// # Errors
    ///
    /// If the device has no memory for them, or may not bind as much at once.
    ///
    /// # Panics
    ///
    /// If the tree is of another number of triangles.
    ///
    /// ```no_run
    /// use kdray::{BuildOptions, Mesh, Ray, Tree};
    /// use kdray_gpu::{Device, Limits, Selection, TraceOptions, Tracer};
    ///
    /// let mesh = Mesh::new(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]])?;
    /// let tree = Tree::build(&mesh, &BuildOptions::default())?;
    /// let device = Device::open(&Selection::Best, &Limits::PORTABLE)?;
    /// let tracer = Tracer::new(&device, &mesh, &tree)?;
    /// let rays = [0.25, 0.75].map(|x| Ray::new([x, 0.5, 1.0], [0.0, 0.0, -1.0]));
    /// let mut hits = [None; 2];
    /// tracer.batch(TraceOptions::default()).closest_hits(&rays, &mut hits)?;
    /// assert_eq!(hits.map(|hit| hit.map(|hit| hit.t)), [Some(1.0), None]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(device: &'a Device, mesh: &Mesh, tree: &Tree) -> Result<Self, GpuError> {
        assert_eq!(mesh.triangles().len(), tree.triangle_count(), "the tree is of another mesh");
        Ok(Self { device, scene: Scene::upload(device, mesh, tree)? })
    }

    /// Compiles the kernels of the queries, which would otherwise happen during the first one.
    ///
    /// # Errors
    ///
    /// If a kernel is refused, or the device fails.
    pub fn prepare(&self) -> Result<(), GpuError> {
        self.device.compile(super::KERNELS)
    }

    /// Compiles the kernels of [`Tracer::record_closest`] and [`Tracer::record_any`] only.
    ///
    /// # Errors
    ///
    /// As [`Tracer::prepare`].
    pub fn prepare_first_hits(device: &Device) -> Result<(), GpuError> {
        device.compile(&[&CLOSEST, &LOCATE, &ANY])
    }

    /// What answers queries over a scene that is on the device.
    pub(crate) fn over(device: &'a Device, scene: Scene) -> Self {
        Self { device, scene }
    }

    /// Reads the tree back, which is that of `mesh`.
    ///
    /// # Errors
    ///
    /// If the device fails.
    ///
    /// # Panics
    ///
    /// As [`Tracer::new`].
    pub fn tree(&self, mesh: &Mesh) -> Result<Tree, GpuError> {
        self.check_mesh(mesh);
        self.scene.tree.read(self.device, mesh)
    }

    /// Panics if `mesh` has another number of triangles than the one on the device.
    pub fn check_mesh(&self, mesh: &Mesh) {
        let count = self.scene.triangle_count;
        assert_eq!(mesh.triangles().len(), count, "the tree is of another mesh");
    }

    /// Takes another mesh and its `tree`, in the memory of those before if there is room.
    ///
    /// # Errors
    ///
    /// As [`Tracer::new`]; what it answers then is of neither mesh.
    ///
    /// # Panics
    ///
    /// As [`Tracer::new`].
    pub fn replace(&mut self, mesh: &Mesh, tree: &Tree) -> Result<(), GpuError> {
        assert_eq!(mesh.triangles().len(), tree.triangle_count(), "the tree is of another mesh");
        self.scene.replace(self.device, mesh, tree)
    }

    /// The mesh on the device: three floats a position, three indices a triangle.
    #[must_use]
    pub fn mesh(&self) -> [&Buffer; 2] {
        [&self.scene.positions, &self.scene.triangles]
    }

    /// The device that it is on.
    #[must_use]
    pub fn device(&self) -> &'a Device {
        self.device
    }

    /// Bytes of the device that it holds.
    #[must_use]
    pub fn size_bytes(&self) -> u64 {
        self.scene.size_bytes()
    }

    /// Finds the [closest hits](kdray::Tracer::closest_hit) of rays that are on the device.
    ///
    /// `triangles` gets a word a ray, `u32::MAX` where nothing is hit, and `hits` four, a
    /// [`kdray::Hit`]; the triangle is in both.
    pub fn record_closest(
        &self,
        recording: &mut Recording,
        rays: &Rays,
        [triangles, hits]: [&Buffer; 2],
    ) {
        let answers = [triangles, hits];
        // Nothing is counted, so the hits stand in for the counts.
        rays.query(recording, (&CLOSEST, false), &self.scene, &answers);
        rays.locate(recording, &self.scene, answers);
    }

    /// Finds out whether rays that are on the device [hit anything](kdray::Tracer::any_hit):
    /// `found` gets a word a ray, 1 or 0.
    pub fn record_any(&self, recording: &mut Recording, rays: &Rays, found: &Buffer) {
        rays.query(recording, (&ANY, false), &self.scene, &[found]);
    }

    /// Asks for rays in the memory of the host.
    #[must_use]
    pub fn batch<'b>(&'b self, options: TraceOptions<'b>) -> Batch<'b> {
        Batch { tracer: self, options }
    }
}
