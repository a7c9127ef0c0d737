//! Numbers for tests.

/// A number without a pattern, in 0..1.
pub(super) fn noise(state: &mut u32) -> f32 {
    *state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    (*state >> 8) as f32 / (1 << 24) as f32
}
