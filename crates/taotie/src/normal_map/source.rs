//! The map to convert.

use crate::image::Bitmap;
use crate::scene::{GreenChannel, NormalSpace};
use crate::surface::{NormalMapKind, is_normal_map};

/// The content of a map.
///
/// ```
/// use taotie::normal_map::MapContent;
/// use taotie::scene::NormalSpace;
///
/// let title = |content: MapContent| match content {
///     MapContent::Heights => "heights",
///     MapContent::Normals(NormalSpace::Tangent) => "normals in tangent space",
///     MapContent::Normals(NormalSpace::Object) => "normals in object space",
/// };
/// assert_eq!(title(MapContent::Normals(NormalSpace::Object)), "normals in object space");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum MapContent {
    /// Heights in the first channel; white is high.
    Heights,
    /// Normals.
    Normals(NormalSpace),
}

/// A map to convert.
///
/// ```no_run
/// use taotie::normal_map::{MapContent, MapSource};
/// use taotie::scene::{GreenChannel, NormalSpace};
///
/// let content = MapContent::Normals(NormalSpace::Tangent);
/// let bitmap = taotie::io::read_bitmap("directx.png".as_ref())?;
/// let source = MapSource { bitmap, content, green: GreenChannel::Down };
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct MapSource {
    /// The texels as stored.
    pub bitmap: Bitmap,
    /// The meaning of its values.
    pub content: MapContent,
    /// The direction in which green points; used only for tangent-space normals.
    pub green: GreenChannel,
}

/// Guesses the content of a map from its pixels: normals, or heights if it is grey; `None` if it looks like neither.
///
/// ```
/// use taotie::image::{Bitmap, Texels};
/// use taotie::normal_map::{MapContent, guessed_content};
/// use taotie::scene::NormalSpace;
///
/// let even = |texel: [u8; 4]| Bitmap::new(2, 2, 3, Texels::U8(vec![texel; 4]));
/// assert_eq!(guessed_content(&even([90, 90, 90, 255])?), Some(MapContent::Heights));
/// let tangent = MapContent::Normals(NormalSpace::Tangent);
/// assert_eq!(guessed_content(&even([128, 128, 255, 255])?), Some(tangent));
/// assert_eq!(guessed_content(&even([255, 255, 90, 255])?), None);
/// # Ok::<(), taotie::Error>(())
/// ```
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
