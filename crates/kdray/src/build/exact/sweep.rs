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
