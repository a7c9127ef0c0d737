//! The finished tree: nodes, references, and what can be known of them.

mod check;
mod file;
mod node;
mod stats;
mod validate;

pub use file::FileError;
pub use node::{Kind, Node};
pub use stats::Stats;
pub use validate::Violation;

use std::sync::Arc;

use crate::build::{self, BuildError, BuildOptions, BuildReport, Cost, Growth};
use crate::geometry::{Aabb, Frame, Mesh};

/// An exact-SAH kd-tree over the triangles of a mesh.
///
/// The tree is data: 8-byte [`Node`]s in depth-first order, a left child right behind its parent,
/// and the references of the leaves, each leaf's sorted by triangle. It borrows nothing and does
/// not keep the mesh; [`Tree::validate`] and [`Tracer::new`](crate::Tracer::new) take both.
#[derive(Clone)]
pub struct Tree {
    pub(crate) header: Header,
    storage: Storage,
    /// Of leaves that have references, in order: bounds of the parts of these. The builder knows
    /// them, and hands them to tracers; they are not in a tree's bytes.
    parts: Option<Vec<Aabb>>,
}

/// What a tree says of itself, beside its nodes and references.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Header {
    pub(crate) bounds: Aabb,
    pub(crate) frame: Frame,
    pub(crate) cost: Cost,
    pub(crate) triangles: u32,
    /// [`Mesh::fingerprint`] of the mesh it was built from.
    pub(crate) mesh: u64,
}

/// Where nodes and references live.
#[derive(Clone)]
enum Storage {
    Owned {
        nodes: Vec<Node>,
        references: Vec<u32>,
    },
    /// A tree file, checked when it was opened.
    File {
        bytes: Arc<dyn AsRef<[u8]> + Send + Sync>,
        nodes: usize,
        references: usize,
    },
}

impl Tree {
    /// Builds the exact-SAH tree of `mesh`.
    ///
    /// The same mesh and options give the same tree, byte for byte, on every machine, with any
    /// number of threads and any [`Builder`](crate::Builder). Costs O(N log N) time with the
    /// default builder; [`Tree::build_reported`] says what memory it took. \[WH06]
    ///
    /// # Errors
    ///
    /// [`BuildError`]: an option out of range, the memory budget, or cancellation.
    ///
    /// ```
    /// use kdray::{BuildOptions, Mesh, Ray, Tracer, Tree};
    ///
    /// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let mesh = Mesh::new(&positions, &[[0, 1, 2]])?;
    /// let tree = Tree::build(&mesh, &BuildOptions::default())?;
    /// let tracer = Tracer::new(&mesh, &tree);
    /// let hit = tracer.closest_hit(&Ray::new([0.25, 0.25, 1.0], [0.0, 0.0, -1.0])).unwrap();
    /// assert_eq!((hit.triangle, hit.t), (0, 1.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn build(mesh: &Mesh, options: &BuildOptions) -> Result<Self, BuildError> {
        Ok(Self::build_reported(mesh, options)?.0)
    }

    /// [`Tree::build`], and what it took.
    ///
    /// # Errors
    ///
    /// As [`Tree::build`].
    pub fn build_reported(
        mesh: &Mesh,
        options: &BuildOptions,
    ) -> Result<(Self, BuildReport), BuildError> {
        build::build(mesh, options)
    }

    pub(crate) fn from_growth(mesh: &Mesh, growth: Growth, cost: Cost) -> Self {
        let parts = Some(growth.parts);
        Self { parts, ..Self::from_parts(mesh, growth.nodes, growth.references, cost) }
    }

    /// The tree whose parts a builder on another device made. Nothing is checked: parts that make
    /// no tree give a tree that makes a tracer panic.
    #[doc(hidden)]
    #[must_use]
    pub fn from_parts(mesh: &Mesh, nodes: Vec<Node>, references: Vec<u32>, cost: Cost) -> Self {
        let header = Header {
            bounds: mesh.bounds(),
            frame: mesh.frame(),
            cost,
            triangles: mesh.triangles().len() as u32,
            mesh: mesh.fingerprint(),
        };
        Self { header, storage: Storage::Owned { nodes, references }, parts: None }
    }

    /// The nodes, in depth-first order; the root is the first.
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        match &self.storage {
            Storage::Owned { nodes, .. } => nodes,
            Storage::File { bytes, nodes, .. } => {
                bytemuck::cast_slice(&file::body((**bytes).as_ref())[..nodes * size_of::<Node>()])
            }
        }
    }

    /// The references of all leaves: indices of triangles, which [`Kind::Leaf`] points into.
    #[must_use]
    pub fn references(&self) -> &[u32] {
        match &self.storage {
            Storage::Owned { references, .. } => references,
            Storage::File { bytes, nodes, references } => {
                let start = nodes * size_of::<Node>();
                let end = start + references * size_of::<u32>();
                bytemuck::cast_slice(&file::body((**bytes).as_ref())[start..end])
            }
        }
    }

    /// Of leaves that have references, in order: bounds of the parts of these, if the tree was just
    /// built.
    pub(crate) fn parts(&self) -> Option<&[Aabb]> {
        self.parts.as_deref()
    }

    /// The box of the root: the bounds of all triangles, in the mesh's frame.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.header.bounds
    }

    /// The frame of the mesh.
    #[must_use]
    pub fn frame(&self) -> Frame {
        self.header.frame
    }

    /// The prices that the tree was built for.
    #[must_use]
    pub fn cost(&self) -> Cost {
        self.header.cost
    }

    /// How many triangles the mesh has.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.header.triangles as usize
    }

    /// Bytes of nodes and references.
    #[must_use]
    pub fn size_bytes(&self) -> usize {
        size_of_val(self.nodes()) + size_of_val(self.references())
    }

    /// Whether `mesh` is the one that the tree was built from.
    #[must_use]
    pub fn is_of(&self, mesh: &Mesh) -> bool {
        self.header.mesh == mesh.fingerprint()
    }
}

impl PartialEq for Tree {
    /// Equal trees have equal bytes.
    fn eq(&self, other: &Self) -> bool {
        self.header == other.header
            && self.nodes() == other.nodes()
            && self.references() == other.references()
    }
}

impl std::fmt::Debug for Tree {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Tree")
            .field("triangles", &self.header.triangles)
            .field("nodes", &self.nodes().len())
            .field("references", &self.references().len())
            .field("bounds", &self.header.bounds)
            .finish_non_exhaustive()
    }
}
