//! Eight numbers with NEON, four and four.

use std::arch::aarch64::*;
use std::ops::{Add, Div, Mul, Sub};

use super::{Arithmetic, Mask, Numbers, Vector, operators};
use crate::trace::simd::Neon;

/// Eight numbers in NEON.
#[derive(Clone, Copy)]
pub(in crate::trace) struct Eight([float32x4_t; 2]);

/// Truths of eight lanes: all ones or zeros.
#[derive(Clone, Copy)]
pub(in crate::trace) struct EightTruths([uint32x4_t; 2]);

operators! { Eight, |a, b|
    Add add [vaddq_f32(a[0], b[0]), vaddq_f32(a[1], b[1])];
    Sub sub [vsubq_f32(a[0], b[0]), vsubq_f32(a[1], b[1])];
    Mul mul [vmulq_f32(a[0], b[0]), vmulq_f32(a[1], b[1])];
    Div div [vdivq_f32(a[0], b[0]), vdivq_f32(a[1], b[1])];
}

/// Of what is not a number, and of zeros, the least and the greatest are those of AVX2: the second
/// where neither is less. NEON's own instructions for them differ.
impl Arithmetic for Eight {
    type Number = f32;
    type Mask = EightTruths;

    #[inline(always)]
    fn all(self, number: f32) -> Self {
        // SAFETY: as above.
        Self(unsafe { [vdupq_n_f32(number); 2] })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::pick(self.is_less(other), self, other)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::pick(other.is_less(self), self, other)
    }

    #[inline(always)]
    fn is_less(self, than: Self) -> EightTruths {
        // SAFETY: as above.
        EightTruths(unsafe { [vcltq_f32(self.0[0], than.0[0]), vcltq_f32(self.0[1], than.0[1])] })
    }

    #[inline(always)]
    fn is_at_most(self, most: Self) -> EightTruths {
        // SAFETY: as above.
        EightTruths(unsafe { [vcleq_f32(self.0[0], most.0[0]), vcleq_f32(self.0[1], most.0[1])] })
    }
}

impl Mask for EightTruths {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { [vandq_u32(self.0[0], other.0[0]), vandq_u32(self.0[1], other.0[1])] })
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { [vorrq_u32(self.0[0], other.0[0]), vorrq_u32(self.0[1], other.0[1])] })
    }

    #[inline(always)]
    fn and_not(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { [vbicq_u32(self.0[0], other.0[0]), vbicq_u32(self.0[1], other.0[1])] })
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        const BITS: [u32; 8] = [1, 2, 4, 8, 16, 32, 64, 128];
        // SAFETY: as above; there are four bits each to load.
        unsafe {
            let low = vandq_u32(self.0[0], vld1q_u32(BITS.as_ptr()));
            let high = vandq_u32(self.0[1], vld1q_u32(BITS[4..].as_ptr()));
            vaddvq_u32(vorrq_u32(low, high))
        }
    }
}

impl Vector for Eight {
    #[cfg(test)]
    const LANES: usize = 8;
    type Proof = Neon;

    #[inline(always)]
    fn of_numbers(_: Neon, numbers: &Numbers) -> Self {
        // SAFETY: as above; there are four numbers each to load.
        Self(unsafe { [vld1q_f32(numbers.0.as_ptr()), vld1q_f32(numbers.0[4..].as_ptr())] })
    }

    #[inline(always)]
    fn numbers(self) -> Numbers {
        let mut numbers = Numbers([0.0; 8]);
        // SAFETY: as above; there is room for four numbers each.
        unsafe {
            vst1q_f32(numbers.0.as_mut_ptr(), self.0[0]);
            vst1q_f32(numbers.0[4..].as_mut_ptr(), self.0[1]);
        }
        numbers
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { [vabsq_f32(self.0[0]), vabsq_f32(self.0[1])] })
    }

    #[inline(always)]
    fn fused(self, factor: Self, term: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe {
            [
                vfmaq_f32(term.0[0], self.0[0], factor.0[0]),
                vfmaq_f32(term.0[1], self.0[1], factor.0[1]),
            ]
        })
    }

    #[inline(always)]
    fn pick(mask: EightTruths, these: Self, those: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe {
            [
                vbslq_f32(mask.0[0], these.0[0], those.0[0]),
                vbslq_f32(mask.0[1], these.0[1], those.0[1]),
            ]
        })
    }
}
