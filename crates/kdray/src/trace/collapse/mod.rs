//! Make wide nodes of the exact tree.
//!
//! A wide node stands for a subtree, cut off below at most eight descendants; empty leaves are left
//! out. A child's box holds the parts of its triangles inside its cell and is often much smaller than
//! the cell. A leaf of several blocks is one child, or each of its blocks is one, with a box of its
//! own. What is best is planned.

mod blocks;
mod bounds;
mod bunch;
mod plan;
mod shapes;

use smallvec::SmallVec;

use super::wide::{Child, Layout, Wide};
use crate::geometry::{Aabb, Mesh};
use crate::memory::with_huge_pages;
use crate::tree::{Kind, Tree};
use blocks::blocks;
use bounds::tight_bounds;
use plan::{Item, Items, Plan};
use shapes::Shapes;

/// The layout of a tree, its root first.
pub(super) fn collapse(mesh: &Mesh, tree: &Tree) -> Layout {
    let bounds = tight_bounds(mesh, tree);
    let (blocks, boxes) = blocks(mesh, tree, &bounds);
    let plan = Plan::new(Shapes::new(tree, bounds, boxes));
    let mut collapse = Collapse { plan: &plan, wides: Vec::new() };
    collapse.wide(plan.shapes.solid(0));
    let found = collapse.wides;
    let mut wides = with_huge_pages(found.len());
    wides.extend_from_slice(&found);
    Layout { wides, blocks }
}

struct Collapse<'a> {
    plan: &'a Plan<'a>,
    wides: Vec<Wide>,
}

impl Collapse<'_> {
    /// Lays out the subtree at `node` below a wide node of its own.
    fn wide(&mut self, node: usize) -> Child {
        let index = self.wides.len();
        self.wides.push(Wide::EMPTY);
        let (mut items, mut wide) = (Items::new(), Wide::EMPTY);
        if !self.plan.shapes.is_empty(node) {
            self.plan.open(node, 8, &mut items);
        }
        for (place, item) in items.iter().enumerate() {
            match *item {
                Item::Node(node) => {
                    wide.set(place, &self.plan.shapes.bounds[node], self.child(node))
                }
                Item::Block(block) => {
                    wide.set(place, &self.plan.shapes.boxes[block], Child::one(block));
                }
            }
        }
        let (order, _) = self.order(node, &items, &mut 0);
        wide.set_order(order, items.len());
        self.wides[index] = wide;
        Child(index as u32)
    }

    fn child(&mut self, node: usize) -> Child {
        let is_leaf = self.plan.shapes.children(node).is_none();
        if is_leaf && self.plan.is_chain(node) {
            let blocks = self.plan.shapes.blocks(node);
            if blocks.len() == 1 { Child::one(blocks.start) } else { Child::leaf(blocks.start) }
        } else {
            self.wide(node)
        }
    }

    /// By octant, the places of the items below `node` as [`Wide::order`] has them, and how
    /// many they are. `next` is the place of the first of them.
    fn order(&self, node: usize, items: &[Item], next: &mut usize) -> ([u32; 8], u32) {
        if items.get(*next) == Some(&Item::Node(node)) {
            *next += 1;
            return ([*next as u32 - 1; 8], 1);
        }
        let Kind::Inner { axis, right, .. } = self.plan.shapes.tree.nodes()[node].kind() else {
            let first = *next;
            // Nothing may be left of the triangles of a leaf in its cell.
            *next += if self.plan.shapes.is_empty(node) {
                0
            } else {
                self.plan.shapes.blocks(node).len()
            };
            return (self.order_of_blocks(&items[first..*next], first), (*next - first) as u32);
        };
        let left = self.order(node + 1, items, next);
        let right = self.order(right, items, next);
        let both = |octant: usize| {
            let backward = octant >> axis & 1 == 1;
            let [near, far] = if backward { [&right, &left] } else { [&left, &right] };
            if near.1 == 0 { far.0[octant] } else { far.0[octant] | near.0[octant] << (4 * far.1) }
        };
        ([0, 1, 2, 3, 4, 5, 6, 7].map(both), left.1 + right.1)
    }

    /// The same for the blocks of a leaf: by how far their middles are along the octant's diagonal.
    fn order_of_blocks(&self, items: &[Item], first: usize) -> [u32; 8] {
        [0, 1, 2, 3, 4, 5, 6, 7].map(|octant: usize| {
            let along = |item: &Item| {
                let Item::Block(block) = *item else { return 0.0 };
                let Aabb { lower, upper } = self.plan.shapes.boxes[block];
                let sign = |axis: usize| if octant >> axis & 1 == 1 { -1.0 } else { 1.0 };
                (0..3).map(|axis| sign(axis) * (lower[axis] + upper[axis])).sum::<f32>()
            };
            let places = items.iter().enumerate();
            let mut places: SmallVec<[(f32, usize); 8]> =
                places.map(|(at, item)| (along(item), first + at)).collect();
            places.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            places.iter().fold(0, |order, (_, place)| order << 4 | *place as u32)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::bounds::{clipped_parts, known_parts};
    use super::*;
    use crate::BuildOptions;
    use crate::trace::block::Block;

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
        let leaves = layout.wides.iter().flat_map(|wide| {
            let is_free = |place: &usize| wide.bounds[0][0][*place] > wide.bounds[1][0][*place];
            (0..8).filter(move |place| !is_free(place)).map(|place| wide.children[place])
        });
        let mut triangles = Vec::new();
        for (child, first) in leaves.filter_map(|child| Some((child, child.block()?))) {
            triangles.extend(layout.blocks_of(child, first).iter().flat_map(Block::triangles));
        }
        let mut expected = tree.references().to_vec();
        triangles.sort_unstable();
        expected.sort_unstable();
        assert_eq!(triangles, expected);
    }
}
