//! Encoding from display-referred light to code values.

use crate::math::{Lane, poly};

/// The sRGB-encoded value of a linear one, both in [0, 1]: IEC 61966-2-1.
///
/// `f32`: within 3e-7, so 1e-4 of an 8-bit code and 0.02 of a 16-bit one (`laws::film::encoding_is_close`).
#[inline(always)]
pub fn srgb_from_linear<L: Lane>(linear: L) -> L {
    let power = poly::pow(linear, linear.lit(1.0 / 2.4));
    let curve = power * linear.lit(1.055) - linear.lit(0.055);
    L::select(linear.le(linear.lit(0.003_130_8)), linear * linear.lit(12.92), curve)
}

/// The code nearest to a value in [0, 1], if `top` is the code of one: an integral number in [0, `top`].
#[inline(always)]
pub fn round_to_codes<L: Lane>(value: L, top: f64) -> L {
    (value * value.lit(top) + value.lit(0.5)).floor()
}
