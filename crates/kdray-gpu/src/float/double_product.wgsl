// f64 products and quotients in integers. Twin: `double.rs`.

//#import double

// All 64 bits of a product: high, low.
fn d_product(a: u32, b: u32) -> vec2u {
    let low = (a & 0xffffu) * (b & 0xffffu);
    let one = (a & 0xffffu) * (b >> 16u) + (low >> 16u);
    let other = (a >> 16u) * (b & 0xffffu) + (one & 0xffffu);
    let high = (a >> 16u) * (b >> 16u) + (one >> 16u) + (other >> 16u);
    return vec2u(high, (other << 16u) | (low & 0xffffu));
}

fn d_mul(a: Double, b: Double) -> Double {
    let lowest = d_product(a.low, b.low);
    let one = d_product(a.high, b.low);
    let other = d_product(a.low, b.high);
    let highest = d_product(a.high, b.high);
    // Words of the product, and what each carries into the next; the lowest is only looked at.
    let third_half = one.y + other.y;
    let third = third_half + lowest.x;
    let third_carry = u32(third_half < one.y) + u32(third < third_half);
    let second_half = highest.y + one.x;
    let second_most = second_half + other.x;
    let second = second_most + third_carry;
    let second_carry =
        u32(second_half < one.x) + u32(second_most < other.x) + u32(second < third_carry);
    let first = highest.x + second_carry;
    // Half of it may be in front of the point.
    let shift = u32((first & F_SIGN) == 0u);
    let high = (first << shift) | select(0u, second >> 31u, shift == 1u);
    let low = (second << shift) | select(0u, third >> 31u, shift == 1u);
    let rest = u32(((third << shift) | lowest.y) != 0u);
    let exponent = a.exponent + b.exponent + 1 - i32(shift);
    return d_normal(a.sign ^ b.sign, exponent, vec2u(high, low | rest));
}

const D_QUOTIENT = 55u; // Digits of a quotient: 53, one to round by, and one if the first is zero.

// `a / b`; zero where both are zero.
fn d_div(a: Double, b: Double) -> Double {
    // Room for a digit in front.
    var rest = vec2u(a.high >> 1u, (a.high << 31u) | (a.low >> 1u));
    let divisor = vec2u(b.high >> 1u, (b.high << 31u) | (b.low >> 1u));
    var quotient = vec2u(0u);
    for (var digit = 0u; digit < D_QUOTIENT; digit++) {
        let is_in = rest.x > divisor.x || (rest.x == divisor.x && rest.y >= divisor.y);
        let taken = select(vec2u(0u), divisor, is_in);
        quotient = vec2u((quotient.x << 1u) | (quotient.y >> 31u), (quotient.y << 1u) | u32(is_in));
        rest = vec2u(rest.x - taken.x - u32(rest.y < taken.y), rest.y - taken.y);
        rest = vec2u((rest.x << 1u) | (rest.y >> 31u), rest.y << 1u);
    }
    let below = u32((rest.x | rest.y) != 0u);
    let digits = vec2u((quotient.x << 9u) | (quotient.y >> 23u), (quotient.y << 9u) | below);
    let is_zero = a.high == 0u || b.high == 0u;
    let exponent = select(a.exponent - b.exponent, 0, is_zero);
    return d_normal(a.sign ^ b.sign, exponent, select(digits, vec2u(0u), is_zero));
}
