//! The sRGB transfer function, IEC 61966-2-1. Images in memory are linear; this only runs when reading and writing
//! files.

use super::scalar;

/// The linear value of an encoded value; both in [0, 1].
pub fn linear_from_srgb(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { scalar::pow((encoded + 0.055) / 1.055, 2.4) }
}

/// The encoded value of a linear value; both in [0, 1].
pub fn srgb_from_linear(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * scalar::pow(linear, 1.0 / 2.4) - 0.055 }
}
