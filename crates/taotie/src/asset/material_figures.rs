//! The differences between the materials of an asset and its scan, in numbers.

use crate::bake::MaterialError;
use crate::compare::Summary;

/// The differences between the materials of an asset and its scan, over evenly spread points; all `None` if the scan
/// specifies no material, or no point was found.
///
/// ```
/// use taotie::asset::MaterialFigures;
///
/// /// Returns `true` if a difference of colour is hardly visible.
/// fn keeps_its_colors(material: &MaterialFigures) -> bool {
///     material.color.is_some_and(|color| color.mean < 1.0 && color.p95 < 3.0)
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[non_exhaustive]
pub struct MaterialFigures {
    /// CIEDE2000 between the base colours; about 1 is just visible.
    pub color: Option<Summary>,
    /// Between the metallic values, [0, 1].
    pub metallic: Option<Summary>,
    /// Between the perceptual roughness values, [0, 1].
    pub roughness: Option<Summary>,
    /// Between the emitted radiances, in the channel that differs most.
    pub emission: Option<Summary>,
    /// Between the alphas, [0, 1]; those of a mask are 0 or 1.
    pub alpha: Option<Summary>,
    /// The share of the points at which a value of scan or asset is not finite, [0, 1]: these values are in none of
    /// the summaries.
    pub not_finite: f64,
}

impl MaterialFigures {
    /// Summarizes measured errors.
    pub(super) fn of(error: &MaterialError) -> Self {
        Self {
            color: error.color.summary(),
            metallic: error.metallic.summary(),
            roughness: error.roughness.summary(),
            emission: error.emission.summary(),
            alpha: error.alpha.summary(),
            not_finite: error.not_finite,
        }
    }

    /// Returns the differences of scalar properties with their names, in reporting order.
    pub fn numbers(&self) -> [(&'static str, Option<Summary>); 4] {
        [
            ("metallic", self.metallic),
            ("roughness", self.roughness),
            ("emission", self.emission),
            ("alpha", self.alpha),
        ]
    }
}
