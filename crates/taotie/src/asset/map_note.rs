//! Notes on the maps of a written asset.

use super::textures::SeparateMap;
use crate::bake::MapKind;
use crate::image::Bitmap;
use std::path::{Path, PathBuf};

/// A map of a written asset: where it is stored, and what its values mean.
///
/// ```
/// use std::path::PathBuf;
/// use taotie::asset::WrittenAsset;
/// use taotie::bake::MapKind;
///
/// /// Returns the file of the height map and the heights of black and white, model units.
/// fn height(written: &WrittenAsset) -> Option<(PathBuf, [f64; 2])> {
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
    /// The name of its material in file names, if the asset has several.
    pub material: Option<String>,
    /// Its file; `None` if it is inside the asset. JSON has its name without folders.
    #[cfg_attr(feature = "serde", serde(serialize_with = "super::certified_files::named::option"))]
    pub file: Option<PathBuf>,
    /// Bits per channel.
    pub bits: u8,
    /// The value of black, in `unit`, if the map stores numbers.
    pub black: Option<f64>,
    /// The value of white.
    pub white: Option<f64>,
    /// The unit of these values.
    pub unit: &'static str,
}

impl MapNote {
    /// Describes a map inside the asset. `label` is that of its material, here and below; it may be empty.
    pub(super) fn inside(label: &str, map: MapKind, bitmap: &Bitmap) -> Self {
        let (material, bits) = (named(label), bitmap.bits());
        Self { map, material, file: None, bits, black: None, white: None, unit: "" }
    }

    /// Describes a map in a separate file next to the model `path`.
    pub(super) fn separate(own: &SeparateMap, label: &str, path: &Path) -> Self {
        Self {
            map: own.map,
            material: named(label),
            file: Some(own.file(label, path)),
            bits: own.bitmap.bits(),
            black: own.range.map(|range| range.black),
            white: own.range.map(|range| range.white),
            unit: own.range.map_or("", |range| range.unit),
        }
    }
}

/// Returns the label of a material, if it has one.
fn named(label: &str) -> Option<String> {
    (!label.is_empty()).then(|| label.to_owned())
}
