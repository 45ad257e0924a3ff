//! Notes on the maps of a written asset.

use super::textures::Beside;
use crate::bake::MapKind;
use crate::image::Bitmap;
use std::path::{Path, PathBuf};

/// A map of a written asset: where it stands, and what its numbers mean.
///
/// ```
/// use std::path::PathBuf;
/// use taotie::asset::Written;
/// use taotie::bake::MapKind;
///
/// /// Returns the file of the height map and the heights of black and white, model units.
/// fn height(written: &Written) -> Option<(PathBuf, [f64; 2])> {
///     let note = written.maps().into_iter().find(|note| note.map == MapKind::Height)?;
///     Some((note.file?, [note.black?, note.white?]))
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct MapNote {
    /// The kind of map.
    pub map: MapKind,
    /// Its file; `None` inside of the asset.
    pub file: Option<PathBuf>,
    /// Bits a channel.
    pub bits: u8,
    /// The number of black, in `unit`, where the map holds numbers.
    pub black: Option<f64>,
    /// The number of white.
    pub white: Option<f64>,
    /// The unit of these.
    pub unit: &'static str,
}

impl MapNote {
    pub(super) fn inside((map, bitmap): (MapKind, &Bitmap)) -> Self {
        Self { map, file: None, bits: bitmap.bits(), black: None, white: None, unit: "" }
    }

    pub(super) fn beside(beside: &Beside, path: &Path) -> Self {
        Self {
            map: beside.map,
            file: Some(beside.file(path)),
            bits: beside.bitmap.bits(),
            black: beside.range.map(|range| range.black),
            white: beside.range.map(|range| range.white),
            unit: beside.range.map_or("", |range| range.unit),
        }
    }
}
