//! Arithmetic on eight numbers at once, for whatever the processor has.

use std::ops::{Add, Mul, Sub};

#[cfg(target_arch = "x86_64")]
use super::vector::{Arithmetic, Eight, Mask, Vector};

/// A value for each axis. A closure would not do: it is compiled apart, for any processor.
macro_rules! by_axis {
    (|$axis:ident| $value:expr) => {
        [
            {
                let $axis = 0;
                $value
            },
            {
                let $axis = 1;
                $value
            },
            {
                let $axis = 2;
                $value
            },
        ]
    };
}
pub(super) use by_axis;

/// Eight numbers in single precision.
///
/// Numbers come from others, so that only what the processor has is used. Ways differ in roundings:
/// they are for bounds that hold with any of them.
pub(super) trait Eights:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// A number in every lane.
    fn all(self, number: f32) -> Self;
    fn load(self, numbers: &[f32; 8]) -> Self;
    fn numbers(self) -> [f32; 8];
    /// The other where either is not a number. So is [`Eights::max`].
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    /// `self * factor + term`, rounded once or twice.
    fn fused(self, factor: Self, term: Self) -> Self;
    fn magnitude(self) -> Self;
    fn sqrt(self) -> Self;
    fn over(self, whole: Self) -> Self;
    /// [`Eights::over`], to eleven bits or more.
    fn roughly_over(self, whole: Self) -> Self;
    /// A bit a lane, the first lowest.
    fn is_less(self, than: Self) -> u32;
    fn is_at_most(self, most: Self) -> u32;
    /// By lane, one of these where `self` is less than `than`, and one of those where not.
    fn pick(self, than: Self, these: Self, those: Self) -> Self;
    /// A bit a lane, the first lowest: the signs.
    fn signs(self) -> u32;
    /// Of the lanes of a mask one with the least number, and that; of an empty mask, any.
    fn least_of(self, mask: u32) -> (usize, f32);
    /// The lanes of a mask, in front.
    fn packed(self, mask: u32) -> Self;
}

/// One after the other, or as the compiler sees fit.
#[derive(Clone, Copy)]
pub(super) struct Array(pub(super) [f32; 8]);

macro_rules! by_lane {
    (|$lane:ident| $value:expr) => {{
        let mut numbers = [0.0; 8];
        for $lane in 0..8 {
            numbers[$lane] = $value;
        }
        Array(numbers)
    }};
}

macro_rules! operators {
    ($($operator:ident $name:ident $symbol:tt;)*) => {$(
        impl $operator for Array {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                by_lane!(|lane| self.0[lane] $symbol other.0[lane])
            }
        }
    )*};
}

operators! {
    Add add +;
    Sub sub -;
    Mul mul *;
}

impl Eights for Array {
    #[inline(always)]
    fn all(self, number: f32) -> Self {
        Self([number; 8])
    }

    #[inline(always)]
    fn load(self, numbers: &[f32; 8]) -> Self {
        Self(*numbers)
    }

    #[inline(always)]
    fn numbers(self) -> [f32; 8] {
        self.0
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.pick(other, self, other)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        other.pick(self, self, other)
    }

    #[inline(always)]
    fn fused(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        by_lane!(|lane| self.0[lane].abs())
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        by_lane!(|lane| self.0[lane].sqrt())
    }

    #[inline(always)]
    fn over(self, whole: Self) -> Self {
        by_lane!(|lane| self.0[lane] / whole.0[lane])
    }

    #[inline(always)]
    fn roughly_over(self, whole: Self) -> Self {
        self.over(whole)
    }

    #[inline(always)]
    fn is_less(self, than: Self) -> u32 {
        (0..8).fold(0, |bits, lane| bits | u32::from(self.0[lane] < than.0[lane]) << lane)
    }

    #[inline(always)]
    fn is_at_most(self, most: Self) -> u32 {
        (0..8).fold(0, |bits, lane| bits | u32::from(self.0[lane] <= most.0[lane]) << lane)
    }

