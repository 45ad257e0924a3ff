//! The candidates that a search has tried.

use crate::io::{ImageCodec, VertexBits};

/// A file made by a search, and its measurements.
///
/// ```
/// use taotie::asset::{Asset, Trial};
///
/// /// Returns the trial closest to the scan.
/// fn nearest(asset: &Asset) -> Option<&Trial> {
///     asset.trials().iter().min_by(|a, b| a.mean_angle.total_cmp(&b.mean_angle))
/// }
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Trial {
    /// `true` if it is the scan itself, packed, with its nodes, materials, uvs and textures; otherwise it was made
    /// from the scan.
    pub is_scan: bool,
    /// `true` if it became the asset.
    pub is_chosen: bool,
    /// Triangles.
    pub triangles: usize,
    /// Texels along a side of its maps; for a packed scan, along the longest side of any; 0 if it has none.
    pub size: u32,
    /// `true` if it has a normal map.
    pub has_normal_map: bool,
    /// The format of its normal map; for a packed scan with several, of the first that was re-encoded; `None` if
    /// there is none.
    pub normals: Option<ImageCodec>,
    /// The bits of its vertices.
    pub bits: VertexBits,
    /// The mean angle between its normals and the scan's as seen, degrees.
    pub mean_angle: f64,
    /// The 95th percentile of these angles, degrees.
    pub p95_angle: f64,
    /// The mean difference of base colours as seen, CIEDE2000; `None` if the scan has no colours.
    pub mean_color: Option<f64>,
    /// The 95th percentile of these differences.
    pub p95_color: Option<f64>,
    /// The ratio of a figure of its angles to the limit, the largest one if several are limited.
    pub angle_ratio: f64,
    /// The same for colours.
    pub color_ratio: Option<f64>,
    /// The largest ratio of its triangles or graphics memory to a ceiling; 0 without ceilings.
    pub ceiling_ratio: f64,
    /// `true` if it is close enough to the scan, and within all ceilings.
    pub is_near: bool,
    /// Its bytes as a GLB of one level of detail, without metadata.
    pub bytes: u64,
    /// Its bytes on a graphics card; see [`GltfSizes`](crate::io::GltfSizes).
    pub gpu_bytes: u64,
}

impl Trial {
    /// The kinds of assets: with a normal map, without one, and the packed scan.
    pub const KINDS: [&'static str; 3] = ["a normal map", "no normal map", "the packed scan"];

    /// Returns its kind, one of [`Trial::KINDS`].
    pub fn kind(&self) -> &'static str {
        match self {
            Self { is_scan: true, .. } => Self::KINDS[2],
            Self { has_normal_map: true, .. } => Self::KINDS[0],
            _ => Self::KINDS[1],
        }
    }

    /// Converts ratios to limits multiplied by `factor` into ratios to the limits themselves.
    pub(super) fn scale(&mut self, factor: f64) {
        self.angle_ratio *= factor;
        self.color_ratio = self.color_ratio.map(|ratio| ratio * factor);
        self.judge();
    }

    /// Decides whether it is close enough.
    pub(super) fn judge(&mut self) {
        self.is_near = self.ratio() <= 1.0 && self.is_within();
    }

    /// Returns `true` if it is within all ceilings.
    pub fn is_within(&self) -> bool {
        self.ceiling_ratio <= 1.0
    }

    /// Returns the largest ratio of its differences to their limits; at most 1 is close enough.
    pub fn ratio(&self) -> f64 {
        self.angle_ratio.max(self.color_ratio.unwrap_or_default())
    }
}
