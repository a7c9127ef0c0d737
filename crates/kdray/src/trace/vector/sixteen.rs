//! Sixteen numbers with AVX-512.

use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

use super::eight::transposed;
use super::{Arithmetic, MOST, Mask, Numbers, Precise, Vector, operators};
use crate::geometry::Ray;
use crate::trace::simd::HasAvx512;

/// Sixteen numbers in AVX-512.
#[derive(Clone, Copy)]
pub(in crate::trace) struct Sixteen(__m512);

/// Sixteen numbers in double precision in AVX-512.
#[derive(Clone, Copy)]
pub(in crate::trace) struct PreciseSixteen([__m512d; 2]);

/// Truths of sixteen lanes.
#[derive(Clone, Copy)]
pub(in crate::trace) struct SixteenTruths(u16);

operators! { Sixteen, |a, b|
    Add add _mm512_add_ps(a, b);
    Sub sub _mm512_sub_ps(a, b);
    Mul mul _mm512_mul_ps(a, b);
    Div div _mm512_div_ps(a, b);
}
operators! { PreciseSixteen, |a, b|
    Add add [_mm512_add_pd(a[0], b[0]), _mm512_add_pd(a[1], b[1])];
    Sub sub [_mm512_sub_pd(a[0], b[0]), _mm512_sub_pd(a[1], b[1])];
    Mul mul [_mm512_mul_pd(a[0], b[0]), _mm512_mul_pd(a[1], b[1])];
    Div div [_mm512_div_pd(a[0], b[0]), _mm512_div_pd(a[1], b[1])];
}

impl Arithmetic for Sixteen {
    type Number = f32;
    type Mask = SixteenTruths;

    #[inline(always)]
    fn all(self, number: f32) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_set1_ps(number) })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_min_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_max_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn is_less(self, than: Self) -> SixteenTruths {
        // SAFETY: as above.
        SixteenTruths(unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, than.0) })
    }

    #[inline(always)]
    fn is_at_most(self, most: Self) -> SixteenTruths {
        // SAFETY: as above.
        SixteenTruths(unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, most.0) })
    }
}

impl Arithmetic for PreciseSixteen {
    type Number = f64;
    type Mask = SixteenTruths;

    #[inline(always)]
    fn all(self, number: f64) -> Self {
        // SAFETY: as above.
        Self(unsafe { [_mm512_set1_pd(number); 2] })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe {
            [_mm512_min_pd(self.0[0], other.0[0]), _mm512_min_pd(self.0[1], other.0[1])]
        })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe {
            [_mm512_max_pd(self.0[0], other.0[0]), _mm512_max_pd(self.0[1], other.0[1])]
        })
    }

    #[inline(always)]
    fn is_less(self, than: Self) -> SixteenTruths {
        // SAFETY: as above.
        SixteenTruths(unsafe {
            u16::from(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0[0], than.0[0]))
                | u16::from(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0[1], than.0[1])) << 8
        })
    }

    #[inline(always)]
    fn is_at_most(self, most: Self) -> SixteenTruths {
        // SAFETY: as above.
        SixteenTruths(unsafe {
            u16::from(_mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0[0], most.0[0]))
                | u16::from(_mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0[1], most.0[1])) << 8
        })
    }
}

impl Mask for SixteenTruths {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    #[inline(always)]
    fn and_not(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self.0)
    }
}

impl Precise for PreciseSixteen {
    type Rounded = Sixteen;

    #[inline(always)]
    fn rounded(self) -> Sixteen {
        // SAFETY: as above.
        Sixteen(unsafe {
            let low = _mm512_castps256_ps512(_mm512_cvtpd_ps(self.0[0]));
            _mm512_insertf32x8::<1>(low, _mm512_cvtpd_ps(self.0[1]))
        })
    }
}

impl Vector for Sixteen {
    const LANES: usize = 16;
    type Proof = HasAvx512;
    type Precise = PreciseSixteen;

    #[inline(always)]
    fn of_rays(_: HasAvx512, rays: &[Ray]) -> [Self; 8] {
        // SAFETY: as above.
        unsafe {
            let [low, high] = [transposed(rays), transposed(&rays[8..])];
            let mut columns = [Self(_mm512_setzero_ps()); 8];
            for (column, (low, high)) in columns.iter_mut().zip(low.into_iter().zip(high)) {
                *column = Self(_mm512_insertf32x8::<1>(_mm512_castps256_ps512(low), high));
            }
            columns
        }
    }

    #[inline(always)]
    fn of_numbers(_: HasAvx512, numbers: &Numbers) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_load_ps(numbers.0.as_ptr()) })
    }

    #[inline(always)]
    fn numbers(self) -> Numbers {
        let mut numbers = Numbers([0.0; MOST]);
        // SAFETY: as above.
        unsafe { _mm512_store_ps(numbers.0.as_mut_ptr(), self.0) };
        numbers
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_abs_ps(self.0) })
    }

    #[inline(always)]
    fn with_signs_of(self, signs: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe {
            let signs = _mm512_and_ps(_mm512_set1_ps(-0.0), signs.0);
            _mm512_or_ps(signs, self.magnitude().0)
        })
    }

    #[inline(always)]
    fn least(self) -> f32 {
        // SAFETY: as above.
        unsafe { _mm512_reduce_min_ps(self.0) }
    }

    #[inline(always)]
    fn greatest(self) -> f32 {
        // SAFETY: as above.
        unsafe { _mm512_reduce_max_ps(self.0) }
    }

    #[inline(always)]
    fn fused(self, factor: Self, term: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_fmadd_ps(self.0, factor.0, term.0) })
    }

    #[inline(always)]
    fn pick(mask: SixteenTruths, these: Self, those: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_mask_blend_ps(mask.0, those.0, these.0) })
    }

    #[inline(always)]
    fn precise(self) -> PreciseSixteen {
        // SAFETY: as above.
        PreciseSixteen(unsafe {
            let high = _mm512_extractf32x8_ps::<1>(self.0);
            [_mm512_cvtps_pd(_mm512_castps512_ps256(self.0)), _mm512_cvtps_pd(high)]
        })
    }
}