    #[inline(always)]
    fn pick(self, than: Self, these: Self, those: Self) -> Self {
        by_lane!(|lane| if self.0[lane] < than.0[lane] { these.0[lane] } else { those.0[lane] })
    }

    #[inline(always)]
    fn signs(self) -> u32 {
        (0..8).fold(0, |bits, lane| bits | self.0[lane].to_bits() >> 31 << lane)
    }

    #[inline(always)]
    fn least_of(self, mask: u32) -> (usize, f32) {
        let lanes = (0..8).filter(|lane| mask >> lane & 1 == 1);
        let nearer = |a: usize, b: usize| if self.0[b] < self.0[a] { b } else { a };
        let least = lanes.reduce(nearer).unwrap_or(0);
        (least, self.0[least])
    }

    #[inline(always)]
    fn packed(self, mask: u32) -> Self {
        let (mut packed, mut count) = (self, 0);
        for lane in 0..8 {
            packed.0[count] = self.0[lane];
            count += (mask >> lane & 1) as usize;
        }
        packed
    }
}

#[cfg(target_arch = "x86_64")]
impl Eights for Eight {
    #[inline(always)]
    fn all(self, number: f32) -> Self {
        Arithmetic::all(self, number)
    }

    #[inline(always)]
    fn load(self, numbers: &[f32; 8]) -> Self {
        // SAFETY: a vector exists, so the processor has the instruction. The same below.
        Self(unsafe { std::arch::x86_64::_mm256_loadu_ps(numbers.as_ptr()) })
    }

    #[inline(always)]
    fn numbers(self) -> [f32; 8] {
        let mut numbers = [0.0; 8];
        // SAFETY: as above.
        unsafe { std::arch::x86_64::_mm256_storeu_ps(numbers.as_mut_ptr(), self.0) };
        numbers
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Arithmetic::min(self, other)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Arithmetic::max(self, other)
    }

    #[inline(always)]
    fn fused(self, factor: Self, term: Self) -> Self {
        Vector::fused(self, factor, term)
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        Vector::magnitude(self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { std::arch::x86_64::_mm256_sqrt_ps(self.0) })
    }

    #[inline(always)]
    fn over(self, whole: Self) -> Self {
        self / whole
    }

    #[inline(always)]
    fn roughly_over(self, whole: Self) -> Self {
        // SAFETY: as above.
        self * Self(unsafe { std::arch::x86_64::_mm256_rcp_ps(whole.0) })
    }

    #[inline(always)]
    fn is_less(self, than: Self) -> u32 {
        Arithmetic::is_less(self, than).bits()
    }

    #[inline(always)]
    fn is_at_most(self, most: Self) -> u32 {
        Arithmetic::is_at_most(self, most).bits()
    }

    #[inline(always)]
    fn pick(self, than: Self, these: Self, those: Self) -> Self {
        Vector::pick(Arithmetic::is_less(self, than), these, those)
    }

    #[inline(always)]
    fn signs(self) -> u32 {
        // SAFETY: as above.
        unsafe { std::arch::x86_64::_mm256_movemask_ps(self.0) as u32 }
    }

    #[inline(always)]
    fn least_of(self, mask: u32) -> (usize, f32) {
        use std::arch::x86_64::*;
        // SAFETY: as above.
        unsafe {
            let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let is_in = _mm256_and_si256(_mm256_set1_epi32(mask as i32), bits);
            let is_in = _mm256_castsi256_ps(_mm256_cmpeq_epi32(is_in, bits));
            let numbers = _mm256_blendv_ps(_mm256_set1_ps(f32::INFINITY), self.0, is_in);
            let least = _mm256_min_ps(numbers, _mm256_permute2f128_ps::<1>(numbers, numbers));
            let least = _mm256_min_ps(least, _mm256_permute_ps::<0x4e>(least));
            let least = _mm256_min_ps(least, _mm256_permute_ps::<0xb1>(least));
            let is_least = _mm256_cmp_ps::<_CMP_EQ_OQ>(numbers, least);
            let lanes = _mm256_movemask_ps(is_least) as u32 & mask;
            (lanes.trailing_zeros() as usize & 7, _mm256_cvtss_f32(least))
        }
    }

