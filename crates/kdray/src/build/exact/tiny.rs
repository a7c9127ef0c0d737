//! Subtrees of few references: to count all of them at every plane is faster than to keep events.

use super::columns::{Columns, Counts, MOST, Sides};
use super::set::Set;
use super::sweep::{Candidate, cheapest};
use super::{Context, Growth, Node, NodeCost};
use crate::geometry::Aabb;

/// Subtrees of at most this many references are tiny.
pub(super) const TINY: usize = MOST;

/// Memory that is used again from subtree to subtree.
#[derive(Default)]
pub(super) struct Tiny {
    /// A node and the right siblings on the way to it.
    pending: Vec<Columns>,
    counts: Box<Counts>,
    straddlers: Vec<Straddler>,
}

/// A reference on both sides of a plane, and its parts there.
type Straddler = (u32, [Option<Aabb>; 2]);

impl Tiny {
    /// Builds the subtree of a node.
    pub(super) fn build(&mut self, context: &Context, growth: &mut Growth, set: &Set, node: Node) {
        let mut subtree = Subtree { context, growth, tiny: self };
        subtree.columns_at(0).fill(set);
        subtree.node(0, set.triangles.len(), node, false);
    }

    /// Bytes that it holds.
    pub(super) fn bytes(&self) -> usize {
        self.pending.capacity() * size_of::<Columns>()
            + self.straddlers.capacity() * size_of::<Straddler>()
    }
}

struct Subtree<'a> {
    context: &'a Context<'a>,
    growth: &'a mut Growth,
    tiny: &'a mut Tiny,
}

impl Subtree<'_> {
    /// The columns of `level`, which may hold anything.
    fn columns_at(&mut self, level: usize) -> &mut Columns {
        if self.tiny.pending.len() == level {
            self.tiny.pending.push(Columns::EMPTY);
        }
        &mut self.tiny.pending[level]
    }

    /// Builds the subtree of the node whose columns are at `level`. The counts of its planes may
    /// be known already.
    fn node(&mut self, level: usize, mut count: usize, mut node: Node, mut is_counted: bool) {
        loop {
            let Some((candidate, reach)) = self.plane(level, count, &node, &mut is_counted) else {
                let leaf = &self.tiny.pending[level];
                return self.growth.push_leaf(&leaf.triangles[..count], &leaf.bounds(count));
            };
            let place = self.growth.push_inner(candidate.axis, candidate.position);
            let [left, right] = node.cut(candidate.axis, candidate.position, [0, 0]);
            match reach {
                // The plane cuts off empty space, and the other child is the node again.
                [0, _] => {
                    self.growth.push_leaf(&[], &Aabb::EMPTY);
                    self.growth.set_right(place);
                }
                [_, 0] => {
                    self.node(level, count, left, true);
                    self.growth.set_right(place);
                    return self.growth.push_leaf(&[], &Aabb::EMPTY);
                }
                _ => {
                    let counts = self.split(level, reach, [&left.bounds, &right.bounds]);
                    self.node(level + 1, counts[0], left, false);
                    self.growth.set_right(place);
                    (count, is_counted) = (counts[1], false);
                }
            }
            node = right;
        }
    }

    /// The cheapest plane of a node and the references that reach its two sides, as bits, or
    /// `None` if the node is a leaf.
    fn plane(
        &mut self,
        level: usize,
        count: usize,
        node: &Node,
        is_counted: &mut bool,
    ) -> Option<(Candidate, [u64; 2])> {
        let cost = self.context.prices(node, count)?;
        let Tiny { pending, counts, .. } = &mut *self.tiny;
        let columns = &pending[level];
        if !*is_counted {
            columns.count(count, counts);
            *is_counted = true;
        }
        let by_axis = columns.cheapest(count, counts, &node.bounds, &cost);
        let candidate = cheapest(by_axis, cost.leaf(count))?;
        let sides = columns.sides(count, candidate.axis, candidate.position);
        Some((candidate, reach(&sides, &node.bounds, &candidate, &cost)))
    }

    /// Leaves the references of the right child at `level`, and those of the left one above; gives
    /// how many they are. `reach` are the references that reach the two, as bits.
    fn split(
        &mut self,
        level: usize,
        [mut left, mut right]: [u64; 2],
        cells: [&Aabb; 2],
    ) -> [usize; 2] {
        self.columns_at(level + 1);
        let Tiny { pending, straddlers, .. } = &mut *self.tiny;
        let [columns, above] = pending[level..].first_chunk_mut().expect("two levels");
        straddlers.clear();
        let mut rest = left & right;
        while rest != 0 {
            let reference = rest.trailing_zeros();
            let triangle = columns.triangles[reference as usize];
            let corners = self.context.mesh.triangle(triangle as usize);
            let parts = cells.map(|cell| self.context.limits.part(&corners, cell));
            left &= !(u64::from(parts[0].is_none()) << reference);
            right &= !(u64::from(parts[1].is_none()) << reference);
            straddlers.push((reference, parts));
            rest &= rest - 1;
        }
        columns.keep(left, above);
        columns.retain(right);
        for (reference, parts) in straddlers {
            for (bits, child, part) in
                [(left, &mut *above, parts[0]), (right, &mut *columns, parts[1])]
            {
                let before = bits & ((1 << *reference) - 1);
                if let Some(part) = part {
                    child.set_bounds(before.count_ones() as usize, &part);
                }
            }
        }
        [left, right].map(|bits| bits.count_ones() as usize)
    }
}

/// The references that reach the two sides of a plane. Flat ones reach the cheaper side (left on a
/// tie).
fn reach(sides: &Sides, bounds: &Aabb, candidate: &Candidate, cost: &NodeCost) -> [u64; 2] {
    let Candidate { axis, position, .. } = *candidate;
    let flat_left = [sides.below | sides.flat, sides.above];
    let flat_right = [sides.below, sides.above | sides.flat];
    if sides.flat == 0 {
        return flat_left;
    }
    let distances = [position - bounds.lower[axis], bounds.upper[axis] - position];
    let price =
        |reach: [u64; 2]| cost.split(axis, distances, reach.map(|bits| bits.count_ones() as i32));
    if price(flat_left) <= price(flat_right) { flat_left } else { flat_right }
}
