//! f32 arithmetic in integers, operation by operation what `pack.wgsl`, `soft.wgsl` and
//! `soft_div.wgsl` do.
//!
//! Floats are their bits. Operands are numbers, neither infinite nor NaN; what is too large becomes
//! infinite. Subnormals are numbers like all others, and results are rounded to the nearest, to
//! even on a tie.

const SIGN: u32 = 0x8000_0000;
const INFINITY: u32 = 0x7f80_0000;

/// The float nearest to `significand / 2^31 * 2^(exponent - 127)`.
pub(super) fn pack(sign: u32, exponent: i32, significand: u32) -> u32 {
    if exponent >= 255 {
        return sign | INFINITY;
    }
    let digits = shift_right(significand, (1 - exponent).max(0) as u32);
    let (kept, rest) = (digits >> 8, digits & 0xff);
    let up = u32::from(rest > 0x80 || (rest == 0x80 && kept & 1 == 1));
    sign | (((exponent - 1).max(0) as u32) << 23).wrapping_add(kept + up)
}

/// `x / 2^shift`, whose lowest bit also stands for everything shifted out.
fn shift_right(x: u32, shift: u32) -> u32 {
    let kept = x >> shift.min(31);
    let lost = if shift > 31 { x } else { x & ((1 << shift) - 1) };
    let kept = if shift > 31 { 0 } else { kept };
    kept | u32::from(lost != 0)
}

fn exponent(bits: u32) -> i32 {
    let exponent = (bits >> 23 & 0xff) as i32;
    if exponent == 0 { 9 - (bits & 0x7f_ffff).leading_zeros() as i32 } else { exponent }
}

fn digits(bits: u32) -> u32 {
    let digits = bits & 0x7f_ffff;
    let is_subnormal = bits & INFINITY == 0;
    let shift = if is_subnormal && digits != 0 { digits.leading_zeros() - 8 } else { 0 };
    if is_subnormal { digits << shift } else { digits | 0x80_0000 }
}

/// The float nearest to `n`.
#[must_use]
pub fn from_u32(n: u32) -> u32 {
    if n == 0 {
        return 0;
    }
    let zeros = n.leading_zeros();
    pack(0, 158 - zeros as i32, n << zeros)
}

/// `a + b`.
#[must_use]
pub fn add(a: u32, b: u32) -> u32 {
    let (large, small) = if a << 1 >= b << 1 { (a, b) } else { (b, a) };
    if small << 1 == 0 {
        return if large << 1 == 0 { a & b } else { large };
    }
    let exponent = (large >> 23 & 0xff).max(1);
    let distance = exponent - (small >> 23 & 0xff).max(1);
    let x = aligned(large) << 7;
    let y = shift_right(aligned(small) << 7, distance);
    let sum = if (a ^ b) & SIGN != 0 { x - y } else { x + y };
    if sum == 0 {
        return 0;
    }
    let zeros = sum.leading_zeros();
    pack(large & SIGN, exponent as i32 + 1 - zeros as i32, sum << zeros)
}

fn aligned(bits: u32) -> u32 {
    (bits & 0x7f_ffff) | if bits & INFINITY != 0 { 0x80_0000 } else { 0 }
}

/// `a - b`.
#[must_use]
pub fn sub(a: u32, b: u32) -> u32 {
    add(a, b ^ SIGN)
}

/// `a * b`.
#[must_use]
pub fn mul(a: u32, b: u32) -> u32 {
    let sign = (a ^ b) & SIGN;
    if a << 1 == 0 || b << 1 == 0 {
        return sign;
    }
    let (x, y) = (digits(a), digits(b));
    let middle = (x >> 12) * (y & 0xfff) + (x & 0xfff) * (y >> 12);
    let low = ((middle & 0xf) << 12) + (x & 0xfff) * (y & 0xfff);
    let product = (((x >> 12) * (y >> 12)) << 8) + (middle >> 4) + (low >> 16);
    let digits = product | u32::from(low & 0xffff != 0);
    let zeros = digits.leading_zeros();
    pack(sign, exponent(a) + exponent(b) - 126 - zeros as i32, digits << zeros)
}

/// `a / b`.
#[must_use]
pub fn div(a: u32, b: u32) -> u32 {
    let sign = (a ^ b) & SIGN;
    if a << 1 == 0 {
        return sign;
    }
    if b << 1 == 0 {
        return sign | INFINITY;
    }
    let divisor = digits(b);
    let is_below = digits(a) < divisor;
    let mut rest = (digits(a) << u32::from(is_below)) - divisor;
    let mut quotient = 1;
    for places in [8, 8, 8, 7] {
        rest <<= places;
        quotient = quotient << places | (rest / divisor);
        rest %= divisor;
    }
    let exponent = exponent(a) - exponent(b) + 127 - i32::from(is_below);
    pack(sign, exponent, quotient | u32::from(rest != 0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::float::probe;

    /// Every operation, against the processor's.
    fn check(a: u32, b: u32) {
        let [x, y] = [a, b].map(f32::from_bits);
        let same = |name: &str, soft: u32, hard: f32| {
            assert_eq!(
                soft,
                hard.to_bits(),
                "{x:e} {name} {y:e}: {:e}, {hard:e}",
                f32::from_bits(soft)
            );
        };
        same("+", add(a, b), x + y);
        same("-", sub(a, b), x - y);
        same("*", mul(a, b), x * y);
        if y != 0.0 {
            same("/", div(a, b), x / y);
        }
    }

    #[test]
    fn hard_cases_are_those_of_the_processor() {
        for [a, b, c] in probe::cases() {
            check(a, b);
            check(b, c);
        }
    }

    /// All exponents and differences of exponents, with digits that are ends of ranges.
    #[test]
    fn all_pairs_of_exponents_are_those_of_the_processor() {
        let digits = [0, 1, 0x40_0000, 0x55_5555, 0x7f_ffff];
        let numbers = (0..255).flat_map(|exponent| digits.map(|digits| exponent << 23 | digits));
        let numbers: Vec<u32> = numbers.collect();
        for &a in &numbers {
            for &b in &numbers {
                check(a, b);
                check(a | SIGN, b);
            }
        }
    }

    #[test]
    fn integers_are_rounded_as_the_processor_does() {
        let near = |n: u32| (0..40).map(move |step| n.wrapping_add(step).wrapping_sub(20));
        let powers = (0..32).flat_map(|power| near(1 << power));
        for n in powers.chain((0..1 << 20).map(|n: u32| n.wrapping_mul(0x9e37_79b9))) {
            assert_eq!(from_u32(n), (n as f32).to_bits(), "{n}");
        }
    }
}
