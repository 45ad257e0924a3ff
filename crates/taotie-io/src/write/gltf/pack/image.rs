//! The images of a file: re-encoded at a smaller size and in another format.

use super::super::codec::CodecKind;
use super::super::edit;
use super::super::graft::{Storage, take_along};
use super::super::image_encoding::LossyTexture;
use crate::gltf::{OF_TEXTURES, RawGltf, image_bytes, uses};
use serde_json::{Value, json};
use taotie_engine::error::Result;
use taotie_engine::image::{Bitmap, Encoding};

/// An image that can be re-encoded.
#[derive(Debug)]
pub(super) struct OwnImage {
    pub texture: LossyTexture,
    /// The bytes of its file.
    pub stored: Vec<u8>,
    pub kind: CodecKind,
}

/// Takes the bytes of images out of a document; `None` for an image that stays in it.
///
/// # Errors
/// [`taotie_engine::Error::Io`] if a file cannot be read.
pub(super) fn taken(raw: &mut RawGltf, bitmaps: Vec<Option<Bitmap>>) -> Result<Vec<Option<OwnImage>>> {
    take_along(raw, bitmaps.len(), Storage::Inside)?;
    let is_opaque = is_opaque(&raw.json);
    let own = bitmaps.into_iter().enumerate().map(|(number, bitmap)| {
        let encoding = encoding(&uses(&raw.json, number)).filter(|_| !has_substitute(&raw.json, number))?;
        let stored = image_bytes(raw, raw.json.pointer(&format!("/images/{number}"))?).ok()??;
        let kind = CodecKind::detect(&stored).filter(|kind| *kind != CodecKind::Ktx2)?;
        // The maximum side length of WebP.
        let bits = if encoding == Encoding::Srgb { 8 } else { 16 };
        let fits = |bitmap: &Bitmap| bitmap.bits() <= bits && bitmap.width().max(bitmap.height()) <= 16_383;
        let bitmap = bitmap.filter(|bitmap| cfg!(feature = "webp") && fits(bitmap))?;
        let texture = LossyTexture::new(bitmap, encoding);
        let texture = if is_opaque { texture.without_alpha() } else { texture };
        let json = raw.json.pointer_mut(&format!("/images/{number}"))?;
        ["bufferView", "uri", "mimeType"].iter().for_each(|name| edit::remove(json, name));
        Some(OwnImage { texture, stored, kind })
    });
    Ok(own.collect())
}

/// Returns `true` if no material of a document reads alpha.
fn is_opaque(json: &Value) -> bool {
    let mode = |material: &Value| material.get("alphaMode").is_none_or(|mode| mode == "OPAQUE");
    edit::items(json, "materials").iter().all(mode)
}

/// Returns the encoding of an image's texels according to its uses; `None` if it has several encodings, none, or one
/// whose loss cannot be measured here.
fn encoding(uses: &[String]) -> Option<Encoding> {
    let of = |role: &String| match role.as_str() {
        "normal" => Some(Encoding::Normal),
        "base color" | "emissive" => Some(Encoding::Srgb),
        "metallic roughness" | "occlusion" => Some(Encoding::Linear),
        _ => None,
    };
    let first = of(uses.first()?)?;
    uses.iter().all(|role| of(role) == Some(first)).then_some(first)
}

/// Updates textures to an image whose kind has changed: with the right extension, or without.
pub(super) fn show_as(kind: CodecKind, json: &mut Value, number: usize) {
    let pointer = |name: &str| format!("/extensions/{name}/source");
    for texture in edit::items_mut(json, "textures") {
        let extended = OF_TEXTURES.iter().find_map(|name| texture.pointer(&pointer(name)));
        if extended.or(texture.get("source")).and_then(Value::as_u64) != Some(number as u64) {
            continue;
        }
        edit::remove(texture, "source");
        let extensions = edit::member(texture, "extensions");
        OF_TEXTURES.iter().for_each(|name| edit::remove(extensions, name));
        match kind.extension() {
            Some(name) => *edit::member(extensions, name) = json!({ "source": number }),
            None => *edit::member(texture, "source") = number.into(),
        }
        if texture["extensions"].as_object().is_none_or(|all| all.is_empty()) {
            edit::remove(texture, "extensions");
        }
    }
    if let Some(name) = kind.extension() {
        edit::require(json, name);
    }
}

/// Returns `true` if a texture has an alternative to this image, which is a fallback for programs that cannot read
/// it.
fn has_substitute(json: &Value, number: usize) -> bool {
    let shows = |texture: &Value, name: &str| texture.pointer(&format!("/extensions/{name}")).is_some();
    let substitutes = |texture: &Value| OF_TEXTURES.iter().any(|name| shows(texture, name));
    let own = |texture: &&Value| edit::number(texture, "source") == Some(number);
    edit::items(json, "textures").iter().filter(own).any(substitutes)
}
