//! One number in double precision, as a vector of one lane.

use super::{Arithmetic, Mask, Precise};

impl Arithmetic for f64 {
    type Number = Self;
    type Mask = bool;

    #[inline(always)]
    fn all(self, number: Self) -> Self {
        number
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn is_less(self, than: Self) -> bool {
        self < than
    }

    #[inline(always)]
    fn is_at_most(self, most: Self) -> bool {
        self <= most
    }
}

impl Mask for bool {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        self & other
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        self | other
    }

    #[inline(always)]
    fn and_not(self, other: Self) -> Self {
        self & !other
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self)
    }
}

impl Precise for f64 {
    type Rounded = f32;

    #[inline(always)]
    fn rounded(self) -> f32 {
        self as f32
    }
}
