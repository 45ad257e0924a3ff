//! Grafts baked textures onto the materials of a glTF file. Everything else is preserved: nodes, skins, morph
//! targets, animations, cameras, names, extras, and accessors to the last bit. Primitives without tangents get them
//! if they show a normal map, provided that no vertex has to be split.

mod changes;

use super::codec::CodecKind;
use super::draft::{Container, encoded_glb, uri};
use super::edit;
use super::format::GltfFormat;
use super::material::GltfMaterial;
use super::textures::{Encoded, encode, sampler_json};
use crate::gltf::{GltfSource, OF_TEXTURES, RawGltf, is_known};
use crate::json::Json;
use crate::limits::Limits;
use crate::write::FileBytes;
use crate::xmp;
use changes::GLOSSINESS;
use serde_json::{Value, json};
use std::path::Path;
use taotie_engine::error::{Result, Warnings};
use taotie_engine::image::Sampler;
use taotie_engine::scene::Material;

/// A glTF file, and the materials grafted onto it.
#[derive(Debug, Clone, Copy)]
pub struct GltfGraft<'a> {
    /// The file.
    pub source: GltfSource<'a>,
    /// The limits within which it is read.
    pub limits: Limits,
    /// The size of the file's unit in metres, by which a new root node scales everything; `None` if it is in metres.
    pub root_scale: Option<f32>,
    /// The materials to change.
    pub materials: &'a [GraftedMaterial<'a>],
    /// A rights notice in addition to the file's own.
    pub copyright: Option<&'a str>,
    /// An XMP packet for the whole asset, replacing the file's own.
    pub xmp: Option<&'a Json>,
    /// Further members of `asset.extras`.
    pub extras: Option<&'a Json>,
}

impl<'a> GltfGraft<'a> {
    /// Returns a file without any grafted material.
    pub fn unchanged(source: GltfSource<'a>, limits: Limits) -> Self {
        Self { source, limits, root_scale: None, materials: &[], copyright: None, xmp: None, extras: None }
    }
}

/// A material of a file, and its baked replacement.
#[derive(Debug, Clone, Copy)]
pub struct GraftedMaterial<'a> {
    /// Its index in the file; one past the last is glTF's default, for triangles without a material.
    pub number: usize,
    /// A word in the names of its images that distinguishes it from other materials; may be empty if it is the only
    /// one.
    pub label: &'a str,
    /// Its factors and layers, and the new textures. Slots without a texture keep the file's, as do the name, and
    /// whether it is double-sided.
    pub material: GltfMaterial<'a>,
    /// The material as read from the file. Layers that are the same in `material` stay unchanged in the file.
    pub said: &'a Material,
    /// The sampler of the new textures, such as [`gltf_sampler`](crate::gltf_sampler) makes.
    pub sampler: Sampler,
    /// `true` if vertex colours are removed, which would be multiplied with the baked colours.
    pub drops_colors: bool,
}

/// The files of a model, and notes on what was not preserved.
#[derive(Debug, Clone, Default)]
pub struct EncodedModel {
    /// The files, the model first.
    pub files: Vec<FileBytes>,
    /// Warnings about dropped content.
    pub warnings: Warnings,
}

impl From<Vec<FileBytes>> for EncodedModel {
    fn from(files: Vec<FileBytes>) -> Self {
        Self { files, warnings: Warnings::default() }
    }
}

