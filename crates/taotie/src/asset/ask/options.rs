//! The options of a bake, and of the packing of its asset.

use super::channels::Channels;
use super::figure::Figure;
use super::lod::Lod;
use super::requirement::{self, Requirement};
use std::path::PathBuf;
use std::sync::Arc;
use taotie_engine::bake::{MapContent, MapKind, MatchRule, SetSizes};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{GreenChannel, NormalSpace};
use taotie_engine::surface::NoiseHandling;
use taotie_io::{CodecKind, CodecSet, GltfFormat, TextureCodecs, VertexBits, XmpProperties};

/// A mesh provided by the caller.
///
/// ```
/// use std::sync::Arc;
/// use taotie::Mesh;
/// use taotie::asset::{BakeOptions, MeshSource};
///
/// let low = MeshSource::Mesh(Arc::new(Mesh::sphere(1.0, 24, 12)));
/// BakeOptions { low: Some(low), ..BakeOptions::default() }.check()?;
/// let low = MeshSource::File("low.glb".into());
/// BakeOptions { low: Some(low), ..BakeOptions::default() }.check()?;
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum MeshSource {
    /// In a model file.
    File(PathBuf),
    /// In memory, with or without uvs; not supported by serde.
    #[serde(skip)]
    Mesh(Arc<Mesh>),
}

impl MeshSource {
    /// Returns the file's path as text; `None` in memory.
    pub(in crate::asset) fn path(&self) -> Option<String> {
        match self {
            Self::File(path) => Some(path.display().to_string()),
            Self::Mesh(_) => None,
        }
    }

    /// Returns the file's name without folders; `None` in memory.
    pub(in crate::asset) fn name(&self) -> Option<String> {
        match self {
            Self::File(path) => Some(path.file_name().unwrap_or_default().to_string_lossy().into_owned()),
            Self::Mesh(_) => None,
        }
    }
}

/// The start and length of projection rays.
///
/// ```
/// use taotie::asset::{BakeOptions, MeshSource, RayDistance};
///
/// let low = Some(MeshSource::File("low.glb".into()));
/// let ray_distance = RayDistance::Cage(MeshSource::File("cage.glb".into()));
/// BakeOptions { low, ray_distance, ..BakeOptions::default() }.check()?;
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RayDistance {
    /// Twice the gap between the meshes, measured around each vertex.
    #[default]
    Auto,
    /// The same distance everywhere, both outward and inward, model units; above 0.
    Uniform(f64),
    /// From a cage, the low-poly mesh with its vertices moved outward, and equally far inward.
    Cage(MeshSource),
}

