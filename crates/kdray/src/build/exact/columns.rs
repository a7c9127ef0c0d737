//! A few references, column by column.

#[cfg(target_arch = "x86_64")]
use super::lanes::{Avx2, detect};
use super::lanes::{LANES, Lanes, Plain};
use super::pricing::Pricing;
use super::set::Set;
use super::sweep::Candidate;
use crate::build::NodeCost;
use crate::geometry::Aabb;
use crate::geometry::ordered::position_of;

/// The most references that columns hold; half as many more would be counted in twice the time.
pub(super) const MOST: usize = 64;

/// References of a node: triangles, which ascend, and bounds. Where there is no reference, bounds
/// are empty.
#[derive(Clone)]
#[repr(C, align(64))]
pub(super) struct Columns {
    pub(super) triangles: [u32; MOST],
    /// By axis.
    lower: [[f32; MOST]; 3],
    upper: [[f32; MOST]; 3],
}

/// Counts at the planes in the bounds of columns, which only depend on these.
#[derive(Clone)]
pub(super) struct Counts {
    /// By axis, end (lower, upper) and reference.
    at: [[[Count; MOST / LANES]; 2]; 3],
    has_flat: [bool; 3],
}

/// References on the sides of eight planes.
#[derive(Clone, Copy, Default)]
struct Count {
    left: [i32; LANES],
    flat: [i32; LANES],
    right: [i32; LANES],
}

impl Columns {
    pub(super) const EMPTY: Self = Self {
        triangles: [0; MOST],
        lower: [[f32::INFINITY; MOST]; 3],
        upper: [[f32::NEG_INFINITY; MOST]; 3],
    };

    /// The references of a set of at most [`MOST`].
    pub(super) fn fill(&mut self, set: &Set) {
        let count = set.triangles.len();
        self.triangles[..count].copy_from_slice(set.triangles);
        for axis in 0..3 {
            self.pad(axis, count);
            for event in set.events[axis] {
                let position = position_of(event.ordered_position());
                let ends = [&mut self.upper[axis], &mut self.lower[axis]];
                ends[usize::from(event.enters())][event.reference()] = position;
            }
        }
    }

    /// Empty bounds behind the first `count`.
    fn pad(&mut self, axis: usize, count: usize) {
        let padded = count.next_multiple_of(LANES);
        self.lower[axis][count..padded].fill(f32::INFINITY);
        self.upper[axis][count..padded].fill(f32::NEG_INFINITY);
    }

    /// Of the first `count` references those below, in and above a plane, as bits; straddlers are
    /// below and above.
    pub(super) fn sides(&self, count: usize, axis: usize, position: f32) -> Sides {
        let (lower, upper) = (&self.lower[axis], &self.upper[axis]);
        #[cfg(target_arch = "x86_64")]
        if let Some(lanes) = detect() {
            // SAFETY: `lanes` is proof that the processor has AVX2.
            return unsafe { sides_avx2(lanes, lower, upper, count, position) };
        }
        sides_with(Plain, lower, upper, count, position)
    }

    /// Writes the references whose bit is set to `kept`.
    pub(super) fn keep(&self, bits: u64, kept: &mut Self) {
        let places = Places::new(bits);
        for (to, from) in places.iter() {
            kept.triangles[to] = self.triangles[from];
        }
        for axis in 0..3 {
            for (to, from) in places.iter() {
                kept.lower[axis][to] = self.lower[axis][from];
                kept.upper[axis][to] = self.upper[axis][from];
            }
            kept.pad(axis, places.count);
        }
    }

    /// Drops the references whose bit is not set.
    pub(super) fn retain(&mut self, bits: u64) {
        let places = Places::new(bits);
        for (to, from) in places.iter() {
            self.triangles[to] = self.triangles[from];
        }
        for axis in 0..3 {
            for (to, from) in places.iter() {
                self.lower[axis][to] = self.lower[axis][from];
                self.upper[axis][to] = self.upper[axis][from];
            }
            self.pad(axis, places.count);
        }
    }

    /// Bounds of the first `count` references.
    pub(super) fn bounds(&self, count: usize) -> Aabb {
        let mut bounds = Aabb::EMPTY;
        for axis in 0..3 {
            for reference in 0..count.min(MOST) {
                let (lower, upper) = (self.lower[axis][reference], self.upper[axis][reference]);
                let first = &mut bounds.lower[axis];
                *first = if lower < *first { lower } else { *first };
                let last = &mut bounds.upper[axis];
                *last = if upper > *last { upper } else { *last };
            }
        }
        bounds
    }

    pub(super) fn set_bounds(&mut self, place: usize, bounds: &Aabb) {
        for axis in 0..3 {
            self.lower[axis][place] = bounds.lower[axis];
            self.upper[axis][place] = bounds.upper[axis];
        }
    }

