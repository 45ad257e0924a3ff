//! Figures in words: what each one measures, and how it compares scan and asset.

use super::figure::Figure;

/// The way in which a figure compares scan and asset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Looking {
    /// As seen, at the same pixel of both, with the whole object in view.
    Overview,
    /// As seen close up, at the resolution of the scan's detail.
    CloseUp,
    /// Point by point along the projection rays of a bake.
    OnTheSurface,
    /// The shapes themselves.
    Shape,
    /// Images from all sides in one grey material.
    Images,
    /// The files.
    Files,
}

impl Looking {
    /// Returns the way of comparing in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Overview => "overview",
            Self::CloseUp => "close-up",
            Self::OnTheSurface => "on the surface",
            Self::Shape => "shape",
            Self::Images => "images",
            Self::Files => "files",
        }
    }
}

impl Figure {
    /// Returns the way in which the figure compares scan and asset.
    pub fn looking(self) -> Looking {
        self.described().0
    }

    /// Returns the figure's title, such as `normal error, mean`.
    pub fn title(self) -> &'static str {
        self.described().1
    }

    fn described(self) -> (Looking, &'static str) {
        match self {
            Self::MeanAngle => (Looking::Overview, "normal error, mean"),
            Self::P95Angle => (Looking::Overview, "normal error, 95 %"),
            Self::MaxAngle => (Looking::Overview, "normal error, largest sampled"),
            Self::PatchAngle => (Looking::CloseUp, "normal error, mean in the worst 1 % of the surface"),
            Self::MeanColor => (Looking::Overview, "colour error, mean"),
            Self::P95Color => (Looking::Overview, "colour error, 95 %"),
            Self::PatchColor => (Looking::CloseUp, "colour error, mean in the worst 1 % of the surface"),
            Self::SurfaceMeanAngle => (Looking::OnTheSurface, "normal error, mean"),
            Self::SurfaceP95Angle => (Looking::OnTheSurface, "normal error, 95 %"),
            Self::SurfaceMaxAngle => (Looking::OnTheSurface, "normal error, largest sampled"),
            Self::Missed => (Looking::CloseUp, "visible surface that the other lacks"),
            Self::Completeness => (Looking::Shape, "scan within 0.5 % of the diagonal of the asset"),
            Self::WithinAngle => (Looking::CloseUp, "surface within a normal error"),
            Self::WithinColor => (Looking::CloseUp, "surface within a colour error"),
            Self::WithinDistance => (Looking::Shape, "surface within a distance"),
            Self::Hausdorff => (Looking::Shape, "largest distance (Hausdorff), proven bound"),
            Self::Silhouette => (Looking::Shape, "outline, largest deviation"),
            Self::Texel => (Looking::CloseUp, "texel of the asset, median width"),
            Self::Flip => (Looking::Images, "visual difference (FLIP), mean"),
            Self::WorstView => (Looking::Images, "visual difference (FLIP), worst view"),
            Self::Ssim => (Looking::Images, "structural similarity (SSIM), worst view"),
            Self::Triangles => (Looking::Files, "triangles"),
            Self::GpuMemory => (Looking::Files, "GPU memory"),
            Self::Bytes => (Looking::Files, "size of the asset"),
        }
    }
}
