//! Make wide nodes of the exact tree.
//!
//! A wide node stands for a subtree, cut off below eight descendants. These are the ones that a ray
//! is most likely to meet, found by opening the one with the largest surface again and again; empty
//! leaves are left out. A child's box holds the parts of its triangles inside its cell and is often
//! much smaller than the cell.

use rayon::prelude::*;

use super::block::{Block, LANES};
use super::wide::{Child, Layout, Wide};
use crate::geometry::clip::clip;
use crate::geometry::{Aabb, Mesh};
use crate::memory::{with_huge_pages, zeros_in_huge_pages};
use crate::tree::{Kind, Node, Tree};

/// Nodes whose leaves are laid out by one task.
const NODES: usize = 4096;

/// The layout of a tree, its root first.
pub(super) fn collapse(mesh: &Mesh, tree: &Tree) -> Layout {
    let bounds = tight_bounds(mesh, tree);
    let mut collapse = Collapse { tree, bounds, wides: Vec::new(), block_count: 0 };
    collapse.wide(0);
    let mut wides = with_huge_pages(collapse.wides.len());
    wides.extend_from_slice(&collapse.wides);
    drop(collapse);
    Layout { wides, blocks: blocks(mesh, tree) }
}

/// The blocks of all leaves.
fn blocks(mesh: &Mesh, tree: &Tree) -> Vec<Block> {
    let tasks = tree.nodes().chunks(NODES);
    let counts: Vec<usize> =
        tasks.clone().map(|nodes| nodes.iter().map(block_count).sum()).collect();
    let mut blocks: Vec<Block> = zeros_in_huge_pages(counts.iter().sum());
    let mut rest = &mut blocks[..];
    let task = |(nodes, count)| (nodes, rest.split_off_mut(..count).expect("as many as counted"));
    let tasks: Vec<(&[Node], &mut [Block])> = tasks.zip(counts).map(task).collect();
    tasks.into_par_iter().for_each(|(nodes, blocks)| fill(mesh, tree, nodes, blocks));
    blocks
}

/// How many blocks a node fills.
fn block_count(node: &Node) -> usize {
    match node.kind() {
        Kind::Leaf { count, .. } => count.div_ceil(LANES),
        Kind::Inner { .. } => 0,
    }
}

/// Writes the blocks of the leaves among `nodes`.
fn fill(mesh: &Mesh, tree: &Tree, nodes: &[Node], blocks: &mut [Block]) {
    let mut blocks = blocks.iter_mut();
    for node in nodes {
        if let Kind::Leaf { first, count } = node.kind() {
            let mut chunks = tree.references()[first..first + count].chunks(LANES);
            while let Some(chunk) = chunks.next() {
                let corners = |triangle: u32| mesh.triangle(triangle as usize);
                let block = blocks.next().expect("as many as counted");
                *block = Block::new(chunk, chunks.len() == 0, corners);
            }
        }
    }
}

/// By node: bounds of the parts of its triangles inside its cell.
fn tight_bounds(mesh: &Mesh, tree: &Tree) -> Vec<Aabb> {
    let nodes = tree.nodes();
    let mut bounds = match tree.parts() {
        Some(parts) => known_parts(tree, parts),
        None => clipped_parts(mesh, tree),
    };
    for (index, node) in nodes.iter().enumerate().rev() {
        if let Kind::Inner { right, .. } = node.kind() {
            bounds[index] = bounds[index + 1].union(&bounds[right]);
        }
    }
    bounds
}

/// By node: what the builder knows of its parts if it is a leaf.
fn known_parts(tree: &Tree, parts: &[Aabb]) -> Vec<Aabb> {
    let mut parts = parts.iter();
    let part = |node: &Node| match node.kind() {
        Kind::Leaf { count: 1.., .. } => *parts.next().expect("every leaf has bounds"),
        _ => Aabb::EMPTY,
    };
    tree.nodes().iter().map(part).collect()
}

/// By node: bounds of the parts of its triangles if it is a leaf, found by clipping these.
fn clipped_parts(mesh: &Mesh, tree: &Tree) -> Vec<Aabb> {
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
    bounds
}

/// Descendants of a node, and the areas of those that may be opened.
struct Open {
    nodes: [usize; 8],
    areas: [f64; 8],
    len: usize,
}

/// The area of what cannot be opened.
const LEAF: f64 = -1.0;

struct Collapse<'a> {
    tree: &'a Tree,
    /// By node.
    bounds: Vec<Aabb>,
    wides: Vec<Wide>,
    /// Blocks of the leaves so far.
    block_count: usize,
}

