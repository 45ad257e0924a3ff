//! Converts MTL materials to the scene's.

use super::mtl::{Channel, Map, Mtl};
use super::textures::{ChannelReader, Textures, combine};
use crate::error::Warnings;
use crate::image::{Bitmap, Encoding, Sampler, Wrap};
use crate::scene::{
    AlphaMode, Classic, GreenChannel, HeightMap, Light, Material, NormalMap, NormalSpace, TextureRef,
    UvTransform,
};
use crate::surface::{NormalMapKind, is_normal_map};

/// Returns the material for files and names without a library entry: the neutral default, double-sided, since formats
/// without a rule for back faces are full of shells and of inconsistently wound faces.
pub(in crate::io) fn neutral(name: &str) -> Material {
    Material { name: name.to_owned(), double_sided: true, ..Material::default() }
}

/// Converts an MTL material to the scene's.
///
/// Kd is the base colour, taken as linear. Roughness is Pr, or follows from Ns by α² = 2/(Ns + 2); a map of roughness
/// or metalness replaces its number, as in Blender. Opacity is d, or 1 − Tr. Ka, Kd, Ks and Ns are kept for the
/// classic models. A zero colour with a texture is read as one: exporters write it to mean "see texture".
pub(super) fn material(mtl: &Mtl, textures: &mut Textures, warnings: &mut Warnings) -> Material {
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
        (None, Some(shininess)) => roughness_from_shininess(shininess),
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
        uv_set: 0,
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
    let opacity = mtl.dissolve.unwrap_or(1.0 - mtl.transparency.unwrap_or(0.0)).clamp(0.0, 1.0);
    warnings.note("materials with opacity 0 are invisible", usize::from(opacity == 0.0));
    if opacity < 1.0 {
        m.alpha = AlphaMode::Blend;
    }
    let mut color = mtl.diffuse.unwrap_or([m.base_color[0], m.base_color[1], m.base_color[2]]);
    if let Some(map) = &mtl.diffuse_map
        && let Some(texture) = textures.plain(map, &mtl.folder, color_encoding(map), warnings)
    {
        m.base_color_texture = Some(texture_ref(texture, map));
        color = factor(mtl.diffuse, "Kd", warnings);
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
    if let (Some(a), Some(b)) = (rough, metal) {
        let differ = (a.scale, a.offset, a.clamp) != (b.scale, b.offset, b.clamp);
        warnings.note("map_Pm and map_Pr have different options; using those of map_Pr", usize::from(differ));
    }
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
