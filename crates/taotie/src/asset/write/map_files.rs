//! Maps of a written asset: notes on where each is stored and what its values mean, green turned down for other
//! programs, and numbers as OpenEXR stores them.

use crate::asset::ask::Packing;
use crate::asset::bake::{Range, SeparateMap, Textures};
use std::path::{Path, PathBuf};
use taotie_engine::bake::MapKind;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::{Bitmap, Texels};
use taotie_engine::math::srgb::linear_from_srgb;
use taotie_engine::normal_map::green_turned;
use taotie_engine::scene::{GreenChannel, NormalSpace};
use taotie_io::GltfMaterial;

/// A map of a written asset: where it is stored, and what its values mean.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct MapNote {
    /// The kind of map.
    pub map: MapKind,
    /// The name of its material in file names, if the asset has several.
    pub material: Option<String>,
    /// Its file; `None` if it is inside the asset. JSON has its name without folders.
    #[serde(serialize_with = "without_folders::option")]
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
pub(super) fn named(label: &str) -> Option<String> {
    (!label.is_empty()).then(|| label.to_owned())
}

/// Returns the name of a file without its folders, which are private and differ between machines.
pub(in crate::asset) fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Serializes paths to JSON without their folders.
pub(in crate::asset) mod without_folders {
    use super::name_of;
    use serde::{Serialize, Serializer};
    use std::path::{Path, PathBuf};

    /// Writes an optional path.
    pub fn option<S: Serializer>(path: &Option<PathBuf>, serializer: S) -> Result<S::Ok, S::Error> {
        path.as_deref().map(name_of).serialize(serializer)
    }

    /// Writes a list of paths.
    pub fn list<S: Serializer>(paths: &[PathBuf], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(paths.iter().map(|path: &PathBuf| name_of(Path::new(path))))
    }
}

/// Returns the tangent-space maps of a material with green down, for programs that expect it, if the packing asks for
/// them; the asset's own maps have green up, as glTF requires.
///
/// # Errors
/// [`Error::Invalid`] if it does, and no such map was baked.
pub(super) fn turned_green(
    space: NormalSpace,
    textures: &Textures,
    packing: &Packing,
) -> Result<Vec<SeparateMap>> {
    if packing.green == GreenChannel::Up {
        return Ok(Vec::new());
    }
    let is_tangent = space == NormalSpace::Tangent;
    let turned: Vec<SeparateMap> = tangent_maps(textures)
        .filter(|_| is_tangent)
        .map(|(map, bitmap)| SeparateMap { map, bitmap: green_turned(bitmap), range: None })
        .collect();
    match turned.is_empty() {
        false => Ok(turned),
        true => Err(Error::invalid(
            "green down",
            "needs a normal or bent map in tangent space; bake one, or omit it",
        )),
    }
}

fn tangent_maps(textures: &Textures) -> impl Iterator<Item = (MapKind, &Bitmap)> {
    let bent = textures.separate.iter().filter(|file| file.map == MapKind::Bent);
    let normal = textures.normal.as_ref().map(|bitmap| (MapKind::Normal, bitmap));
    normal.into_iter().chain(bent.map(|file| (file.map, &file.bitmap)))
}

/// The meaning of a map's codes, [0, 1].
#[derive(Debug, Clone, Copy)]
pub(super) enum Meaning {
    /// Unit vectors n as (n + 1) / 2.
    Direction,
    /// Colour as sRGB; alpha unchanged.
    Color,
    /// Numbers between the values of black and white.
    Number(Range),
    /// The numbers themselves.
    Plain,
}

impl Meaning {
    fn number(self, code: f32) -> f32 {
        match self {
            Self::Direction => code * 2.0 - 1.0,
            Self::Color => linear_from_srgb(f64::from(code)) as f32,
            Self::Number(Range { black, white, .. }) => (black + f64::from(code) * (white - black)) as f32,
            Self::Plain => code,
        }
    }
}

