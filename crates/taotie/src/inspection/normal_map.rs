//! The kind of a normal map: as drawn, and as guessed from its pixels.

use crate::image::Bitmap;
use crate::scene::{GreenChannel, NormalMap, NormalSpace};
use crate::surface::{GreenVerdict, NormalMapKind, green_direction, invalid_texels, is_normal_map};

/// A normal map: how it is drawn, and the guess from its pixels.
///
/// ```
/// use taotie::inspection::{MaterialReport, NormalMapReport};
/// use taotie::scene::GreenChannel;
///
/// /// Returns `true` if green points down, as in DirectX.
/// fn is_directx(material: &MaterialReport) -> bool {
///     let is_down = |map: &NormalMapReport| map.green == GreenChannel::Down;
///     material.normal_map.as_ref().is_some_and(is_down)
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct NormalMapReport {
    /// Multiplies x and y.
    pub scale: f32,
    /// The space in which it is drawn.
    pub space: NormalSpace,
    /// The green direction with which it is drawn.
    pub green: GreenChannel,
    /// The guess from its pixels.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub pixels: Pixels,
}

/// The guess about a normal map from its pixels.
///
/// ```
/// use taotie::inspection::Pixels;
/// use taotie::surface::NormalMapKind;
///
/// /// Returns `true` if the pixels leave no doubt that this is a tangent-space map.
/// fn is_surely_tangent(pixels: &Pixels) -> bool {
///     pixels.kind_by_pixels == NormalMapKind::Tangent && pixels.invalid_texels == Some(0)
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Pixels {
    /// Its kind.
    pub kind_by_pixels: NormalMapKind,
    /// Its green direction; `None` unless it is a tangent-space map.
    pub green_by_pixels: Option<GreenVerdict>,
    /// The confidence in the green direction, [0, 1]; 0 if unclear.
    pub green_confidence: Option<f32>,
    /// Texels that cannot be tangent-space normals; `None` unless it is such a map.
    pub invalid_texels: Option<usize>,
    /// The number of texels.
    pub texels: usize,
}

impl NormalMapReport {
    /// Makes the report on `map`, given the analysis of its `pixels`.
    pub(super) fn new(map: &NormalMap, pixels: Pixels) -> Self {
        Self { scale: map.scale, space: map.space, green: map.green, pixels }
    }
}

impl Pixels {
    /// Reports on a texture that is used as a normal map.
    pub(crate) fn of(bitmap: &Bitmap) -> Self {
        let kind = is_normal_map(bitmap);
        let guess = (kind == NormalMapKind::Tangent).then(|| green_direction(bitmap));
        Self {
            kind_by_pixels: kind,
            green_by_pixels: guess.map(|guess| guess.verdict),
            green_confidence: guess.map(|guess| guess.confidence),
            invalid_texels: guess.map(|_| invalid_texels(bitmap)),
            texels: bitmap.texels().len(),
        }
    }
}