impl Collapse<'_> {
    /// Lays out the subtree at `node` below a wide node of its own.
    fn wide(&mut self, node: usize) -> Child {
        let index = self.wides.len();
        self.wides.push(Wide::EMPTY);
        let open = self.descendants(node);
        let descendants = &open.nodes[..open.len];
        let mut wide = Wide::EMPTY;
        for (place, descendant) in descendants.iter().enumerate() {
            let child = self.child(*descendant);
            wide.set(place, &self.bounds[*descendant], child);
        }
        let (order, _) = self.order(node, descendants, &mut 0);
        wide.set_order(order, descendants.len());
        self.wides[index] = wide;
        Child(index as u32)
    }

    /// A descendant, which comes behind all that are laid out already.
    fn child(&mut self, node: usize) -> Child {
        match self.tree.nodes()[node].kind() {
            Kind::Inner { .. } => self.wide(node),
            Kind::Leaf { .. } => {
                let first = self.block_count;
                self.block_count += block_count(&self.tree.nodes()[node]);
                Child::leaf(first)
            }
        }
    }

    /// At most eight descendants that hold everything below `node`, from left to right.
    fn descendants(&self, node: usize) -> Open {
        let mut open = Open { nodes: [0; 8], areas: [LEAF; 8], len: 0 };
        if !self.is_empty(node) {
            open.len = 1;
            self.put(node, 0, &mut open);
        }
        loop {
            let (mut largest, mut area) = (None, 0.0);
            for place in 0..open.len {
                if open.areas[place] >= area {
                    (largest, area) = (Some(place), open.areas[place]);
                }
            }
            let Some(place) = largest else { return open };
            let below = self.children(open.nodes[place]).expect("leaves have no area");
            match below.map(|child| !self.is_empty(child)) {
                [true, true] if open.len == 8 => return open,
                [true, true] => {
                    open.nodes.copy_within(place..open.len, place + 1);
                    open.areas.copy_within(place..open.len, place + 1);
                    open.len += 1;
                    self.put(below[0], place, &mut open);
                    self.put(below[1], place + 1, &mut open);
                }
                [is_left, _] => self.put(below[usize::from(!is_left)], place, &mut open),
            }
        }
    }

    fn put(&self, node: usize, place: usize, open: &mut Open) {
        let is_leaf = self.children(node).is_none();
        open.nodes[place] = node;
        open.areas[place] = if is_leaf { LEAF } else { self.bounds[node].half_area() };
    }

    fn is_empty(&self, node: usize) -> bool {
        self.bounds[node].is_empty()
    }

    fn children(&self, node: usize) -> Option<[usize; 2]> {
        match self.tree.nodes()[node].kind() {
            Kind::Inner { right, .. } => Some([node + 1, right]),
            Kind::Leaf { .. } => None,
        }
    }

    /// By octant, the places of the descendants below `node` as [`Wide::order`] has them, and how
    /// many they are. `next` is the place of the first of them.
    fn order(&self, node: usize, descendants: &[usize], next: &mut usize) -> ([u32; 8], u32) {
        if descendants.get(*next) == Some(&node) {
            *next += 1;
            return ([*next as u32 - 1; 8], 1);
        }
        let Kind::Inner { axis, right, .. } = self.tree.nodes()[node].kind() else {
            return ([0; 8], 0);
        };
        let left = self.order(node + 1, descendants, next);
        let right = self.order(right, descendants, next);
        let both = |octant: usize| {
            let backward = octant >> axis & 1 == 1;
            let [near, far] = if backward { [&right, &left] } else { [&left, &right] };
            if near.1 == 0 { far.0[octant] } else { far.0[octant] | near.0[octant] << (4 * far.1) }
        };
        ([0, 1, 2, 3, 4, 5, 6, 7].map(both), left.1 + right.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BuildOptions;

    /// Triangles that reach over many cells.
    fn mesh() -> Mesh {
        let mut state = 7_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 16_777_216.0
        };
        let positions: Vec<[f32; 3]> = (0..1500).map(|_| [0; 3].map(|_| next())).collect();
        let near = |k: u32| [k, (k + 1) % 1500, (k * 7 + 2) % 1500];
        let triangles: Vec<[u32; 3]> = (0..1500).map(near).collect();
        Mesh::new(&positions, &triangles).expect("sound")
    }

    #[test]
    fn what_the_builder_knows_is_what_clipping_finds() {
        let mesh = mesh();
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("no limits");
        let known = known_parts(&tree, tree.parts().expect("it was just built"));
        for (known, found) in known.iter().zip(clipped_parts(&mesh, &tree)) {
            let is_inner_or_empty = known.is_empty();
            // Both are larger than the parts by at most some ulps of one.
            let is_near = |a: f32, b: f32| (a - b).abs() < 1e-5;
            for axis in 0..3 {
                assert!(
                    is_inner_or_empty
                        || is_near(known.lower[axis], found.lower[axis])
                            && is_near(known.upper[axis], found.upper[axis]),
                    "{known:?} {found:?}"
                );
            }
        }
    }

    #[test]
    fn every_leaf_has_its_blocks() {
        let mesh = mesh();
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("no limits");
        let layout = collapse(&mesh, &tree);
        let leaves = layout.wides.iter().flat_map(|wide| wide.children);
        let mut triangles = Vec::new();
        for first in leaves.filter_map(Child::block).filter(|first| *first < layout.blocks.len()) {
            let last = layout.blocks[first..].iter().position(Block::is_last);
            let last = first + last.expect("a leaf ends");
            triangles.extend(layout.blocks[first..=last].iter().flat_map(Block::triangles));
        }
        let mut expected = tree.references().to_vec();
        triangles.sort_unstable();
        expected.sort_unstable();
        assert_eq!(triangles, expected);
    }
}
