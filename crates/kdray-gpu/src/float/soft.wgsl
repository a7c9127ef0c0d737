// f32 sums and products in integers, for devices whose own are not those of the processor.
//
// Operands are numbers, not infinities and not NaN; what is too large becomes infinite.
// Twin: `soft.rs`.

fn f_add(a: u32, b: u32) -> u32 {
    let is_ordered = (a << 1u) >= (b << 1u);
    let large = select(b, a, is_ordered);
    let small = select(a, b, is_ordered);
    if (small << 1u) == 0u {
        // A zero is negative only if both are.
        return select(large, a & b, (large << 1u) == 0u);
    }
    let exponent = i32(max((large >> 23u) & 0xffu, 1u));
    let distance = u32(exponent) - max((small >> 23u) & 0xffu, 1u);
    let x = f_aligned(large) << 7u;
    let y = f_shift_right(f_aligned(small) << 7u, distance);
    let sum = select(x + y, x - y, ((a ^ b) & F_SIGN) != 0u);
    if sum == 0u {
        return 0u;
    }
    let zeros = countLeadingZeros(sum);
    return f_pack(large & F_SIGN, exponent + 1 - i32(zeros), sum << zeros);
}

// The digits of a float, those of subnormals with leading zeros.
fn f_aligned(bits: u32) -> u32 {
    return (bits & 0x7fffffu) | select(0u, 0x800000u, (bits & F_INFINITY) != 0u);
}

fn f_sub(a: u32, b: u32) -> u32 {
    return f_add(a, b ^ F_SIGN);
}

fn f_mul(a: u32, b: u32) -> u32 {
    let sign = (a ^ b) & F_SIGN;
    if (a << 1u) == 0u || (b << 1u) == 0u {
        return sign;
    }
    // 48 bits, in parts of 12.
    let x = f_digits(a);
    let y = f_digits(b);
    let middle = (x >> 12u) * (y & 0xfffu) + (x & 0xfffu) * (y >> 12u);
    let low = ((middle & 0xfu) << 12u) + (x & 0xfffu) * (y & 0xfffu);
    let product = (((x >> 12u) * (y >> 12u)) << 8u) + (middle >> 4u) + (low >> 16u);
    let digits = product | u32((low & 0xffffu) != 0u);
    let zeros = countLeadingZeros(digits);
    return f_pack(sign, f_exponent(a) + f_exponent(b) - 126 - i32(zeros), digits << zeros);
}
