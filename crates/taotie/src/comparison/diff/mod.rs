//! The difference of two images, or of the normals in two maps.
//!
//! Images are compared as a screen shows them: sRGB, composited over a background. Normals are compared by the angle
//! between them, without texels that have alpha 0 or no unit vector.
//!
//! ```
//! use taotie::comparison::diff::{DiffOptions, ImagePair, NamedBitmap};
//! use taotie::{Bitmap, Progress};
//! use taotie_engine::image::Texels;
//!
//! # fn main() -> taotie::Result<()> {
//! let grey = |code: u8| Bitmap::new(16, 16, 1, Texels::U8(vec![[code, code, code, 255]; 256]));
//! let images = [("black", grey(0)?), ("white", grey(255)?)];
//! let [a, b] = images.each_ref().map(|(name, bitmap)| NamedBitmap { name, bitmap });
//! let options = DiffOptions::default();
//! let figures = ImagePair::new([a, b], &options)?.figures(&options, Progress::SILENT)?;
//! assert_eq!(figures.rmse, Some(1.0));
//! # Ok(())
//! # }
//! ```

mod pair;

pub use pair::{DiffFigures, ImageContent, ImagePair, NamedBitmap, guessed_encoding};

use taotie_engine::compare::{NormalEncoding, PIXELS_PER_DEGREE};
use taotie_engine::math::Vec3;
use taotie_engine::names::Named;

/// A metric of difference.
///
/// ```
/// use taotie::comparison::diff::Metric;
/// use taotie_engine::names::Named;
///
/// assert_eq!(Metric::from_name("ssim")?, Metric::Ssim);
/// assert!(Metric::Ssim.is_worse(0.90, 0.95) && !Metric::Flip.is_worse(0.90, 0.95));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
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
/// use taotie_engine::compare::NormalEncoding;
/// use taotie::comparison::diff::{DiffOptions, Encoding};
///
/// let encoding = Encoding::Normals(NormalEncoding::Signed);
/// let options = DiffOptions { encoding, ..DiffOptions::default() };
/// assert_ne!(options.encoding, Encoding::Auto);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
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
/// use taotie::Vec3;
/// use taotie::comparison::diff::{DiffOptions, Metric};
///
/// let grey = Vec3::splat(0.2);
/// let options = DiffOptions { metric: Some(Metric::Flip), background: grey, ..DiffOptions::default() };
/// assert!(options.pixels_per_degree > 60.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
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
