//! The map that is converted.

use crate::image::Bitmap;
use crate::scene::{GreenChannel, NormalSpace};
use crate::surface::{NormalMapKind, is_normal_map};

/// The content of a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum MapContent {
    /// Heights in the first channel; white is high.
    Heights,
    /// Normals.
    Normals(NormalSpace),
}

/// A map to be converted.
#[derive(Debug, Clone)]
pub struct MapSource {
    /// The texels as they are stored.
    pub bitmap: Bitmap,
    /// The meaning of its numbers.
    pub content: MapContent,
    /// The direction in which green points; read for tangent-space normals alone.
    pub green: GreenChannel,
}

/// Returns what a map holds by its pixels: normals, or heights where it is grey; `None` where it looks like neither.
pub fn guessed_content(bitmap: &Bitmap) -> Option<MapContent> {
    match is_normal_map(bitmap) {
        NormalMapKind::Tangent => Some(MapContent::Normals(NormalSpace::Tangent)),
        NormalMapKind::Object => Some(MapContent::Normals(NormalSpace::Object)),
        NormalMapKind::No => is_grey(bitmap).then_some(MapContent::Heights),
    }
}

fn is_grey(bitmap: &Bitmap) -> bool {
    (0..bitmap.texels().len()).map(|i| bitmap.stored(i)).all(|[r, g, b, _]| r == g && g == b)
}