    /// Counts the references on the sides of the planes in the bounds of the first `count`.
    pub(super) fn count(&self, count: usize, counts: &mut Counts) {
        #[cfg(target_arch = "x86_64")]
        if let Some(lanes) = detect() {
            // SAFETY: `lanes` is proof that the processor has AVX2.
            return unsafe { count_avx2(lanes, self, count, counts) };
        }
        count_with(Plain, self, count, counts);
    }

    /// The cheapest plane along each axis.
    pub(super) fn cheapest(
        &self,
        count: usize,
        counts: &Counts,
        bounds: &Aabb,
        cost: &NodeCost,
    ) -> [Option<Candidate>; 3] {
        #[cfg(target_arch = "x86_64")]
        if let Some(lanes) = detect() {
            // SAFETY: `lanes` is proof that the processor has AVX2.
            return unsafe { cheapest_avx2(lanes, self, count, counts, bounds, cost) };
        }
        cheapest_with(Plain, self, count, counts, bounds, cost)
    }
}

/// References below, in and above a plane, as bits.
pub(super) struct Sides {
    pub(super) below: u64,
    pub(super) flat: u64,
    pub(super) above: u64,
}

/// Where the bits of a number are.
struct Places {
    at: [u8; MOST],
    count: usize,
}

impl Places {
    fn new(mut bits: u64) -> Self {
        let mut places = Self { at: [0; MOST], count: 0 };
        while bits != 0 {
            places.at[places.count & (MOST - 1)] = bits.trailing_zeros() as u8;
            bits &= bits - 1;
            places.count += 1;
        }
        places
    }

