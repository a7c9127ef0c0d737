//! f64 arithmetic in integers, operation by operation what `double.wgsl` and `double_product.wgsl`
//! do.
//!
//! Results have the bits of the processor's as long as those are neither subnormal nor infinite;
//! exponents have no end here.

use bytemuck::{Pod, Zeroable};

const SIGN: u32 = 0x8000_0000;

/// The exponent of zero.
const LOWEST: i32 = -0x2000_0000;

/// `digits / 2^63 * 2^exponent`: 64 digits, of which the first is set and the last 11 are not.
/// Zero has no digits, and an exponent below all others.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct Double {
    high: u32,
    low: u32,
    exponent: i32,
    sign: u32,
}

impl Double {
    fn zero(sign: u32) -> Self {
        Self { high: 0, low: 0, exponent: LOWEST, sign }
    }

    fn with(sign: u32, exponent: i32, digits: u64) -> Self {
        Self { high: (digits >> 32) as u32, low: digits as u32, exponent, sign }
    }

    fn digits(self) -> u64 {
        u64::from(self.high) << 32 | u64::from(self.low)
    }

    /// The f32 nearest to it. Twin of `d_to_f32`.
    #[must_use]
    pub fn to_f32(self) -> u32 {
        if self.high == 0 {
            return self.sign;
        }
        super::soft::pack(self.sign, self.exponent + 127, self.high | u32::from(self.low != 0))
    }

    /// Rounds 64 digits, of which the first is set and the last stands for everything below, to 53.
    fn round(sign: u32, exponent: i32, digits: u64) -> Self {
        let (rest, kept) = (digits & 0x7ff, digits & !0x7ff);
        if rest < 0x400 || (rest == 0x400 && digits & 0x800 == 0) {
            return Self::with(sign, exponent, kept);
        }
        match kept.checked_add(0x800) {
            Some(digits) => Self::with(sign, exponent, digits),
            None => Self::with(sign, exponent + 1, 1 << 63),
        }
    }

    /// Brings the first digit to the front, and rounds.
    fn normal(sign: u32, exponent: i32, digits: u64) -> Self {
        if digits == 0 {
            return Self::zero(0);
        }
        let zeros = digits.leading_zeros();
        Self::round(sign, exponent - zeros as i32, digits << zeros)
    }

    /// The digits over `2^shift`. The last digit also stands for those lost.
    fn shift_right(self, shift: u32) -> u64 {
        let lost = |kept: u64| u64::from(kept << shift != self.digits());
        self.digits().checked_shr(shift).map_or(1, |kept| kept | lost(kept))
    }

    /// Whether `|self| < |other|`, for numbers that are not zero.
    fn is_below(self, other: Self) -> bool {
        (self.exponent, self.digits()) < (other.exponent, other.digits())
    }

    /// `self + other`.
    #[must_use]
    #[expect(clippy::should_implement_trait, reason = "it is called as the shader calls it")]
    pub fn add(self, other: Self) -> Self {
        if self.high == 0 || other.high == 0 {
            return match (self.high, other.high) {
                (0, 0) => Self::zero(self.sign & other.sign),
                (0, _) => other,
                _ => self,
            };
        }
        let (large, small) = if self.is_below(other) { (other, self) } else { (self, other) };
        let x = large.digits() >> 1;
        let y = small.shift_right(1 + (large.exponent - small.exponent) as u32);
        let sum = if large.sign == small.sign { x + y } else { x - y };
        Self::normal(large.sign, large.exponent + 1, sum)
    }

    /// `self - other`.
    #[must_use]
    #[expect(clippy::should_implement_trait, reason = "it is called as the shader calls it")]
    pub fn sub(self, other: Self) -> Self {
        self.add(Self { sign: other.sign ^ SIGN, ..other })
    }

    /// `self * other`.
    #[must_use]
    #[expect(clippy::should_implement_trait, reason = "it is called as the shader calls it")]
    pub fn mul(self, other: Self) -> Self {
        let sign = self.sign ^ other.sign;
        if self.high == 0 || other.high == 0 {
            return Self::zero(sign);
        }
        let product = u128::from(self.digits()) * u128::from(other.digits());
        let exponent = self.exponent + other.exponent;
        let zeros = product.leading_zeros();
        let shifted = product << zeros;
        let digits = (shifted >> 64) as u64 | u64::from(shifted as u64 != 0);
        Self::round(sign, exponent + 1 - zeros as i32, digits)
    }

