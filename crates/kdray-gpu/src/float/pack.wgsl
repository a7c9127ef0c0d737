// Rounded floats from integers. Twin: `soft.rs`.

const F_SIGN = 0x80000000u;
const F_INFINITY = 0x7f800000u;

// The float nearest to `significand / 2^31 * 2^(exponent - 127)`, even on a tie. The significand's
// highest bit is set; its lowest also stands for everything below it.
fn f_pack(sign: u32, exponent: i32, significand: u32) -> u32 {
    if exponent >= 255 {
        return sign | F_INFINITY;
    }
    // Subnormals have the exponent of the smallest normal float, and fewer digits.
    let digits = f_shift_right(significand, u32(max(1 - exponent, 0)));
    let kept = digits >> 8u;
    let rest = digits & 0xffu;
    let up = u32(rest > 0x80u || (rest == 0x80u && (kept & 1u) == 1u));
    // The highest bit of `kept`, or a carry into it, counts the exponent up by one.
    return sign | ((u32(max(exponent - 1, 0)) << 23u) + kept + up);
}

// `x / 2^shift`, whose lowest bit also stands for everything shifted out.
fn f_shift_right(x: u32, shift: u32) -> u32 {
    let kept = x >> min(shift, 31u);
    let lost = select(x & ((1u << min(shift, 31u)) - 1u), x, shift > 31u);
    return select(kept, 0u, shift > 31u) | u32(lost != 0u);
}

// Exponent and 24 digits of a float that is not zero, subnormals brought to the same form.
fn f_exponent(bits: u32) -> i32 {
    let digits = bits & 0x7fffffu;
    let exponent = i32((bits >> 23u) & 0xffu);
    return select(exponent, 9 - i32(countLeadingZeros(digits)), exponent == 0);
}

fn f_digits(bits: u32) -> u32 {
    let digits = bits & 0x7fffffu;
    let is_subnormal = (bits & F_INFINITY) == 0u;
    let shift = select(0u, countLeadingZeros(digits) - 8u, is_subnormal && digits != 0u);
    return select(digits | 0x800000u, digits << shift, is_subnormal);
}

// The float nearest to `n`.
fn f_from_u32(n: u32) -> u32 {
    if n == 0u {
        return 0u;
    }
    let zeros = countLeadingZeros(n);
    return f_pack(0u, 158 - i32(zeros), n << zeros);
}

// An integer that compares like the float. Twin: `kdray`'s `ordered`.
fn f_key(bits: u32) -> u32 {
    return bits ^ (u32(i32(bits) >> 31u) | F_SIGN);
}

// The float of a key.
fn f_of_key(key: u32) -> u32 {
    return key ^ (~u32(i32(key) >> 31u) | F_SIGN);
}

// Whether `a < b`; both zeros are equal.
fn f_less(a: u32, b: u32) -> bool {
    let is_zero = ((a | b) << 1u) == 0u;
    return !is_zero && f_key(a) < f_key(b);
}
