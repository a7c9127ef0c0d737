//! Find the cheapest plane of a node.
//!
//! At event `k` of an axis, with `starts` starts before it, there are
//!
//! ```text
//! N_left = starts        N_right = N - (k - starts) - (1 if the event is an end)
//! ```
//!
//! references on the two sides: the counts of \[WZL11], section 3. Events that share a plane with
//! others count too many references (all but the last end and the first start of the plane do),
//! never too few, and prices grow with the counts; so every event may be priced as if it were
//! alone, and the cheapest of them is the cheapest plane. Flat references need more care: the
//! plane they lie in is priced once with all of them on each side, at the first and after the last.
//!
//! Prices are non-negative, so their bits compare like them, and decisions fall on integers.

use super::event::{Event, Kind, position_of};
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

/// Lanes that are priced together.
const LANES: usize = 8;
/// Events whose counts are worked out before they are priced.
const BLOCK: usize = 64;
/// The price of no plane.
const NO_PRICE: u32 = f32::INFINITY.to_bits();

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
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2.
        return unsafe { sweep_avx2(set, bounds, cost, axis) };
    }
    sweep_lanes(set, bounds, cost, axis)
}

/// [`sweep_lanes`] compiled for AVX2. Multiplications and additions stay apart: same prices.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn sweep_avx2(set: &Set, bounds: &Aabb, cost: &NodeCost, axis: usize) -> Option<Candidate> {
    sweep_lanes(set, bounds, cost, axis)
}

#[inline(always)]
fn sweep_lanes(set: &Set, bounds: &Aabb, cost: &NodeCost, axis: usize) -> Option<Candidate> {
    let mut events = set.events[axis];
    let mut pricing = Pricing::new(bounds, cost, axis);
    let mut block = Block::new(bounds.lower[axis]);
    let mut counter = Counter::new(set.triangles.len());
    if events.len() == 2 * set.triangles.len() {
        for chunk in events.chunks(BLOCK) {
            counter.fill(chunk, &mut block);
            pricing.price(&mut block);
        }
    } else {
        while !events.is_empty() {
            events = counter.fill_with_planars(events, &mut block);
            pricing.price(&mut block);
        }
        counter.finish(&mut block);
        pricing.price(&mut block);
    }
    pricing.best()
}

/// Planes to be priced: position and counts.
struct Block {
    ordered: [u32; BLOCK],
    left: [i32; BLOCK],
    right: [i32; BLOCK],
    len: usize,
    /// A position that is no candidate, for lanes without a plane.
    outside: u32,
}

impl Block {
    #[inline(always)]
    fn new(outside: f32) -> Self {
        let outside = super::event::ordered(outside);
        Self { ordered: [outside; BLOCK], left: [0; BLOCK], right: [0; BLOCK], len: 0, outside }
    }

    #[inline(always)]
    fn push(&mut self, ordered: u32, left: i32, right: i32) {
        self.ordered[self.len] = ordered;
        self.left[self.len] = left;
        self.right[self.len] = right;
        self.len += 1;
    }
}

/// The counts at the events passed so far.
struct Counter {
    left: i32,
    right: i32,
    /// The plane of the planars just passed: after the last of them they are all left.
    flat: Option<u32>,
}

impl Counter {
    #[inline(always)]
    fn new(count: usize) -> Self {
        Self { left: 0, right: count as i32, flat: None }
    }

    /// Counts for a chunk without planars.
    #[inline(always)]
    fn fill(&mut self, chunk: &[Event], block: &mut Block) {
        let (mut left, right) = (self.left, self.right);
        let before = self.left;
        for (k, event) in chunk.iter().enumerate() {
            let is_start = event.is_start() as i32;
            block.ordered[k] = event.ordered_position();
            block.left[k] = left;
            block.right[k] = right - (k as i32 - (left - before)) - (1 - is_start);
            left += is_start;
        }
        block.len = chunk.len();
        self.left = left;
        self.right = right - (chunk.len() as i32 - (left - before));
    }

