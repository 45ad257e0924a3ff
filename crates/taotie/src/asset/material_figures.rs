//! The differences of an asset's material from its scan's, in numbers.

use crate::bake::MaterialError;
use crate::compare::Summary;

/// The differences of the material that an asset shows from that of its scan, over points spread evenly; all `None`
/// where the scan says nothing of its material, or no point was found.
///
/// ```
/// use taotie::asset::MaterialFigures;
///
/// /// Returns `true` where hardly anybody sees a difference of colour.
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
    /// Between the values of metallic, [0, 1].
    pub metallic: Option<Summary>,
    /// Between the roughnesses as artists set them, [0, 1].
    pub roughness: Option<Summary>,
    /// Between the radiances emitted, in the channel that differs most.
    pub emission: Option<Summary>,
    /// Between the alphas, [0, 1]; those of a mask are 0 or 1.
    pub alpha: Option<Summary>,
    /// The part of the points at which a value of scan or asset is not finite, [0, 1]: what is not finite is in none of
    /// the summaries.
    pub not_finite: f64,
}

impl MaterialFigures {
    /// Sums up what was measured.
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

    /// Returns the differences of plain numbers by their names, in the order in which they are told.
    pub fn numbers(&self) -> [(&'static str, Option<Summary>); 4] {
        [
            ("metallic", self.metallic),
            ("roughness", self.roughness),
            ("emission", self.emission),
            ("alpha", self.alpha),
        ]
    }
}