/// Returns the bytes of an OpenEXR file with the numbers of a map.
///
/// # Errors
/// [`Error::Unsupported`] without the feature `exr`.
pub(super) fn encode_numbers(bitmap: &Bitmap, meaning: Meaning) -> Result<Vec<u8>> {
    let channels = if matches!(bitmap.channels(), 2 | 4) { 4 } else { 3 };
    let texels = (bitmap.width() * bitmap.height()) as usize;
    let mut samples = Vec::with_capacity(texels * channels);
    for texel in (0..texels).map(|i| bitmap.stored(i)) {
        samples.extend(texel[..3].iter().map(|code| meaning.number(*code)));
        samples.extend(&texel[3..channels]);
    }
    exr([bitmap.width(), bitmap.height()], &["R", "G", "B", "A"][..channels], &samples)
}

#[cfg(feature = "exr")]
fn exr([width, height]: [u32; 2], channels: &[&str], samples: &[f32]) -> Result<Vec<u8>> {
    taotie_io::encode_exr((width, height), &[taotie_io::ExrLayer { name: "", channels, samples }])
}

#[cfg(not(feature = "exr"))]
fn exr(_: [u32; 2], _: &[&str], _: &[f32]) -> Result<Vec<u8>> {
    Err(taotie_engine::Error::needs_feature("maps as OpenEXR", "exr"))
}

/// Returns a map of unit vectors as codes: floats store the vectors themselves.
///
/// # Errors
/// None: the size does not change.
pub(in crate::asset) fn codes_of_normals(bitmap: Bitmap) -> Result<Bitmap> {
    let Texels::F32(texels) = bitmap.texels() else { return Ok(bitmap) };
    let code = |[x, y, z, a]: &[f32; 4]| {
        let [x, y, z] = [*x, *y, *z].map(|v| v * 0.5 + 0.5);
        [x, y, z, *a]
    };
    let codes = Texels::F32(texels.iter().map(code).collect());
    Bitmap::new(bitmap.width(), bitmap.height(), bitmap.channels(), codes)
}

/// Returns the warning for these materials, which are unlit and hide their maps.
pub(super) fn note_unlit<T>(hiding: impl Iterator<Item = T>) -> Warnings {
    let mut warnings = Warnings::default();
    let what = "materials are unlit (KHR_materials_unlit): viewers show only their base colour map";
    warnings.note(what, hiding.count());
    warnings
}

/// Returns true if a written material hides textures.
pub(super) fn hides_maps(material: &GltfMaterial<'_>) -> bool {
    let GltfMaterial { metallic_roughness_map, occlusion_map, normal_map, emissive_map, layers, .. } =
        material;
    let hidden = [metallic_roughness_map, occlusion_map, normal_map, emissive_map];
    layers.is_some_and(|layers| layers.unlit) && hidden.iter().any(|map| map.is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_become_what_they_stand_for() {
        let range = Range { black: -1.0, white: 3.0, unit: "model units" };
        let numbers = [Meaning::Direction, Meaning::Color, Meaning::Number(range), Meaning::Plain];
        assert_eq!(numbers.map(|meaning| meaning.number(1.0)), [1.0, 1.0, 3.0, 1.0]);
        assert_eq!(numbers.map(|meaning| meaning.number(0.0)), [-1.0, 0.0, -1.0, 0.0]);
        assert!((Meaning::Color.number(0.5) - 0.214).abs() < 1e-3);
    }

    #[test]
    fn vectors_become_codes_again() {
        let vectors = Texels::F32(vec![[1.0, -1.0, 0.0, 1.0]]);
        let codes = codes_of_normals(Bitmap::new(1, 1, 3, vectors).unwrap()).unwrap();
        assert_eq!(codes.stored(0)[..3], [1.0, 0.0, 0.5]);
        let stored = Bitmap::new(1, 1, 3, Texels::U8(vec![[255, 0, 128, 255]])).unwrap();
        assert_eq!(codes_of_normals(stored.clone()).unwrap().stored(0), stored.stored(0));
    }
}
