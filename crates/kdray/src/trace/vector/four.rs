//! Four numbers in double precision with AVX2.

use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

use super::{Arithmetic, Mask, Precise, operators};

/// Four numbers in double precision in AVX2.
#[derive(Clone, Copy)]
pub(in crate::trace) struct Four(pub(in crate::trace) __m256d);

/// Truths of four lanes: all ones or zeros.
#[derive(Clone, Copy)]
pub(in crate::trace) struct FourTruths(__m256d);

operators! { Four, |a, b|
    Add add _mm256_add_pd(a, b);
    Sub sub _mm256_sub_pd(a, b);
    Mul mul _mm256_mul_pd(a, b);
    Div div _mm256_div_pd(a, b);
}

impl Arithmetic for Four {
    type Number = f64;
    type Mask = FourTruths;

    #[inline(always)]
    fn all(self, number: f64) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_set1_pd(number) })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_min_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_max_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn is_less(self, than: Self) -> FourTruths {
        // SAFETY: as above.
        FourTruths(unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, than.0) })
    }

    #[inline(always)]
    fn is_at_most(self, most: Self) -> FourTruths {
        // SAFETY: as above.
        FourTruths(unsafe { _mm256_cmp_pd::<_CMP_LE_OQ>(self.0, most.0) })
    }
}

impl Mask for FourTruths {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_and_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_or_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn and_not(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_andnot_pd(other.0, self.0) })
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: as above.
        unsafe { _mm256_movemask_pd(self.0) as u32 }
    }
}

impl Precise for Four {
    type Rounded = [f32; 4];

    #[inline(always)]
    fn rounded(self) -> [f32; 4] {
        let mut rounded = [0.0; 4];
        // SAFETY: as above; there is room for four.
        unsafe { _mm_storeu_ps(rounded.as_mut_ptr(), _mm256_cvtpd_ps(self.0)) };
        rounded
    }
}
