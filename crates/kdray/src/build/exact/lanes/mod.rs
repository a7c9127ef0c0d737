//! Eight planes at a time: the arithmetic of pricing, for every processor and for AVX2.
//!
//! Both give the same bits: every operation is rounded on its own, as `NodeCost` says.

use super::event::Event;
use crate::geometry::ordered::position_of;

/// Planes that are counted and priced together.
pub(super) const LANES: usize = 8;

/// Eight numbers, eight counts, eight truths, and what is done with them.
pub(super) trait Lanes: Copy {
    type Numbers: Copy;
    type Counts: Copy;
    type Truths: Copy;

    fn numbers(self, number: f32) -> Self::Numbers;
    fn load(self, numbers: &[f32; LANES]) -> Self::Numbers;
    fn add(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    fn subtract(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    fn multiply(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    fn min(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    /// The least of the eight.
    fn least(self, numbers: Self::Numbers) -> f32;

    fn counts(self, count: i32) -> Self::Counts;
    fn load_counts(self, counts: &[i32; LANES]) -> Self::Counts;
    fn store_counts(self, counts: Self::Counts) -> [i32; LANES];
    fn sum(self, a: Self::Counts, b: Self::Counts) -> Self::Counts;
    fn difference(self, a: Self::Counts, b: Self::Counts) -> Self::Counts;
    /// One more where it is true.
    fn count(self, counts: Self::Counts, truths: Self::Truths) -> Self::Counts;
    fn to_numbers(self, counts: Self::Counts) -> Self::Numbers;
    fn is_zero(self, counts: Self::Counts) -> Self::Truths;

    fn is_less(self, a: Self::Numbers, than: Self::Numbers) -> Self::Truths;
    fn is_equal(self, a: Self::Numbers, to: Self::Numbers) -> Self::Truths;
    fn and(self, a: Self::Truths, b: Self::Truths) -> Self::Truths;
    fn or(self, a: Self::Truths, b: Self::Truths) -> Self::Truths;
    /// `a` where it is true, else `b`.
    fn select(self, truths: Self::Truths, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    fn bits(self, truths: Self::Truths) -> u32;

    /// What eight events say, in any order of lanes.
    fn passed(self, events: &[Event; LANES]) -> Passed<Self>;
}

/// Eight events in order, as a plane passes them.
pub(super) struct Passed<L: Lanes> {
    pub(super) positions: L::Numbers,
    /// References that entered the left side before, among the eight.
    pub(super) entered: L::Counts,
    /// References that left the right side before or here, among the eight.
    pub(super) gone: L::Counts,
    /// References that enter the left side, among the eight.
    pub(super) entering: i32,
}

/// For every processor.
#[derive(Clone, Copy)]
pub(super) struct Plain;

fn map<A: Copy, B: Copy, C>(a: [A; LANES], b: [B; LANES], f: impl Fn(A, B) -> C) -> [C; LANES] {
    std::array::from_fn(|lane| f(a[lane], b[lane]))
}

impl Lanes for Plain {
    type Numbers = [f32; LANES];
    type Counts = [i32; LANES];
    type Truths = [bool; LANES];

    fn numbers(self, number: f32) -> [f32; LANES] {
        [number; LANES]
    }

    fn load(self, numbers: &[f32; LANES]) -> [f32; LANES] {
        *numbers
    }

    fn add(self, a: [f32; LANES], b: [f32; LANES]) -> [f32; LANES] {
        map(a, b, |a, b| a + b)
    }

    fn subtract(self, a: [f32; LANES], b: [f32; LANES]) -> [f32; LANES] {
        map(a, b, |a, b| a - b)
    }

    fn multiply(self, a: [f32; LANES], b: [f32; LANES]) -> [f32; LANES] {
        map(a, b, |a, b| a * b)
    }

    fn min(self, a: [f32; LANES], b: [f32; LANES]) -> [f32; LANES] {
        map(a, b, |a, b| if a < b { a } else { b })
    }

    fn least(self, numbers: [f32; LANES]) -> f32 {
        numbers.into_iter().fold(f32::INFINITY, f32::min)
    }

    fn counts(self, count: i32) -> [i32; LANES] {
        [count; LANES]
    }

    fn load_counts(self, counts: &[i32; LANES]) -> [i32; LANES] {
        *counts
    }

    fn store_counts(self, counts: [i32; LANES]) -> [i32; LANES] {
        counts
    }

    fn sum(self, a: [i32; LANES], b: [i32; LANES]) -> [i32; LANES] {
        map(a, b, |a, b| a + b)
    }

    fn difference(self, a: [i32; LANES], b: [i32; LANES]) -> [i32; LANES] {
        map(a, b, |a, b| a - b)
    }

    fn count(self, counts: [i32; LANES], truths: [bool; LANES]) -> [i32; LANES] {
        map(counts, truths, |count, truth| count + i32::from(truth))
    }

    fn to_numbers(self, counts: [i32; LANES]) -> [f32; LANES] {
        counts.map(|count| count as f32)
    }

    fn is_zero(self, counts: [i32; LANES]) -> [bool; LANES] {
        counts.map(|count| count == 0)
    }

    fn is_less(self, a: [f32; LANES], than: [f32; LANES]) -> [bool; LANES] {
        map(a, than, |a, b| a < b)
    }

    fn is_equal(self, a: [f32; LANES], to: [f32; LANES]) -> [bool; LANES] {
        map(a, to, |a, b| a == b)
    }

    fn and(self, a: [bool; LANES], b: [bool; LANES]) -> [bool; LANES] {
        map(a, b, |a, b| a & b)
    }

    fn or(self, a: [bool; LANES], b: [bool; LANES]) -> [bool; LANES] {
        map(a, b, |a, b| a | b)
    }

    fn select(self, truths: [bool; LANES], a: [f32; LANES], b: [f32; LANES]) -> [f32; LANES] {
        std::array::from_fn(|lane| if truths[lane] { a[lane] } else { b[lane] })
    }

    fn bits(self, truths: [bool; LANES]) -> u32 {
        (0..LANES).fold(0, |bits, lane| bits | u32::from(truths[lane]) << lane)
    }

    fn passed(self, events: &[Event; LANES]) -> Passed<Self> {
        let (mut entered, mut gone) = ([0; LANES], [0; LANES]);
        let mut entering = 0;
        for lane in 0..LANES {
            entered[lane] = entering;
            entering += i32::from(events[lane].enters());
            gone[lane] = lane as i32 + 1 - entering;
        }
        let positions = events.map(|event| position_of(event.ordered_position()));
        Passed { positions, entered, gone, entering }
    }
}

/// Proof that the processor has AVX2.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub(super) struct Avx2(());

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
pub(super) use avx2::detect;

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::super::event::Kind;
    use super::*;

    #[test]
    fn events_pass_the_same_on_every_processor() {
        let Some(lanes) = detect() else { return };
        for bits in 0..256_u32 {
            let events = std::array::from_fn(|lane| {
                let kind = if bits >> lane & 1 == 1 { Kind::Start } else { Kind::End };
                Event::new(lane as f32 - 3.5, kind, 5)
            });
            let (plain, vector) = (Plain.passed(&events), lanes.passed(&events));
            let entered = lanes.store_counts(vector.entered);
            let gone = lanes.store_counts(vector.gone);
            for lane in 0..LANES {
                let position = lanes.numbers(plain.positions[lane]);
                let place = lanes.bits(lanes.is_equal(vector.positions, position));
                let place = place.trailing_zeros() as usize;
                assert_eq!((entered[place], gone[place]), (plain.entered[lane], plain.gone[lane]));
            }
            assert_eq!(vector.entering, plain.entering);
        }
    }
}
