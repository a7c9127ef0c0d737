//! A mesh and its tree in the memory of a device.

use kdray::{Aabb, Mesh, Tree};

use crate::device::{Buffer, Device};
use crate::error::GpuError;

/// Words of a buffer that nothing is in: kernels bind no empty ones.
const LEAST: u64 = 4;

/// What queries read.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    pub(crate) nodes: Buffer,
    pub(crate) references: Buffer,
    pub(crate) positions: Buffer,
    pub(crate) triangles: Buffer,
    pub(crate) bounds: Aabb,
    /// The largest coordinate of the bounds.
    pub(crate) reach: f32,
}

impl Scene {
    pub(crate) fn upload(device: &Device, mesh: &Mesh, tree: &Tree) -> Result<Self, GpuError> {
        let mut scene = Self {
            nodes: device.buffer("nodes", LEAST)?,
            references: device.buffer("references", LEAST)?,
            positions: device.buffer("positions", LEAST)?,
            triangles: device.buffer("triangles", LEAST)?,
            bounds: tree.bounds(),
            reach: 0.0,
        };
        scene.replace(device, mesh, tree)?;
        Ok(scene)
    }

    /// Brings another scene, in the buffers of the one before where they are large enough.
    pub(crate) fn replace(
        &mut self,
        device: &Device,
        mesh: &Mesh,
        tree: &Tree,
    ) -> Result<(), GpuError> {
        self.bounds = tree.bounds();
        let coordinates = self.bounds.lower.iter().chain(&self.bounds.upper);
        self.reach = coordinates.fold(0.0, |most, v| v.abs().max(most));
        device.refill(&mut self.nodes, "nodes", tree.nodes())?;
        device.refill(&mut self.references, "references", tree.references())?;
        device.refill(&mut self.positions, "positions", mesh.positions())?;
        device.refill(&mut self.triangles, "triangles", mesh.triangles())
    }

    /// Bytes of the device that it takes.
    pub(crate) fn size_bytes(&self) -> u64 {
        let buffers = [&self.nodes, &self.references, &self.positions, &self.triangles];
        buffers.into_iter().map(Buffer::size_bytes).sum()
    }
}
