//! Find the cheapest plane of a node.
//!
//! At event `k` of an axis, with `entered` references that entered the left side before it, there
//! are
//!
//! ```text
//! N_left = entered       N_right = N - (k - entered) - (1 if the event leaves)
//! ```
//!
//! references on the two sides: the counts of \[WZL11], section 3. Events that share a plane with
//! others count too many references, never too few, and prices grow with the counts; so every event
//! may be priced as if it were alone, and the cheapest of them is the cheapest plane. The last end
//! and the first start of a plane count right, and so do the first flat reference that enters, with
//! all flat ones on the right, and the last one that leaves, with all of them on the left.

use super::event::{Event, Kind};
#[cfg(target_arch = "x86_64")]
use super::lanes::{Avx2, detect};
use super::lanes::{LANES, Lanes, Plain};
use super::pricing::Pricing;
use super::set::Set;
use crate::build::NodeCost;
use crate::geometry::Aabb;

/// The cheapest plane found so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) price: f32,
    pub(super) axis: usize,
    pub(super) position: f32,
}

/// The first of the cheapest planes in order of axis and position, if cheaper than a leaf.
pub(super) fn cheapest(by_axis: [Option<Candidate>; 3], leaf_price: f32) -> Option<Candidate> {
    let mut best = None;
    let mut best_price = leaf_price;
    for candidate in by_axis.into_iter().flatten() {
        if candidate.price < best_price {
            best_price = candidate.price;
            best = Some(candidate);
        }
    }
    best
}

/// The first of the cheapest planes along `axis` that lie strictly inside `bounds`.
pub(super) fn sweep(set: &Set, bounds: &Aabb, cost: &NodeCost, axis: usize) -> Option<Candidate> {
    let (events, count) = (set.events[axis], set.triangles.len());
    #[cfg(target_arch = "x86_64")]
    if let Some(lanes) = detect() {
        // SAFETY: `lanes` is proof that the processor has AVX2.
        return unsafe { sweep_avx2(lanes, events, count, bounds, cost, axis) };
    }
    sweep_with(Pricing::new(Plain, bounds, cost, axis), events, count)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn sweep_avx2(
    lanes: Avx2,
    events: &[Event],
    count: usize,
    bounds: &Aabb,
    cost: &NodeCost,
    axis: usize,
) -> Option<Candidate> {
    sweep_with(Pricing::new(lanes, bounds, cost, axis), events, count)
}

#[inline(always)]
fn sweep_with<L: Lanes>(
    mut pricing: Pricing<L>,
    events: &[Event],
    count: usize,
) -> Option<Candidate> {
    let mut counter = Counter { left: 0, right: count as i32 };
    let (chunks, rest) = events.as_chunks::<LANES>();
    for chunk in chunks {
        counter.pass(chunk, &mut pricing);
    }
    if !rest.is_empty() {
        // No plane lies beyond everything.
        let mut last = [Event::new(f32::INFINITY, Kind::End, 0); LANES];
        last[..rest.len()].copy_from_slice(rest);
        counter.pass(&last, &mut pricing);
    }
    pricing.best()
}

/// The counts at the events passed so far.
struct Counter {
    left: i32,
    right: i32,
}

impl Counter {
    // Not a closure: those are not compiled for the processor that their function is for.
    #[inline(always)]
    fn pass<L: Lanes>(&mut self, events: &[Event; LANES], pricing: &mut Pricing<L>) {
        let lanes = pricing.lanes;
        let passed = lanes.passed(events);
        let left = lanes.sum(lanes.counts(self.left), passed.entered);
        let right = lanes.difference(lanes.counts(self.right), passed.gone);
        pricing.price(passed.positions, left, right);
        self.left += passed.entering;
        self.right -= LANES as i32 - passed.entering;
    }
}

#[cfg(test)]
mod tests {
    use super::super::columns::{Columns, Counts, MOST};
    use super::super::event::events_of;
    use super::*;
    use crate::build::Cost;

    /// Bounds on a coarse grid, many of them flat and many in one plane, and their events.
    fn references(count: usize, seed: u32) -> (Vec<Aabb>, [Vec<Event>; 3]) {
        let mut state = seed;
        let mut next = |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) % below
        };
        let mut bounds = Vec::new();
        for _ in 0..count {
            let lower = [0; 3].map(|_| next(9) as f32 - 4.0);
            let upper = lower.map(|lower| lower + 0.5 * next(4) as f32);
            bounds.push(Aabb { lower, upper });
        }
        let events = [0, 1, 2].map(|axis| {
            let of = |(name, bounds): (usize, &Aabb)| events_of(bounds, axis, name as u32);
            let mut events: Vec<Event> = bounds.iter().enumerate().flat_map(of).collect();
            events.sort_unstable();
            events
        });
        (bounds, events)
    }

    fn is_same(a: &Option<Candidate>, b: &Option<Candidate>) -> bool {
        let bits = |c: &Candidate| (c.price.to_bits(), c.axis, c.position.to_bits());
        a.as_ref().map(bits) == b.as_ref().map(bits)
    }

    #[test]
    fn sweeping_counting_and_every_processor_find_the_same_plane() {
        for seed in 0..300 {
            let count = 1 + seed as usize % MOST;
            let (bounds, events) = references(count, seed);
            let triangles: Vec<u32> = (0..count as u32).collect();
            let set = Set { triangles: &triangles, events: [&events[0], &events[1], &events[2]] };
            let node = bounds.iter().fold(Aabb::EMPTY, |all, bounds| all.union(bounds));
            let cost = NodeCost::new(&Cost::default(), &node);
            let mut columns = Columns::EMPTY;
            columns.fill(&set);
            let mut counts = Counts::default();
            columns.count(count, &mut counts);
            let counted = columns.cheapest(count, &counts, &node, &cost);
            for axis in 0..3 {
                let swept = sweep(&set, &node, &cost, axis);
                let pricing = Pricing::new(Plain, &node, &cost, axis);
                let plain = sweep_with(pricing, set.events[axis], count);
                assert!(is_same(&swept, &plain), "{swept:?} {plain:?}");
                assert!(is_same(&swept, &counted[axis]), "{swept:?} {:?}", counted[axis]);
            }
        }
    }
}
