//! A mesh and its tree in the memory of a device.

use kdray::{Aabb, Cost, Mesh, Node, Tree};

use crate::device::{Buffer, Device};
use crate::error::GpuError;

/// Words of a buffer that nothing is in: kernels bind no empty ones.
const LEAST: u64 = 4;

/// The bytes of a tree. Buffers may have room for more.
#[derive(Clone, Debug)]
pub(crate) struct Packed {
    pub(crate) nodes: Buffer,
    pub(crate) references: Buffer,
    /// How many nodes and references there are.
    pub(crate) counts: [u32; 2],
    /// The prices that it was built for.
    pub(crate) cost: Cost,
}

impl Packed {
    /// Bytes of nodes and references.
    pub(crate) fn size_bytes(&self) -> u64 {
        let [nodes, references] = self.counts.map(u64::from);
        8 * nodes + 4 * references
    }

    /// Reads the tree, which is that of `mesh`.
    pub(crate) fn read(&self, device: &Device, mesh: &Mesh) -> Result<Tree, GpuError> {
        let (nodes, references) = self.lists(device)?;
        Ok(Tree::from_parts(mesh, nodes, references, self.cost))
    }

    /// Reads nodes and references.
    pub(crate) fn lists(&self, device: &Device) -> Result<(Vec<Node>, Vec<u32>), GpuError> {
        let [nodes, references] = self.counts.map(u64::from);
        let nodes = device.read(&self.nodes.words(0, 2 * nodes))?;
        let references = match references {
            0 => Vec::new(),
            count => device.read(&self.references.words(0, count))?,
        };
        Ok((nodes, references))
    }
}

/// What queries read.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    pub(crate) tree: Packed,
    pub(crate) positions: Buffer,
    pub(crate) triangles: Buffer,
    pub(crate) triangle_count: usize,
    pub(crate) bounds: Aabb,
    /// The largest coordinate of the bounds.
    pub(crate) reach: f32,
}

impl Scene {
    /// A mesh that is on the device, with its tree.
    pub(crate) fn new(mesh: &Mesh, [positions, triangles]: [Buffer; 2], tree: Packed) -> Self {
        let (bounds, triangle_count) = (mesh.bounds(), mesh.triangles().len());
        let reach = reach(&bounds);
        Self { tree, positions, triangles, triangle_count, bounds, reach }
    }

    pub(crate) fn upload(device: &Device, mesh: &Mesh, tree: &Tree) -> Result<Self, GpuError> {
        let buffer = |label| device.buffer(label, LEAST);
        let nothing = Packed {
            nodes: buffer("nodes")?,
            references: buffer("references")?,
            counts: [0; 2],
            cost: tree.cost(),
        };
        let mut scene = Self::new(mesh, [buffer("positions")?, buffer("triangles")?], nothing);
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
        self.triangle_count = mesh.triangles().len();
        self.bounds = mesh.bounds();
        self.reach = reach(&self.bounds);
        self.tree.counts = [tree.nodes().len(), tree.references().len()].map(|count| count as u32);
        self.tree.cost = tree.cost();
        device.refill(&mut self.tree.nodes, "nodes", tree.nodes())?;
        device.refill(&mut self.tree.references, "references", tree.references())?;
        device.refill(&mut self.positions, "positions", mesh.positions())?;
        device.refill(&mut self.triangles, "triangles", mesh.triangles())
    }

    /// Bytes of the device that it takes.
    pub(crate) fn size_bytes(&self) -> u64 {
        let Self { tree: Packed { nodes, references, .. }, positions, triangles, .. } = self;
        [nodes, references, positions, triangles].map(Buffer::size_bytes).iter().sum()
    }
}

/// The largest coordinate of a box.
fn reach(bounds: &Aabb) -> f32 {
    bounds.lower.iter().chain(&bounds.upper).fold(0.0, |most, v| v.abs().max(most))
}
