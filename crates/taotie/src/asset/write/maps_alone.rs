//! Standalone maps, without a model: textures for a low-poly mesh that stays in its own file, one set for each of its
//! materials.

use super::map_files::{
    MapNote, Meaning, PackedChannels, codes_of_normals, encode_numbers, encoding_of, name_of, named,
    note_unlit, turned_green,
};
use crate::asset::ask::{BakeOptions, Channels, Packing};
use crate::asset::bake::{Made, Part, Range, SeparateMap, labeled};
use crate::asset::source::{KeptTextures, Property};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use taotie_engine::bake::{MapContent, MapKind};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::{Bitmap, Encoding, Sampler, Texture};
use taotie_engine::math::Mat4;
use taotie_engine::names::Named;
use taotie_engine::normal_map::green_turned;
use taotie_engine::scene::{
    GreenChannel, Instance, Material, NormalMap, NormalSpace, Scene, SceneData, TextureRef, UvTransform,
};
use taotie_io::{FileBytes, FileSet, Limits, Loaded, MapFormat, TextureCodecs};

/// Returns true if a path requests standalone maps.
pub(super) fn is_alone(path: &Path) -> bool {
    MapFormat::of(path).is_some()
}

/// A texture as a separate file, and the maps that it holds.
struct MapFile<'a> {
    /// The name of its material in file names; empty if there is only one.
    label: &'a str,
    /// `true` if normals are in tangent space.
    is_tangent: bool,
    maps: Vec<MapKind>,
    bitmap: &'a Bitmap,
    range: Option<Range>,
    origin: Option<[f64; 3]>,
    legend: Option<&'a BTreeMap<String, String>>,
    path: PathBuf,
}

/// Returns the path of a part's first map, for its UDIM tile.
fn placed(part: &Part, path: &Path) -> PathBuf {
    match part.low.tile() {
        Some(tile) => path.with_file_name(name_of(path).replace(BakeOptions::UDIM, &tile.number.to_string())),
        None => path.into(),
    }
}

/// Returns the textures of a material. The first is in `path` itself, the others in files next to it: `out.png`,
/// `out.ao.png`. If there are several materials, the names contain their labels: `out.wood.png`, `out.wood.ao.png`.
/// Those of UDIM tiles state the tile: `out.1001.png`, `out.1001.ao.png`.
fn files<'a>(part: &'a Part, path: &Path) -> Vec<MapFile<'a>> {
    let (label, name, textures) = (part.low.label(), part.low.file_label(), &part.maps.textures);
    let path = &placed(part, path);
    let mut files: Vec<MapFile<'a>> = Vec::new();
    for (map, bitmap) in textures.inside() {
        match files.iter_mut().find(|file| std::ptr::eq(file.bitmap, bitmap)) {
            Some(file) => file.maps.push(map),
            None => files.push(MapFile::new(map, bitmap)),
        }
    }
    let other = |other: &'a SeparateMap| {
        let SeparateMap { range, origin, legend, .. } = other;
        MapFile {
            range: *range,
            origin: *origin,
            legend: Some(legend),
            ..MapFile::new(other.map, &other.bitmap)
        }
    };
    files.extend(textures.separate.iter().map(other));
    files.sort_by_key(|file| {
        textures.stored.iter().position(|map| file.maps.contains(map)).unwrap_or(usize::MAX)
    });
    for (i, file) in files.iter_mut().enumerate() {
        file.label = label;
        // Object space is a map without a slot.
        file.is_tangent = textures.normal.is_some();
        file.path = match (i, name) {
            (0, "") => path.into(),
            (0, name) => sibling(path, name),
            _ => sibling(path, &labeled(name, file.name())),
        };
        if file.holds(&[MapKind::Emission]) {
            let white = f64::from(textures.strength);
            file.range = Some(Range { black: 0.0, white, unit: "radiance" });
        }
    }
    files
}

/// The name of a texture that holds both occlusion and roughness.
const ORM: &str = "orm";

/// Returns the path of a map next to the first.
fn sibling(path: &Path, name: &str) -> PathBuf {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    path.with_extension(format!("{name}.{extension}"))
}

/// Returns every file that standalone maps of one material may be written to, `path` itself first.
pub(super) fn possible_files(path: &Path, packing: &Packing) -> Vec<PathBuf> {
    let packed = packing.channels.iter().map(Channels::name);
    let names = MapKind::NAMES.iter().map(|(name, _)| *name).chain([ORM]).chain(packed);
    std::iter::once(path.to_path_buf()).chain(names.map(|name| sibling(path, name))).collect()
}

