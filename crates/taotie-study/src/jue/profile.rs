//! Cross-sections of relief: height as a smooth function of distance, so that normals are continuous.

/// 0 below 0, 1 above 1, 3t² − 2t³ between.
pub(super) fn smooth(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// `level` inside (negative distance), 0 outside, with a bevel of `width` centred on the edge. Millimetres.
pub(super) fn plateau(distance: f32, level: f32, width: f32) -> f32 {
    level * smooth(0.5 - distance / width)
}

/// 1 at offset 0, falling smoothly to 0 at `half_width` on both sides.
pub(super) fn bump(offset: f32, half_width: f32) -> f32 {
    smooth(1.0 - offset.abs() / half_width)
}

/// A hemisphere over radius [0, 1], flattened at the base: a cheap alternative to the smooth (1 − r²)^1.5.
pub(super) fn dome(radius: f32) -> f32 {
    let t = (1.0 - radius * radius).max(0.0);
    t * t * (1.5 - 0.5 * t)
}

/// A triangle wave of period 1: 0 at whole numbers and 0.5 halfway between.
pub(super) fn from_whole(t: f32) -> f32 {
    (t - (t + 0.5).floor()).abs()
}
