//! A texture that may be encoded in several ways.

use super::format::Lossy;
use super::image_packing::{ImagePacking, Stored, encode};
use super::webp::WebPLoss;
use crate::error::Result;
use crate::image::{Bitmap, Encoding, Texels, Texture};
use crate::math::Vec3;
use std::borrow::Cow;

/// A texture that may be encoded in several ways.
///
/// ```
/// use taotie::image::{Bitmap, Encoding, Texels};
/// use taotie::io::{Lossy, LossyTexture};
///
/// let texels = (0..64 * 64).map(|i| [i as u8, (i / 64 * 4) as u8, 0, 255]).collect();
/// let texture = LossyTexture::new(Bitmap::new(64, 64, 3, Texels::U8(texels))?, Encoding::Srgb);
/// let file = texture.encoded(64, Some(Lossy::Jpeg(90)))?;
/// assert!(texture.may_be_jpeg() && file.starts_with(&[0xff, 0xd8]));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug)]
pub struct LossyTexture {
    texture: Texture,
    /// `true` if some texel is not opaque.
    has_alpha: bool,
}

impl LossyTexture {
    /// Takes a bitmap and the meaning of its texels.
    pub fn new(bitmap: Bitmap, encoding: Encoding) -> Self {
        Self { has_alpha: bitmap.has_alpha(), texture: Texture::new(bitmap, encoding) }
    }

    /// Returns the meaning of its texels.
    pub fn encoding(&self) -> Encoding {
        self.texture.encoding()
    }

    /// Returns the bitmap.
    pub fn bitmap(&self) -> &Bitmap {
        self.texture.bitmap()
    }

    /// Returns the longer side, texels.
    pub fn side(&self) -> u32 {
        self.texture.width().max(self.texture.height())
    }

    /// Returns `true` if JPEG can hold it: each of its texels is opaque.
    pub fn may_be_jpeg(&self) -> bool {
        !self.has_alpha
    }

    /// Returns its file with `side` texels along the longer side, at most its own: lossy, or lossless WebP.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if the encoder refuses; [`crate::Error::Unsupported`] without the feature `webp`, or for
    /// texels of floats.
    pub fn encoded(&self, side: u32, loss: Option<Lossy>) -> Result<Vec<u8>> {
        let packing = loss.map_or(ImagePacking::WebP(WebPLoss::Lossless), ImagePacking::from);
        let stored = Stored { encoding: self.encoding(), alpha: self.has_alpha };
        encode(&*self.resized(side)?, stored, packing)
    }

    /// Returns it with `side` texels along the longer side, at most its own, as encoders get it.
    ///
    /// # Errors
    /// As those of [`Bitmap::new`].
    pub fn resized(&self, side: u32) -> Result<Cow<'_, Bitmap>> {
        let level = self.texture.resized(side.clamp(1, self.side()));
        match self.encoding() {
            Encoding::Normal if side < self.side() => Ok(Cow::Owned(normals(&level)?)),
            _ => Ok(level),
        }
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
