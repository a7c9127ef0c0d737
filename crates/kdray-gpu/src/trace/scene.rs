//! A mesh and its tree in the memory of a device.

use kdray::{Aabb, Mesh, Tree};

use crate::device::{Buffer, Device};
use crate::error::GpuError;

/// Fewest words of a buffer: kernels bind no empty ones.
const LEAST: usize = 4;

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
        let bounds = tree.bounds();
        Ok(Self {
            nodes: words(device, "nodes", bytemuck::cast_slice(tree.nodes()))?,
            references: words(device, "references", tree.references())?,
            positions: words(device, "positions", bytemuck::cast_slice(mesh.positions()))?,
            triangles: words(device, "triangles", bytemuck::cast_slice(mesh.triangles()))?,
            reach: bounds.lower.iter().chain(&bounds.upper).fold(0.0, |most, v| v.abs().max(most)),
            bounds,
        })
    }

    /// Bytes of the device that it takes.
    pub(crate) fn size_bytes(&self) -> u64 {
        let buffers = [&self.nodes, &self.references, &self.positions, &self.triangles];
        buffers.into_iter().map(Buffer::size_bytes).sum()
    }
}

/// A buffer that kernels can bind.
fn words(device: &Device, label: &'static str, words: &[u32]) -> Result<Buffer, GpuError> {
    let (asked, offered) = (size_of_val(words) as u64, device.limits().binding_bytes);
    if asked > offered {
        let (adapter, limit) = (device.adapter().name.clone(), "binding_bytes");
        return Err(GpuError::Limit { adapter, limit, asked, offered });
    }
    let mut padded = [0; LEAST];
    let count = words.len().min(LEAST);
    padded[..count].copy_from_slice(&words[..count]);
    device.upload(label, if words.len() < LEAST { &padded } else { words })
}
