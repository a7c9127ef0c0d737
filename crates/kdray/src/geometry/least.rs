//! The lesser and the greater of two numbers, in one instruction each: `f32::min` and `f32::max` look for
//! NaN besides.

/// The lesser of two numbers, neither of which is NaN.
#[inline(always)]
pub(crate) fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater of two numbers, neither of which is NaN.
#[inline(always)]
pub(crate) fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
