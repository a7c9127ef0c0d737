//! A tree without what is empty in it.

use std::ops::Range;

use super::blocks::block_count;
use crate::geometry::Aabb;
use crate::tree::{Kind, Node, Tree};

/// The boxes of a tree and of its blocks.
pub(super) struct Shapes<'a> {
    pub(super) tree: &'a Tree,
    /// By block.
    pub(super) boxes: Vec<Aabb>,
    /// By node; the same below.
    pub(super) bounds: Vec<Aabb>,
    /// The first block at or below it.
    firsts: Vec<u32>,
}

impl<'a> Shapes<'a> {
    pub(super) fn new(tree: &'a Tree, bounds: Vec<Aabb>, boxes: Vec<Aabb>) -> Self {
        let mut first = 0;
        let first_of = |node: &Node| {
            first += block_count(node) as u32;
            first - block_count(node) as u32
        };
        let firsts = tree.nodes().iter().map(first_of).collect();
        Self { tree, boxes, bounds, firsts }
    }

    /// The blocks of a leaf.
    pub(super) fn blocks(&self, leaf: usize) -> Range<usize> {
        let first = self.firsts[leaf] as usize;
        first..first + block_count(&self.tree.nodes()[leaf])
    }

    pub(super) fn is_empty(&self, node: usize) -> bool {
        self.bounds[node].is_empty()
    }

    /// What is left of a node if nodes with an empty side are passed over.
    pub(super) fn solid(&self, mut node: usize) -> usize {
        while let Kind::Inner { right, .. } = self.tree.nodes()[node].kind() {
            node = match [node + 1, right].map(|child| self.is_empty(child)) {
                [false, false] => break,
                [true, _] => right,
                [false, true] => node + 1,
            };
        }
        node
    }

    /// The children of a solid inner node, solid both.
    pub(super) fn children(&self, node: usize) -> Option<[usize; 2]> {
        let Kind::Inner { right, .. } = self.tree.nodes()[node].kind() else { return None };
        Some([self.solid(node + 1), self.solid(right)])
    }
}