/// The options of a bake. Built by `Default` and struct update.
///
/// ```
/// use taotie::asset::{BakeOptions, Lod};
/// use taotie_engine::bake::MapKind;
///
/// let maps = vec![MapKind::Normal, MapKind::Occlusion];
/// let lods = vec![Lod::Triangles(5_000), Lod::Pixels(64)];
/// let options = BakeOptions { triangles: 20_000, lods, maps, ..BakeOptions::default() };
/// assert!(options.check().is_ok());
/// assert!(BakeOptions { triangles: 4_000, ..options }.check().is_err(), "fewer than 5,000");
/// ```
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct BakeOptions {
    /// The low-poly mesh; `None` simplifies the scan. A file with several materials, or a glTF file with several
    /// meshes or motion, is kept as is, and each of its materials gets its own maps.
    pub low: Option<MeshSource>,
    /// Triangles of the low-poly mesh, at least 4; ignored with `low`, `goal` or `bytes`.
    pub triangles: u32,
    /// `true` if the low-poly mesh is made from the scan's watertight outer surface ([`taotie_engine::bake::remesh`])
    /// rather than from its triangles; not with `low`. A search then leaves the packed scan out.
    pub remesh: bool,
    /// Finds the smallest asset in bytes that meets these requirements, as far as they concern visible angles and
    /// colours, missed surface and the Hausdorff distance; if they do not mention angles or colours,
    /// [`Requirement::visually_lossless`] applies to these. The asset may have a normal map or none, or be the scan
    /// itself, packed. `triangles`, `size` and the packing are then ignored.
    #[serde(with = "requirement::optional")]
    pub goal: Option<Vec<Requirement>>,
    /// Finds the asset closest to the scan, by the limits of `goal`, within this number of bytes, including metadata.
    /// With `goal`, any asset that meets it is enough.
    pub bytes: Option<u64>,
    /// The image formats available to a search for the smallest asset; if empty, those of `codecs`.
    pub images: Vec<CodecKind>,
    /// The codecs available to a search for the smallest asset.
    pub codecs: CodecSet,
    /// Further levels of detail, each coarser than the one before.
    pub lods: Vec<Lod>,
    /// `true` if no uvs may be generated, since no file would store them: `low` with uvs is then required. For
    /// standalone maps.
    pub keep_uvs: bool,
    /// Texels across the maps, 16 to 16384, or [`BakeOptions::AUTO_SIZE`].
    #[serde(with = "side_as_text")]
    pub size: u32,
    /// Texels down the maps; `None` for a square. Only for `low` with uvs: generated atlases are square.
    pub height: Option<u32>,
    /// The sizes of the maps of several materials.
    pub sizes: SetSizes,
    /// The maps to bake.
    pub maps: Vec<MapKind>,
    /// `true` if maps of all other varying properties of the scan's materials are baked too: base colour, alpha,
    /// normals, metallic-roughness, occlusion, emission. Onto a given low-poly mesh, only those that its own material
    /// leaves at defaults.
    pub carry: bool,
    /// The space of normals and bent normals.
    pub space: NormalSpace,
    /// Samples per texel along each side, 1 to 8: 2 means four per texel.
    pub side: u32,
    /// Bits per channel of normal maps, 8 or 16; 8-bit maps are dithered if they would show banding. 32, for standalone
    /// maps as OpenEXR or TIFF, stores all maps as floats.
    pub bits: u8,
    /// The number of texels by which UV islands are dilated beyond their borders, at most 16384; `None` fills the
    /// map.
    pub dilation: Option<u32>,
    /// Rays over the hemisphere per texel, for occlusion and bent normals, 1 to 4096.
    pub ao_rays: u32,
    /// The distance within which surfaces occlude, model units; `None` for any distance.
    pub ao_distance: Option<f64>,
    /// Roughness of the scan's own surface, [0, 1]; `None` uses that of its material.
    pub roughness: Option<f64>,
    /// The radius of rounded edges for the bevel map, model units; `None` for 1 % of the scan's diagonal.
    pub bevel_radius: Option<f64>,
    /// How points of `low` find those of the scan that they show.
    #[serde(rename = "match")]
    pub matching: MatchRule,
    /// `true` if uvs and materials of `low` are ignored: it is unwrapped, and gets the scan's materials.
    pub new_uvs: bool,
    /// `true` if the uvs of `low` are on UDIM tiles, each of which gets its own maps. For standalone maps, whose path
    /// contains `<UDIM>`.
    pub udim: bool,
    /// The distance within which the scan is searched for.
    pub ray_distance: RayDistance,
    /// `true` if ray distances are multiplied by the red channel of the vertex colours of `low`, linear.
    pub ray_colors: bool,
    /// `true` if rays on flat faces follow the face, away from its edges, where the scan does; normals averaged at the
    /// edges would shift its relief there. Without effect on a cage.
    pub straighten: bool,
    /// The image file of a mask on the uvs of `low` that replaces `straighten`: rays follow the normals of triangles
    /// where its red channel is 1, and averaged normals where it is 0.
    pub skew_mask: Option<PathBuf>,
    /// Whether to keep or remove the scan's noise. If it is removed, everything is made from the scan without it: a
    /// search too compares its candidates with that, but the proof compares with the scan as given. `None` keeps it and
    /// does not measure it.
    pub noise: Option<NoiseHandling>,
    /// `true` if the scan is checked for faults: open edges, duplicate triangles.
    pub inspect: bool,
}

