//! The figures of one material of an asset that has several.

use super::level_figures::Measured;
use crate::compare::Summary;

/// The differences of the triangles of one material from the scan, in numbers.
///
/// ```
/// use taotie::asset::{Figures, PartFigures};
///
/// /// Returns the material whose normals are farthest off.
/// fn worst(figures: &Figures) -> Option<&PartFigures> {
///     let mean = |part: &PartFigures| part.angles.map_or(f64::INFINITY, |angles| angles.mean);
///     figures.parts.iter().max_by(|a, b| mean(a).total_cmp(&mean(b)))
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PartFigures {
    /// The name of the material in the names of files.
    pub material: String,
    /// Triangles.
    pub triangles: usize,
    /// Degrees between the normals shown and the scan's; `None` where no point was found.
    pub angles: Option<Summary>,
    /// The same without the normal map.
    pub without_map: Option<Summary>,
    /// The part of the points whose projection ray missed the scan.
    pub missed: f64,
    /// The part for which no point of the scan was found at all.
    pub lost: f64,
}

impl PartFigures {
    /// Sums up what was measured of a material of so many triangles.
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
