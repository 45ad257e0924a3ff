//! What a search has tried.

use crate::io::{ImageCodec, VertexBits};

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
    /// The format of its normal map, of a packed scan with several the first that was encoded again; `None` if there is none.
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
    /// How many times the limit a figure of its angles is, the worst one if several are limited.
    pub angle_ratio: f64,
    /// The same of colours.
    pub color_ratio: Option<f64>,
    /// How many times a ceiling on triangles or on memory of the graphics card it has, the worst one; 0 without ceilings.
    pub ceiling_ratio: f64,
    /// `true` if it is near enough to the scan, and within all ceilings.
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

    /// Takes ratios to limits that are so many times as large for those to the limits themselves.
    pub(super) fn scale(&mut self, factor: f64) {
        self.angle_ratio *= factor;
        self.color_ratio = self.color_ratio.map(|ratio| ratio * factor);
        self.judge();
    }

    /// Decides whether it is near enough.
    pub(super) fn judge(&mut self) {
        self.is_near = self.ratio() <= 1.0 && self.is_within();
    }

    /// Returns `true` if it is within all ceilings.
    pub fn is_within(&self) -> bool {
        self.ceiling_ratio <= 1.0
    }

    /// Returns how many times the limits its differences are, at worst; at most 1 is near enough.
    pub fn ratio(&self) -> f64 {
        self.angle_ratio.max(self.color_ratio.unwrap_or_default())
    }
}