impl Default for BakeOptions {
    /// 50,000 triangles, a normal map of 2048² texels with four samples each, and the maps that the scan's material
    /// needs.
    fn default() -> Self {
        Self {
            low: None,
            triangles: 50_000,
            remesh: false,
            goal: None,
            bytes: None,
            images: Vec::new(),
            codecs: CodecSet::Portable,
            lods: Vec::new(),
            keep_uvs: false,
            size: 2048,
            height: None,
            sizes: SetSizes::Same,
            maps: vec![MapKind::Normal],
            carry: true,
            space: NormalSpace::Tangent,
            side: 2,
            bits: 8,
            dilation: None,
            ao_rays: AO_RAYS,
            ao_distance: None,
            roughness: None,
            bevel_radius: None,
            matching: MatchRule::ByName,
            new_uvs: false,
            udim: false,
            ray_distance: RayDistance::Auto,
            ray_colors: false,
            straighten: true,
            skew_mask: None,
            noise: None,
            inspect: true,
        }
    }
}

/// The maximum dilation of UV islands, texels.
const MOST_DILATION: u32 = 16_384;

/// The default number of rays over the hemisphere.
const AO_RAYS: u32 = 64;

/// Why the maps of a mesh without uvs are square.
pub(in crate::asset) const SQUARE: &str =
    "generated atlases are square; use one number, or a low-poly mesh with uvs";

/// Why standalone maps need uvs.
pub(in crate::asset) const NEEDS_UVS: &str =
    "no file would store generated uvs; use a low-poly mesh with uvs, or write a .glb";

/// Why a mask needs uvs.
pub(in crate::asset) const MASK_NEEDS_UVS: &str =
    "it is on the uvs of the low-poly mesh, and new ones are generated; omit it, or use a mesh with uvs";

impl BakeOptions {
    /// The value of [`BakeOptions::size`] that preserves the scan's detail: the smallest power
    /// of two, 256 to 8192, whose texels are at most as wide as a texel of the scan's textures or half its median edge,
    /// on nearly all of the surface. It is `"auto"` in JSON and TOML.
    ///
    /// ```
    /// use taotie::asset::BakeOptions;
    ///
    /// let options = BakeOptions { size: BakeOptions::AUTO_SIZE, ..BakeOptions::default() };
    /// assert!(options.check().is_ok());
    /// ```
    pub const AUTO_SIZE: u32 = 0;

    /// The part of a path that the number of a tile replaces, if [`BakeOptions::udim`] is set.
    pub const UDIM: &str = "<UDIM>";

    /// Refuses invalid options, before any work begins.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a value out of range, and for values that contradict each other.
    pub fn check(&self) -> Result<()> {
        self.check_numbers()?;
        self.check_levels()?;
        self.check_goal()
    }

