//! The figures of a proof.

use super::level_figures::LevelFigures;
use super::part_figures::PartFigures;
use crate::bake::Fit;

/// The differences of an asset from its scan, in numbers.
///
/// ```
/// use taotie::asset::{BIN_WIDTH, Figures};
///
/// /// Returns the mean angle by which the map improves on vertex normals alone, degrees, on the surface.
/// fn gain(figures: &Figures) -> Option<f64> {
///     let finest = figures.finest()?;
///     Some(finest.without_map?.mean - finest.surface_angles?.mean)
/// }
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Figures {
    /// Of each level of detail, the finest first.
    pub levels: Vec<LevelFigures>,
    /// The scan's diagonal, model units.
    pub diagonal: f64,
    /// The fit of the meshes to one another; `None` where the low-poly mesh has no area.
    pub fit: Option<FitFigures>,
    /// Bytes of the scan's files; 0 in memory.
    pub bytes_in: u64,
    /// Bytes of the asset, with the files that it names.
    pub bytes_out: u64,
    /// Of each material of the asset, where it has several.
    pub parts: Vec<PartFigures>,
    /// What no figure and no image looks at.
    pub unseen: Vec<String>,
}

impl Figures {
    /// Returns the figures of the finest level; `None` if nothing was measured.
    pub fn finest(&self) -> Option<&LevelFigures> {
        self.levels.first()
    }
}

/// The fit of two meshes to one another; see [`Fit`].
///
/// ```
/// use taotie::asset::FitFigures;
///
/// /// Returns `true` where the meshes hardly belong together.
/// fn lie_apart(fit: &FitFigures) -> bool {
///     fit.away > 0.1 || fit.turned > 0.1
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct FitFigures {
    /// The part of the low-poly mesh far from the scan.
    pub away: f64,
    /// The part that faces the other way.
    pub turned: f64,
    /// The mean distance as a part of the diagonal.
    pub distance_of_diagonal: f64,
}

impl From<Fit> for FitFigures {
    fn from(fit: Fit) -> Self {
        Self { away: fit.away, turned: fit.turned, distance_of_diagonal: fit.distance }
    }
}