    /// `self / other`; zero where both are zero.
    #[must_use]
    #[expect(clippy::should_implement_trait, reason = "it is called as the shader calls it")]
    pub fn div(self, other: Self) -> Self {
        const QUOTIENT: u32 = 55;
        let sign = self.sign ^ other.sign;
        if self.high == 0 || other.high == 0 {
            return Self::zero(sign);
        }
        let (mut rest, divisor, mut quotient) = (self.digits() >> 1, other.digits() >> 1, 0);
        for _ in 0..QUOTIENT {
            quotient <<= 1;
            if rest >= divisor {
                rest -= divisor;
                quotient |= 1;
            }
            rest <<= 1;
        }
        let digits = quotient << (64 - QUOTIENT) | u64::from(rest != 0);
        Self::normal(sign, self.exponent - other.exponent, digits)
    }
}

impl From<f64> for Double {
    /// The same number; it is neither subnormal nor infinite nor NaN.
    fn from(number: f64) -> Self {
        let bits = number.to_bits();
        let sign = (bits >> 32) as u32 & SIGN;
        if number == 0.0 {
            return Self::zero(sign);
        }
        let exponent = (bits >> 52 & 0x7ff) as i32 - 1023;
        Self::with(sign, exponent, bits << 11 | 1 << 63)
    }
}

/// What the processor makes of two operands: sum, difference, product and quotient, where they are
/// as far from the ends of its range as is promised, and, as its bits, the f32 of the first.
#[must_use]
pub fn evaluate(a: f64, b: f64) -> ([Option<Double>; 4], u32) {
    let known = |x: f64| (x == 0.0 || x.is_normal()).then(|| Double::from(x));
    let product = if a == 0.0 || b == 0.0 || a * b != 0.0 { known(a * b) } else { None };
    let quotient = if b == 0.0 || (a != 0.0 && a / b == 0.0) { None } else { known(a / b) };
    ([known(a + b), known(a - b), product, quotient], (a as f32).to_bits())
}

/// Hard cases: ties and all but ties of every operation, cancellation, numbers far apart, and f32
/// numbers from subnormal to overflowing. The same on every machine.
#[must_use]
pub fn cases(count: usize) -> Vec<[f64; 2]> {
    use rand_pcg::Pcg64;
    use rand_pcg::rand_core::{Rng, SeedableRng};
    let mut random = Pcg64::seed_from_u64(0x6432);
    let mut number = |digits: u32, exponents: u64| {
        let bits = random.next_u64();
        let kept = bits & ((1 << 52) - 1) & !((1_u64 << (52 - digits)) - 1);
        let exponent = 1023 - exponents / 2 + random.next_u64() % exponents;
        f64::from_bits(bits & 1 << 63 | exponent << 52 | kept)
    };
    let ulps = |x: f64, ulps: i64| f64::from_bits(x.to_bits().wrapping_add_signed(ulps));
    (0..count)
        .map(|index| match index % 8 {
            0 => [number(52, 8), number(52, 8)],
            1 => [number(52, 120), number(52, 120)],
            2 => [number(52, 900), number(52, 900)],
            3 => [number(26, 4), number(27, 4)],
            4 => [number(5, 110), number(52, 4)],
            5 => {
                let (a, steps) = (number(52, 4), index as i64 / 8 % 9 - 4);
                [a, -ulps(a, steps)]
            }
            6 => {
                // Near ties of f32, down to subnormals.
                let a = number(24, 340);
                [ulps(a, index as i64 / 8 % 3 - 1), number(3, 4)]
            }
            _ => [number(1, 120), if index % 16 == 7 { 0.0 } else { ulps(1.0, -1) }],
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_those_of_the_processor() {
        let cases = cases(2_000_000);
        let mut known = [0; 4];
        for [x, y] in cases {
            let (a, b) = (Double::from(x), Double::from(y));
            let (expected, single) = evaluate(x, y);
            let results = [a.add(b), a.sub(b), a.mul(b), a.div(b)];
            for (operation, (result, expected)) in results.into_iter().zip(expected).enumerate() {
                if let Some(expected) = expected {
                    assert_eq!(result, expected, "operation {operation} of {x:e} {y:e}");
                    known[operation] += 1;
                }
            }
            assert_eq!(a.to_f32(), single, "{x:e}");
        }
        assert!(known.iter().all(|count| *count > 1_500_000), "{known:?}");
    }
}