    fn check_numbers(&self) -> Result<()> {
        let wrong = |what: String, why: &str| Err(Error::invalid(what, why));
        let is_above_0 = |v: &Option<f64>| v.is_none_or(|v| v > 0.0 && v.is_finite());
        match self {
            Self { triangles: n @ 0..4, .. } => wrong(format!("{n} triangles"), "use at least 4"),
            Self { size: BakeOptions::AUTO_SIZE, height: Some(_), .. } => {
                wrong(self.maps_in_words(), "they are square; omit the height")
            }
            _ if self.size != BakeOptions::AUTO_SIZE
                && !self.map_size().iter().all(|side| (16..=16_384).contains(side)) =>
            {
                wrong(self.maps_in_words(), "use 16 to 16384 texels")
            }
            Self { new_uvs: true, skew_mask: Some(_), .. } => wrong("a mask".into(), MASK_NEEDS_UVS),
            Self { udim: true, skew_mask: Some(_), .. } => {
                wrong("a mask".into(), "it has no UDIM tiles; omit it, or bake one tile after the other")
            }
            Self { ray_colors: true, lods, .. } if !lods.is_empty() => wrong(
                "ray distances from vertex colours".into(),
                "coarser levels of detail have other vertices; omit one",
            ),
            Self { new_uvs: true, keep_uvs: true, .. } => wrong("standalone maps".into(), NEEDS_UVS),
            Self { low: None, .. } if self.names_low() => {
                wrong("options of a low-poly mesh".into(), "there is none; give one, or omit them")
            }
            Self { udim: true, keep_uvs: false, .. } => {
                wrong("UDIM tiles".into(), "no model format stores them; write standalone maps")
            }
            Self { new_uvs: true, .. } if !self.is_square() => wrong(self.maps_in_words(), SQUARE),
            Self { low: Some(_), remesh: true, .. } => {
                wrong("a remesh of the scan".into(), "a given low-poly mesh is kept as is; omit one")
            }
            Self { low: None, keep_uvs: true, .. } => wrong("standalone maps".into(), NEEDS_UVS),
            Self { low: None, .. } if !self.is_square() => wrong(self.maps_in_words(), SQUARE),
            Self { maps, .. } if maps.is_empty() => wrong("no maps".into(), "name at least one to bake"),
            Self { side: n, .. } if !(1..=8).contains(n) => {
                wrong(format!("{n}×{n} samples per texel"), "use 1 to 8 along each side")
            }
            Self { bits, .. } if ![8, 16, 32].contains(bits) => {
                wrong(format!("{bits} bits per channel"), "use 8 or 16, or 32 for standalone maps")
            }
            Self {
                matching: MatchRule::Uv,
                ray_distance: RayDistance::Cage(_) | RayDistance::Uniform(_),
                ..
            } => wrong("matching by uvs".into(), "it follows no rays; omit their distance"),
            Self { matching: MatchRule::Uv, ray_colors: true, .. } => wrong(
                "matching by uvs".into(),
                "it follows no rays; omit their distances from vertex colours",
            ),
            Self { matching: MatchRule::Uv, .. } if self.new_uvs || self.udim => wrong(
                "matching by uvs".into(),
                "it needs those of the low-poly mesh, in one tile; omit new uvs and UDIM tiles",
            ),
            Self { dilation: Some(n), .. } if *n > MOST_DILATION => {
                wrong(format!("a dilation of {n} texels"), "use at most 16384, the side of the largest map")
            }
            Self { ao_rays: n, .. } if !(1..=4096).contains(n) => {
                wrong(format!("{n} occlusion rays"), "use 1 to 4096")
            }
            Self { ao_distance: v, .. } if !is_above_0(v) => {
                wrong("the distance of occlusion".into(), "use a length above 0, in model units")
            }
            Self { bevel_radius: v, .. } if !is_above_0(v) => {
                wrong("the radius of rounded edges".into(), "use a length above 0, in model units")
            }
            Self { roughness: Some(v), .. } if !(0.0..=1.0).contains(v) => {
                wrong(format!("a roughness of {v}"), "use a number in [0, 1]")
            }
            _ => Ok(()),
        }
    }

    /// Returns `true` if an option concerns a given low-poly mesh.
    fn names_low(&self) -> bool {
        let matches_uvs = self.matching == MatchRule::Uv;
        self.new_uvs
            || self.ray_colors
            || self.skew_mask.is_some()
            || matches_uvs
            || self.sizes != SetSizes::Same
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
        let goal = self.goal.as_deref().map(requirement::argument);
        let what = goal.into_iter().chain(bytes).collect::<Vec<_>>().join(",");
        if self.low.is_some() {
            return Err(Error::invalid(
                what,
                "a search cannot be combined with a given low-poly mesh; omit one",
            ));
        }
        let has_budget = |required: &Requirement| required.figure == Figure::Bytes;
        let has_budget = self.bytes.is_some() || self.goal.iter().flatten().any(has_budget);
        if has_budget && !self.lods.is_empty() {
            return Err(Error::invalid(
                what,
                "a search within a byte limit makes one level of detail; omit the limit or the levels",
            ));
        }
        if self.space == NormalSpace::Object || !self.maps.contains(&MapKind::Normal) {
            let why = "a search needs a normal map in tangent space: add normal to the maps, and leave out object space";
            return Err(Error::invalid(what, why));
        }
        Ok(())
    }

