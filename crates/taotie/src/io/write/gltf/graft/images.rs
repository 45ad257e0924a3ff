//! The images of a document: new ones for the bake, and its own, moved into the new file or next to it.

use super::super::codec::CodecKind;
use super::super::edit;
use super::super::images::Encoded;
use super::super::uri::uri;
use super::views;
use crate::error::Result;
use crate::io::gltf::RawGltf;
use crate::io::write::FileBytes;
use serde_json::json;
use std::path::Path;

/// The storage of images.
#[derive(Clone, Copy)]
pub(in super::super) enum Storage<'a> {
    /// In the document's buffer.
    Inside,
    /// In files next to this model.
    Separate(&'a Path),
}

/// The common properties of the new textures of a material.
pub(super) struct Textured<'a> {
    pub storage: Storage<'a>,
    /// A word that distinguishes its images from those of other materials.
    pub label: &'a str,
    /// The index of the sampler.
    pub sampler: usize,
}

/// Adds an image and a texture for it. Returns the texture's index.
pub(super) fn add(raw: &mut RawGltf, image: &Encoded, of: &Textured) -> usize {
    let Textured { storage, label, sampler } = *of;
    let json = match (image.bytes(), storage) {
        (Some(bytes), Storage::Inside) => {
            let view = views::add(raw, bytes.to_vec());
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
pub(super) fn stem(path: &Path, label: &str) -> String {
    labeled(&path.file_stem().unwrap_or_default().to_string_lossy(), label)
}

fn labeled(first: &str, second: &str) -> String {
    let parts = [first, second].into_iter().filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join("_")
}

/// Carries over those of the first `count` images that are external files of the source: into the document, or as
/// files next to the new one, which it returns. Images that are missing or of unknown kind stay as references.
///
/// # Errors
/// [`crate::Error::Io`] if a file cannot be read.
pub(in super::super) fn take_along(
    raw: &mut RawGltf,
    count: usize,
    storage: Storage,
) -> Result<Vec<FileBytes>> {
    let mut files = Vec::new();
    for i in 0..count {
        let name = edit::items(&raw.json, "images").get(i).and_then(|image| image.get("uri")?.as_str());
        let Some(bytes) = name.map(|name| raw.file(name)).transpose()?.flatten() else { continue };
        let Some(kind) = CodecKind::detect(&bytes) else { continue };
        let said = match storage {
            Storage::Inside => {
                let view = views::add(raw, bytes);
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