/// Returns the files of a model with grafted materials, `path` first: a GLB, or a `.gltf` with its external files.
/// Images that are no longer used are dropped. Geometry keeps its packing, regardless of [`GltfFormat::meshopt`]. A
/// material loses KHR_materials_pbrSpecularGlossiness if the extension would hide the grafted values; this is counted
/// in the warnings.
///
/// # Errors
/// [`taotie_engine::Error::Io`] and [`taotie_engine::Error::Parse`] if the source cannot be read,
/// [`taotie_engine::Error::Limit`] if it exceeds a limit; otherwise as [`encode_gltf`](crate::encode_gltf).
pub fn encode_graft(path: &Path, graft: &GltfGraft, format: &GltfFormat) -> Result<EncodedModel> {
    let storage = match Container::of(path)? {
        Container::Glb => Storage::Inside,
        Container::Gltf => Storage::Separate(path),
    };
    let mut raw = RawGltf::read(graft.source, &graft.limits)?;
    let own_images = edit::items(&raw.json, "images").len();
    let (mut external, mut warnings) = (Vec::new(), Warnings::default());
    let glossy = changes::count_glossy(&raw.json);
    for material in graft.materials {
        external.extend(graft_material(&mut raw, material, format, storage)?);
    }
    let what = format!("dropped {GLOSSINESS} of the low-poly mesh's materials");
    let uncovered = glossy - changes::count_glossy(&raw.json);
    warnings.note(format!("{what}: viewers would show it instead of the bake"), uncovered);
    let mapped = graft.materials.iter().filter(|grafted| grafted.material.normal_map.is_some());
    let mapped: Vec<usize> = mapped.map(|grafted| grafted.number).collect();
    changes::give_tangents(&mut raw, graft.source, &mapped)?;
    if let Some(scale) = graft.root_scale {
        changes::scale_to_metres(&mut raw, scale, &mut warnings)?;
    }
    say_about(&mut raw.json, graft);
    let own_images = prune(&mut raw.json, own_images);
    external.extend(take_along(&mut raw, own_images, storage)?);
    let bytes = edit::joined_buffers(&mut raw)?;
    let mut files = match storage {
        Storage::Inside => {
            vec![FileBytes { path: path.to_path_buf(), bytes: encoded_glb(edit::text(&raw.json)?, &bytes)? }]
        }
        Storage::Separate(_) => gltf(path, raw.json, bytes)?,
    };
    files.extend(external);
    Ok(EncodedModel { files, warnings })
}

/// Grafts a material and returns the files of its new images next to the model.
fn graft_material(
    raw: &mut RawGltf,
    grafted: &GraftedMaterial,
    format: &GltfFormat,
    storage: Storage,
) -> Result<Vec<FileBytes>> {
    let GraftedMaterial { number, label, ref material, .. } = *grafted;
    material.check()?;
    changes::give_default_material(&mut raw.json, number);
    if number >= edit::items(&raw.json, "materials").len() {
        return Err(raw.error(format!("material {number}"), "no longer exists; bake again"));
    }
    let encoded = encode(material, format)?;
    let sampler = if encoded.is_empty() { 0 } else { add_sampler(&mut raw.json, &grafted.sampler) };
    let mut textures = Vec::new();
    for image in &encoded {
        let texture = add_image(raw, image, &Textured { storage, label, sampler });
        textures.extend(image.uses(texture, material));
        if let Some(name) = image.extension() {
            edit::require(&mut raw.json, name);
        }
    }
    let json = &mut raw.json["materials"][number];
    changes::graft(json, material, grafted.said, textures);
    changes::extensions(json).iter().for_each(|name| edit::name(&mut raw.json, "extensionsUsed", name));
    if grafted.drops_colors {
        changes::drop_colors(&mut raw.json, number);
    }
    let Storage::Separate(path) = storage else { return Ok(Vec::new()) };
    let labeled = path.with_file_name(format!("{}.gltf", stem(path, label)));
    Ok(encoded.into_iter().filter_map(|image| image.into_file(&labeled)).collect())
}

/// The storage of images: within the document or in external files.
#[derive(Clone, Copy)]
pub(super) enum Storage<'a> {
    /// In the document's buffer.
    Inside,
    /// In files next to this model.
    Separate(&'a Path),
}

/// The common properties of the new textures of a material.
struct Textured<'a> {
    storage: Storage<'a>,
    /// A word that distinguishes its images from those of other materials.
    label: &'a str,
    /// The index of the sampler.
    sampler: usize,
}

/// Adds an image and a texture for it. Returns the texture's index.
fn add_image(raw: &mut RawGltf, image: &Encoded, of: &Textured) -> usize {
    let Textured { storage, label, sampler } = *of;
    let json = match (image.bytes(), storage) {
        (Some(bytes), Storage::Inside) => {
            let view = edit::add_view(raw, bytes.to_vec());
            let name = labeled(label, image.role());
            json!({ "name": name, "bufferView": view, "mimeType": image.mime_type() })
        }
        (Some(_), Storage::Separate(path)) => json!({ "uri": uri(&image.file_name(&stem(path, label))) }),
        (None, _) => json!({ "uri": uri(&image.file_name("")) }),
    };
    let source = edit::push(&mut raw.json, "images", json);
    let mut texture = image.texture(source);
    *edit::member(&mut texture, "sampler") = sampler.into();
    edit::push(&mut raw.json, "textures", texture)
}

