//! Maps of a written asset: notes on where each is stored and what its values mean, green turned down for other
//! programs, and numbers as OpenEXR stores them.

use crate::asset::ask::{CHANNELS, ChannelSource, Channels, MapChannel, Packing, Quantity};
use crate::asset::bake::{Part, Range, SeparateMap, Textures, label_color, labeled};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use taotie_engine::bake::{MapContent, MapKind};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::{Bitmap, Encoding, Sampler, TexelFilter, Texels, Texture, Wrap};
use taotie_engine::math::srgb::{linear_from_srgb, srgb_from_linear};
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::names::Named;
use taotie_engine::normal_map::{Storage, green_turned, store_codes, store_rgba};
use taotie_engine::proof::MapError;
use taotie_engine::scene::{GreenChannel, NormalSpace};
use taotie_io::{GltfMaterial, MapFormat};

/// The content of a channel of a texture that packs several maps.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::asset) struct Packed {
    /// The name of the texture, such as `orm`.
    pub texture: String,
    /// 0 for red, 3 for alpha.
    pub number: usize,
    pub map: MapChannel,
}

/// A map of a written asset: where it is stored, and what its values mean.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
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
    pub unit: Cow<'static, str>,
    /// The point that positions are relative to, in the scan's space and unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub origin: Option<[f64; 3]>,
    /// The colours of materials or objects, as `#rrggbb` in sRGB, by their names.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub legend: BTreeMap<String, String>,
    /// The channel of the file that holds it, `R`, `G`, `B` or `A`, if the file packs several maps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<Cow<'static, str>>,
    /// The content of this channel: a map or one of its components, such as `1-roughness` or `normal.g`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub content: Option<Cow<'static, str>>,
    /// The packed channel that it describes; `None` if the file does not pack several maps.
    #[serde(skip)]
    pub(in crate::asset) packed: Option<Packed>,
    /// How far the values are from the scan's, measured by the proof for maps that no figure covers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<MapError>,
}

impl MapNote {
    /// Returns its name for people: that of its map; of a packed channel, such as `orm R (ao)`.
    pub fn title(&self) -> String {
        match &self.packed {
            Some(Packed { texture, number, map }) => format!("{texture} {} ({map})", CHANNELS[*number]),
            None => self.map.name().to_owned(),
        }
    }

    /// Returns `true` if no figure of a proof covers it. Figures see the maps that a renderer shows under direct light: neither
    /// occlusion nor packed channels.
    pub(in crate::asset) fn is_in_no_figure(&self) -> bool {
        self.packed.is_some() || self.map.is_separate() || self.is_occlusion()
    }

    /// Returns `true` for occlusion, inside the asset or in a file of its own.
    pub(in crate::asset) fn is_occlusion(&self) -> bool {
        matches!(self.map, MapKind::Occlusion | MapKind::OcclusionMap)
    }

    /// Describes a map inside the asset. `label` is that of its material, here and below; it may be empty.
    pub(super) fn inside(label: &str, map: MapKind, bitmap: &Bitmap) -> Self {
        let (material, bits) = (named(label), bitmap.bits());
        let (file, black, white, unit) = (None, None, None, Cow::Borrowed(""));
        Self {
            map,
            material,
            file,
            bits,
            black,
            white,
            unit,
            origin: None,
            legend: BTreeMap::new(),
            channel: None,
            content: None,
            packed: None,
            error: None,
        }
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
            unit: own.range.map_or("", |range| range.unit).into(),
            origin: own.origin,
            legend: own.legend.clone(),
            channel: None,
            content: None,
            packed: None,
            error: None,
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
        .map(|(map, bitmap)| SeparateMap::plain(map, green_turned(bitmap)))
        .collect();
    match turned.is_empty() {
        false => Ok(turned),
        true => Err(Error::invalid(
            "green down",
            "needs a normal, bent or bevel map in tangent space; bake one, or omit it",
        )),
    }
}

fn tangent_maps(textures: &Textures) -> impl Iterator<Item = (MapKind, &Bitmap)> {
    let others = textures.separate.iter().filter(|file| matches!(file.map, MapKind::Bent | MapKind::Bevel));
    let normal = textures.normal.as_ref().map(|bitmap| (MapKind::Normal, bitmap));
    normal.into_iter().chain(others.map(|file| (file.map, &file.bitmap)))
}

/// A texture of one material that packs channels of its maps.
pub(super) struct PackedChannels<'a> {
    pub part: &'a Part,
    pub channels: &'a Channels,
    /// Maps with green down, if the packing asks for them.
    pub turned: &'a [SeparateMap],
}

