//! Which descendants of a node are the children of its wide node.
//!
//! Of all ways to cut a subtree into wide nodes this finds the one with the least expected number of
//! steps and blocks, from the leaves up: for every node and every number of children, what it costs
//! if at most so many stand for it \[YKL17].

use smallvec::SmallVec;

use super::shapes::Shapes;
use crate::geometry::Aabb;
use crate::trace::prepare::lesser;

/// What a child of a wide node stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Item {
    /// All that is below a node.
    Node(usize),
    /// A block of a leaf.
    Block(usize),
}

/// Children of a wide node, from left to right.
pub(super) type Items = SmallVec<[Item; 8]>;

/// Price of a step; that of a block is one.
const STEP: f64 = 1.0;

/// What the best layout of every subtree costs: each node and block as much as its box is met.
pub(super) struct Plan<'a> {
    pub(super) shapes: Shapes<'a>,
    /// By node and number, from one to eight: the cost if at most so many children stand for it.
    costs: Vec<[f32; 8]>,
}

impl<'a> Plan<'a> {
    pub(super) fn new(shapes: Shapes<'a>) -> Self {
        let costs = vec![[0.0; 8]; shapes.bounds.len()];
        let mut plan = Self { shapes, costs };
        for node in (0..plan.costs.len()).rev() {
            let shapes = &plan.shapes;
            if !shapes.is_empty(node) && shapes.solid(node) == node {
                plan.costs[node] = match shapes.children(node) {
                    None => plan.costs_of_leaf(node),
                    Some(below) => plan.costs_of_both(node, below),
                };
            }
        }
        plan
    }

    fn costs_of_leaf(&self, node: usize) -> [f32; 8] {
        let boxes = &self.shapes.boxes[self.shapes.blocks(node)];
        let area = self.shapes.bounds[node].half_area();
        if boxes.len() == 1 {
            return [area as f32; 8];
        }
        let apart: f64 = boxes.iter().map(Aabb::half_area).sum();
        let together = area * boxes.len() as f64;
        let alone = if boxes.len() <= 8 { together.min(STEP * area + apart) } else { together };
        std::array::from_fn(|more| {
            (if more + 1 >= boxes.len() { apart.min(alone) } else { alone }) as f32
        })
    }

    fn costs_of_both(&self, node: usize, below: [usize; 2]) -> [f32; 8] {
        let [left, right] = below.map(|node| self.costs[node]);
        let mut costs = [f32::INFINITY; 8];
        // The costs of the right, behind as many children as the left has.
        let mut behind = [f32::INFINITY; 16];
        behind[8..].copy_from_slice(&right);
        for (share, left) in left.iter().enumerate().take(7) {
            for (cost, right) in costs.iter_mut().zip(&behind[7 - share..]) {
                *cost = lesser(*cost, left + right);
            }
        }
        costs[0] = (STEP * self.shapes.bounds[node].half_area()) as f32 + costs[7];
        for more in 1..8 {
            costs[more] = lesser(costs[more], costs[more - 1]);
        }
        costs
    }

    /// How many of so many children are best for the left, and the cost.
    #[inline]
    fn best_share(&self, [left, right]: [usize; 2], children: usize) -> (usize, f32) {
        let mut best = (1, f32::INFINITY);
        for share in 1..children {
            let cost = self.costs[left][share - 1] + self.costs[right][children - share - 1];
            if cost < best.1 {
                best = (share, cost);
            }
        }
        best
    }

    /// The best children, so many at most, for what is below a node.
    pub(super) fn open(&self, node: usize, children: usize, items: &mut Items) {
        if let Some([left, right]) = self.shapes.children(node) {
            let (share, _) = self.best_share([left, right], children);
            self.stand(left, share, items);
            self.stand(right, children - share, items);
            return;
        }
        let blocks = self.shapes.blocks(node);
        if blocks.len() > 1 && blocks.len() <= 8 {
            items.extend(blocks.map(Item::Block));
        } else {
            items.push(Item::Node(node));
        }
    }

    /// The best children, so many at most, for a node.
    fn stand(&self, node: usize, children: usize, items: &mut Items) {
        let costs = &self.costs[node];
        let fewest = costs.iter().position(|cost| *cost == costs[children - 1]).unwrap_or(0) + 1;
        if fewest == 1 {
            items.push(Item::Node(node));
        } else {
            self.open(node, fewest, items);
        }
    }

    /// Whether a leaf is best left as it is, block after block, below a box of its own.
    pub(super) fn is_chain(&self, leaf: usize) -> bool {
        let count = self.shapes.blocks(leaf).len();
        let together = (self.shapes.bounds[leaf].half_area() * count as f64) as f32;
        count == 1 || count > 8 || self.costs[leaf][0] == together
    }
}
