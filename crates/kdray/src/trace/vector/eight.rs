//! Eight numbers with AVX2.

use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

use super::four::{Four, FourTruths};
use super::{Arithmetic, MOST, Mask, Numbers, Precise, Vector, operators};
use crate::geometry::Ray;
use crate::trace::simd::HasAvx2;

/// Eight numbers in AVX2.
#[derive(Clone, Copy)]
pub(in crate::trace) struct Eight(pub(in crate::trace) __m256);

/// Truths of eight lanes: all ones or zeros.
#[derive(Clone, Copy)]
pub(in crate::trace) struct EightTruths(pub(in crate::trace) __m256);

/// Eight numbers in double precision in AVX2.
#[derive(Clone, Copy)]
pub(in crate::trace) struct PreciseEight(pub(in crate::trace) [Four; 2]);

/// Truths of eight lanes in double precision.
#[derive(Clone, Copy)]
pub(in crate::trace) struct PreciseEightTruths([FourTruths; 2]);

operators! { Eight, |a, b|
    Add add _mm256_add_ps(a, b);
    Sub sub _mm256_sub_ps(a, b);
    Mul mul _mm256_mul_ps(a, b);
    Div div _mm256_div_ps(a, b);
}

/// Operators, half by half.
macro_rules! halves {
    ($($operator:ident $name:ident;)*) => {$(
        impl $operator for PreciseEight {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self([self.0[0].$name(other.0[0]), self.0[1].$name(other.0[1])])
            }
        }
    )*};
}
halves! { Add add; Sub sub; Mul mul; Div div; }

impl Arithmetic for Eight {
    type Number = f32;
    type Mask = EightTruths;

    #[inline(always)]
    fn all(self, number: f32) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_set1_ps(number) })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_min_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_max_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn is_less(self, than: Self) -> EightTruths {
        // SAFETY: as above.
        EightTruths(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, than.0) })
    }

    #[inline(always)]
    fn is_at_most(self, most: Self) -> EightTruths {
        // SAFETY: as above.
        EightTruths(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, most.0) })
    }
}

impl Arithmetic for PreciseEight {
    type Number = f64;
    type Mask = PreciseEightTruths;

    #[inline(always)]
    fn all(self, number: f64) -> Self {
        Self([self.0[0].all(number); 2])
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self([self.0[0].min(other.0[0]), self.0[1].min(other.0[1])])
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self([self.0[0].max(other.0[0]), self.0[1].max(other.0[1])])
    }

    #[inline(always)]
    fn is_less(self, than: Self) -> PreciseEightTruths {
        PreciseEightTruths([self.0[0].is_less(than.0[0]), self.0[1].is_less(than.0[1])])
    }

    #[inline(always)]
    fn is_at_most(self, most: Self) -> PreciseEightTruths {
        PreciseEightTruths([self.0[0].is_at_most(most.0[0]), self.0[1].is_at_most(most.0[1])])
    }
}

impl Mask for EightTruths {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_and_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_or_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn and_not(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_andnot_ps(other.0, self.0) })
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: as above.
        unsafe { _mm256_movemask_ps(self.0) as u32 }
    }
}

impl Mask for PreciseEightTruths {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self([self.0[0].and(other.0[0]), self.0[1].and(other.0[1])])
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        Self([self.0[0].or(other.0[0]), self.0[1].or(other.0[1])])
    }

    #[inline(always)]
    fn and_not(self, other: Self) -> Self {
        Self([self.0[0].and_not(other.0[0]), self.0[1].and_not(other.0[1])])
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        self.0[0].bits() | self.0[1].bits() << 4
    }
}

impl Precise for PreciseEight {
    type Rounded = Eight;

    #[inline(always)]
    fn rounded(self) -> Eight {
        let [Four(low), Four(high)] = self.0;
        // SAFETY: as above.
        Eight(unsafe { _mm256_set_m128(_mm256_cvtpd_ps(high), _mm256_cvtpd_ps(low)) })
    }
}