    /// Returns the limits that an asset and its levels of detail must meet.
    pub(in crate::asset) fn limits(&self) -> Vec<Requirement> {
        self.goal.clone().unwrap_or_else(Requirement::visually_lossless)
    }

    /// Returns `true` if the options request a search.
    pub fn searches(&self) -> bool {
        self.goal.is_some() || self.bytes.is_some()
    }

    /// Returns `true` if a search can find the smallest asset: no mesh is given, and all maps can be judged:
    /// tangent-space normals and the properties of the scan.
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

    /// Returns the size of the maps, texels across and down.
    pub(in crate::asset) fn map_size(&self) -> [u32; 2] {
        [self.size, self.height.unwrap_or(self.size)]
    }

    /// Returns `true` if the maps are square.
    pub(in crate::asset) fn is_square(&self) -> bool {
        self.height.is_none_or(|height| height == self.size)
    }

    /// Describes the maps by their size, for errors.
    pub(in crate::asset) fn maps_in_words(&self) -> String {
        match self.map_size() {
            [BakeOptions::AUTO_SIZE, _] => "maps of automatic size".into(),
            [width, height] => format!("maps of {width}×{height}"),
        }
    }

    /// Returns `true` if one of these maps is baked.
    pub(in crate::asset) fn bakes(&self, any: &[MapKind]) -> bool {
        any.iter().any(|map| self.maps.contains(map))
    }
}

/// Notes options that affect none of the baked maps.
pub(in crate::asset) fn note_unread_options(options: &BakeOptions, warnings: &mut Warnings) {
    let bakes = |any: &[MapKind]| options.bakes(any);
    let sky = bakes(&[MapKind::Occlusion, MapKind::Bent]);
    let directions = options.maps.iter().any(|map| map.content() == MapContent::Direction);
    let normals = bakes(&[MapKind::Normal, MapKind::Bent]);
    let unread = [
        ("the number of occlusion rays has no effect: none of ao, bent, thickness and bevel is baked", {
            options.ao_rays != AO_RAYS && !sky && !bakes(&[MapKind::Thickness, MapKind::Bevel])
        }),
        ("the radius of rounded edges has no effect: no bevel map is baked", {
            options.bevel_radius.is_some() && !bakes(&[MapKind::Bevel])
        }),
        ("the distance of occlusion has no effect: neither ao nor bent is baked", {
            options.ao_distance.is_some() && !sky
        }),
        ("the roughness has no effect: no roughness is baked", {
            options.roughness.is_some() && !bakes(&[MapKind::Roughness])
        }),
        ("16 bits have no effect: no map of directions is baked", options.bits == 16 && !directions),
        ("object space has no effect: neither normal nor bent is baked", {
            options.space == NormalSpace::Object && !normals
        }),
    ];
    unread.iter().filter(|(_, is)| *is).for_each(|(what, _)| warnings.note(*what, 1));
}

/// Sides as JSON: numbers, or `"auto"`.
mod side_as_text {
    use super::BakeOptions;
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    /// The text for [`BakeOptions::AUTO_SIZE`].
    const AUTO: &str = "auto";

    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Side {
        Texels(u32),
        Word(String),
    }

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes fields by reference")]
    pub fn serialize<S: Serializer>(size: &u32, serializer: S) -> Result<S::Ok, S::Error> {
        if *size == BakeOptions::AUTO_SIZE {
            serializer.serialize_str(AUTO)
        } else {
            serializer.serialize_u32(*size)
        }
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
        match Side::deserialize(deserializer) {
            Ok(Side::Texels(texels)) => Ok(texels),
            Ok(Side::Word(word)) if word == AUTO => Ok(BakeOptions::AUTO_SIZE),
            _ => Err(D::Error::custom("expected a number of texels, or \"auto\"")),
        }
    }
}

