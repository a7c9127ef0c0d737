//! The tree as traversal reads it: nodes of eight boxes.
//!
//! Wide nodes are made from the exact tree: a node stands for a subtree of it, cut off below eight
//! descendants. These are the ones that a ray is most likely to meet, found by opening the one with
//! the largest surface again and again; empty leaves are left out. A child's box holds the parts
//! of its triangles inside its cell and is often much smaller than the cell. The cells do not
//! overlap, so neither do the boxes, and a ray comes to them one after the other.

use rayon::prelude::*;

use super::block::{Block, LANES};
use crate::geometry::clip::clip;
use crate::geometry::{Aabb, Mesh};
use crate::memory::with_huge_pages;
use crate::tree::{Kind, Node, Tree};

/// Eight boxes, and what is in them. Free places have empty boxes.
#[repr(C, align(32))]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct Wide {
    /// By end (lower, upper), axis and child.
    pub(super) bounds: [[[f32; 8]; 3]; 2],
    pub(super) children: [Child; 8],
}

/// What is in a box: another wide node, or the first of a leaf's blocks.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct Child(pub(super) u32);

impl Child {
    const LEAF: u32 = 1 << 31;

    /// The first block of a leaf, or `None` for a wide node.
    #[inline(always)]
    pub(super) fn block(self) -> Option<usize> {
        (self.0 & Self::LEAF != 0).then_some((self.0 & !Self::LEAF) as usize)
    }
}

impl Wide {
    pub(super) const EMPTY: Self = Self {
        bounds: [[[f32::INFINITY; 8]; 3], [[f32::NEG_INFINITY; 8]; 3]],
        children: [Child(0); 8],
    };

    pub(super) fn set(&mut self, place: usize, bounds: &Aabb, child: Child) {
        for axis in 0..3 {
            self.bounds[0][axis][place] = bounds.lower[axis];
            self.bounds[1][axis][place] = bounds.upper[axis];
        }
        self.children[place] = child;
    }
}

/// Wide nodes and the blocks of the leaves, each in depth-first order.
pub(super) struct Layout {
    pub(super) wides: Vec<Wide>,
    pub(super) blocks: Vec<Block>,
}

impl Layout {
    pub(super) fn new(mesh: &Mesh, tree: &Tree) -> Self {
        let bounds = tight_bounds(mesh, tree);
        let layout = Self { wides: Vec::new(), blocks: with_huge_pages(block_count(tree)) };
        let mut collapse = Collapse { mesh, tree, bounds, layout };
        collapse.wide(0);
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

/// By node: bounds of the parts of its triangles inside its cell.
fn tight_bounds(mesh: &Mesh, tree: &Tree) -> Vec<Aabb> {
    let nodes = tree.nodes();
    let mut bounds = vec![tree.bounds(); nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        if let Kind::Inner { axis, position, right } = node.kind() {
            let [left_cell, right_cell] = bounds[index].cut(axis, position);
            (bounds[index + 1], bounds[right]) = (left_cell, right_cell);
        }
    }
    bounds.par_iter_mut().zip(nodes).for_each(|(bounds, node)| {
        if let Kind::Leaf { first, count } = node.kind() {
            let triangles = &tree.references()[first..first + count];
            let part = |triangle: &u32| clip(&mesh.triangle(*triangle as usize), bounds);
            *bounds =
                triangles.iter().filter_map(part).fold(Aabb::EMPTY, |all, part| all.union(&part));
        }
    });
    for (index, node) in nodes.iter().enumerate().rev() {
        if let Kind::Inner { right, .. } = node.kind() {
            bounds[index] = bounds[index + 1].union(&bounds[right]);
        }
    }
    bounds
}

struct Collapse<'a> {
    mesh: &'a Mesh,
    tree: &'a Tree,
    bounds: Vec<Aabb>,
    layout: Layout,
}

impl Collapse<'_> {
    /// Lays out the subtree at `node` below a wide node of its own; gives that node's index.
    fn wide(&mut self, node: usize) -> u32 {
        let index = self.layout.wides.len();
        self.layout.wides.push(Wide::EMPTY);
        let mut wide = Wide::EMPTY;
        for (place, descendant) in self.descendants(node).into_iter().enumerate() {
            let bounds = self.bounds[descendant];
            let child = self.child(descendant);
            wide.set(place, &bounds, child);
        }
        self.layout.wides[index] = wide;
        index as u32
    }

    /// At most eight descendants that hold everything below `node`.
    fn descendants(&self, node: usize) -> Vec<usize> {
        let is_empty = |node: usize| self.bounds[node].is_empty();
        let children = |node: usize| match self.tree.nodes()[node].kind() {
            Kind::Inner { right, .. } => Some([node + 1, right]),
            Kind::Leaf { .. } => None,
        };
        let mut open: Vec<usize> = if is_empty(node) { Vec::new() } else { vec![node] };
        loop {
            let area = |place: &usize| self.bounds[open[*place]].half_area();
            let largest = (0..open.len())
                .filter(|place| children(open[*place]).is_some())
                .max_by(|a, b| area(a).total_cmp(&area(b)));
            let Some(largest) = largest else { return open };
            let below = children(open[largest]).into_iter().flatten();
            let below: Vec<usize> = below.filter(|child| !is_empty(*child)).collect();
            if open.len() - 1 + below.len() > 8 {
                return open;
            }
            open.splice(largest..=largest, below);
        }
    }

    fn child(&mut self, node: usize) -> Child {
        match self.tree.nodes()[node].kind() {
            Kind::Inner { .. } => Child(self.wide(node)),
            Kind::Leaf { first, count } => self.leaf(first, count),
        }
    }

    fn leaf(&mut self, first: usize, count: usize) -> Child {
        let start = self.layout.blocks.len() as u32;
        let chunks = self.tree.references()[first..first + count].chunks(LANES);
        let last = chunks.len() - 1;
        for (index, chunk) in chunks.enumerate() {
            let corners = |triangle: u32| self.mesh.triangle(triangle as usize);
            self.layout.blocks.push(Block::new(chunk, index == last, corners));
        }
        Child(start | Child::LEAF)
    }
}