/// The storage of a channel.
enum Stored<'a> {
    /// A channel of a stored texture, and the values of its black and white.
    Texture(&'a Bitmap, usize, Option<Range>),
    /// The same code everywhere, and the values of black and white.
    Uniform(f32, Option<Range>),
}

impl Stored<'_> {
    fn bitmap(&self) -> Option<&Bitmap> {
        match self {
            Self::Texture(bitmap, ..) => Some(bitmap),
            Self::Uniform(..) => None,
        }
    }

    fn range(&self) -> Option<Range> {
        match self {
            Self::Texture(_, _, range) | Self::Uniform(_, range) => *range,
        }
    }
}

/// The content of a channel.
struct Source<'a> {
    stored: Stored<'a>,
    /// `None` for a constant.
    map: Option<MapChannel>,
}

impl Source<'_> {
    /// Returns the code of a texel, [0, 1].
    fn code(&self, texel: usize) -> f32 {
        let code = match self.stored {
            Stored::Texture(bitmap, channel, _) => bitmap.stored(texel)[channel],
            Stored::Uniform(code, _) => code,
        };
        if self.map.is_some_and(|map| map.is_inverted) { 1.0 - code } else { code }
    }
}

fn bits(sources: &[Source<'_>]) -> u8 {
    sources.iter().filter_map(|source| source.stored.bitmap()).map(Bitmap::bits).max().unwrap_or(8)
}

impl PackedChannels<'_> {
    /// Returns its name with that of its material, if there are several.
    pub fn name(&self) -> String {
        labeled(self.part.low.file_label(), self.channels.name())
    }

    /// Returns the texture, with as many bits as the deepest of its maps.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a map that was not baked.
    pub fn bitmap(&self) -> Result<Bitmap> {
        let all = self.sources()?;
        let sizes = all.iter().filter_map(|source| source.stored.bitmap());
        let size = sizes.map(|bitmap| [bitmap.width(), bitmap.height()]).next().unwrap_or([1, 1]);
        let storage = Storage { bits: bits(&all), dither: false };
        match all.as_slice() {
            [r, g, b, a] => store_rgba(size, |i| [r, g, b, a].map(|source| source.code(i)), storage),
            all => store_codes(size, |i| std::array::from_fn(|k| all[k].code(i)), 3, storage),
        }
    }

    /// Returns the map in each channel of the file `path`.
    ///
    /// # Errors
    /// As [`PackedChannels::bitmap`].
    pub fn notes(&self, path: &Path) -> Result<Vec<MapNote>> {
        let all = self.sources()?;
        let bits = bits(&all);
        let note = |(number, source): (usize, &Source<'_>)| {
            let map = source.map?;
            let range = source.stored.range();
            let whole = Range { black: 0.0, white: 1.0, unit: "" };
            let range = range.or(map.is_inverted.then_some(whole));
            let ends = range.map(|Range { black, white, .. }| match map.is_inverted {
                true => [white, black],
                false => [black, white],
            });
            Some(MapNote {
                map: map.quantity.map(),
                material: named(self.part.low.label()),
                file: Some(path.to_path_buf()),
                bits,
                black: ends.map(|[black, _]| black),
                white: ends.map(|[_, white]| white),
                unit: range.map_or("", |range| range.unit).into(),
                origin: self.own(map.quantity.map()).and_then(|own| own.origin),
                legend: BTreeMap::new(),
                channel: Some(CHANNELS[number].into()),
                content: Some(map.to_string().into()),
                packed: Some(Packed { texture: self.channels.name().to_owned(), number, map }),
                error: None,
            })
        };
        Ok(all.iter().enumerate().filter_map(note).collect())
    }

    fn sources(&self) -> Result<Vec<Source<'_>>> {
        let of = |source: &ChannelSource| match source {
            ChannelSource::Constant(code) => Ok(Source { stored: Stored::Uniform(*code, None), map: None }),
            ChannelSource::Map(map) => Ok(Source { stored: self.stored(map.quantity)?, map: Some(*map) }),
        };
        self.channels.sources().iter().map(of).collect()
    }

    /// Returns the separate map of a kind, with green as requested.
    fn own(&self, map: MapKind) -> Option<&SeparateMap> {
        self.turned.iter().chain(&self.part.maps.textures.separate).find(|own| own.map == map)
    }

    fn refused(&self, why: String) -> Error {
        Error::invalid(format!("the channels `{}`", self.channels.name()), why)
    }

    /// Returns the storage of a quantity: a texture, or factors of the material.
    fn stored(&self, quantity: Quantity) -> Result<Stored<'_>> {
        let Part { low, maps } = self.part;
        let (textures, map) = (&maps.textures, quantity.map());
        if low.origin.is_scan {
            return Err(self
                .refused("the asset is the scan, packed; give triangles, a size or a low-poly mesh".into()));
        }
        if let Some(own) = self.own(map) {
            let channel = if let Quantity::Component(_, channel) = quantity { channel } else { 0 };
            return Ok(Stored::Texture(&own.bitmap, channel, own.range));
        }
        let material = textures.material(&low.material, &low.kept);
        // Of a baked map, all factors are the radiance of white.
        let brightest = material.emissive.iter().fold(1.0, |most: f32, v| most.max(*v));
        let (baked, factor, kept) = match quantity {
            Quantity::Metallic => {
                (textures.roughness_texture(), (2, material.metallic), &low.kept.metallic_roughness)
            }
            Quantity::Map(MapKind::Roughness) => {
                (textures.roughness_texture(), (1, material.roughness), &low.kept.metallic_roughness)
            }
            Quantity::Map(MapKind::Occlusion | MapKind::OcclusionMap) => {
                (textures.occlusion_texture(), (0, 1.0), &low.kept.occlusion)
            }
            Quantity::Map(MapKind::Alpha) => {
                let texture = textures.color.as_ref().filter(|color| color.channels() == 4);
                (texture, (3, material.base_color[3]), &low.kept.color)
            }
            Quantity::Component(MapKind::Albedo, k) => {
                let code = srgb_from_linear(f64::from(material.base_color[k])) as f32;
                (textures.color.as_ref(), (k, code), &low.kept.color)
            }
            Quantity::Component(MapKind::Emission, k) => {
                let code = srgb_from_linear(f64::from(material.emissive[k] / brightest)) as f32;
                (textures.emission.as_ref(), (k, code), &low.kept.emission)
            }
            Quantity::Component(MapKind::Normal, k) => {
                (textures.normal.as_ref(), (k, [0.5, 0.5, 1.0][k]), &None)
            }
            Quantity::Component(..) | Quantity::Map(_) => {
                return Err(self.refused(format!("{} is not baked; add it to the maps", map.name())));
            }
        };
        let (channel, code) = factor;
        let radiance = Range { black: 0.0, white: f64::from(brightest), unit: "radiance" };
        let range = (map == MapKind::Emission).then_some(radiance);
        match (baked, kept) {
            (Some(bitmap), _) => Ok(Stored::Texture(bitmap, channel, range)),
            (None, None) => Ok(Stored::Uniform(code, range)),
            (None, Some(_)) => {
                let why = format!(
                    "{} is not baked: the low-poly mesh keeps its own; add it to the maps",
                    map.name()
                );
                Err(self.refused(why))
            }
        }
    }
}

