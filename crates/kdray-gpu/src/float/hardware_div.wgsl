// The device's own f32 quotients, for devices that round them.

fn f_div(a: u32, b: u32) -> u32 {
    return f_out(f_in(a) / f_in(b));
}
