//! The options of a bake.

use super::figure::Figure;
use super::lod::Lod;
use super::map_side::{self, AUTO_SIZE};
use super::requirement::Requirement;
use super::requirement_text;
use super::scan_size::ScanSize;
use crate::bake::MapKind;
use crate::error::{Error, Result};
use crate::io::{CodecKind, CodecSet};
use crate::mesh::Mesh;
use crate::scene::NormalSpace;
use std::path::PathBuf;
use std::sync::Arc;

/// A mesh that the caller brings.
///
/// ```
/// use std::sync::Arc;
/// use taotie::asset::{BakeOptions, MeshSource};
/// use taotie::mesh::Mesh;
///
/// let low = MeshSource::Mesh(Arc::new(Mesh::sphere(1.0, 24, 12)));
/// BakeOptions { low: Some(low), ..BakeOptions::default() }.check()?;
/// let low = MeshSource::File("low.glb".into());
/// BakeOptions { low: Some(low), ..BakeOptions::default() }.check()?;
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum MeshSource {
    /// In a model file.
    File(PathBuf),
    /// In memory, with uvs or without; serde cannot say it.
    #[cfg_attr(feature = "serde", serde(skip))]
    Mesh(Arc<Mesh>),
}

impl MeshSource {
    /// Returns the file's path as text; `None` in memory.
    pub(super) fn path(&self) -> Option<String> {
        match self {
            Self::File(path) => Some(path.display().to_string()),
            Self::Mesh(_) => None,
        }
    }

    /// Returns the file's name without folder; `None` in memory.
    pub(super) fn name(&self) -> Option<String> {
        match self {
            Self::File(path) => Some(path.file_name().unwrap_or_default().to_string_lossy().into_owned()),
            Self::Mesh(_) => None,
        }
    }
}

/// The start of projection rays, and the ray distance.
///
/// ```
/// use taotie::asset::{BakeOptions, MeshSource, RayDistance};
///
/// let low = Some(MeshSource::File("low.glb".into()));
/// let ray_distance = RayDistance::Cage(MeshSource::File("cage.glb".into()));
/// BakeOptions { low, ray_distance, ..BakeOptions::default() }.check()?;
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum RayDistance {
    /// Twice the gap between the meshes, measured around each vertex.
    #[default]
    Auto,
    /// As far everywhere, both ways, model units; above 0.
    Uniform(f64),
    /// From a cage, the low-poly mesh with its vertices moved outward, and as far inward.
    Cage(MeshSource),
}

/// The options of a bake. Built by `Default` and struct update.
///
/// ```
/// use taotie::asset::{BakeOptions, Lod};
/// use taotie::bake::MapKind;
///
/// let maps = vec![MapKind::Normal, MapKind::Occlusion];
/// let lods = vec![Lod::Triangles(5_000), Lod::Pixels(64)];
/// let options = BakeOptions { triangles: 20_000, lods, maps, ..BakeOptions::default() };
/// assert!(options.check().is_ok());
/// assert!(BakeOptions { triangles: 4_000, ..options }.check().is_err(), "fewer than 5,000");
/// ```
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct BakeOptions {
    /// The low-poly mesh; `None` simplifies the scan. A file of several materials, or a glTF file of several meshes or one
    /// that moves, stays as it is, and each of its materials gets maps of its own.
    pub low: Option<MeshSource>,
    /// Triangles of the low-poly mesh, at least 4; not read with `low`, `goal` or `bytes`.
    pub triangles: u32,
    /// Finds the asset of the fewest bytes that meets these requirements, as far as they are about angles and colours as seen;
    /// what is said of neither stays as [`Requirement::visually_lossless`] has it. It may have a normal map or none, or be the
    /// scan itself, packed. Then neither `triangles` and `size` nor the packing are read.
    #[cfg_attr(feature = "serde", serde(with = "requirement_text::optional"))]
    pub goal: Option<Vec<Requirement>>,
    /// Finds the asset that is nearest to the scan, by the limits of `goal`, among those of at most so many bytes, metadata
    /// included. With `goal` one that meets it is enough.
    pub bytes: Option<u64>,
    /// The image formats that a search for the smallest asset may choose from; those of `codecs` if empty.
    pub images: Vec<CodecKind>,
    /// The codecs that a search for the smallest asset may choose from.
    pub codecs: CodecSet,
    /// Further levels of detail, each coarser than the one before.
    pub lods: Vec<Lod>,
    /// `true` where no uvs may be made, since no file will hold them: `low` is needed then, with uvs. For maps alone.
    pub keep_uvs: bool,
    /// Texels across the maps, 16 to 16384, or [`AUTO_SIZE`].
    #[cfg_attr(feature = "serde", serde(with = "super::map_side::as_text"))]
    pub size: u32,
    /// Texels down the maps; as many as across where `None`. Only for `low` with uvs: atlases that are made are square.
    pub height: Option<u32>,
    /// The maps to bake.
    pub maps: Vec<MapKind>,
    /// `true` where the maps of all else that varies in the scan's materials are baked too: base colour, alpha, normals,
    /// metallic-roughness, occlusion, emission. Onto a low-poly mesh that is given go those that its own material leaves
    /// open.
    pub carry: bool,
    /// The space of normals and bent normals.
    pub space: NormalSpace,
    /// Samples a texel along each side, 1 to 8: 2 are four a texel.
    pub side: u32,
    /// Bits a channel of normal maps, 8 or 16; those of 8 are dithered where they would show bands.
    pub bits: u8,
    /// The number of texels by which UV islands are grown beyond their borders, at most 16384; `None` fills the map.
    pub dilation: Option<u32>,
    /// Rays over the hemisphere a texel, for occlusion and bent normals, 1 to 4096.
    pub ao_rays: u32,
    /// The distance within which surfaces block them, model units; `None` for any distance.
    pub ao_distance: Option<f64>,
    /// Roughness of the scan's own surface, [0, 1]; `None` takes that of its material.
    pub roughness: Option<f64>,
    /// The distance within which the scan is looked for.
    pub ray_distance: RayDistance,
    /// `true` where faults of the scan are looked for: open edges, triangles that are there twice.
    pub inspect: bool,
}

