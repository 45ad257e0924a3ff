//! The images of a file: encoded anew, smaller and in another format.

use super::super::edit;
use super::super::graft::images::{Storage, kind, take_along};
use super::super::image_packing::{ImagePacking, Stored, difference, encode};
use super::super::webp::WebPLoss;
use crate::error::Result;
use crate::image::{Bitmap, Encoding, Texels, Texture};
use crate::io::decode_bitmap;
use crate::io::gltf::{OF_TEXTURES, RawGltf, image_bytes, uses};
use crate::math::Vec3;
use serde_json::{Value, json};
use std::path::Path;

/// The format of images that are encoded anew.
pub(super) const WEBP: ImagePacking = ImagePacking::WebP(WebPLoss::Lossless);

/// An image that can be encoded anew.
#[derive(Debug)]
pub(super) struct OwnImage {
    texture: Texture,
    /// `true` if some texel is not opaque.
    has_alpha: bool,
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
        let fits = |bitmap: &Bitmap| bitmap.bits() <= 16 && bitmap.width().max(bitmap.height()) <= 16_383;
        let bitmap = bitmap.filter(|bitmap| cfg!(feature = "webp") && fits(bitmap))?;
        let has_alpha = bitmap.has_alpha();
        let texture = Texture::new(bitmap, encoding);
        let json = raw.json.pointer_mut(&format!("/images/{number}"))?;
        ["bufferView", "uri", "mimeType"].iter().for_each(|name| edit::remove(json, name));
        Some(OwnImage { texture, has_alpha, stored, mime_type })
    });
    Ok(own.collect())
}

/// Returns the meaning of an image's texels by what materials read of it; `None` if it has several, none, or one that is not
/// drawn here.
fn encoding(uses: &[String]) -> Option<Encoding> {
    let of = |role: &String| match role.as_str() {
        "normal" | "clearcoat normal" => Some(Encoding::Normal),
        "base color" | "emissive" => Some(Encoding::Srgb),
        "metallic roughness" | "occlusion" | "clearcoat" | "clearcoat roughness" => Some(Encoding::Linear),
        _ => None,
    };
    let first = of(uses.first()?)?;
    uses.iter().all(|role| of(role) == Some(first)).then_some(first)
}

impl OwnImage {
    pub fn encoding(&self) -> Encoding {
        self.texture.encoding()
    }

    /// Returns the longer side, texels.
    pub fn side(&self) -> u32 {
        self.texture.width().max(self.texture.height())
    }

    /// Returns the WebP with at most so many texels along the longer side.
    pub fn encoded(&self, side: u32, quality: Option<u8>) -> Result<Vec<u8>> {
        let loss = quality.map_or(WebPLoss::Lossless, WebPLoss::Quality);
        let stored = Stored { encoding: self.encoding(), alpha: self.has_alpha };
        let is_smaller = side < self.side();
        let level = self.texture.resized(side);
        match self.encoding() {
            Encoding::Normal if is_smaller => encode(&normals(&level)?, stored, ImagePacking::WebP(loss)),
            _ => encode(&level, stored, ImagePacking::WebP(loss)),
        }
    }

    /// Returns the root mean square difference of the texels that an object shows where it fills a screen from those of a
    /// packed image, [0, 1].
    pub fn error(&self, bytes: &[u8]) -> Result<f64> {
        /// The longer side from which on texels are finer than pixels.
        const OF_SCREEN: u32 = 512;
        let own = self.texture.resized(OF_SCREEN);
        let other = decode_bitmap(bytes, "a packed image", Path::new(""))?;
        Ok(difference(&own, &other))
    }
}

/// Returns the normals of a mip level, which are shorter than 1 where they differ, as unit vectors in 8 bits.
fn normals(level: &Bitmap) -> Result<Bitmap> {
    let code = |v: f32| ((v * 0.5 + 0.5) * 255.0).round() as u8;
    let texel = |i: usize| {
        let [x, y, z, _] = level.stored(i).map(|v| v * 2.0 - 1.0);
        let [x, y, z] = Vec3::new(x, y, z).normalize_or(Vec3::new(0.0, 0.0, 1.0)).to_array();
        [code(x), code(y), code(z), 255]
    };
    let texels = (0..level.texels().len()).map(texel).collect();
    Bitmap::new(level.width(), level.height(), 3, Texels::U8(texels))
}

/// Lets textures show an image by an extension alone.
pub(super) fn show_by(extension: &str, json: &mut Value, number: usize) {
    for texture in edit::items_mut(json, "textures") {
        if edit::number(texture, "source") == Some(number) {
            edit::remove(texture, "source");
            *edit::member(edit::member(texture, "extensions"), extension) = json!({ "source": number });
        }
    }
}

/// Says whether a texture shows another image in place of this one, which is there for programs that cannot read that.
fn has_substitute(json: &Value, number: usize) -> bool {
    let shows = |texture: &Value, name: &str| texture.pointer(&format!("/extensions/{name}")).is_some();
    let substitutes = |texture: &Value| OF_TEXTURES.iter().any(|name| shows(texture, name));
    let own = |texture: &&Value| edit::number(texture, "source") == Some(number);
    edit::items(json, "textures").iter().filter(own).any(substitutes)
}
