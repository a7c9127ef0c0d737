//! Subtrees of few references: to count all of them at every plane is faster than to keep events.

use super::columns::{Columns, Counts, MOST};
use super::set::Set;
use super::sweep::{Candidate, cheapest};
use super::{Context, Growth, Node, NodeCost};
use crate::build::plane::{Plane, Side};
use crate::geometry::Aabb;

/// Subtrees of at most this many references are tiny.
pub(super) const TINY: usize = MOST;

/// Memory that is used again from subtree to subtree.
#[derive(Default)]
pub(super) struct Tiny {
    /// A node and the right siblings on the way to it.
    pending: Vec<Columns>,
    counts: Box<Counts>,
}

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
            let Some(plane) = self.plane(level, count, &node, &mut is_counted) else {
                return self.growth.push_leaf(&self.tiny.pending[level].triangles[..count]);
            };
            let place = self.growth.push_inner(plane.axis, plane.position);
            let [left, right] = node.cut(plane.axis, plane.position, [0, 0]);
            let reach = self.tiny.pending[level].reach(count, &plane);
            match reach {
                // The plane cuts off empty space, and the other child is the node again.
                [0, _] => {
                    self.growth.push_leaf(&[]);
                    self.growth.set_right(place);
                }
                [_, 0] => {
                    self.node(level, count, left, true);
                    self.growth.set_right(place);
                    return self.growth.push_leaf(&[]);
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

    /// The cheapest plane of a node, or `None` if it is a leaf.
    fn plane(
        &mut self,
        level: usize,
        count: usize,
        node: &Node,
        is_counted: &mut bool,
    ) -> Option<Plane> {
        let cost = self.context.prices(node, count)?;
        let Tiny { pending, counts } = &mut *self.tiny;
        if !*is_counted {
            pending[level].count(count, counts);
            *is_counted = true;
        }
        let by_axis = pending[level].cheapest(count, counts, &node.bounds, &cost);
        let candidate = cheapest(by_axis, cost.leaf(count))?;
        Some(pending[level].plane(count, &node.bounds, &candidate, &cost))
    }

    /// Leaves the references of the right child at `level`, and those of the left one above; gives
    /// how many they are. `reach` are the references that reach the two, as bits.
    fn split(
        &mut self,
        level: usize,
        [mut left, mut right]: [u32; 2],
        cells: [&Aabb; 2],
    ) -> [usize; 2] {
        self.columns_at(level + 1);
        let [columns, above] = self.tiny.pending[level..].first_chunk_mut().expect("two levels");
        let mut parts = [(0, [None; 2]); MOST];
        let (mut straddlers, mut rest) = (0, left & right);
        while rest != 0 {
            let reference = rest.trailing_zeros();
            let corners = self.context.mesh.triangle(columns.triangles[reference as usize] as usize);
            let part = cells.map(|cell| self.context.limits.part(&corners, cell));
            left &= !(u32::from(part[0].is_none()) << reference);
            right &= !(u32::from(part[1].is_none()) << reference);
            parts[straddlers] = (reference, part);
            straddlers += 1;
            rest &= rest - 1;
        }
        columns.keep(left, above);
        let node = columns.clone();
        node.keep(right, columns);
        for (reference, part) in &parts[..straddlers] {
            for (bits, child, part) in [(left, &mut *above, part[0]), (right, &mut *columns, part[1])] {
                let before = bits & ((1 << reference) - 1);
                if let Some(part) = part {
                    child.set_bounds(before.count_ones() as usize, &part);
                }
            }
        }
        [left.count_ones() as usize, right.count_ones() as usize]
    }
}

impl Columns {
    /// The plane of `candidate`, with its flat references on the cheaper side (left on a tie).
    fn plane(&self, count: usize, bounds: &Aabb, candidate: &Candidate, cost: &NodeCost) -> Plane {
        let Candidate { axis, position, .. } = *candidate;
        let plane = |flat| Plane { axis, position, flat };
        let [left, right] = [Side::Left, Side::Right].map(|flat| {
            self.reach(count, &plane(flat)).map(|bits| bits.count_ones() as i32)
        });
        if left == right {
            return plane(Side::Left);
        }
        let distances = [position - bounds.lower[axis], bounds.upper[axis] - position];
        let price = |counts| cost.split(axis, distances, counts);
        plane(if price(left) <= price(right) { Side::Left } else { Side::Right })
    }
}