impl Default for BakeOptions {
    /// 50,000 triangles, a normal map of 2048² texels, four samples each, and the maps that the scan's material needs.
    fn default() -> Self {
        Self {
            low: None,
            triangles: 50_000,
            goal: None,
            bytes: None,
            images: Vec::new(),
            codecs: CodecSet::Portable,
            lods: Vec::new(),
            keep_uvs: false,
            size: 2048,
            height: None,
            maps: vec![MapKind::Normal],
            carry: true,
            space: NormalSpace::Tangent,
            side: 2,
            bits: 8,
            dilation: None,
            ao_rays: AO_RAYS,
            ao_distance: None,
            roughness: None,
            ray_distance: RayDistance::Auto,
            inspect: true,
        }
    }
}

/// The most texels by which UV islands are grown.
const MOST_DILATION: u32 = 16_384;

/// The default number of rays over the hemisphere.
pub(super) const AO_RAYS: u32 = 64;

/// Why maps of a mesh without uvs have as many texels across as down.
pub(super) const SQUARE: &str =
    "atlases that are made are square; give one number, or a low-poly mesh with uvs";

/// What maps need that are written without a model.
pub(super) const NEEDS_UVS: &str =
    "no file holds the uvs that would be made for them; give a low-poly mesh with uvs, or write a .glb";

impl BakeOptions {
    /// Refuses what cannot be done, before any work begins.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a value out of its range, and for values that contradict one another.
    pub fn check(&self) -> Result<()> {
        self.check_numbers()?;
        self.check_levels()?;
        self.check_goal()
    }

    fn check_numbers(&self) -> Result<()> {
        let wrong = |what: String, why: &str| Err(Error::invalid(what, why));
        let is_above_0 = |v: &Option<f64>| v.is_none_or(|v| v > 0.0 && v.is_finite());
        match self {
            Self { triangles: n @ 0..4, .. } => wrong(format!("{n} triangles"), "ask for at least 4"),
            Self { size: AUTO_SIZE, height: Some(_), .. } => {
                wrong(self.maps_in_words(), "they are square; leave the height out")
            }
            _ if self.size != AUTO_SIZE
                && !self.map_size().iter().all(|side| (16..=16_384).contains(side)) =>
            {
                wrong(self.maps_in_words(), "give 16 to 16384 texels")
            }
            Self { low: None, keep_uvs: true, .. } => wrong("maps alone".into(), NEEDS_UVS),
            Self { low: None, .. } if !self.is_square() => wrong(self.maps_in_words(), SQUARE),
            Self { maps, .. } if maps.is_empty() => wrong("no map".into(), "name at least one to bake"),
            Self { side: n, .. } if !(1..=8).contains(n) => {
                wrong(format!("{n}×{n} samples a texel"), "give 1 to 8 along each side")
            }
            Self { bits, .. } if ![8, 16].contains(bits) => {
                wrong(format!("{bits} bits a channel"), "normals are stored in 8 or 16")
            }
            Self { dilation: Some(n), .. } if *n > MOST_DILATION => {
                wrong(format!("a dilation of {n} texels"), "give at most 16384, the side of the largest map")
            }
            Self { ao_rays: n, .. } if !(1..=4096).contains(n) => {
                wrong(format!("{n} rays for occlusion"), "give 1 to 4096")
            }
            Self { ao_distance: v, .. } if !is_above_0(v) => {
                wrong("the distance of occlusion".into(), "give model units above 0")
            }
            Self { roughness: Some(v), .. } if !(0.0..=1.0).contains(v) => {
                wrong(format!("a roughness of {v}"), "give a number in [0, 1]")
            }
            _ => Ok(()),
        }
    }

    fn check_levels(&self) -> Result<()> {
        let made = (self.low.is_none() && !self.searches()).then_some(self.triangles);
        Lod::check(&self.lods, made)
    }

