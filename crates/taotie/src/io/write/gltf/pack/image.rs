//! The images of a file: encoded anew, smaller and in another format.

use super::super::edit;
use super::super::graft::images::{Storage, kind, take_along};
use super::super::image_packing::ImagePacking;
use super::super::lossy_texture::LossyTexture;
use super::super::webp::WebPLoss;
use crate::error::Result;
use crate::image::{Bitmap, Encoding};
use crate::io::gltf::{OF_TEXTURES, RawGltf, image_bytes, uses};
use serde_json::{Value, json};

/// An image that can be encoded anew.
#[derive(Debug)]
pub(super) struct OwnImage {
    pub texture: LossyTexture,
    /// The bytes of its file.
    pub stored: Vec<u8>,
    pub mime_type: &'static str,
}

/// Takes the bytes of images out of a document; `None` for one that stays in it.
///
/// # Errors
/// [`crate::Error::Io`] if a file cannot be read.
pub(super) fn taken(raw: &mut RawGltf, bitmaps: Vec<Option<Bitmap>>) -> Result<Vec<Option<OwnImage>>> {
    take_along(raw, bitmaps.len(), Storage::Inside)?;
    let own = bitmaps.into_iter().enumerate().map(|(number, bitmap)| {
        let encoding = encoding(&uses(&raw.json, number)).filter(|_| !has_substitute(&raw.json, number))?;
        let stored = image_bytes(raw, raw.json.pointer(&format!("/images/{number}"))?).ok()??;
        let (mime_type, _) = kind(&stored).filter(|(mime_type, _)| *mime_type != "image/ktx2")?;
        // The longest side of WebP.
        let bits = if encoding == Encoding::Srgb { 8 } else { 16 };
        let fits = |bitmap: &Bitmap| bitmap.bits() <= bits && bitmap.width().max(bitmap.height()) <= 16_383;
        let bitmap = bitmap.filter(|bitmap| cfg!(feature = "webp") && fits(bitmap))?;
        let texture = LossyTexture::new(bitmap, encoding);
        let json = raw.json.pointer_mut(&format!("/images/{number}"))?;
        ["bufferView", "uri", "mimeType"].iter().for_each(|name| edit::remove(json, name));
        Some(OwnImage { texture, stored, mime_type })
    });
    Ok(own.collect())
}

/// Returns the meaning of an image's texels by what materials read of it; `None` if it has several, none, or one whose loss
/// nothing here measures.
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

/// Lets textures show an image as its new media type demands: WebP by an extension alone, others by none.
pub(super) fn show_anew(mime_type: &str, json: &mut Value, number: usize) {
    let webp = ImagePacking::WebP(WebPLoss::Lossless);
    let Some(extension) = webp.extension() else { return };
    let is_webp = mime_type == webp.mime_type();
    for texture in edit::items_mut(json, "textures") {
        let pointer = format!("/extensions/{extension}/source");
        let shown = texture.pointer(&pointer).or(texture.get("source")).and_then(Value::as_u64);
        if shown != Some(number as u64) {
            continue;
        }
        if is_webp {
            edit::remove(texture, "source");
            *edit::member(edit::member(texture, "extensions"), extension) = json!({ "source": number });
        } else {
            edit::remove(edit::member(texture, "extensions"), extension);
            if edit::member(texture, "extensions").as_object().is_none_or(|all| all.is_empty()) {
                edit::remove(texture, "extensions");
            }
            *edit::member(texture, "source") = number.into();
        }
    }
    if is_webp {
        edit::require(json, extension);
    }
}

/// Says whether a texture shows another image in place of this one, which is there for programs that cannot read that.
fn has_substitute(json: &Value, number: usize) -> bool {
    let shows = |texture: &Value, name: &str| texture.pointer(&format!("/extensions/{name}")).is_some();
    let substitutes = |texture: &Value| OF_TEXTURES.iter().any(|name| shows(texture, name));
    let own = |texture: &&Value| edit::number(texture, "source") == Some(number);
    edit::items(json, "textures").iter().filter(own).any(substitutes)
}
