//! What a search has tried.

use crate::io::VertexBits;

/// A file that a search made, and what it measured of it.
///
/// ```
/// use taotie::asset::{Asset, Trial};
///
/// /// Returns the trial that came nearest to the scan.
/// fn nearest(asset: &Asset) -> Option<&Trial> {
///     asset.trials().iter().min_by(|a, b| a.mean_angle.total_cmp(&b.mean_angle))
/// }
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Trial {
    /// `true` if it is the scan itself, packed, with its nodes, materials, uvs and textures; else it was made from the scan.
    pub is_scan: bool,
    /// `true` for the one that the asset is.
    pub is_chosen: bool,
    /// Triangles.
    pub triangles: usize,
    /// Texels along a side of its maps, of a packed scan along the longest side of any; 0 if it has none.
    pub size: u32,
    /// `true` if it has a normal map.
    pub has_normal_map: bool,
    /// The quality of its maps as lossy WebP, of a packed scan of its normal maps; `None` if they lose nothing, or there are
    /// none.
    pub quality: Option<u8>,
    /// The bits of its vertices.
    pub bits: VertexBits,
    /// The mean angle between its normals and the scan's as seen, degrees.
    pub mean_angle: f64,
    /// The mean difference of base colours as seen, CIEDE2000; `None` if the scan has no colours.
    pub mean_color: Option<f64>,
    /// `true` if it is near enough to the scan.
    pub is_near: bool,
    /// Its bytes as a GLB of one level of detail, without metadata.
    pub bytes: u64,
}
