//! Grafts baked textures onto the materials of a glTF file. Everything else is preserved: nodes, skins, morph
//! targets, animations, cameras, names, extras, and accessors to the last bit. Primitives without tangents get them
//! if they show a normal map, provided that no vertex has to be split.

mod factors;
pub(super) mod images;
mod primitives;
pub(super) mod prune;
mod root;
mod spans;
mod tangents;
pub(super) mod views;

use super::Container;
use super::container;
use super::edit;
use super::format::GltfFormat;
use super::images::encode;
use super::material::GltfMaterial;
use super::material_json::put_texture;
use super::samplers;
use super::uri::uri;
use crate::error::{Result, Warnings};
use crate::image::Sampler;
use crate::io::gltf::{GltfSource, RawGltf};
use crate::io::json::Json;
use crate::io::limits::Limits;
use crate::io::write::FileBytes;
use crate::io::xmp;
use crate::scene::Material;
use images::{Storage, Textured};
use serde_json::{Value, json};
use std::path::Path;

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
    /// The sampler of the new textures, such as [`gltf_sampler`](crate::io::gltf_sampler) makes.
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
/// [`crate::Error::Io`] and [`crate::Error::Parse`] if the source cannot be read, [`crate::Error::Limit`] if it
/// exceeds a limit; otherwise as [`encode_gltf`](crate::io::encode_gltf).
pub fn encode_graft(path: &Path, graft: &GltfGraft, format: &GltfFormat) -> Result<EncodedModel> {
    let storage = match Container::of(path)? {
        Container::Glb => Storage::Inside,
        Container::Gltf => Storage::Separate(path),
    };
    let mut raw = RawGltf::read(graft.source, &graft.limits)?;
    let own_images = edit::items(&raw.json, "images").len();
    let (mut external, mut warnings) = (Vec::new(), Warnings::default());
    let glossy = factors::count_glossy(&raw.json);
    for material in graft.materials {
        external.extend(graft_material(&mut raw, material, format, storage)?);
    }
    let what = format!("dropped {} of the low-poly mesh's materials", factors::GLOSSINESS);
    let uncovered = glossy - factors::count_glossy(&raw.json);
    warnings.note(format!("{what}: viewers would show it instead of the bake"), uncovered);
    let mapped = graft.materials.iter().filter(|grafted| grafted.material.normal_map.is_some());
    let mapped: Vec<usize> = mapped.map(|grafted| grafted.number).collect();
    tangents::give(&mut raw, graft.source, &mapped)?;
    if let Some(scale) = graft.root_scale {
        root::scale(&mut raw, scale, &mut warnings)?;
    }
    say_about(&mut raw.json, graft);
    let own_images = prune::prune(&mut raw.json, own_images);
    external.extend(images::take_along(&mut raw, own_images, storage)?);
    let bytes = views::joined(&mut raw)?;
    let mut files = match storage {
        Storage::Inside => vec![FileBytes {
            path: path.to_path_buf(),
            bytes: container::encoded(edit::text(&raw.json)?, &bytes)?,
        }],
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
    primitives::give_default(&mut raw.json, number);
    if number >= edit::items(&raw.json, "materials").len() {
        return Err(raw.error(format!("material {number}"), "no longer exists; bake again"));
    }
    let encoded = encode(material, format)?;
    let sampler = if encoded.is_empty() { 0 } else { add_sampler(&mut raw.json, &grafted.sampler) };
    let mut json = raw.json["materials"][number].take();
    let core = factors::core(&json);
    factors::graft(&mut json, material, grafted.said);
    for image in &encoded {
        let texture = images::add(raw, image, &Textured { storage, label, sampler });
        image.slots().iter().for_each(|slot| put_texture(&mut json, *slot, texture, material));
        if let Some(name) = image.extension() {
            edit::require(&mut raw.json, name);
        }
    }
    factors::uncover(&mut json, &core);
    factors::extensions(&json).iter().for_each(|name| edit::name(&mut raw.json, "extensionsUsed", name));
    raw.json["materials"][number] = json;
    if grafted.drops_colors {
        primitives::drop_colors(&mut raw.json, number);
    }
    let Storage::Separate(path) = storage else { return Ok(Vec::new()) };
    let labeled = path.with_file_name(format!("{}.gltf", images::stem(path, label)));
    Ok(encoded.into_iter().filter_map(|image| image.into_file(&labeled)).collect())
}

/// Returns the index of a sampler in the document, adding it if necessary.
fn add_sampler(json: &mut Value, sampler: &Sampler) -> usize {
    let sampler = samplers::json(sampler);
    let known = edit::items(json, "samplers").iter().position(|known| *known == sampler);
    known.unwrap_or_else(|| edit::push(json, "samplers", sampler))
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
    let name = format!("{}.bin", images::stem(path, ""));
    for buffer in edit::items_mut(&mut json, "buffers").take(1) {
        *edit::member(buffer, "uri") = uri(&name).into();
    }
    let document = FileBytes { path: path.to_path_buf(), bytes: edit::text(&json)? };
    let numbers = FileBytes { path: path.with_file_name(name), bytes };
    Ok(std::iter::once(document).chain((!numbers.bytes.is_empty()).then_some(numbers)).collect())
}
