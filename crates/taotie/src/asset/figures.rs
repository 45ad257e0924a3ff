//! The figures of a proof.

use super::level_figures::LevelFigures;
use super::part_figures::PartFigures;
use crate::bake::Fit;
use crate::length::Unit;

/// The differences of an asset from its scan, in numbers.
///
/// ```
/// use taotie::asset::{BIN_WIDTH, Figures};
///
/// /// Returns the mean angle by which the map improves on plain vertex normals, degrees, on the surface.
/// fn gain(figures: &Figures) -> Option<f64> {
///     let finest = figures.finest()?;
///     Some(finest.without_map?.mean - finest.surface_angles?.mean)
/// }
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Figures {
    /// The unit of all lengths, that of the scan's coordinates; `None` if unknown. In JSON it is `unit`, its name,
    /// and `metres_per_unit`.
    #[cfg_attr(feature = "serde", serde(flatten, with = "unit_as_json"))]
    pub unit: Option<Unit>,
    /// One for each level of detail, the finest first.
    pub levels: Vec<LevelFigures>,
    /// The scan's diagonal, in the scan's unit, like all lengths.
    pub diagonal: f64,
    /// How well the meshes fit each other; `None` if the low-poly mesh has no area.
    pub fit: Option<FitFigures>,
    /// Bytes of the scan's files; 0 for a scan in memory.
    pub bytes_in: u64,
    /// Bytes of the asset, including the files that it references.
    pub bytes_out: u64,
    /// Bytes that the asset takes on a graphics card; `None` unless it is glTF.
    pub gpu_bytes: Option<u64>,
    /// One for each material of the asset, if it has several.
    pub parts: Vec<PartFigures>,
    /// Contents that no figure and no image compares.
    pub unseen: Vec<String>,
}

impl Figures {
    /// Returns the figures of the finest level; `None` if nothing was measured.
    pub fn finest(&self) -> Option<&LevelFigures> {
        self.levels.first()
    }
}

/// A unit and its size in metres, which is derived from it.
#[cfg(feature = "serde")]
mod unit_as_json {
    use super::Unit;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[derive(Serialize, Deserialize)]
    struct Fields {
        unit: Option<Unit>,
        #[serde(skip_deserializing)]
        metres_per_unit: Option<f64>,
    }

    #[allow(clippy::ref_option)] // serde passes the field itself.
    pub fn serialize<S: Serializer>(unit: &Option<Unit>, serializer: S) -> Result<S::Ok, S::Error> {
        Fields { unit: *unit, metres_per_unit: unit.map(Unit::metres) }.serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Unit>, D::Error> {
        Fields::deserialize(deserializer).map(|fields| fields.unit)
    }
}

/// How well two meshes fit each other; see [`Fit`].
///
/// ```
/// use taotie::asset::FitFigures;
///
/// /// Returns `true` if the meshes hardly belong together.
/// fn lie_apart(fit: &FitFigures) -> bool {
///     fit.away > 0.1 || fit.turned > 0.1
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct FitFigures {
    /// The fraction of the low-poly mesh far from the scan.
    pub away: f64,
    /// The fraction that faces the opposite way.
    pub turned: f64,
    /// The mean distance as a fraction of the diagonal.
    pub distance_of_diagonal: f64,
}

impl From<Fit> for FitFigures {
    fn from(fit: Fit) -> Self {
        Self { away: fit.away, turned: fit.turned, distance_of_diagonal: fit.distance }
    }
}