impl Vector for Eight {
    const LANES: usize = 8;
    type Proof = HasAvx2;
    type Precise = PreciseEight;

    #[inline(always)]
    fn of_rays(_: HasAvx2, rays: &[Ray]) -> [Self; 8] {
        // SAFETY: as above.
        unsafe {
            let mut columns = [Self(_mm256_setzero_ps()); 8];
            for (column, lanes) in columns.iter_mut().zip(transposed(rays)) {
                *column = Self(lanes);
            }
            columns
        }
    }

    #[inline(always)]
    fn of_numbers(_: HasAvx2, numbers: &Numbers) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_load_ps(numbers.0.as_ptr()) })
    }

    #[inline(always)]
    fn numbers(self) -> Numbers {
        let mut numbers = Numbers([0.0; MOST]);
        // SAFETY: as above.
        unsafe { _mm256_store_ps(numbers.0.as_mut_ptr(), self.0) };
        numbers
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }

    #[inline(always)]
    fn with_signs_of(self, signs: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe {
            let signs = _mm256_and_ps(_mm256_set1_ps(-0.0), signs.0);
            _mm256_or_ps(signs, self.magnitude().0)
        })
    }

    #[inline(always)]
    fn least(self) -> f32 {
        // SAFETY: as above.
        unsafe {
            let high = _mm256_extractf128_ps::<1>(self.0);
            let four = _mm_min_ps(_mm256_castps256_ps128(self.0), high);
            let two = _mm_min_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_min_ss(two, _mm_movehdup_ps(two)))
        }
    }

    #[inline(always)]
    fn greatest(self) -> f32 {
        // SAFETY: as above.
        -Self(unsafe { _mm256_xor_ps(_mm256_set1_ps(-0.0), self.0) }).least()
    }

    #[inline(always)]
    fn fused(self, factor: Self, term: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_fmadd_ps(self.0, factor.0, term.0) })
    }

    #[inline(always)]
    fn pick(mask: EightTruths, these: Self, those: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_blendv_ps(those.0, these.0, mask.0) })
    }

    #[inline(always)]
    fn precise(self) -> PreciseEight {
        // SAFETY: as above.
        PreciseEight(unsafe {
            let high = _mm256_extractf128_ps::<1>(self.0);
            let low = _mm256_castps256_ps128(self.0);
            [Four(_mm256_cvtps_pd(low)), Four(_mm256_cvtps_pd(high))]
        })
    }
}

/// The first eight rays as their eight numbers, a ray a lane.
#[inline]
#[target_feature(enable = "avx2")]
pub(super) fn transposed(rays: &[Ray]) -> [__m256; 8] {
    // SAFETY: a ray is eight numbers.
    let row = |ray: usize| unsafe { _mm256_loadu_ps(std::ptr::from_ref(&rays[ray]).cast()) };
    let pairs = |[a, b]: [usize; 2]| {
        [_mm256_unpacklo_ps(row(a), row(b)), _mm256_unpackhi_ps(row(a), row(b))]
    };
    let fours = |[a, b]: [__m256; 2], [c, d]: [__m256; 2]| {
        [
            _mm256_shuffle_ps::<0x44>(a, c),
            _mm256_shuffle_ps::<0xee>(a, c),
            _mm256_shuffle_ps::<0x44>(b, d),
            _mm256_shuffle_ps::<0xee>(b, d),
        ]
    };
    let front = fours(pairs([0, 1]), pairs([2, 3]));
    let back = fours(pairs([4, 5]), pairs([6, 7]));
    let low = |at: usize| _mm256_permute2f128_ps::<0x20>(front[at], back[at]);
    let high = |at: usize| _mm256_permute2f128_ps::<0x31>(front[at], back[at]);
    [low(0), low(1), low(2), low(3), high(0), high(1), high(2), high(3)]
}
