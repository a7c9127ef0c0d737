//! The 8-byte node.

/// A node of the tree.
///
/// ```text
///          word 0                 word 1: 31                      2 1  0
/// inner    plane, bits of an f32          index of the right child  axis (0, 1, 2)
/// leaf     first reference                number of references      3
/// ```
///
/// The left child of an inner node is the node after it.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Node {
    first: u32,
    second: u32,
}

/// A node, taken apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A node that is cut by a plane.
    Inner {
        /// 0, 1 or 2 for x, y, z.
        axis: usize,
        /// Where the plane meets that axis.
        position: f32,
        /// Index of the right child; the left one is the next node.
        right: usize,
    },
    /// A node that is not cut.
    Leaf {
        /// Index of its first reference.
        first: usize,
        /// How many references it has.
        count: usize,
    },
}

const LEAF: u32 = 3;

impl Node {
    /// The most nodes or references that an index can name.
    pub(crate) const MAX_INDEX: usize = (1 << 30) - 1;

    #[inline]
    pub(crate) fn inner(axis: usize, position: f32, right: u32) -> Self {
        Self { first: position.to_bits(), second: right << 2 | axis as u32 }
    }

    #[inline]
    pub(crate) fn leaf(first: u32, count: u32) -> Self {
        Self { first, second: count << 2 | LEAF }
    }

    /// The node, taken apart.
    #[must_use]
    #[inline]
    pub fn kind(self) -> Kind {
        let index = (self.second >> 2) as usize;
        match self.second & 3 {
            LEAF => Kind::Leaf { first: self.first as usize, count: index },
            axis => {
                let position = f32::from_bits(self.first);
                Kind::Inner { axis: axis as usize, position, right: index }
            }
        }
    }

    /// The same inner node with another right child.
    pub(crate) fn with_right(self, right: u32) -> Self {
        Self { second: right << 2 | self.second & 3, ..self }
    }

    /// The same node where its subtree starts at node `nodes` and reference `references`.
    pub(crate) fn moved(self, nodes: u32, references: u32) -> Self {
        if self.second & 3 == LEAF {
            Self { first: self.first + references, ..self }
        } else {
            Self { second: self.second + (nodes << 2), ..self }
        }
    }
}

impl std::fmt::Debug for Node {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.kind().fmt(f)
    }
}

const _: () = assert!(size_of::<Node>() == 8, "a cache line holds eight nodes");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_keep_what_they_are_made_of() {
        let inner = Node::inner(2, -1.5, 70).kind();
        assert_eq!(inner, Kind::Inner { axis: 2, position: -1.5, right: 70 });
        let leaf = Node::leaf(5, Node::MAX_INDEX as u32).kind();
        assert_eq!(leaf, Kind::Leaf { first: 5, count: Node::MAX_INDEX });
    }

    #[test]
    fn moving_a_subtree_moves_its_indices() {
        let inner = Node::inner(1, 0.5, 7).moved(100, 1000);
        assert_eq!(inner, Node::inner(1, 0.5, 107));
        assert_eq!(Node::leaf(3, 4).moved(100, 1000), Node::leaf(1003, 4));
    }
}