impl<'a> MapFile<'a> {
    fn new(map: MapKind, bitmap: &'a Bitmap) -> Self {
        let (maps, path) = (vec![map], PathBuf::new());
        Self { label: "", is_tangent: false, maps, bitmap, range: None, origin: None, legend: None, path }
    }

    fn holds(&self, any: &[MapKind]) -> bool {
        any.iter().any(|map| self.maps.contains(map))
    }

    /// Returns the name of its only map, or of several in one texture.
    fn name(&self) -> &'static str {
        let occlusion = self.holds(&[MapKind::Occlusion, MapKind::OcclusionMap]);
        let roughness = self.holds(&[MapKind::Roughness, MapKind::MetallicRoughness]);
        if occlusion && roughness { ORM } else { self.maps[0].name() }
    }

    fn encoding(&self) -> Encoding {
        encoding_of(&self.maps)
    }

    /// Returns its bytes, in the format of its extension, with the texels of `bitmap`.
    fn encoded(&self, bitmap: &Bitmap) -> Result<Vec<u8>> {
        match MapFormat::of(&self.path) {
            Some(format) if self.stores_numbers() => encode_numbers(bitmap, self.meaning(), format),
            Some(MapFormat::Dds) if self.maps.iter().any(|map| map.content() == MapContent::Label) => {
                let what = format!("{} as DDS", self.name());
                Err(Error::unsupported(what, "blocks and mip levels mix colours; write a .png"))
            }
            Some(MapFormat::Dds) if self.is_tangent && self.holds(&[MapKind::Normal]) => {
                taotie_io::encode_map(bitmap, Encoding::Normal, MapFormat::Dds)
            }
            format => taotie_io::encode_map(bitmap, self.encoding(), format.unwrap_or(MapFormat::Png)),
        }
    }

    /// Returns `true` if the file stores numbers as floats rather than codes.
    fn stores_numbers(&self) -> bool {
        match MapFormat::of(&self.path) {
            Some(MapFormat::Exr) => true,
            Some(MapFormat::Tiff) => self.bitmap.bits() == 32,
            _ => false,
        }
    }

    fn meaning(&self) -> Meaning {
        match (self.encoding(), self.range) {
            _ if self.maps.iter().any(|map| map.content() == MapContent::Direction) => Meaning::Direction,
            _ if self.maps.iter().any(|map| map.content() == MapContent::Label) => Meaning::Plain,
            (Encoding::Srgb, _) => Meaning::Color,
            (_, Some(range)) => Meaning::Number(range),
            (_, None) => Meaning::Plain,
        }
    }

    /// Returns the values of black and white in the file: floats are the numbers themselves, except for emission.
    fn file_range(&self) -> Option<Range> {
        let is_number = matches!(self.meaning(), Meaning::Number(_)) && self.stores_numbers();
        self.range.map(|range| if is_number { Range { black: 0.0, white: 1.0, ..range } } else { range })
    }

    fn notes(&self) -> impl Iterator<Item = MapNote> {
        let range = self.file_range();
        self.maps.iter().map(move |map| MapNote {
            map: *map,
            material: named(self.label),
            file: Some(self.path.clone()),
            bits: self.bitmap.bits(),
            black: range.map(|range| range.black),
            white: range.map(|range| range.white),
            unit: range.map_or("", |range| range.unit).into(),
            origin: self.origin,
            legend: self.legend.cloned().unwrap_or_default(),
            channel: None,
            content: None,
            packed: None,
            error: None,
        })
    }
}

/// Returns the kind, material and file of each map of a part.
pub(super) fn notes(part: &Part, path: &Path, packing: &Packing) -> Vec<MapNote> {
    let mut notes: Vec<MapNote> = files(part, path).iter().flat_map(MapFile::notes).collect();
    for channels in &packing.channels {
        let packed = PackedChannels { part, channels, turned: &[] };
        // They were written, so no map is missing.
        notes.extend(packed.notes(&sibling(&placed(part, path), &packed.name())).unwrap_or_default());
    }
    notes
}

