//! Numbers for the tests of this module.

/// Numbers in [0, 1) from a linear congruence.
pub(super) fn numbers(mut state: u32) -> impl FnMut() -> f32 {
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    }
}
