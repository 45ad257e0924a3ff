//! Options of a comparison of two images.

use crate::compare::{NormalEncoding, PIXELS_PER_DEGREE};
use crate::math::Vec3;
use crate::names::Named;

/// A metric of difference.
///
/// ```
/// use taotie::comparison::diff::Metric;
/// use taotie::names::Named;
///
/// assert_eq!(Metric::from_name("ssim")?, Metric::Ssim);
/// assert!(Metric::Ssim.is_worse(0.90, 0.95) && !Metric::Flip.is_worse(0.90, 0.95));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Metric {
    /// Angle between normals, degrees.
    Angle,
    /// FLIP, [0, 1]: 0 for equal images.
    Flip,
    /// Structural similarity: 1 for equal images.
    Ssim,
    /// Peak signal-to-noise ratio, decibels: infinite for equal images.
    Psnr,
    /// Root mean square error of the encoded channels, [0, 1].
    Rmse,
}

impl Named for Metric {
    const WHAT: &'static str = "metric";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("angle", Self::Angle),
        ("flip", Self::Flip),
        ("ssim", Self::Ssim),
        ("psnr", Self::Psnr),
        ("rmse", Self::Rmse),
    ];
}

impl Metric {
    /// Returns `true` if `value` is worse than `limit`.
    pub fn is_worse(self, value: f64, limit: f64) -> bool {
        match self {
            Self::Angle | Self::Flip | Self::Rmse => value > limit,
            Self::Ssim | Self::Psnr => value < limit,
        }
    }
}

/// The meaning of the values in two images.
///
/// ```
/// use taotie::compare::NormalEncoding;
/// use taotie::comparison::diff::{DiffOptions, Encoding};
///
/// let encoding = Encoding::Normals(NormalEncoding::Signed);
/// let options = DiffOptions { encoding, ..DiffOptions::default() };
/// assert_ne!(options.encoding, Encoding::Auto);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Encoding {
    /// Normals if both look like normal maps, else colours.
    #[default]
    Auto,
    /// Colours.
    Color,
    /// Normals, stored this way in both.
    Normals(NormalEncoding),
}

/// Options of a comparison of two images.
///
/// ```
/// use taotie::comparison::diff::{DiffOptions, Metric};
/// use taotie::math::Vec3;
///
/// let grey = Vec3::splat(0.2);
/// let options = DiffOptions { metric: Some(Metric::Flip), background: grey, ..DiffOptions::default() };
/// assert!(options.pixels_per_degree > 60.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct DiffOptions {
    /// The only metric; `None` for all that apply.
    pub metric: Option<Metric>,
    /// The meaning of the values.
    pub encoding: Encoding,
    /// The background colour for transparent images, linear RGB in [0, 1].
    pub background: Vec3,
    /// The resolution that FLIP assumes, in pixels per degree of the viewer's field of view.
    pub pixels_per_degree: f64,
}

impl Default for DiffOptions {
    fn default() -> Self {
        Self {
            metric: None,
            encoding: Encoding::Auto,
            background: Vec3::splat(0.0),
            pixels_per_degree: f64::from(PIXELS_PER_DEGREE),
        }
    }
}