    #[inline(always)]
    fn packed(self, mask: u32) -> Self {
        // SAFETY: as above.
        Self(unsafe {
            std::arch::x86_64::_mm256_permutevar8x32_ps(self.0, super::step::places(mask))
        })
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use crate::trace::noise::noise;

    /// Numbers, some of them special.
    fn numbers(state: &mut u32) -> [f32; 8] {
        [(); 8].map(|()| match (12.0 * noise(state)) as u32 {
            0 => f32::NAN,
            1 => f32::INFINITY,
            2 => f32::NEG_INFINITY,
            3 => 0.0,
            4 => 1.0,
            _ => 8.0 * noise(state) - 4.0,
        })
    }

    fn bits(numbers: [f32; 8]) -> [u32; 8] {
        numbers.map(|number| if number.is_nan() { 1 } else { number.to_bits() })
    }

    /// What must not differ, of both ways.
    fn answers<E: Eights>(zero: E, [a, b, c, d]: [[f32; 8]; 4], mask: u32) -> Vec<[u32; 8]> {
        let [a, b, c, d] = [a, b, c, d].map(|numbers| zero.load(&numbers));
        let lanes = [a.min(b), a.max(b), a.magnitude(), b.magnitude().sqrt(), a.over(b)];
        let more = [a.pick(b, c, d), a + b, a - b, a * b, zero.all(3.0)];
        let mut answers: Vec<_> = lanes.iter().chain(&more).map(|it| bits(it.numbers())).collect();
        let mut packed = bits(a.packed(mask).numbers());
        packed[mask.count_ones() as usize..].fill(0);
        answers.push(packed);
        answers.push([a.is_less(b), a.is_at_most(b), c.magnitude().signs(), 0, 0, 0, 0, 0]);
        let numbers = c.magnitude().numbers().map(|it| if it.is_nan() { 7.0 } else { it });
        let (lane, least) = zero.load(&numbers).least_of(mask);
        if mask != 0 {
            assert!(mask >> lane & 1 == 1 && numbers[lane] == least);
            answers.push([least.to_bits(); 8]);
        }
        answers
    }

    #[target_feature(enable = "avx2,fma,popcnt,bmi1")]
    fn answers_avx2(numbers: [[f32; 8]; 4], mask: u32) -> Vec<[u32; 8]> {
        answers(Eight(std::arch::x86_64::_mm256_setzero_ps()), numbers, mask)
    }

    #[target_feature(enable = "avx2,fma")]
    fn rough_avx2(part: f32, whole: f32) -> f32 {
        let zero = Eight(std::arch::x86_64::_mm256_setzero_ps());
        Eights::numbers(Eights::all(zero, part).roughly_over(Eights::all(zero, whole)))[0]
    }

    #[test]
    fn avx2_is_like_one_after_the_other() {
        if crate::trace::simd::Best::detect().avx2().is_none() {
            println!("this processor has no AVX2: its path was not tested");
            return;
        }
        let mut state = 3;
        for round in 0..20_000 {
            let given = [(); 4].map(|()| numbers(&mut state));
            let plain = answers(Array([0.0; 8]), given, round & 255);
            // SAFETY: the processor has what it takes.
            let fast = unsafe { answers_avx2(given, round & 255) };
            assert_eq!(plain, fast, "{given:?}");
            let [part, whole] = [1.0 + noise(&mut state), 0.1 + noise(&mut state)];
            // SAFETY: as above.
            let rough = unsafe { rough_avx2(part, whole) };
            assert!((rough * whole / part - 1.0).abs() < 1.0 / 2048.0, "{part} {whole}");
        }
    }
}
