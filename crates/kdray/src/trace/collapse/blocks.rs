//! The blocks of the leaves, and their boxes.

use rayon::prelude::*;

use super::bunch::{Part, bunch};
use crate::geometry::{Aabb, Mesh};
use crate::memory::zeros_in_huge_pages;
use crate::trace::block::{Block, LANES};
use crate::trace::prepare::{greater, lesser};
use crate::tree::{Kind, Node, Tree};

/// Nodes whose leaves are laid out by one task.
const NODES: usize = 4096;

/// The blocks of all leaves, and their boxes.
pub(super) fn blocks(mesh: &Mesh, tree: &Tree, bounds: &[Aabb]) -> (Vec<Block>, Vec<Aabb>) {
    let tasks = tree.nodes().chunks(NODES).zip(bounds.chunks(NODES));
    let counts: Vec<usize> =
        tasks.clone().map(|(nodes, _)| nodes.iter().map(block_count).sum()).collect();
    let count = counts.iter().sum();
    let (mut blocks, mut boxes) = (zeros_in_huge_pages(count), vec![Aabb::EMPTY; count]);
    let mut rest = (&mut blocks[..], &mut boxes[..]);
    let task = |(task, count)| {
        let blocks = rest.0.split_off_mut(..count).expect("as many as counted");
        (task, blocks, rest.1.split_off_mut(..count).expect("as many as counted"))
    };
    let tasks: Vec<_> = tasks.zip(counts).map(task).collect();
    tasks.into_par_iter().for_each(|((nodes, bounds), blocks, boxes)| {
        fill(mesh, tree, (nodes, bounds), (blocks, boxes));
    });
    (blocks, boxes)
}

/// How many blocks a node fills.
pub(super) fn block_count(node: &Node) -> usize {
    match node.kind() {
        Kind::Leaf { count, .. } => count.div_ceil(LANES),
        Kind::Inner { .. } => 0,
    }
}

/// Writes the blocks of the leaves among `nodes`, and their boxes.
fn fill(
    mesh: &Mesh,
    tree: &Tree,
    (nodes, bounds): (&[Node], &[Aabb]),
    (blocks, boxes): (&mut [Block], &mut [Aabb]),
) {
    let mut blocks = blocks.iter_mut().zip(boxes);
    let mut parts = Vec::new();
    for (node, bounds) in nodes.iter().zip(bounds) {
        if let Kind::Leaf { first, count: count @ 1.. } = node.kind() {
            let mut rest = count.div_ceil(LANES);
            let part = |triangle: &u32| Part {
                triangle: *triangle,
                bounds: common(&Aabb::of_points(&mesh.triangle(*triangle as usize)), bounds),
            };
            parts.clear();
            parts.extend(tree.references()[first..first + count].iter().map(part));
            bunch(&mut parts, &mut |parts| {
                let (block, its_box) = blocks.next().expect("as many as counted");
                let corners = |triangle: u32| mesh.triangle(triangle as usize);
                let mut ids = [0; LANES];
                for (id, part) in ids.iter_mut().zip(parts) {
                    *id = part.triangle;
                    *its_box = its_box.union(&part.bounds);
                }
                rest -= 1;
                *block = Block::new(&ids[..parts.len()], rest == 0, corners);
            });
        }
    }
}

fn common(a: &Aabb, b: &Aabb) -> Aabb {
    Aabb {
        lower: [0, 1, 2].map(|axis| greater(a.lower[axis], b.lower[axis])),
        upper: [0, 1, 2].map(|axis| lesser(a.upper[axis], b.upper[axis])),
    }
}
