//! What a normal map is said to be, and what its pixels say.

use serde::Serialize;
use taotie::image::Bitmap;
use taotie::scene::{GreenChannel, NormalMap, NormalSpace};
use taotie::surface::{GreenVerdict, NormalMapKind, green_direction, invalid_texels, is_normal_map};

/// What a normal map is drawn as, and what its pixels say.
#[derive(Debug, Clone, Serialize)]
pub struct NormalMapReport {
    /// Multiplies x and y.
    pub scale: f32,
    /// The space it is drawn in: `tangent` or `object`.
    pub space: &'static str,
    /// The green direction it is drawn with: `up` or `down`.
    pub green: &'static str,
    /// What the pixels say.
    #[serde(flatten)]
    pub pixels: Pixels,
}

/// What the pixels of a normal map say.
#[derive(Debug, Clone, Serialize)]
pub struct Pixels {
    /// `tangent`, `object`, or `none` where it is no normal map.
    pub kind_by_pixels: &'static str,
    /// `up`, `down` or `unclear`; `None` unless it is a tangent-space map.
    pub green_by_pixels: Option<&'static str>,
    /// How sure the green direction is, [0, 1]; 0 where unclear.
    pub green_confidence: Option<f32>,
    /// Texels that cannot be tangent-space normals; `None` unless it is such a map.
    pub invalid_texels: Option<usize>,
    /// How many texels there are.
    pub texels: usize,
}

impl NormalMapReport {
    /// About `map`, of which `pixels` are.
    pub fn new(map: &NormalMap, pixels: Pixels) -> Self {
        let space = match map.space {
            NormalSpace::Tangent => "tangent",
            NormalSpace::Object => "object",
        };
        let green = match map.green {
            GreenChannel::Up => "up",
            GreenChannel::Down => "down",
        };
        Self { scale: map.scale, space, green, pixels }
    }
}

impl Pixels {
    /// Of a texture that is used as a normal map.
    pub fn of(bitmap: &Bitmap) -> Self {
        let kind = is_normal_map(bitmap);
        let guess = (kind == NormalMapKind::Tangent).then(|| green_direction(bitmap));
        Self {
            kind_by_pixels: match kind {
                NormalMapKind::Tangent => "tangent",
                NormalMapKind::Object => "object",
                NormalMapKind::No => "none",
            },
            green_by_pixels: guess.map(|guess| match guess.verdict {
                GreenVerdict::Up => "up",
                GreenVerdict::Down => "down",
                GreenVerdict::Unclear => "unclear",
            }),
            green_confidence: guess.map(|guess| guess.confidence),
            invalid_texels: guess.map(|_| invalid_texels(bitmap)),
            texels: bitmap.texels().len(),
        }
    }
}