    /// Each place, behind how many there are before it.
    fn iter(&self) -> impl Iterator<Item = (usize, usize)> {
        let at = self.at[..self.count].iter();
        at.map(|place| usize::from(*place) & (MOST - 1)).enumerate()
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn sides_avx2(
    lanes: Avx2,
    lower: &[f32; MOST],
    upper: &[f32; MOST],
    count: usize,
    position: f32,
) -> Sides {
    sides_with(lanes, lower, upper, count, position)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn count_avx2(lanes: Avx2, columns: &Columns, count: usize, counts: &mut Counts) {
    count_with(lanes, columns, count, counts);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn cheapest_avx2(
    lanes: Avx2,
    columns: &Columns,
    count: usize,
    counts: &Counts,
    bounds: &Aabb,
    cost: &NodeCost,
) -> [Option<Candidate>; 3] {
    cheapest_with(lanes, columns, count, counts, bounds, cost)
}

// No closures below: they are not compiled for the processor that their function is for.

#[inline(always)]
fn sides_with<L: Lanes>(
    lanes: L,
    lower: &[f32; MOST],
    upper: &[f32; MOST],
    count: usize,
    position: f32,
) -> Sides {
    let plane = lanes.numbers(position);
    let (mut below, mut above) = (0, 0);
    for group in 0..count.min(MOST).div_ceil(LANES) {
        let starts_before = lanes.is_less(group_of(lanes, lower, group), plane);
        let ends_after = lanes.is_less(plane, group_of(lanes, upper, group));
        below |= u64::from(lanes.bits(starts_before)) << (group * LANES);
        above |= u64::from(lanes.bits(ends_after)) << (group * LANES);
    }
    let all = u64::MAX >> (MOST - count.clamp(1, MOST));
    Sides { below: below & all, flat: !(below | above) & all, above: above & all }
}

#[inline(always)]
fn count_with<L: Lanes>(lanes: L, columns: &Columns, count: usize, counts: &mut Counts) {
    let count = count.min(MOST);
    for axis in 0..3 {
        let (lower, upper) = (&columns.lower[axis], &columns.upper[axis]);
        let mut flat_bits = 0;
        for group in 0..count.div_ceil(LANES) {
            let [starts, ends] = [group_of(lanes, lower, group), group_of(lanes, upper, group)];
            flat_bits |= lanes.bits(lanes.is_equal(starts, ends));
            let none = lanes.counts(0);
            let [mut at_start, mut at_end] = [[none; 2]; 2];
            for reference in 0..count {
                let (first, last) =
                    (lanes.numbers(lower[reference]), lanes.numbers(upper[reference]));
                at_start[0] = lanes.count(at_start[0], lanes.is_less(first, starts));
                at_start[1] = lanes.count(at_start[1], lanes.is_less(starts, last));
                at_end[0] = lanes.count(at_end[0], lanes.is_less(first, ends));
                at_end[1] = lanes.count(at_end[1], lanes.is_less(ends, last));
            }
            counts.at[axis][0][group].left = lanes.store_counts(at_start[0]);
            counts.at[axis][0][group].right = lanes.store_counts(at_start[1]);
            counts.at[axis][1][group].left = lanes.store_counts(at_end[0]);
            counts.at[axis][1][group].right = lanes.store_counts(at_end[1]);
        }
        counts.has_flat[axis] = flat_bits != 0;
        if flat_bits != 0 {
            count_flat(lanes, [lower, upper], count, &mut counts.at[axis]);
        }
    }
}

#[inline(always)]
fn group_of<L: Lanes>(lanes: L, column: &[f32; MOST], group: usize) -> L::Numbers {
    lanes.load(&column.as_chunks().0[group])
}

#[inline(always)]
fn count_flat<L: Lanes>(
    lanes: L,
    [lower, upper]: [&[f32; MOST]; 2],
    count: usize,
    counts: &mut [[Count; MOST / LANES]; 2],
) {
    for (end, planes) in [lower, upper].into_iter().enumerate() {
        for group in 0..count.div_ceil(LANES) {
            let planes = group_of(lanes, planes, group);
            let mut flat = lanes.counts(0);
            for reference in 0..count {
                let first = lanes.is_equal(lanes.numbers(lower[reference]), planes);
                let last = lanes.is_equal(lanes.numbers(upper[reference]), planes);
                flat = lanes.count(flat, lanes.and(first, last));
            }
            counts[end][group].flat = lanes.store_counts(flat);
        }
    }
}

#[inline(always)]
fn cheapest_with<L: Lanes>(
    lanes: L,
    columns: &Columns,
    count: usize,
    counts: &Counts,
    bounds: &Aabb,
    cost: &NodeCost,
) -> [Option<Candidate>; 3] {
    let mut best = [None; 3];
    for (axis, best) in best.iter_mut().enumerate() {
        let mut pricing = Pricing::new(lanes, bounds, cost, axis);
        for (end, ends) in [&columns.lower[axis], &columns.upper[axis]].into_iter().enumerate() {
            for group in 0..count.min(MOST).div_ceil(LANES) {
                let planes = group_of(lanes, ends, group);
                let at = &counts.at[axis][end][group];
                let (left, right) = (lanes.load_counts(&at.left), lanes.load_counts(&at.right));
                if counts.has_flat[axis] {
                    let flat = lanes.load_counts(&at.flat);
                    pricing.price_unordered(planes, lanes.sum(left, flat), right);
                    pricing.price_unordered(planes, left, lanes.sum(right, flat));
                } else {
                    pricing.price_unordered(planes, left, right);
                }
            }
        }
        *best = pricing.best();
    }
    best
}

impl Default for Counts {
    fn default() -> Self {
        Self { at: [[[Count::default(); MOST / LANES]; 2]; 3], has_flat: [false; 3] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_keeps_its_order() {
        let mut columns = Columns::EMPTY;
        for place in 0..20 {
            columns.triangles[place] = 100 + place as u32;
            let number = place as f32;
            columns.set_bounds(place, &Aabb { lower: [number; 3], upper: [number + 1.0; 3] });
        }
        let mut kept = columns.clone();
        let bits = 1 << 3 | 1 << 4 | 1 << 11 | 1 << 19;
        columns.keep(bits, &mut kept);
        columns.retain(bits);
        for columns in [&kept, &columns] {
            assert_eq!(columns.triangles[..4], [103, 104, 111, 119]);
            assert_eq!(columns.upper[2][..8], {
                let none = f32::NEG_INFINITY;
                [4.0, 5.0, 12.0, 20.0, none, none, none, none]
            });
            assert_eq!(columns.bounds(4), Aabb { lower: [3.0; 3], upper: [20.0; 3] });
        }
    }

    #[test]
    fn sides_and_counts_are_the_same_on_every_processor() {
        let mut columns = Columns::EMPTY;
        for place in 0..37_usize {
            let lower = (place * 7 % 10) as f32;
            let upper = lower + (place % 3) as f32;
            columns.set_bounds(place, &Aabb { lower: [lower; 3], upper: [upper; 3] });
        }
        let sides = columns.sides(37, 1, 4.0);
        let plain = sides_with(Plain, &columns.lower[1], &columns.upper[1], 37, 4.0);
        assert_eq!([sides.below, sides.flat, sides.above], [plain.below, plain.flat, plain.above]);
        assert_eq!(sides.below | sides.flat | sides.above, (1 << 37) - 1);
        let (mut counts, mut expected) = (Counts::default(), Counts::default());
        columns.count(37, &mut counts);
        count_with(Plain, &columns, 37, &mut expected);
        for (group, plain) in counts.at.iter().flatten().zip(expected.at.iter().flatten()) {
            for (count, plain) in group.iter().zip(plain) {
                assert_eq!(
                    (count.left, count.flat, count.right),
                    (plain.left, plain.flat, plain.right)
                );
            }
        }
    }
}
