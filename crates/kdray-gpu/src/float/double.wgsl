// f64 arithmetic in integers: the processor's digits, with exponents that have no end.
//
// Results that would be subnormal or infinite on the processor keep all their digits here. There
// are no branches: drivers put every call in line, and neighbours rarely take the same way.
// Twin: `double.rs`.

//#import float_pack

// `digits / 2^63 * 2^exponent`: 64 digits, of which the first is set and the last 11 are not.
// Zero has no digits, and an exponent below all others.
struct Double {
    high: u32,
    low: u32,
    exponent: i32,
    sign: u32, // The highest bit.
}

const D_LOWEST = -0x20000000;

fn d_of(bits: u32) -> Double {
    let is_zero = (bits << 1u) == 0u;
    let exponent = select(f_exponent(bits) - 127, D_LOWEST, is_zero);
    return Double(f_digits(bits) << 8u, 0u, exponent, bits & F_SIGN);
}

// The f32 nearest to it.
fn d_to_f32(a: Double) -> u32 {
    let exponent = max(a.exponent, -1000);
    return f_pack(a.sign, exponent + 127, a.high | u32(a.low != 0u));
}

// Brings the first of 64 digits, of which the last stands for everything below, to the front, and
// rounds to 53.
fn d_normal(sign: u32, exponent: i32, digits: vec2u) -> Double {
    let is_short = digits.x == 0u;
    let words = select(digits, vec2u(digits.y, 0u), is_short);
    let shift = countLeadingZeros(words.x) & 31u;
    let pulled = select(words.y >> (32u - shift), 0u, shift == 0u);
    let high = (words.x << shift) | pulled;
    let low = words.y << shift;
    let rest = low & 0x7ffu;
    let is_up = rest > 0x400u || (rest == 0x400u && (low & 0x800u) != 0u);
    let kept = (low & 0xfffff800u) + select(0u, 0x800u, is_up);
    let carried = high + u32(is_up && kept == 0u);
    // All digits were set: the next power of two.
    let is_next = carried == 0u && high != 0u;
    let shifted = exponent - i32(shift + select(0u, 32u, is_short)) + i32(is_next);
    return Double(
        select(carried, 0x80000000u, is_next), kept, select(shifted, D_LOWEST, high == 0u), sign);
}

fn d_add(a: Double, b: Double) -> Double {
    let is_swapped = d_is_below(a, b);
    let sign = select(a.sign, b.sign, is_swapped);
    let exponent = max(a.exponent, b.exponent);
    let large = select(vec2u(a.high, a.low), vec2u(b.high, b.low), is_swapped);
    let small = select(vec2u(b.high, b.low), vec2u(a.high, a.low), is_swapped);
    // A bit of room for a carry.
    let x = vec2u(large.x >> 1u, (large.x << 31u) | (large.y >> 1u));
    let y = d_shift_right(small, 1u + u32(exponent - min(a.exponent, b.exponent)));
    let is_sum = a.sign == b.sign;
    let low = select(x.y - y.y, x.y + y.y, is_sum);
    let carry = u32(select(x.y < y.y, low < x.y, is_sum));
    let high = select(x.x - y.x - carry, x.x + y.x + carry, is_sum);
    // A zero is negative only if both are.
    let is_zero = (high | low) == 0u;
    return d_normal(select(sign, a.sign & b.sign, is_zero), exponent + 1, vec2u(high, low));
}

// The digits over `2^shift`, for a shift of at least one. The last digit also stands for those lost.
fn d_shift_right(digits: vec2u, shift: u32) -> vec2u {
    let is_far = shift >= 32u;
    let words = select(digits, vec2u(0u, digits.x), is_far);
    let by = shift & 31u;
    let mixed = select(words.x << (32u - by), 0u, by == 0u);
    let lost = (words.y & ((1u << by) - 1u)) | select(0u, digits.y, is_far);
    let kept = vec2u(words.x >> by, (words.y >> by) | mixed | u32(lost != 0u));
    return select(kept, vec2u(0u, u32((digits.x | digits.y) != 0u)), shift >= 64u);
}

// Whether `|a| < |b|`.
fn d_is_below(a: Double, b: Double) -> bool {
    let is_same_high = a.high == b.high;
    let has_less = a.high < b.high || (is_same_high && a.low < b.low);
    return a.exponent < b.exponent || (a.exponent == b.exponent && has_less);
}
