// f32 quotients in integers. Twin: `soft.rs`.

fn f_div(a: u32, b: u32) -> u32 {
    let sign = (a ^ b) & F_SIGN;
    if (a << 1u) == 0u {
        return sign;
    }
    if (b << 1u) == 0u {
        return sign | F_INFINITY;
    }
    let divisor = f_digits(b);
    let is_below = f_digits(a) < divisor;
    var rest = (f_digits(a) << u32(is_below)) - divisor;
    // The first digit is 1; then follow 31 more.
    var quotient = 1u;
    for (var step = 0u; step < 4u; step++) {
        let places = select(8u, 7u, step == 3u);
        rest <<= places;
        quotient = (quotient << places) | (rest / divisor);
        rest %= divisor;
    }
    let exponent = f_exponent(a) - f_exponent(b) + 127 - i32(is_below);
    return f_pack(sign, exponent, quotient | u32(rest != 0u));
}