/// Returns all files.
///
/// # Errors
/// [`Error::Invalid`] for what standalone maps cannot have: generated uvs, levels of detail, and the packing of a
/// model; [`Error::Unsupported`] for 16-bit maps as WebP.
pub(super) fn encoded(made: &Made, path: &Path, packing: &Packing) -> Result<Vec<FileBytes>> {
    check(made, path, packing)?;
    let mut encoded = Vec::new();
    for part in &made.parts {
        let turned = turned_green(made.options.space, &part.maps.textures, packing)?;
        for file in files(part, path) {
            let turned = turned.iter().find(|turned| file.holds(&[turned.map]));
            let bitmap = turned.map_or(file.bitmap, |turned| &turned.bitmap);
            encoded.push(FileBytes { bytes: file.encoded(bitmap)?, path: file.path });
        }
        for channels in &packing.channels {
            let packed = PackedChannels { part, channels, turned: &turned };
            let (bitmap, path) = (packed.bitmap()?, sibling(&placed(part, path), &packed.name()));
            // Its codes have different meanings.
            let file = MapFile { path, ..MapFile::new(MapKind::Roughness, &bitmap) };
            let bytes = file.encoded(&bitmap)?;
            match encoded.iter().find(|known| known.path == file.path) {
                // Occlusion, roughness and metalness share a texture anyway.
                Some(known) if known.bytes == bytes => {}
                Some(_) => {
                    let what = format!("the channels `{}`", channels.name());
                    let why =
                        format!("{} already holds other maps; choose another name", name_of(&file.path));
                    return Err(Error::invalid(what, why));
                }
                None => encoded.push(FileBytes { bytes, path: file.path.clone() }),
            }
        }
    }
    Ok(encoded)
}

fn check(made: &Made, path: &Path, packing: &Packing) -> Result<()> {
    let is_unwrapped = made.parts.iter().any(|part| part.low.origin.islands.is_some());
    let names_tiles = name_of(path).contains(BakeOptions::UDIM);
    let has_floats = made.options.bits == 32;
    let is_float = matches!(MapFormat::of(path), Some(MapFormat::Exr | MapFormat::Tiff));
    let wrong = [
        (made.options.udim && !names_tiles, "UDIM tiles need <UDIM> in the file name, as in rock.<UDIM>.png"),
        (!made.options.udim && names_tiles, "<UDIM> in the file name needs a bake of UDIM tiles"),
        (has_floats && !is_float, "only .exr and .tiff store 32 bits; use 16"),
        (is_unwrapped, "no file would store the generated uvs; use a low-poly mesh with uvs"),
        (!made.coarser.is_empty(), "levels of detail need a model; omit them"),
        (
            packing.images != TextureCodecs::default(),
            "the file name determines the format; omit other formats",
        ),
        (packing.meshopt, "there is no geometry to compress"),
        (packing.provenance.is_some(), "they cannot store XMP metadata"),
    ];
    match wrong.iter().find(|(is, _)| *is) {
        Some((_, why)) => Err(Error::invalid("standalone maps", format!("{why}, or write a .glb"))),
        None => Ok(()),
    }
}

/// Returns the properties of the scan's material that are stored in a map.
pub(in crate::asset) fn carried(made: &Made) -> impl Iterator<Item = Property> {
    made.carried.iter().copied().filter(|property| is_in_map(made, *property))
}

fn is_in_map(made: &Made, property: Property) -> bool {
    property.map().is_some_and(|map| made.options.bakes(&[map]))
}

/// Notes what a model would have but standalone maps lack.
pub(super) fn warnings(made: &Made) -> Warnings {
    let mut warnings = Warnings::default();
    let factors = made.carried.iter().filter(|property| !is_in_map(made, **property));
    let factors: Vec<&str> = factors.map(|property| property.name()).collect();
    let what = format!("standalone maps cannot store the scan's material factors: {}", factors.join(", "));
    warnings.note(what, usize::from(!factors.is_empty()));
    let is_told = made.about.copyright.is_some() || made.about.xmp.is_some();
    warnings.note("standalone maps cannot store the scan's rights and history", usize::from(is_told));
    warnings.absorb(note_unlit(made.parts.iter().filter(|part| hides_maps_of(part))));
    warnings
}

/// Returns true if any map belongs to the material rather than the shape.
pub(in crate::asset) fn has_material(made: &Made) -> bool {
    use MapKind::{Albedo, Alpha, Emission, MetallicRoughness, Roughness};
    made.options.bakes(&[Albedo, Alpha, Emission, MetallicRoughness, Roughness])
}

/// Returns the properties that the proof of standalone maps does not compare.
pub(in crate::asset) fn unseen(made: &Made) -> Option<String> {
    let what = match has_material(made) {
        true => "material factors, which the application must set: those of the low-poly mesh are shown",
        false => "colour and material, for which no map is baked",
    };
    (!made.about.is_plain).then(|| what.to_owned())
}