/// Returns the stem of the names of files next to a model: its own, and the label of a material.
fn stem(path: &Path, label: &str) -> String {
    labeled(&path.file_stem().unwrap_or_default().to_string_lossy(), label)
}

fn labeled(first: &str, second: &str) -> String {
    let parts = [first, second].into_iter().filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join("_")
}

/// Returns the index of a sampler in the document, adding it if necessary.
fn add_sampler(json: &mut Value, sampler: &Sampler) -> usize {
    let sampler = sampler_json(sampler);
    let known = edit::items(json, "samplers").iter().position(|known| *known == sampler);
    known.unwrap_or_else(|| edit::push(json, "samplers", sampler))
}

/// Carries over those of the first `count` images that are external files of the source: into the document, or as
/// files next to the new one, which it returns. Images that are missing or of unknown kind stay as references.
///
/// # Errors
/// [`taotie_engine::Error::Io`] if a file cannot be read.
pub(super) fn take_along(raw: &mut RawGltf, count: usize, storage: Storage) -> Result<Vec<FileBytes>> {
    let mut files = Vec::new();
    for i in 0..count {
        let name = edit::items(&raw.json, "images").get(i).and_then(|image| image.get("uri")?.as_str());
        let Some(bytes) = name.map(|name| raw.file(name)).transpose()?.flatten() else { continue };
        let Some(kind) = CodecKind::detect(&bytes) else { continue };
        let said = match storage {
            Storage::Inside => {
                let view = edit::add_view(raw, bytes);
                vec![("bufferView", json!(view)), ("mimeType", json!(kind.media_type()))]
            }
            Storage::Separate(path) => {
                let name = format!("{}.{}", stem(path, &format!("image{i}")), kind.file_extension());
                let said = json!(uri(&name));
                files.push(FileBytes { path: path.with_file_name(name), bytes });
                vec![("uri", said)]
            }
        };
        for image in edit::items_mut(&mut raw.json, "images").skip(i).take(1) {
            edit::remove(image, "uri");
            said.iter().for_each(|(name, value)| *edit::member(image, name) = value.clone());
        }
    }
    Ok(files)
}

/// Drops textures, images and views that are no longer used, and returns how many of the first `count` images are
/// left. If the document uses an unknown extension, which may refer to anything, everything is kept.
fn prune(json: &mut Value, count: usize) -> usize {
    edit::drop_unused(json, &["materials"], GLOSSINESS);
    let knows = |name: &Value| name.as_str().is_some_and(is_known);
    if !edit::items(json, "extensionsUsed").iter().all(knows) {
        return count;
    }
    edit::drop_unnamed(json, "textures", edit::each_texture);
    let kept = edit::drop_unnamed(json, "images", edit::each_image);
    edit::drop_unnamed(json, "bufferViews", edit::each_view);
    for name in OF_TEXTURES {
        edit::drop_unused(json, &["textures"], name);
    }
    kept.into_iter().filter(|image| *image < count as u64).count()
}

/// Writes the asset's metadata: generator, copyright, extras and provenance.
fn say_about(json: &mut Value, graft: &GltfGraft) {
    let asset = edit::member(json, "asset");
    *edit::member(asset, "generator") = concat!("taotie ", env!("CARGO_PKG_VERSION")).into();
    if let Some(copyright) = graft.copyright {
        let own = asset.get("copyright").and_then(Value::as_str).filter(|own| *own != copyright);
        let both = own.map_or_else(|| copyright.to_owned(), |own| format!("{own}; {copyright}"));
        *edit::member(asset, "copyright") = both.into();
    }
    let extras = graft.extras.and_then(|extras| extras.0.as_object());
    for (name, value) in extras.into_iter().flatten() {
        *edit::member(edit::member(asset, "extras"), name) = value.clone();
    }
    if let Some(packet) = graft.xmp {
        let extension = edit::member(edit::member(json, "extensions"), xmp::EXTENSION);
        let number = edit::push(extension, "packets", packet.0.clone());
        let asset = edit::member(json, "asset");
        let named = json!({ "packet": number });
        *edit::member(edit::member(asset, "extensions"), xmp::EXTENSION) = named;
        edit::name(json, "extensionsUsed", xmp::EXTENSION);
    }
}

