// The device's own f32 sums and products, kept from being rewritten. Floats are held as their bits.
//
// The driver does not know that `float_zero` is zero, so what passes through it is opaque: no
// operation can be fused with another one, moved across it or worked out beforehand. Two zeros,
// because the same one twice would cancel.

@group(1) @binding(0) var<uniform> float_zero: vec4u;

fn f_in(bits: u32) -> f32 {
    return bitcast<f32>(bits ^ float_zero.x);
}

fn f_out(x: f32) -> u32 {
    return bitcast<u32>(x) ^ float_zero.y;
}

fn f_add(a: u32, b: u32) -> u32 {
    return f_out(f_in(a) + f_in(b));
}

fn f_sub(a: u32, b: u32) -> u32 {
    return f_out(f_in(a) - f_in(b));
}

fn f_mul(a: u32, b: u32) -> u32 {
    return f_out(f_in(a) * f_in(b));
}
