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
    /// The name of its material in names of files, where the asset has several.
    pub material: Option<String>,
    /// Its file; `None` inside of the asset. JSON has its name without folders.
    #[cfg_attr(feature = "serde", serde(serialize_with = "super::certified_files::named::option"))]
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
    /// Tells of a map in the asset. `label` is that of its material, as everywhere here; it may be empty.
    pub(super) fn inside(label: &str, map: MapKind, bitmap: &Bitmap) -> Self {
        let (material, bits) = (named(label), bitmap.bits());
        Self { map, material, file: None, bits, black: None, white: None, unit: "" }
    }

    /// Tells of a map in a file beside the model `path`.
    pub(super) fn beside(beside: &Beside, label: &str, path: &Path) -> Self {
        Self {
            map: beside.map,
            material: named(label),
            file: Some(beside.file(label, path)),
            bits: beside.bitmap.bits(),
            black: beside.range.map(|range| range.black),
            white: beside.range.map(|range| range.white),
            unit: beside.range.map_or("", |range| range.unit),
        }
    }
}

/// Returns the label of a material that has one.
fn named(label: &str) -> Option<String> {
    (!label.is_empty()).then(|| label.to_owned())
}
