//! Development from light to display values: the settings, and the formula for a pixel.

use super::ToneCurve;
use super::encode::srgb_from_linear;
use super::tone::clamped;
use crate::math::{Lane, SimdLevel, Vec3};

/// The settings for developing an image.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Development {
    /// The exponent of two by which light is multiplied; [−60, 60].
    pub exposure_stops: f32,
    /// The curve that compresses light into the range of a display.
    pub tone: ToneCurve,
    /// The colour behind transparent parts of the image: linear, display-referred, in [0, 1]. It is composited after
    /// the tone curve. `None` keeps transparency in the file.
    pub background: Option<Vec3>,
    /// The SIMD level; it never changes a bit.
    pub simd: SimdLevel,
}

/// Develops one pixel, or a pack: from premultiplied linear RGBA to sRGB and straight alpha in [0, 1].
///
/// Colour is divided by alpha, multiplied by `exposure`, mapped through the curve, composited over the background in
/// linear light, and encoded. If alpha is zero, colour is black.
#[inline(always)]
pub fn develop_pixel<L: Lane>(
    rgba: [L; 4],
    exposure: f32,
    tone: ToneCurve,
    background: Option<Vec3>,
) -> [L; 4] {
    let (light, alpha) = developed_light(rgba, exposure, tone, background);
    [srgb_from_linear(light.x), srgb_from_linear(light.y), srgb_from_linear(light.z), alpha]
}

/// [`develop_pixel`] before it is encoded: display-referred linear light in [0, 1], and alpha.
#[inline(always)]
pub(super) fn developed_light<L: Lane>(
    [r, g, b, a]: [L; 4],
    exposure: f32,
    tone: ToneCurve,
    background: Option<Vec3>,
) -> (Vec3<L>, L) {
    let alpha = a.clamp(0.0, 1.0);
    let zero = a.lit(0.0);
    let straight = Vec3::select(zero.lt(alpha), Vec3::new(r, g, b) / alpha, Vec3::splat(zero));
    let shown = tone.apply(straight * a.lit(f64::from(exposure)));
    let Some(under) = background else { return (shown, alpha) };
    let under = Vec3::new(a.lit(under.x.into()), a.lit(under.y.into()), a.lit(under.z.into()));
    (clamped(shown * alpha + under * (a.lit(1.0) - alpha), 1.0), a.lit(1.0))
}
