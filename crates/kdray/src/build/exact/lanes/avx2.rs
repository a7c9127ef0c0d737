//! Eight planes at a time with AVX2.

use std::arch::x86_64::*;

use super::{Avx2, LANES, Lanes, Passed};
use crate::build::exact::event::Event;

/// AVX2, if the processor has it.
#[inline(always)]
pub(in crate::build::exact) fn detect() -> Option<Avx2> {
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
