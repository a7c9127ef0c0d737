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
use crate::memory::with_huge_pages;
use crate::tree::{Kind, Node, Tree};

/// Subtrees of at least this many references are laid out as tasks of their own.
const LARGE: usize = 16 * 1024;

/// The layout of a tree, its root first.
pub(super) fn collapse(mesh: &Mesh, tree: &Tree) -> Layout {
    let collapse = Collapse { mesh, tree, bounds: tight_bounds(mesh, tree) };
    let mut layout = Layout { wides: Vec::new(), blocks: with_huge_pages(block_count(tree)) };
    collapse.wide(0, &mut layout);
    layout
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
    mesh: &'a Mesh,
    tree: &'a Tree,
    bounds: Vec<Aabb>,
}

impl Collapse<'_> {
    /// Lays out the subtree at `node` below a wide node of its own.
    fn wide(&self, node: usize, layout: &mut Layout) -> Child {
        let index = layout.wides.len();
        layout.wides.push(Wide::EMPTY);
        let open = self.descendants(node);
        let descendants = &open.nodes[..open.len];
        let mut wide = Wide::EMPTY;
        // Tasks take memory twice, once for themselves: not where there is nobody to do them.
        if rayon::current_num_threads() > 1 && self.is_large(node) {
            let children = self.children_as_tasks(descendants, layout);
            for (place, child) in children.into_iter().enumerate() {
                wide.set(place, &self.bounds[descendants[place]], child);
            }
        } else {
            for (place, descendant) in descendants.iter().enumerate() {
                wide.set(place, &self.bounds[*descendant], self.child(*descendant, layout));
            }
        }
        let (order, _) = self.order(node, descendants, &mut 0);
        wide.set_order(order, descendants.len());
        layout.wides[index] = wide;
        Child(index as u32)
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

    fn child(&self, node: usize, layout: &mut Layout) -> Child {
        match self.tree.nodes()[node].kind() {
            Kind::Inner { .. } => self.wide(node, layout),
            Kind::Leaf { first, count } => self.leaf(first, count, layout),
        }
    }

    fn leaf(&self, first: usize, count: usize, layout: &mut Layout) -> Child {
        let start = layout.blocks.len();
        let chunks = self.tree.references()[first..first + count].chunks(LANES);
        let last = chunks.len() - 1;
        for (index, chunk) in chunks.enumerate() {
            let corners = |triangle: u32| self.mesh.triangle(triangle as usize);
            layout.blocks.push(Block::new(chunk, index == last, corners));
        }
        Child::leaf(start)
    }

    /// Lays out large children at the same time, each for itself, and puts them one behind the
    /// other: where everything is does not depend on the threads.
    fn children_as_tasks(&self, nodes: &[usize], layout: &mut Layout) -> Vec<Child> {
        let lay_out = |node: &usize| {
            let mut layout = Layout { wides: Vec::new(), blocks: Vec::new() };
            let child = self.child(*node, &mut layout);
            (child, layout)
        };
        let children: Vec<_> = nodes.par_iter().map(lay_out).collect();
        children.into_iter().map(|(child, below)| layout.append(child, below)).collect()
    }

    /// Whether a subtree has enough references to be worth a task.
    fn is_large(&self, node: usize) -> bool {
        let (mut first_leaf, mut last_leaf) = (node, node);
        while let Some([left, _]) = self.children(first_leaf) {
            first_leaf = left;
        }
        while let Some([_, right]) = self.children(last_leaf) {
            last_leaf = right;
        }
        let start = |leaf: usize| match self.tree.nodes()[leaf].kind() {
            Kind::Leaf { first, .. } => first,
            Kind::Inner { .. } => 0,
        };
        start(last_leaf) - start(first_leaf) >= LARGE
    }
}