/// Returns the document and its external buffer.
pub(super) fn gltf(path: &Path, mut json: Value, bytes: Vec<u8>) -> Result<Vec<FileBytes>> {
    let name = format!("{}.bin", stem(path, ""));
    for buffer in edit::items_mut(&mut json, "buffers").take(1) {
        *edit::member(buffer, "uri") = uri(&name).into();
    }
    let document = FileBytes { path: path.to_path_buf(), bytes: edit::text(&json)? };
    let numbers = FileBytes { path: path.with_file_name(name), bytes };
    Ok(std::iter::once(document).chain((!numbers.bytes.is_empty()).then_some(numbers)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_of_textures_go_with_the_last_of_them() {
        let file = |extensions: Value| {
            json!({
                "extensionsUsed": ["EXT_texture_webp"], "extensionsRequired": ["EXT_texture_webp"],
                "materials": [{ "normalTexture": { "index": 0 } }],
                "textures": [{ "source": 0, "extensions": extensions }], "images": [{}],
            })
        };
        let mut png = file(json!({}));
        prune(&mut png, 1);
        assert!(png.get("extensionsUsed").is_none() && png.get("extensionsRequired").is_none());
        let mut webp = file(json!({ "EXT_texture_webp": { "source": 0 } }));
        prune(&mut webp, 1);
        assert_eq!(webp["extensionsRequired"], json!(["EXT_texture_webp"]));
    }

    #[test]
    fn what_only_colours_and_gloss_named_goes_with_them() {
        let file = |material: Value| {
            json!({
                "extensionsUsed": [GLOSSINESS], "materials": [material],
                "textures": [{ "source": 0 }], "images": [{}],
            })
        };
        let mut glossy = file(json!({ "extensions": { GLOSSINESS: { "diffuseTexture": { "index": 0 } } } }));
        assert_eq!((prune(&mut glossy, 1), &glossy["extensionsUsed"]), (1, &json!([GLOSSINESS])));
        let mut plain = file(json!({}));
        assert_eq!(prune(&mut plain, 1), 0);
        assert!(plain.get("extensionsUsed").is_none() && plain.get("textures").is_none(), "{plain}");
    }

    #[test]
    fn what_nothing_names_goes() {
        let mut json = json!({
            "extensionsUsed": ["KHR_materials_clearcoat"],
            "materials": [
                { "normalTexture": { "index": 2 } },
                { "extensions": { "KHR_materials_clearcoat": { "clearcoatTexture": { "index": 3 } } } },
            ],
            "textures": [{ "source": 0 }, { "source": 1 }, { "source": 1 }, { "source": 2 }],
            "images": [{ "bufferView": 0 }, { "bufferView": 2 }, { "uri": "a.png" }],
            "accessors": [{ "bufferView": 3, "sparse": { "values": { "bufferView": 4 } } }],
            "bufferViews": ["dead", "dead", "image", "numbers", "sparse"],
        });
        assert_eq!(prune(&mut json, 2), 1, "of the first two, one is left");
        assert_eq!(json["textures"], json!([{ "source": 0 }, { "source": 1 }]));
        assert_eq!(json["images"], json!([{ "bufferView": 0 }, { "uri": "a.png" }]));
        assert_eq!(json["bufferViews"], json!(["image", "numbers", "sparse"]));
        assert_eq!(json["accessors"][0]["sparse"]["values"]["bufferView"], 2);
        assert_eq!(json["materials"][0]["normalTexture"]["index"], 0);
        let coat = "/materials/1/extensions/KHR_materials_clearcoat/clearcoatTexture/index";
        assert_eq!(json.pointer(coat), Some(&json!(1)));
    }

    #[test]
    fn an_unknown_extension_keeps_all() {
        let before = json!({ "extensionsUsed": ["EXT_nobody"], "images": [{}], "bufferViews": [{}] });
        let mut json = before.clone();
        assert_eq!(prune(&mut json, 1), 1);
        assert_eq!(json, before);
    }
}