/// Returns the encoding of a texture that holds these maps: alpha is in that of the base colour.
pub(super) fn encoding_of(maps: &[MapKind]) -> Encoding {
    let is_seen = |map: &MapKind| matches!(map.content(), MapContent::Color | MapContent::Label);
    let is_color = maps.iter().any(|map| is_seen(map) || *map == MapKind::Alpha);
    if is_color { Encoding::Srgb } else { Encoding::Linear }
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

/// The values of a map that was read from its file.
pub(in crate::asset) struct StoredValues {
    texture: Texture,
    /// The meaning of what the texture returns, which is linear.
    meaning: Meaning,
    /// The point that positions are relative to.
    origin: Vec3,
    green: GreenChannel,
    /// The numbers of labels by their colours, if it stores labels.
    labels: BTreeMap<[u8; 3], u32>,
    /// The channel that holds it, if the file packs several maps.
    packed: Option<(usize, MapChannel)>,
    /// The radiance of white, if the channel holds emission; 1 otherwise.
    brightest: f32,
}

impl StoredValues {
    /// Takes the map that a note describes; labels are numbers below `things`.
    pub fn of(note: &MapNote, bitmap: Bitmap, (green, things): (GreenChannel, u32)) -> Self {
        let packed = note.packed.as_ref().map(|packed| (packed.number, packed.map));
        // Packed channels are codes even as floats.
        let is_value = matches!(bitmap.texels(), Texels::F32(_)) && packed.is_none();
        let content = note.map.content();
        let (black, white) = (note.black.unwrap_or(0.0), note.white.unwrap_or(1.0));
        let is_inverted = packed.is_some_and(|(_, map)| map.is_inverted);
        let (black, white) = if is_inverted { (white, black) } else { (black, white) };
        let meaning = match content {
            // Of numbers, the note states what codes mean in this file.
            MapContent::Length => Meaning::Number(Range { black, white, unit: "" }),
            MapContent::Direction if !is_value => Meaning::Direction,
            MapContent::Color if packed.is_some() => Meaning::Color,
            _ => Meaning::Plain,
        };
        let is_coded = content == MapContent::Color && !is_value && packed.is_none();
        let texture = Texture::new(bitmap, if is_coded { Encoding::Srgb } else { Encoding::Linear });
        let labels = match content {
            MapContent::Label => (0..things).map(|number| (label_color(number), number)).collect(),
            _ => BTreeMap::new(),
        };
        let [x, y, z] = note.origin.unwrap_or_default().map(|v| v as f32);
        let brightest = if note.map == MapKind::Emission { white as f32 } else { 1.0 };
        Self { texture, meaning, origin: Vec3::new(x, y, z), green, labels, packed, brightest }
    }

    /// Returns the value at a uv, as a renderer filters it, without those across the map's border; for labels the number of the nearest texel's in all components,
    /// −1 for the colour of none; of a packed channel, its value in all components.
    pub fn at(&self, uv: Vec2) -> Vec3 {
        // Assets whose uvs are within the map clamp them.
        let is_within = [uv.x, uv.y].iter().all(|v| (0.0..=1.0).contains(v));
        let wrap = if is_within { Wrap::Clamp } else { Wrap::Repeat };
        let bilinear = Sampler { wrap_u: wrap, wrap_v: wrap, ..Sampler::BILINEAR };
        if !self.labels.is_empty() {
            let nearest = Sampler { magnify: TexelFilter::Nearest, ..bilinear };
            let [r, g, b, _] = nearest.sample(&self.texture, uv, 0.0);
            let color = [r, g, b].map(|code| (code * 255.0).round() as u8);
            return Vec3::splat(self.labels.get(&color).map_or(-1.0, |number| *number as f32));
        }
        let texel = bilinear.sample(&self.texture, uv, 0.0);
        if let Some((number, map)) = self.packed {
            return Vec3::splat(self.packed_value(texel[number], map));
        }
        let [r, g, b, _] = texel;
        let [x, y, z] = [r, g, b].map(|code| self.meaning.number(code));
        let y = if self.green == GreenChannel::Down { -y } else { y };
        Vec3::new(x, y, z) + self.origin
    }

    /// Returns the number that a code of a packed channel stores.
    fn packed_value(&self, code: f32, map: MapChannel) -> f32 {
        let value = self.meaning.number(if map.is_inverted { 1.0 - code } else { code });
        let Some(component) = map.quantity.component() else { return value };
        let value = if component == 1 && self.green == GreenChannel::Down { -value } else { value };
        value * self.brightest + self.origin.to_array()[component]
    }
}

/// Returns the bytes of an OpenEXR or TIFF file with the numbers of a map as floats.
///
/// # Errors
/// [`Error::Unsupported`] for OpenEXR without the feature `exr`.
pub(super) fn encode_numbers(bitmap: &Bitmap, meaning: Meaning, format: MapFormat) -> Result<Vec<u8>> {
    // Programs expect colours in OpenEXR, and few, not even our own reader, take TIFFs of a single float.
    let channels = if matches!(bitmap.channels(), 2 | 4) { 4 } else { 3 };
    let texels = (bitmap.width() * bitmap.height()) as usize;
    let mut samples = Vec::with_capacity(texels * channels);
    for texel in (0..texels).map(|i| bitmap.stored(i)) {
        samples.extend(texel[..3].iter().map(|code| meaning.number(*code)));
        samples.extend(&texel[3..channels]);
    }
    let size = [bitmap.width(), bitmap.height()];
    match format {
        MapFormat::Tiff => taotie_io::encode_tiff_floats(size.into(), channels as u8, &samples),
        _ => exr(size, &["R", "G", "B", "A"][..channels], &samples),
    }
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
