//! A tree as it grows: nodes in depth-first order, and the references of its leaves.

use super::BuildError;
use crate::geometry::Aabb;
use crate::tree::Node;

/// Nodes and references of a subtree; indices count from its own start.
#[derive(Default)]
pub(crate) struct Growth {
    pub(crate) nodes: Vec<Node>,
    pub(crate) references: Vec<u32>,
    /// Of leaves that have references, in order: bounds of the parts of these.
    pub(crate) parts: Vec<Aabb>,
}

impl Growth {
    /// Adds a leaf. `triangles` are in ascending order, their parts inside `bounds`.
    pub(crate) fn push_leaf(&mut self, triangles: &[u32], bounds: &Aabb) {
        debug_assert!(triangles.is_sorted(), "leaf references are sorted by triangle");
        self.nodes.push(Node::leaf(self.references.len() as u32, triangles.len() as u32));
        self.references.extend_from_slice(triangles);
        if !triangles.is_empty() {
            self.parts.push(*bounds);
        }
    }

    /// Adds an inner node, whose left child comes next, and gives its place for [`Self::set_right`].
    pub(crate) fn push_inner(&mut self, axis: usize, position: f32) -> usize {
        self.nodes.push(Node::inner(axis, position, 0));
        self.nodes.len() - 1
    }

    /// Makes the node that comes next the right child of the one at `place`.
    pub(crate) fn set_right(&mut self, place: usize) {
        let right = self.nodes.len() as u32;
        self.nodes[place] = self.nodes[place].with_right(right);
    }

    /// Adds a whole subtree.
    pub(crate) fn append(&mut self, subtree: &Self) {
        let (nodes, references) = (self.nodes.len() as u32, self.references.len() as u32);
        self.nodes.extend(subtree.nodes.iter().map(|node| node.moved(nodes, references)));
        self.references.extend_from_slice(&subtree.references);
        self.parts.extend_from_slice(&subtree.parts);
    }

    /// Refuses what the 30 bits of a node cannot name.
    pub(super) fn check_size(&self) -> Result<(), BuildError> {
        let limit = Node::MAX_INDEX;
        let refuse = |what| Err(BuildError::TreeTooLarge { what, limit });
        if self.nodes.len() > limit {
            return refuse("nodes");
        }
        if self.references.len() > limit { refuse("references") } else { Ok(()) }
    }

    /// Bytes that the vectors hold, used or not.
    pub(super) fn capacity_bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
            + self.references.capacity() * size_of::<u32>()
            + self.parts.capacity() * size_of::<Aabb>()
    }
}
