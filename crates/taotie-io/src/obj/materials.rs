//! Converts MTL materials to the scene's, with the images that they refer to.

use super::super::bitmap::{combined, decode_within, read_map, texture};
use super::super::reading::{Reading, Reason, find};
use super::super::text::quote;
use super::mtl::{Channel, Map, Mtl};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use taotie_engine::error::Warnings;
use taotie_engine::image::{Bitmap, Encoding, Sampler, Texels, Texture, Wrap};
use taotie_engine::scene::{
    AlphaMode, Classic, GreenChannel, HeightMap, Light, Material, NormalMap, NormalSpace, TextureRef,
    UvTransform,
};
use taotie_engine::surface::{NormalMapKind, is_normal_map};

/// Returns the material for files and names without a library entry: the neutral default, double-sided, since formats
/// without a rule for back faces are full of shells and of inconsistently wound faces.
pub(crate) fn neutral(name: &str) -> Material {
    Material { name: name.to_owned(), double_sided: true, ..Material::default() }
}

/// Converts an MTL material to the scene's.
///
/// Kd is the base colour, taken as linear. Roughness is Pr, or follows from Ns by α² = 2/(Ns + 2); a map of roughness
/// or metalness replaces its number, as in Blender. Opacity is d, or 1 − Tr. Ka, Kd, Ks and Ns are kept for the
/// classic models. A zero colour with a texture is read as one: exporters write it to mean "see texture". So is any Kd of
/// Blender, which writes the value that its texture replaces; its roughness follows from Ns as on its import.
pub(crate) fn material(mtl: &Mtl, textures: &mut Textures, warnings: &mut Warnings) -> Material {
    let mut m = Material {
        metallic: mtl.metallic.unwrap_or(0.0).clamp(0.0, 1.0),
        classic: Classic {
            ambient: mtl.ambient.map(bounded),
            diffuse: mtl.diffuse.map(bounded),
            specular: mtl.specular.map(bounded),
            shininess: mtl.shininess.map(|s| s.clamp(0.0, Light::MOST)),
            slope: None,
        },
        ..neutral(&mtl.name)
    };
    m.roughness = match (mtl.roughness, mtl.shininess) {
        (Some(roughness), _) => roughness.clamp(0.0, 1.0),
        (None, Some(shininess)) => match mtl.blender_shininess {
            Some(most) => 1.0 - (shininess / most).clamp(0.0, 1.0).sqrt(),
            None => roughness_from_shininess(shininess),
        },
        (None, None) => m.roughness,
    };
    set_base_color(&mut m, mtl, textures, warnings);
    set_emission(&mut m, mtl, textures, warnings);
    set_metallic_roughness(&mut m, mtl, textures, warnings);
    set_relief(&mut m, mtl, textures, warnings);
    m
}

/// Returns a colour with its channels limited to valid light values.
fn bounded(color: [f32; 3]) -> [f32; 3] {
    color.map(|v| v.min(Light::MOST))
}

/// Returns the roughness for a shininess s by α² = 2 / (s + 2), and α = roughness².
fn roughness_from_shininess(shininess: f32) -> f32 {
    (2.0 / (shininess.max(0.0) + 2.0)).sqrt().sqrt()
}

fn texture_ref(texture: usize, map: &Map) -> TextureRef {
    let wrap = if map.clamp { Wrap::Clamp } else { Wrap::Repeat };
    let ([su, sv], [ou, ov]) = (map.scale, map.offset);
    TextureRef {
        texture,
        uv_set: map.uv_set,
        sampler: Sampler { wrap_u: wrap, wrap_v: wrap, ..Sampler::default() },
        // Written for a bottom-left origin: v' = 1 − (sv·(1 − v) + ov) from the top.
        transform: UvTransform { linear: [[su, 0.0], [0.0, sv]], offset: [ou, 1.0 - sv - ov] },
    }
}

/// Returns the name of a texture made from up to two files.
fn names(maps: [Option<&Map>; 2]) -> String {
    maps.into_iter().flatten().map(|map| map.file.as_str()).collect::<Vec<_>>().join(" + ")
}

/// Returns the factor for a colour that has a texture: zero is read as one.
fn factor(color: Option<[f32; 3]>, keyword: &str, warnings: &mut Warnings) -> [f32; 3] {
    match color {
        Some([0.0, 0.0, 0.0]) => {
            warnings.note(format!("{keyword} 0 0 0 with map_{keyword} is read as 1 1 1"), 1);
            [1.0; 3]
        }
        other => other.unwrap_or([1.0; 3]),
    }
}

