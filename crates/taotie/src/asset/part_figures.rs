//! The figures of one material of an asset that has several.

use super::level_figures::Measured;
use crate::compare::Summary;

/// The differences of the triangles of one material from the scan, in numbers.
///
/// ```
/// use taotie::asset::{Figures, PartFigures};
///
/// /// Returns the material with the largest normal error.
/// fn worst(figures: &Figures) -> Option<&PartFigures> {
///     let mean = |part: &PartFigures| part.angles.map_or(f64::INFINITY, |angles| angles.mean);
///     figures.parts.iter().max_by(|a, b| mean(a).total_cmp(&mean(b)))
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PartFigures {
    /// The name of the material as used in file names.
    pub material: String,
    /// Triangles.
    pub triangles: usize,
    /// Degrees between the displayed normals and the scan's; `None` if no point was found.
    pub angles: Option<Summary>,
    /// The same without the normal map.
    pub without_map: Option<Summary>,
    /// The share of points whose projection ray missed the scan.
    pub missed: f64,
    /// The share for which no point of the scan was found at all.
    pub lost: f64,
}

impl PartFigures {
    /// Summarizes the measurements of a material with this number of triangles.
    pub(super) fn of(material: &str, triangles: usize, found: &Measured) -> Self {
        Self {
            material: material.to_owned(),
            triangles,
            angles: found.angles.summary(),
            without_map: found.plain.summary(),
            missed: found.missed,
            lost: found.lost,
        }
    }
}
