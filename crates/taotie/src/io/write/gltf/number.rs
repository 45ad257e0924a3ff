//! Numbers of glTF's JSON.

/// Returns the number that prints as the float does: 0.7 and not 0.699999988.
pub(super) fn short(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}
