//! Number formatting in glTF's JSON.

/// Returns the number that prints like the float: 0.7 rather than 0.699999988.
pub(super) fn short(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}