    /// Counts for the first of `events`, as many as the block holds; gives the others. A group of
    /// flat references at one position gives two planes: one with all of them on the right, one
    /// with all of them on the left.
    #[inline(always)]
    fn fill_with_planars<'a>(&mut self, events: &'a [Event], block: &mut Block) -> &'a [Event] {
        for (index, event) in events.iter().enumerate() {
            if block.len + 2 > BLOCK {
                return &events[index..];
            }
            let ordered = event.ordered_position();
            let is_planar = event.is(Kind::Planar);
            if self.flat.is_some_and(|flat| flat != ordered || !is_planar) {
                self.finish(block);
            }
            if is_planar {
                if self.flat.is_none() {
                    block.push(ordered, self.left, self.right);
                }
                self.flat = Some(ordered);
                (self.left, self.right) = (self.left + 1, self.right - 1);
            } else {
                let is_start = event.is_start() as i32;
                self.right -= 1 - is_start;
                block.push(ordered, self.left, self.right);
                self.left += is_start;
            }
        }
        &[]
    }

    /// Ends a group of planars.
    #[inline(always)]
    fn finish(&mut self, block: &mut Block) {
        if let Some(flat) = self.flat.take() {
            block.push(flat, self.left, self.right);
        }
    }
}

/// Prices planes and keeps the cheapest, one in each lane.
struct Pricing<'a> {
    cost: &'a NodeCost,
    axis: usize,
    lower: f32,
    upper: f32,
    best_price: [u32; LANES],
    best_ordered: [u32; LANES],
}

impl<'a> Pricing<'a> {
    #[inline(always)]
    fn new(bounds: &Aabb, cost: &'a NodeCost, axis: usize) -> Self {
        let (lower, upper) = (bounds.lower[axis], bounds.upper[axis]);
        let (best_price, best_ordered) = ([NO_PRICE; LANES], [u32::MAX; LANES]);
        Self { cost, axis, lower, upper, best_price, best_ordered }
    }

    /// Prices the planes of `block` and empties it.
    #[inline(always)]
    fn price(&mut self, block: &mut Block) {
        let padded = block.len.next_multiple_of(LANES);
        block.ordered[block.len..padded].fill(block.outside);
        let (mut best_price, mut best_ordered) = (self.best_price, self.best_ordered);
        let groups = block.ordered[..padded]
            .as_chunks::<LANES>()
            .0
            .iter()
            .zip(block.left.as_chunks().0)
            .zip(block.right.as_chunks().0);
        for ((ordered, left), right) in groups {
            let prices = self.price_lanes(ordered, left, right);
            for lane in 0..LANES {
                let better = prices[lane] < best_price[lane];
                best_price[lane] = if better { prices[lane] } else { best_price[lane] };
                best_ordered[lane] = if better { ordered[lane] } else { best_ordered[lane] };
            }
        }
        (self.best_price, self.best_ordered) = (best_price, best_ordered);
        block.len = 0;
    }

    #[inline(always)]
    fn price_lanes(
        &self,
        ordered: &[u32; LANES],
        left: &[i32; LANES],
        right: &[i32; LANES],
    ) -> [u32; LANES] {
        let mut prices = [0; LANES];
        for lane in 0..LANES {
            let position = position_of(ordered[lane]);
            let distances = [position - self.lower, self.upper - position];
            let price = self.cost.split(self.axis, distances, [left[lane], right[lane]]);
            let inside = (position > self.lower) & (position < self.upper);
            prices[lane] = if inside { price.to_bits() } else { NO_PRICE };
        }
        prices
    }

    /// The cheapest of all lanes; of equals the one with the lowest position.
    fn best(&self) -> Option<Candidate> {
        let (price, ordered) = (0..LANES)
            .map(|lane| (self.best_price[lane], self.best_ordered[lane]))
            .min()
            .filter(|(price, _)| *price < NO_PRICE)?;
        let position = position_of(ordered);
        Some(Candidate { price: f32::from_bits(price), axis: self.axis, position })
    }
}