/// Reads the maps back onto the low-poly mesh, whose materials keep their numbers. Normals are converted back to green up.
/// `path` is that of [`encoded`].
///
/// # Errors
/// Those of reading the files.
pub(in crate::asset) fn read_back(
    made: &Made,
    green: GreenChannel,
    (path, set): (&Path, &FileSet),
) -> Result<Loaded> {
    let mut data = SceneData::default();
    for part in &made.parts {
        let number = part.low.own.as_ref().map_or(0, |own| own.number);
        let mut material = stated(part);
        if part.low.tile().is_some() {
            part.low.label().clone_into(&mut material.name);
        }
        for file in files(part, path) {
            let bitmap = taotie_io::read_bitmap_within(&set.current(&file.path), &Limits::of_own_files())?;
            show(&file, data.textures.len(), (&mut material, made.options.space));
            data.textures.push(texture(&file, bitmap, green)?);
        }
        let world_from_object = Mat4::IDENTITY;
        data.instances.push(Instance { mesh: data.meshes.len(), material: number, world_from_object });
        data.meshes.push(part.low.mesh.clone());
        data.materials.resize(data.materials.len().max(number + 1), Material::default());
        data.materials[number] = material;
    }
    Ok(Loaded::new(Scene::new(data)?, Warnings::default(), "PNG"))
}

/// Returns the material of a part without textures, with the factors that its maps require.
fn stated(Part { low, maps }: &Part) -> Material {
    let none = KeptTextures::default();
    let stated = maps.textures.material(&low.material, &none);
    let mut material = Material {
        base_color: stated.base_color,
        metallic: stated.metallic,
        roughness: stated.roughness,
        occlusion_strength: stated.occlusion_strength,
        emissive: stated.emissive,
        ..low.material.clone()
    };
    material.retain_textures(|_| false);
    material
}

/// Returns a file's texture, with normals as codes with green up. Float colours are linear in the file too.
fn texture(file: &MapFile<'_>, bitmap: Bitmap, green: GreenChannel) -> Result<Texture> {
    if !file.holds(&[MapKind::Normal]) {
        return Ok(Texture::new(bitmap, file.encoding()));
    }
    let codes = codes_of_normals(bitmap)?;
    let up = if green == GreenChannel::Down { green_turned(&codes) } else { codes };
    Ok(Texture::new(up, Encoding::Normal))
}

/// Assigns a texture to the material slots that its maps belong to.
fn show(file: &MapFile<'_>, texture: usize, (material, space): (&mut Material, NormalSpace)) {
    use MapKind::{Albedo, Alpha, Emission, MetallicRoughness, Normal, Occlusion, OcclusionMap, Roughness};
    let uses =
        TextureRef { texture, uv_set: 0, sampler: Sampler::default(), transform: UvTransform::default() };
    // The proof reads an object-space map from its file.
    if file.holds(&[Normal]) && space == NormalSpace::Tangent {
        let green = GreenChannel::Up;
        material.normal = Some(NormalMap { texture: uses, scale: 1.0, space, green });
    }
    let slots = [
        (file.holds(&[Albedo, Alpha]), &mut material.base_color_texture),
        (file.holds(&[Roughness, MetallicRoughness]), &mut material.metallic_roughness_texture),
        (file.holds(&[Occlusion, OcclusionMap]), &mut material.occlusion_texture),
        (file.holds(&[Emission]), &mut material.emissive_texture),
    ];
    slots.into_iter().filter(|(is, _)| *is).for_each(|(_, slot)| *slot = Some(uses));
}

/// Returns true if the low-poly mesh's material hides standalone maps.
fn hides_maps_of(part: &Part) -> bool {
    let is_seen = |map| matches!(map, MapKind::Albedo | MapKind::Alpha);
    part.low.material.unlit && part.maps.textures.inside().any(|(map, _)| !is_seen(map))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_pictures_stand_alone() {
        let paths = ["normal.png", "a/b.WebP", "c.exr", "d.tif", "e.TGA", "scan.glb", "scan.gltf", "png"];
        assert_eq!(
            paths.map(|path| is_alone(path.as_ref())),
            [true, true, true, true, true, false, false, false]
        );
    }

    #[test]
    fn several_numbers_of_one_texture_share_a_name() {
        let bitmap = Bitmap::new(1, 1, 3, taotie_engine::image::Texels::U8(vec![[255; 4]])).unwrap();
        let name = |maps: &[MapKind]| {
            MapFile { maps: maps.to_vec(), ..MapFile::new(MapKind::Normal, &bitmap) }.name()
        };
        assert_eq!(name(&[MapKind::Occlusion]), "ao");
        assert_eq!(name(&[MapKind::Occlusion, MapKind::MetallicRoughness]), "orm");
        assert_eq!(name(&[MapKind::Albedo, MapKind::Alpha]), "albedo");
    }
}
