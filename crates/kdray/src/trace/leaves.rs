//! The tree as traversal reads it: leaves point at blocks of triangles, in leaf order.

use super::block::{Block, LANES};
use crate::geometry::Mesh;
use crate::tree::{Kind, Node, Tree};

/// Nodes whose leaves count blocks, and the blocks.
pub(super) struct Leaves {
    pub(super) nodes: Vec<Node>,
    pub(super) blocks: Vec<Block>,
}

impl Leaves {
    pub(super) fn new(mesh: &Mesh, tree: &Tree) -> Self {
        let mut leaves = Self { nodes: Vec::with_capacity(tree.nodes().len()), blocks: Vec::new() };
        for node in tree.nodes() {
            let Kind::Leaf { first, count } = node.kind() else {
                leaves.nodes.push(*node);
                continue;
            };
            let start = leaves.blocks.len();
            for triangles in tree.references()[first..first + count].chunks(LANES) {
                leaves.blocks.push(Block::new(triangles, |index| mesh.triangle(index as usize)));
            }
            let blocks = leaves.blocks.len() - start;
            leaves.nodes.push(Node::leaf(start as u32, blocks as u32));
        }
        leaves
    }
}
