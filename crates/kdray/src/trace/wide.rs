//! The tree as traversal reads it: three levels in a node of one cache line.
//!
//! A wide node has the seven planes of three levels of the tree and its eight grandchildren, so a
//! ray takes a third of the steps. All eight intervals of `t` are worked out together, in the
//! order in which the ray comes to them: that follows from the signs of its direction alone.

use super::block::{Block, LANES};
use crate::geometry::Mesh;
use crate::memory::with_huge_pages;
use crate::tree::{Kind, Node, Tree};

/// Three levels of the tree.
///
/// ```text
///                planes[3]                      lane   0  1  2   3   4  5  6   7
///        planes[0]      planes[4]               plane  b  d  e   a   c  f  g   axes
///      [1]     [2]     [5]     [6]
///     0   1   2   3   4   5   6   7  children
/// ```
///
/// The last lane holds the axes of the others, two bits each. Where the tree ends early, planes
/// are infinite and the leaf is the leftmost of the children it stands for.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct Wide {
    pub(super) planes: [f32; 8],
    pub(super) children: [Child; 8],
}

/// What lies below a wide node: another one, the first of a leaf's blocks, or nothing.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct Child(pub(super) u32);

const _: () = assert!(size_of::<Wide>() == 64, "a cache line");

impl Child {
    /// A leaf without references.
    pub(super) const EMPTY: Self = Self(u32::MAX);
    const LEAF: u32 = 1 << 31;

    /// The first block of a leaf, or `None` for a wide node.
    #[inline(always)]
    pub(super) fn block(self) -> Option<usize> {
        (self.0 & Self::LEAF != 0).then_some((self.0 & !Self::LEAF) as usize)
    }
}

impl Wide {
    const NO_PLANES: Self = Self { planes: [f32::INFINITY; 8], children: [Child::EMPTY; 8] };

    /// The axes of all lanes, two bits each from the lowest on.
    #[inline(always)]
    pub(super) fn axes(&self) -> u32 {
        self.planes[7].to_bits()
    }

    fn set_plane(&mut self, lane: usize, axis: usize, position: f32) {
        self.planes[lane] = position;
        self.planes[7] = f32::from_bits(self.axes() | (axis as u32) << (2 * lane));
    }
}

/// Wide nodes and the blocks of the leaves, each in depth-first order.
pub(super) struct Layout {
    pub(super) wides: Vec<Wide>,
    pub(super) blocks: Vec<Block>,
}

impl Layout {
    pub(super) fn new(mesh: &Mesh, tree: &Tree) -> Self {
        let mut collapse = Collapse {
            mesh,
            nodes: tree.nodes(),
            references: tree.references(),
            layout: Self { wides: Vec::new(), blocks: with_huge_pages(block_count(tree)) },
        };
        match tree.nodes()[0].kind() {
            Kind::Inner { .. } => {
                collapse.child(0);
            }
            Kind::Leaf { .. } => collapse.leaf_alone(),
        }
        let Self { wides, blocks } = collapse.layout;
        let mut compact = with_huge_pages(wides.len());
        compact.extend_from_slice(&wides);
        Self { wides: compact, blocks }
    }
}

/// How many blocks the leaves of a tree fill.
fn block_count(tree: &Tree) -> usize {
    let blocks = |node: &Node| match node.kind() {
        Kind::Leaf { count, .. } => count.div_ceil(LANES),
        Kind::Inner { .. } => 0,
    };
    tree.nodes().iter().map(blocks).sum()
}

struct Collapse<'a> {
    mesh: &'a Mesh,
    nodes: &'a [Node],
    references: &'a [u32],
    layout: Layout,
}

impl Collapse<'_> {
    /// A tree that is one leaf gets a node above it.
    fn leaf_alone(&mut self) {
        self.layout.wides.push(Wide::NO_PLANES);
        let mut wide = Wide { planes: [f32::INFINITY; 8], ..Wide::NO_PLANES };
        wide.planes[7] = 0.0;
        wide.children[0] = self.child(0);
        self.layout.wides[0] = wide;
    }

    /// Lays out the subtree at `node`.
    fn child(&mut self, node: usize) -> Child {
        match self.nodes[node].kind() {
            Kind::Leaf { count: 0, .. } => Child::EMPTY,
            Kind::Leaf { first, count } => self.leaf(&self.references[first..first + count]),
            Kind::Inner { axis, position, right } => {
                let index = self.layout.wides.len();
                self.layout.wides.push(Wide::NO_PLANES);
                let mut wide = Wide::NO_PLANES;
                wide.planes[7] = 0.0;
                wide.set_plane(3, axis, position);
                for (half, child) in [node + 1, right].into_iter().enumerate() {
                    self.second_level(&mut wide, half, child);
                }
                self.layout.wides[index] = wide;
                Child(index as u32)
            }
        }
    }

    fn second_level(&mut self, wide: &mut Wide, half: usize, node: usize) {
        let Kind::Inner { axis, position, right } = self.nodes[node].kind() else {
            wide.children[4 * half] = self.child(node);
            return;
        };
        wide.set_plane(4 * half, axis, position);
        for (quarter, child) in [node + 1, right].into_iter().enumerate() {
            self.third_level(wide, 4 * half, quarter, child);
        }
    }

    fn third_level(&mut self, wide: &mut Wide, start: usize, quarter: usize, node: usize) {
        let place = start + 2 * quarter;
        let Kind::Inner { axis, position, right } = self.nodes[node].kind() else {
            wide.children[place] = self.child(node);
            return;
        };
        wide.set_plane(start + 1 + quarter, axis, position);
        wide.children[place] = self.child(node + 1);
        wide.children[place + 1] = self.child(right);
    }

    fn leaf(&mut self, triangles: &[u32]) -> Child {
        let first = self.layout.blocks.len();
        let chunks = triangles.chunks(LANES);
        let last = chunks.len() - 1;
        for (index, chunk) in chunks.enumerate() {
            let corners = |triangle: u32| self.mesh.triangle(triangle as usize);
            self.layout.blocks.push(Block::new(chunk, index == last, corners));
        }
        Child(first as u32 | Child::LEAF)
    }
}
