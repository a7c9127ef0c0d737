//! Eight planes at a time: the arithmetic of pricing, for every processor and for AVX2.
//!
//! Both give the same bits: every operation is rounded on its own, as `NodeCost` says.

use super::event::{Event, position_of};

/// Planes that are counted and priced together.
pub(super) const LANES: usize = 8;

/// Eight numbers, eight counts, eight truths, and what is done with them.
pub(super) trait Lanes: Copy {
    type Numbers: Copy;
    type Counts: Copy;
    type Truths: Copy;

    fn numbers(self, number: f32) -> Self::Numbers;
    fn load(self, numbers: &[f32; LANES]) -> Self::Numbers;
    fn store(self, numbers: Self::Numbers) -> [f32; LANES];
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

    fn store(self, numbers: [f32; LANES]) -> [f32; LANES] {
        numbers
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
pub(super) use avx2::detect;

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::*;

    use super::{Avx2, Event, LANES, Lanes, Passed};

    /// AVX2, if the processor has it.
    #[inline(always)]
    pub(in super::super) fn detect() -> Option<Avx2> {
        is_x86_feature_detected!("avx2").then_some(Avx2(()))
    }

    /// Lanes of the events whose halves were shuffled together.
    const ORDER: [usize; LANES] = [0, 1, 4, 5, 2, 3, 6, 7];

    /// By which lanes enter: how many entered before each lane.
    static ENTERED: [[u8; LANES]; 256] = entered_before();

    const fn entered_before() -> [[u8; LANES]; 256] {
        let mut table = [[0; LANES]; 256];
        let mut bits = 0;
        while bits < 256 {
            let mut lane = 0;
            while lane < LANES {
                let mut other = 0;
                while other < LANES {
                    let is_before = ORDER[other] < ORDER[lane];
                    table[bits][lane] += (is_before && bits >> other & 1 == 1) as u8;
                    other += 1;
                }
                lane += 1;
            }
            bits += 1;
        }
        table
    }

    // SAFETY, here and below: an `Avx2` is proof that the processor has what is called.
    impl Lanes for Avx2 {
        type Numbers = __m256;
        type Counts = __m256i;
        type Truths = __m256;

        #[inline(always)]
        fn numbers(self, number: f32) -> __m256 {
            // SAFETY: as above.
            unsafe { _mm256_set1_ps(number) }
        }

        #[inline(always)]
        fn load(self, numbers: &[f32; LANES]) -> __m256 {
            // SAFETY: as above; eight lanes are read.
            unsafe { _mm256_loadu_ps(numbers.as_ptr()) }
        }

        #[inline(always)]
        fn store(self, numbers: __m256) -> [f32; LANES] {
            let mut stored = [0.0; LANES];
            // SAFETY: as above; eight lanes fit.
            unsafe { _mm256_storeu_ps(stored.as_mut_ptr(), numbers) };
            stored
        }

        #[inline(always)]
        fn add(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: as above.
            unsafe { _mm256_add_ps(a, b) }
        }

        #[inline(always)]
        fn subtract(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: as above.
            unsafe { _mm256_sub_ps(a, b) }
        }

        #[inline(always)]
        fn multiply(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: as above.
            unsafe { _mm256_mul_ps(a, b) }
        }

        #[inline(always)]
        fn min(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: as above.
            unsafe { _mm256_min_ps(a, b) }
        }

        #[inline(always)]
        fn least(self, numbers: __m256) -> f32 {
            // SAFETY: as above.
            unsafe {
                let halves =
                    _mm_min_ps(_mm256_castps256_ps128(numbers), _mm256_extractf128_ps::<1>(numbers));
                let pairs = _mm_min_ps(halves, _mm_movehl_ps(halves, halves));
                _mm_cvtss_f32(_mm_min_ss(pairs, _mm_shuffle_ps::<1>(pairs, pairs)))
            }
        }

        #[inline(always)]
        fn counts(self, count: i32) -> __m256i {
            // SAFETY: as above.
            unsafe { _mm256_set1_epi32(count) }
        }

        #[inline(always)]
        fn load_counts(self, counts: &[i32; LANES]) -> __m256i {
            // SAFETY: as above; eight lanes are read.
            unsafe { _mm256_loadu_si256(counts.as_ptr().cast()) }
        }

        #[inline(always)]
        fn store_counts(self, counts: __m256i) -> [i32; LANES] {
            let mut stored = [0; LANES];
            // SAFETY: as above; eight lanes fit.
            unsafe { _mm256_storeu_si256(stored.as_mut_ptr().cast(), counts) };
            stored
        }

        #[inline(always)]
        fn sum(self, a: __m256i, b: __m256i) -> __m256i {
            // SAFETY: as above.
            unsafe { _mm256_add_epi32(a, b) }
        }

        #[inline(always)]
        fn difference(self, a: __m256i, b: __m256i) -> __m256i {
            // SAFETY: as above.
            unsafe { _mm256_sub_epi32(a, b) }
        }

        #[inline(always)]
        fn count(self, counts: __m256i, truths: __m256) -> __m256i {
            // SAFETY: as above. What is true is -1.
            unsafe { _mm256_sub_epi32(counts, _mm256_castps_si256(truths)) }
        }

        #[inline(always)]
        fn to_numbers(self, counts: __m256i) -> __m256 {
            // SAFETY: as above.
            unsafe { _mm256_cvtepi32_ps(counts) }
        }

        #[inline(always)]
        fn is_zero(self, counts: __m256i) -> __m256 {
            // SAFETY: as above.
            unsafe { _mm256_castsi256_ps(_mm256_cmpeq_epi32(counts, _mm256_setzero_si256())) }
        }

        #[inline(always)]
        fn is_less(self, a: __m256, than: __m256) -> __m256 {
            // SAFETY: as above.
            unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(a, than) }
        }

        #[inline(always)]
        fn is_equal(self, a: __m256, to: __m256) -> __m256 {
            // SAFETY: as above.
            unsafe { _mm256_cmp_ps::<_CMP_EQ_OQ>(a, to) }
        }

        #[inline(always)]
        fn and(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: as above.
            unsafe { _mm256_and_ps(a, b) }
        }

        #[inline(always)]
        fn or(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: as above.
            unsafe { _mm256_or_ps(a, b) }
        }

        #[inline(always)]
        fn select(self, truths: __m256, a: __m256, b: __m256) -> __m256 {
            // SAFETY: as above.
            unsafe { _mm256_blendv_ps(b, a, truths) }
        }

        #[inline(always)]
        fn bits(self, truths: __m256) -> u32 {
            // SAFETY: as above.
            unsafe { _mm256_movemask_ps(truths) as u32 }
        }

        #[inline(always)]
        fn passed(self, events: &[Event; LANES]) -> Passed<Self> {
            let halves: *const __m256 = events.as_ptr().cast();
            // SAFETY: as above; eight events are two vectors.
            unsafe {
                let (first, second) =
                    (_mm256_loadu_ps(halves.cast()), _mm256_loadu_ps(halves.add(1).cast()));
                let low = _mm256_castps_si256(_mm256_shuffle_ps::<0x88>(first, second));
                let high = _mm256_castps_si256(_mm256_shuffle_ps::<0xdd>(first, second));
                // The bit of those that enter, first of all bits.
                let enters = _mm256_slli_epi32::<1>(low);
                let bits = _mm256_movemask_ps(_mm256_castsi256_ps(enters));
                let before = _mm_loadl_epi64(ENTERED[bits as usize & 255].as_ptr().cast());
                let entered = _mm256_cvtepu8_epi32(before);
                // Passed up to here, less those that entered before or enter here.
                let passed = _mm256_setr_epi32(1, 2, 5, 6, 3, 4, 7, 8);
                let here = _mm256_srai_epi32::<31>(enters);
                let gone = _mm256_add_epi32(_mm256_sub_epi32(passed, entered), here);
                // `position_of`: the sign bit of what is not negative, all bits of what is.
                let sign = _mm256_srai_epi32::<31>(high);
                let kept = _mm256_xor_si256(high, _mm256_srli_epi32::<1>(sign));
                let positions = _mm256_xor_si256(kept, _mm256_set1_epi32(-1));
                let entering = bits.count_ones() as i32;
                Passed { positions: _mm256_castsi256_ps(positions), entered, gone, entering }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::event::Kind;
    use super::*;

    #[cfg(target_arch = "x86_64")]
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
            let positions = lanes.store(vector.positions);
            let mut lines: Vec<_> = (0..LANES).map(|k| (positions[k], entered[k], gone[k])).collect();
            lines.sort_by(|a, b| a.0.total_cmp(&b.0));
            let expected: Vec<_> =
                (0..LANES).map(|k| (plain.positions[k], plain.entered[k], plain.gone[k])).collect();
            assert_eq!((lines, vector.entering), (expected, plain.entering));
        }
    }
}