fn set_base_color(m: &mut Material, mtl: &Mtl, textures: &mut Textures, warnings: &mut Warnings) {
    let opacity = match (mtl.dissolve, mtl.transparency) {
        (None, Some(1.0)) => {
            warnings.note(
                "Tr 1 without d, which would be invisible, is read as opaque: some programs write it so",
                1,
            );
            1.0
        }
        (dissolve, transparency) => dissolve.unwrap_or(1.0 - transparency.unwrap_or(0.0)).clamp(0.0, 1.0),
    };
    warnings.note("materials with opacity 0 are invisible", usize::from(opacity == 0.0));
    if opacity < 1.0 {
        m.alpha = AlphaMode::Blend;
    }
    let mut color = mtl.diffuse.unwrap_or([m.base_color[0], m.base_color[1], m.base_color[2]]);
    if let Some(map) = &mtl.diffuse_map
        && let Some(texture) = textures.plain(map, &mtl.folder, color_encoding(map), warnings)
    {
        m.base_color_texture = Some(texture_ref(texture, map));
        color = if mtl.blender_shininess.is_some() { [1.0; 3] } else { factor(mtl.diffuse, "Kd", warnings) };
        m.classic.diffuse = mtl.diffuse.map(|_| color);
    }
    let [r, g, b] = color;
    m.base_color = [r, g, b, opacity].map(|v| v.min(Light::MOST));
    set_opacity_map(m, mtl, textures, warnings);
}

fn color_encoding(map: &Map) -> Encoding {
    if map.linear { Encoding::Linear } else { Encoding::Srgb }
}

/// Puts the opacity map, if any, into the alpha channel of the base colour texture.
fn set_opacity_map(m: &mut Material, mtl: &Mtl, textures: &mut Textures, warnings: &mut Warnings) {
    let Some(map) = &mtl.dissolve_map else { return };
    let key = format!("opacity {map:?} of {:?} in {}", mtl.diffuse_map, mtl.folder.display());
    let colored = mtl.diffuse_map.as_ref().filter(|_| m.base_color_texture.is_some());
    note_placements([("map_Kd", colored), ("map_d", Some(map))], warnings);
    let index = textures.keyed(key, &names([colored, Some(map)]), |textures| {
        let opacity = textures.bitmap(map, &mtl.folder, warnings)?;
        let channel = map.channel.unwrap_or(Channel::Stored(if opacity.has_alpha() { 3 } else { 0 }));
        let color = colored.and_then(|map| textures.bitmap(map, &mtl.folder, warnings));
        // Float images are already linear in the file.
        let is_float = color.as_ref().is_some_and(|b| b.bits() == 32);
        let encoding =
            if is_float { Encoding::Linear } else { colored.map_or(Encoding::Linear, color_encoding) };
        let c = |i| color.as_ref().map(|b| ChannelReader::new(b, Channel::Stored(i)));
        let both = combine([c(0), c(1), c(2), Some(ChannelReader::new(&opacity, channel))]);
        textures.combined(both, encoding)
    });
    let Some(texture) = index else { return };
    let cutout = m.alpha == AlphaMode::Opaque && is_cutout(textures.list[texture].bitmap());
    m.alpha = if cutout { AlphaMode::Mask(0.5) } else { AlphaMode::Blend };
    m.base_color_texture = Some(texture_ref(texture, colored.unwrap_or(map)));
}

/// Notes if the second of two maps that are combined in one texture is placed differently than the first.
fn note_placements([(first, a), (second, b)]: [(&str, Option<&Map>); 2], warnings: &mut Warnings) {
    let Some((a, b)) = a.zip(b) else { return };
    let differ = (a.scale, a.offset, a.clamp, a.uv_set) != (b.scale, b.offset, b.clamp, b.uv_set);
    let what = format!("{second} and {first} have different options; using those of {first}");
    warnings.note(what, usize::from(differ));
}

/// Returns `true` if at least 95% of texels are fully opaque or fully transparent.
fn is_cutout(bitmap: &Bitmap) -> bool {
    let count = bitmap.texels().len();
    let hard = (0..count).filter(|i| !(0.02..0.98).contains(&bitmap.stored(*i)[3])).count();
    hard as u64 * 100 >= count as u64 * 95
}