/// The packing of an asset into files. Built by `Default` and struct update.
///
/// ```
/// use taotie::asset::{Asset, Packing, WrittenAsset};
/// use taotie_io::ImageCodec;
/// use taotie::{Progress, Result};
///
/// /// Writes a small file, for viewers that support the glTF extensions.
/// fn write_small(asset: &Asset) -> Result<WrittenAsset> {
///     let packing = Packing { images: ImageCodec::WebP.into(), meshopt: true, ..Packing::default() };
///     asset.write("small.glb", &packing, Progress::SILENT)
/// }
/// ```
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Packing {
    /// The formats of textures; KTX2 needs maps whose sides are multiples of 4.
    pub images: TextureCodecs,
    /// Compresses geometry with meshoptimizer, except for that of a low-poly file that is kept as is.
    pub meshopt: bool,
    /// The set of codecs, which determines the extension for compressed geometry.
    pub codecs: CodecSet,
    /// The bits of compressed vertices. See [`GltfFormat::bits`].
    pub bits: VertexBits,
    /// A JSON file of XMP properties, such as `dc:title`, to add to those of the scan. If the scan has no copyright
    /// notice, `dc:rights` becomes the asset's.
    pub provenance: Option<PathBuf>,
    /// The direction of green in maps for other programs. `Down` (DirectX) writes the tangent-space normal map a
    /// second time next to the asset, as `scan.normal.png`, and bent normals likewise; the asset's own has green up,
    /// as glTF requires.
    pub green: GreenChannel,
    /// Textures that pack maps into their channels, as `scan.orm.png` next to the asset.
    pub channels: Vec<Channels>,
}

impl Packing {
    /// Checks what can be known before a bake: that qualities are in range and used, and that the properties of
    /// [`Packing::provenance`] can be read and used.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Parse`] if the file is not valid JSON; and
    /// [`Error::Invalid`] if a property has an unknown prefix or a value of an unsupported
    /// form, and for an invalid quality.
    pub fn check(&self) -> Result<()> {
        self.format().check()?;
        self.provenance.as_deref().map_or(Ok(()), |path| XmpProperties::read(path).map(drop))
    }

    /// Returns the packing with a different format for the model file.
    pub(in crate::asset) fn with_format(self, format: &GltfFormat) -> Self {
        let GltfFormat { images, meshopt, codecs, bits, for_page: _ } = *format;
        Self { images, meshopt, codecs, bits, ..self }
    }

    /// Returns the format of the model file.
    pub(in crate::asset) fn format(&self) -> GltfFormat {
        let Self { images, meshopt, codecs, bits, .. } = *self;
        GltfFormat { images, for_page: false, meshopt, codecs, bits }
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
            (BakeOptions { low: low.clone(), height: Some(20_000), ..base() }, "maps of 2048×20000: use 16"),
            (BakeOptions { height: Some(1024), ..base() }, "generated atlases are square"),
            (BakeOptions { size: BakeOptions::AUTO_SIZE, height: Some(64), ..base() }, "omit the height"),
            (BakeOptions { maps: Vec::new(), ..base() }, "at least one"),
            (BakeOptions { keep_uvs: true, ..base() }, "standalone maps: no file would store generated uvs"),
            (BakeOptions { side: 9, ..base() }, "1 to 8"),
            (BakeOptions { bits: 12, ..base() }, "8 or 16"),
            (BakeOptions { matching: MatchRule::Uv, ..base() }, "there is none"),
            (BakeOptions { sizes: SetSizes::Even, ..base() }, "there is none"),
            (BakeOptions { dilation: Some(1 << 31), ..base() }, "at most 16384"),
            (BakeOptions { ao_rays: 0, ..base() }, "1 to 4096"),
            (BakeOptions { ao_distance: Some(f64::NAN), ..base() }, "above 0"),
            (BakeOptions { roughness: Some(1.5), ..base() }, "[0, 1]"),
            (BakeOptions { lods: vec![Lod::Triangles(50_000)], ..base() }, "the level of detail 50000"),
            (BakeOptions { goal: Some(Vec::new()), low, ..base() }, "omit one"),
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
