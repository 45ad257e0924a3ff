//! The screen for which levels of detail are switched: the one used to define visually lossless, 3840 × 2160 pixels.

use super::lod::Lod;

const PIXELS: f64 = 3840.0 * 2160.0;
/// An object that fills fewer pixels across shows almost nothing.
const LEAST: f64 = 8.0;

/// Returns the fraction of the screen covered by an object that fills this many pixels, squared, in [0, 1].
pub(super) fn coverage(across: u32) -> f32 {
    (f64::from(across) * f64::from(across) / PIXELS).min(1.0) as f32
}

/// Returns the pixels across an object that covers this fraction of the screen, at least 8, and at most those of the
/// finest.
pub(super) fn across(coverage: f32) -> f32 {
    let across = (f64::from(coverage).max(0.0) * PIXELS).sqrt();
    across.clamp(LEAST, f64::from(Lod::FINEST)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_follow_from_what_is_covered() {
        for pixels in [32, 64, 256, 512] {
            assert!((across(coverage(pixels)) - pixels as f32).abs() < 1e-3);
        }
        assert_eq!((across(1.0), across(0.0)), (512.0, 8.0));
    }
}