fn set_emission(m: &mut Material, mtl: &Mtl, textures: &mut Textures, warnings: &mut Warnings) {
    m.emissive = bounded(mtl.emissive.unwrap_or([0.0; 3]));
    let Some(map) = &mtl.emissive_map else { return };
    if let Some(texture) = textures.plain(map, &mtl.folder, color_encoding(map), warnings) {
        m.emissive = bounded(factor(mtl.emissive, "Ke", warnings));
        m.emissive_texture = Some(texture_ref(texture, map));
    }
}

/// Sets one texture of roughness (green) and metalness (blue) from the two in the file.
///
/// An image used for both without a channel, and that is not grey, is already packed in that order.
fn set_metallic_roughness(m: &mut Material, mtl: &Mtl, textures: &mut Textures, warnings: &mut Warnings) {
    let (rough, metal) = (mtl.roughness_map.as_ref(), mtl.metallic_map.as_ref());
    let Some(placed) = rough.or(metal) else { return };
    note_placements([("map_Pr", rough), ("map_Pm", metal)], warnings);
    let read = |map: Option<&Map>, textures: &mut Textures, warnings: &mut Warnings| {
        map.and_then(|map| textures.bitmap(map, &mtl.folder, warnings))
    };
    let key = format!("roughness {rough:?} metalness {metal:?} in {}", mtl.folder.display());
    let index = textures.keyed(key, &names([rough, metal]), |textures| {
        let green = read(rough, textures, warnings);
        let blue = read(metal, textures, warnings);
        let same = rough.zip(metal).is_some_and(|(a, b)| a.file == b.file);
        let packed = same && green.as_ref().is_some_and(is_colorful);
        let channel = |map: Option<&Map>, packed_as: usize| {
            let default = Channel::Stored(if packed { packed_as } else { 0 });
            map.and_then(|m| m.channel).unwrap_or(default)
        };
        let green = green.as_ref().map(|b| ChannelReader::new(b, channel(rough, 1)));
        let blue = blue.as_ref().map(|b| ChannelReader::new(b, channel(metal, 2)));
        textures.combined(combine([None, green, blue, None]), Encoding::Linear)
    });
    let Some(texture) = index else { return };
    m.metallic_roughness_texture = Some(texture_ref(texture, placed));
    if rough.is_some_and(|map| textures.has(map, &mtl.folder)) {
        m.roughness = 1.0;
    }
    if metal.is_some_and(|map| textures.has(map, &mtl.folder)) {
        m.metallic = 1.0;
    }
}

/// Returns `true` if any of the sampled texels is not grey.
fn is_colorful(bitmap: &Bitmap) -> bool {
    let count = bitmap.texels().len();
    (0..count).step_by((count >> 16) | 1).any(|i| {
        let [r, g, b, _] = bitmap.stored(i);
        r.max(g).max(b) - r.min(g).min(b) > 8.0 / 255.0
    })
}

/// Sets the normal map and the height map. The pixels determine the content of `map_Bump`, and the space of the
/// normals.
fn set_relief(m: &mut Material, mtl: &Mtl, textures: &mut Textures, warnings: &mut Warnings) {
    if let Some(map) = &mtl.bump_map
        && let Some(texture) = textures.relief(map, &mtl.folder, warnings)
    {
        match is_normal_map(textures.list[texture].bitmap()) {
            NormalMapKind::No => m.height = height_map(texture, mtl, textures, warnings),
            kind => m.normal = Some(normal_map(texture, map, kind)),
        }
    }
    if let Some(map) = &mtl.normal_map
        && let Some(texture) = textures.plain(map, &mtl.folder, Encoding::Normal, warnings)
    {
        m.normal = Some(normal_map(texture, map, is_normal_map(textures.list[texture].bitmap())));
    }
}

/// Returns the normal map; -bm scales the tilt of the normals.
fn normal_map(texture: usize, map: &Map, kind: NormalMapKind) -> NormalMap {
    let space = if kind == NormalMapKind::Object { NormalSpace::Object } else { NormalSpace::Tangent };
    NormalMap { texture: texture_ref(texture, map), scale: map.bump, space, green: GreenChannel::Up }
}

