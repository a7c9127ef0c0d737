//! A point whose coordinates are worked with together.

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

/// A point, and a fourth number that means nothing: processors like four.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub(super) struct Corner(__m128);

/// A point, and a fourth number that means nothing.
#[cfg(not(target_arch = "x86_64"))]
#[derive(Clone, Copy)]
pub(super) struct Corner([f32; 4]);

// SAFETY, below: SSE2 is part of every x86-64 processor.
#[cfg(target_arch = "x86_64")]
impl Corner {
    #[inline(always)]
    pub(super) fn new([x, y, z]: [f32; 3]) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm_setr_ps(x, y, z, 0.0) })
    }

    #[inline(always)]
    pub(super) fn all(number: f32) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm_set1_ps(number) })
    }

    #[inline(always)]
    pub(super) fn get<const AXIS: usize>(self) -> f32 {
        // SAFETY: as above.
        unsafe {
            _mm_cvtss_f32(match AXIS {
                0 => self.0,
                1 => _mm_shuffle_ps::<0b01_01_01_01>(self.0, self.0),
                _ => _mm_movehl_ps(self.0, self.0),
            })
        }
    }

    /// The same point with another coordinate.
    #[inline(always)]
    pub(super) fn with<const AXIS: usize>(self, coordinate: f32) -> Self {
        let ones = [-i32::from(AXIS == 0), -i32::from(AXIS == 1), -i32::from(AXIS == 2)];
        // SAFETY: as above.
        unsafe {
            let is_new = _mm_castsi128_ps(_mm_setr_epi32(ones[0], ones[1], ones[2], 0));
            let new = _mm_and_ps(is_new, _mm_set1_ps(coordinate));
            Self(_mm_or_ps(new, _mm_andnot_ps(is_new, self.0)))
        }
    }

    #[inline(always)]
    pub(super) fn plus(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm_add_ps(self.0, other.0) })
    }

    #[inline(always)]
    pub(super) fn minus(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm_sub_ps(self.0, other.0) })
    }

    #[inline(always)]
    pub(super) fn times(self, factor: f32) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm_mul_ps(self.0, _mm_set1_ps(factor)) })
    }

    #[inline(always)]
    pub(super) fn min(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm_min_ps(self.0, other.0) })
    }

    #[inline(always)]
    pub(super) fn max(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm_max_ps(self.0, other.0) })
    }

    /// Along which axes this is less, as bits.
    #[inline(always)]
    pub(super) fn is_less(self, than: Self) -> u32 {
        // SAFETY: as above.
        (unsafe { _mm_movemask_ps(_mm_cmplt_ps(self.0, than.0)) }) as u32 & 0b111
    }

    #[inline(always)]
    pub(super) fn coordinates(self) -> [f32; 3] {
        [self.get::<0>(), self.get::<1>(), self.get::<2>()]
    }
}

#[cfg(not(target_arch = "x86_64"))]
impl Corner {
    #[inline(always)]
    pub(super) fn new([x, y, z]: [f32; 3]) -> Self {
        Self([x, y, z, 0.0])
    }

    #[inline(always)]
    pub(super) fn all(number: f32) -> Self {
        Self([number; 4])
    }

    #[inline(always)]
    pub(super) fn get<const AXIS: usize>(self) -> f32 {
        self.0[AXIS]
    }

    /// The same point with another coordinate.
    #[inline(always)]
    pub(super) fn with<const AXIS: usize>(mut self, coordinate: f32) -> Self {
        self.0[AXIS] = coordinate;
        self
    }

    #[inline(always)]
    fn map(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|axis| f(self.0[axis], other.0[axis])))
    }

    #[inline(always)]
    pub(super) fn plus(self, other: Self) -> Self {
        self.map(other, |a, b| a + b)
    }

    #[inline(always)]
    pub(super) fn minus(self, other: Self) -> Self {
        self.map(other, |a, b| a - b)
    }

    #[inline(always)]
    pub(super) fn times(self, factor: f32) -> Self {
        Self(self.0.map(|coordinate| coordinate * factor))
    }

    #[inline(always)]
    pub(super) fn min(self, other: Self) -> Self {
        self.map(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    pub(super) fn max(self, other: Self) -> Self {
        self.map(other, |a, b| if a > b { a } else { b })
    }

    /// Along which axes this is less, as bits.
    #[inline(always)]
    pub(super) fn is_less(self, than: Self) -> u32 {
        (0..3).fold(0, |bits, axis| bits | u32::from(self.0[axis] < than.0[axis]) << axis)
    }

    #[inline(always)]
    pub(super) fn coordinates(self) -> [f32; 3] {
        [self.0[0], self.0[1], self.0[2]]
    }
}
