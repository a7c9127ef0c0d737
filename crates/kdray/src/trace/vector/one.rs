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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_like_a_lane() {
        // Of two without an order, the second.
        for [a, b, least, greatest] in [
            [1.0, 2.0, 1.0, 2.0],
            [2.0, 1.0, 1.0, 2.0],
            [f64::NAN, 1.0, 1.0, 1.0],
            [0.0, -0.0, -0.0, -0.0],
        ] {
            assert_eq!(Arithmetic::min(a, b).to_bits(), f64::to_bits(least), "{a} {b}");
            assert_eq!(Arithmetic::max(a, b).to_bits(), f64::to_bits(greatest), "{a} {b}");
            assert_eq!([a.is_less(b), a.is_at_most(b)], [a < b, a <= b]);
        }
        assert!(Arithmetic::min(1.0, f64::NAN).is_nan() && Arithmetic::max(1.0, f64::NAN).is_nan());
        assert_eq!([true.and_not(false).bits(), true.and_not(true).bits()], [1, 0]);
    }
}