/// Returns the height map; -bm is the height of white, in model units. Heights in a channel other than red are moved
/// to red.
fn height_map(
    texture: usize,
    mtl: &Mtl,
    textures: &mut Textures,
    warnings: &mut Warnings,
) -> Option<HeightMap> {
    let map = mtl.bump_map.as_ref()?;
    let bitmap = textures.list[texture].bitmap();
    let colorful = is_colorful(bitmap);
    warnings.note("colour image used as a height map; reading its red channel", usize::from(colorful));
    let texture = match map.channel {
        None | Some(Channel::Stored(0)) => texture,
        Some(channel) => {
            let key = format!("height {map:?} in {}", mtl.folder.display());
            textures.keyed(key, &map.file, |textures| {
                let heights = ChannelReader::new(textures.list[texture].bitmap(), channel);
                textures.combined(combine([Some(heights), None, None, None]), Encoding::Linear)
            })?
        }
    };
    Some(HeightMap { texture: texture_ref(texture, map), scale: map.bump })
}

/// Maximum number of missing files that are named individually.
const NAMED: usize = 64;

/// The textures of a scene under construction. Each image that materials refer to is read once.
pub(crate) struct Textures<'a> {
    /// The reading of the model.
    reading: &'a Reading,
    /// The images in the model's file, by the name under which maps refer to them.
    pub embedded: HashMap<String, &'a [u8]>,
    /// The textures, which materials refer to by index.
    pub list: Vec<Texture>,
    /// The source files of each texture.
    pub names: Vec<String>,
    /// The files that were opened, including those that could not be decoded.
    pub files: Vec<PathBuf>,
    /// The files that do not exist.
    pub missing_files: Vec<String>,
    known: HashMap<String, Option<usize>>,
    missing: HashSet<String>,
}

impl<'a> Textures<'a> {
    pub(crate) fn new(reading: &'a Reading) -> Self {
        Self {
            reading,
            embedded: HashMap::new(),
            list: Vec::new(),
            names: Vec::new(),
            files: Vec::new(),
            missing_files: Vec::new(),
            known: HashMap::new(),
            missing: HashSet::new(),
        }
    }

    /// Returns the texture under `key`, made from the files `name`; `make` makes it on the first call. `None` if that
    /// failed.
    fn keyed(
        &mut self,
        key: String,
        name: &str,
        make: impl FnOnce(&mut Self) -> Option<Texture>,
    ) -> Option<usize> {
        if let Some(known) = self.known.get(&key) {
            return *known;
        }
        let index = make(self).map(|texture| {
            self.list.push(texture);
            self.names.push(name.to_owned());
            self.list.len() - 1
        });
        self.known.insert(key, index);
        index
    }

    /// Returns the image of `map` as a separate texture.
    fn plain(
        &mut self,
        map: &Map,
        folder: &Path,
        encoding: Encoding,
        warnings: &mut Warnings,
    ) -> Option<usize> {
        let key = format!("{encoding:?} {}", full_name(map, folder));
        self.keyed(key, &map.file, |s| texture(s.reading, s.bitmap(map, folder, warnings)?, encoding))
    }

    /// Returns the image of `map` as a normal map if its pixels are one, else as heights.
    fn relief(&mut self, map: &Map, folder: &Path, warnings: &mut Warnings) -> Option<usize> {
        let key = format!("relief {}", full_name(map, folder));
        self.keyed(key, &map.file, |s| {
            let bitmap = s.bitmap(map, folder, warnings)?;
            let is_heights = is_normal_map(&bitmap) == NormalMapKind::No;
            texture(s.reading, bitmap, if is_heights { Encoding::Linear } else { Encoding::Normal })
        })
    }

    /// Makes a texture from channels of several images; `None` if there are none, or it does not fit in memory.
    fn combined(&self, bitmap: Option<Bitmap>, encoding: Encoding) -> Option<Texture> {
        combined(self.reading, bitmap?, encoding)
    }

    /// Returns the image of `map`; `None` with a note if it cannot be read.
    fn bitmap(&mut self, map: &Map, folder: &Path, warnings: &mut Warnings) -> Option<Bitmap> {
        let name = full_name(map, folder);
        if self.missing.contains(&name) {
            return None;
        }
        let read = match self.embedded.get(&map.file) {
            Some(bytes) => self.decoded(bytes, &map.file),
            None => self.file(map, folder),
        };
        let why = match read {
            Ok(bitmap) => return Some(bitmap),
            Err(why) => why,
        };
        self.missing.insert(name);
        let what = if self.missing.len() > NAMED {
            "skipped further unreadable textures".to_owned()
        } else {
            format!("skipped texture {}: {why}", quote(&map.file))
        };
        warnings.note(what, 1);
        None
    }