    fn check_goal(&self) -> Result<()> {
        if !self.searches() {
            return Ok(());
        }
        let bytes = self.bytes.map(|bytes| format!("bytes={bytes}"));
        let goal = self.goal.as_deref().map(requirement_text::argument);
        let what = goal.into_iter().chain(bytes).collect::<Vec<_>>().join(",");
        if self.low.is_some() {
            return Err(Error::invalid(
                what,
                "the low-poly mesh is given and none is searched; leave one out",
            ));
        }
        let has_budget = |required: &Requirement| required.figure == Figure::Bytes;
        let has_budget = self.bytes.is_some() || self.goal.iter().flatten().any(has_budget);
        if has_budget && !self.lods.is_empty() {
            return Err(Error::invalid(
                what,
                "a search within so many bytes makes one level of detail; leave the bytes or the levels out",
            ));
        }
        if self.space == NormalSpace::Object || !self.maps.contains(&MapKind::Normal) {
            let why =
                "it is met by a normal map in tangent space: add normal to the maps, leave out object space";
            return Err(Error::invalid(what, why));
        }
        Ok(())
    }

    /// Returns the limits that an asset and its levels of detail have to keep to.
    pub(super) fn limits(&self) -> Vec<Requirement> {
        self.goal.clone().unwrap_or_else(Requirement::visually_lossless)
    }

    /// Returns `true` if the asset is searched for.
    pub fn searches(&self) -> bool {
        self.goal.is_some() || self.bytes.is_some()
    }

    /// Returns `true` if a search can find the smallest asset: no mesh is given, and it can judge each map:
    /// those of normals in tangent space, and of what the scan has.
    pub fn may_search(&self) -> bool {
        const JUDGED: [MapKind; 6] = [
            MapKind::Normal,
            MapKind::Albedo,
            MapKind::MetallicRoughness,
            MapKind::Emission,
            MapKind::Alpha,
            MapKind::OcclusionMap,
        ];
        let is_made = self.low.is_none() && !self.keep_uvs;
        let is_judged = self.bakes(&[MapKind::Normal]) && self.maps.iter().all(|map| JUDGED.contains(map));
        is_made && is_judged && self.space == NormalSpace::Tangent
    }

    /// Returns the options with the number of texels that is chosen for a scan of this size in place of [`AUTO_SIZE`].
    pub fn sized(&self, scan: ScanSize) -> Self {
        let size = if self.size == AUTO_SIZE { map_side::chosen(scan.detail_side) } else { self.size };
        Self { size, ..self.clone() }
    }

    /// Returns how many texels the maps have across and down.
    pub(super) fn map_size(&self) -> [u32; 2] {
        [self.size, self.height.unwrap_or(self.size)]
    }

    /// Returns `true` where the maps have as many texels across as down.
    pub(super) fn is_square(&self) -> bool {
        self.height.is_none_or(|height| height == self.size)
    }

    /// Returns the maps by their size, for errors.
    pub(super) fn maps_in_words(&self) -> String {
        match self.map_size() {
            [AUTO_SIZE, _] => "maps of automatic size".into(),
            [width, height] => format!("maps of {width}×{height}"),
        }
    }

    /// Returns `true` where one of these maps is baked.
    pub(super) fn bakes(&self, any: &[MapKind]) -> bool {
        any.iter().any(|map| self.maps.contains(map))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_is_refused_with_its_reason() {
        let base = BakeOptions::default;
        let low = Some(MeshSource::File("low.glb".into()));
        let cases = [
            (BakeOptions { triangles: 3, ..base() }, "at least 4"),
            (BakeOptions { size: 8, ..base() }, "16 to 16384"),
            (BakeOptions { low: low.clone(), height: Some(20_000), ..base() }, "maps of 2048×20000: give 16"),
            (BakeOptions { height: Some(1024), ..base() }, "atlases that are made are square"),
            (BakeOptions { size: AUTO_SIZE, height: Some(64), ..base() }, "leave the height out"),
            (BakeOptions { maps: Vec::new(), ..base() }, "at least one"),
            (BakeOptions { keep_uvs: true, ..base() }, "maps alone: no file holds the uvs"),
            (BakeOptions { side: 9, ..base() }, "1 to 8"),
            (BakeOptions { bits: 12, ..base() }, "8 or 16"),
            (BakeOptions { dilation: Some(1 << 31), ..base() }, "at most 16384"),
            (BakeOptions { ao_rays: 0, ..base() }, "1 to 4096"),
            (BakeOptions { ao_distance: Some(f64::NAN), ..base() }, "above 0"),
            (BakeOptions { roughness: Some(1.5), ..base() }, "[0, 1]"),
            (BakeOptions { lods: vec![Lod::Triangles(50_000)], ..base() }, "the level of detail 50000"),
            (BakeOptions { goal: Some(Vec::new()), low, ..base() }, "leave one out"),
            (BakeOptions { bytes: Some(9), lods: vec![Lod::Pixels(64)], ..base() }, "one level of detail"),
            (BakeOptions { goal: Some(Vec::new()), space: NormalSpace::Object, ..base() }, "tangent space"),
        ];
        for (options, why) in cases {
            let error = options.check().unwrap_err().to_string();
            assert!(error.contains(why), "{error}");
        }
        assert!(base().check().is_ok() && BakeOptions { height: Some(2048), ..base() }.check().is_ok());
    }
}