    /// Reads the file of `map`.
    fn file(&mut self, map: &Map, folder: &Path) -> Reason<Bitmap> {
        match find(&map.file, &[folder, self.reading.folder()], self.reading) {
            Ok(Some(path)) => {
                self.files.push(path.clone());
                read_map(&path, self.reading).map_err(|error| error.to_string())
            }
            absent => {
                self.missing_files.push(map.file.clone());
                Err(absent.err().unwrap_or_else(|| "file not found".to_owned()))
            }
        }
    }

    /// Decodes an image in the model's file.
    fn decoded(&self, bytes: &[u8], name: &str) -> Reason<Bitmap> {
        let last = name.rsplit(['/', '\\']).next().unwrap_or(name);
        decode_within(bytes, last, self.reading.path(), self.reading).map_err(|error| error.to_string())
    }

    /// Returns `true` if the image of `map` could be read, after it was requested.
    fn has(&self, map: &Map, folder: &Path) -> bool {
        !self.missing.contains(&full_name(map, folder))
    }
}

fn full_name(map: &Map, folder: &Path) -> String {
    format!("{} in {}", map.file, folder.display())
}

/// The channel that a map reads from an image, in [0, 1], at a position in [0, 1), using the nearest texel.
struct ChannelReader<'a> {
    bitmap: &'a Bitmap,
    channel: Channel,
}

impl<'a> ChannelReader<'a> {
    fn new(bitmap: &'a Bitmap, channel: Channel) -> Self {
        Self { bitmap, channel }
    }

    fn at(&self, x: u32, y: u32, size: (u32, u32)) -> f32 {
        let scaled = |i: u32, n: u32, to: u32| (u64::from(i) * u64::from(to) / u64::from(n)) as usize;
        let column = scaled(x, size.0, self.bitmap.width());
        let row = scaled(y, size.1, self.bitmap.height());
        let texel = self.bitmap.stored(row * self.bitmap.width() as usize + column);
        let value = match self.channel {
            Channel::Stored(c) => texel[c],
            Channel::Mean => (texel[0] + texel[1] + texel[2]) / 3.0,
        };
        if value > 0.0 { value.min(1.0) } else { 0.0 }
    }
}

/// Makes a linear image from channels of other images; `None` is 1 everywhere. It has the size of the largest of
/// them, and 16 bits if any has more than 8.
fn combine(channels: [Option<ChannelReader>; 4]) -> Option<Bitmap> {
    let sources = || channels.iter().flatten().map(|r| r.bitmap);
    let size = (sources().map(Bitmap::width).max()?, sources().map(Bitmap::height).max()?);
    let deep = sources().any(|b| b.bits() > 8);
    let texel = |i: u64| {
        let (x, y) = ((i % u64::from(size.0)) as u32, (i / u64::from(size.0)) as u32);
        std::array::from_fn(|c| channels[c].as_ref().map_or(1.0, |reader| reader.at(x, y, size)))
    };
    let count = u64::from(size.0) * u64::from(size.1);
    let texels = if deep {
        Texels::U16((0..count).map(|i| texel(i).map(|v: f32| (v * 65535.0 + 0.5) as u16)).collect())
    } else {
        Texels::U8((0..count).map(|i| texel(i).map(|v: f32| (v * 255.0 + 0.5) as u8)).collect())
    };
    Bitmap::new(size.0, size.1, 4, texels).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn combines_pictures_of_different_size() {
        let small = Bitmap::new(1, 1, 1, Texels::U8(vec![[51; 4]])).unwrap();
        let wide = Bitmap::new(2, 1, 3, Texels::U8(vec![[0, 7, 30, 255], [0, 9, 60, 255]])).unwrap();
        let green = ChannelReader::new(&small, Channel::Stored(0));
        let blue = ChannelReader::new(&wide, Channel::Mean);
        let both = combine([None, Some(green), Some(blue), None]).unwrap();
        assert_eq!(both.texels(), &Texels::U8(vec![[255, 51, 12, 255], [255, 51, 23, 255]]));
        assert!(combine([None, None, None, None]).is_none());
    }
}
