//! A texture that can be encoded in several ways.

use super::codec::ImageCodec;
use super::image_packing::{Stored, encode};
use crate::error::Result;
use crate::image::{Bitmap, Encoding, Texels, Texture};
use crate::math::Vec3;
use std::borrow::Cow;

/// A texture that can be encoded in several ways.
///
/// ```
/// use taotie::image::{Bitmap, Encoding, Texels};
/// use taotie::io::{ImageCodec, LossyTexture};
///
/// let texels = (0..64 * 64).map(|i| [i as u8, (i / 64 * 4) as u8, 0, 255]).collect();
/// let texture = LossyTexture::new(Bitmap::new(64, 64, 3, Texels::U8(texels))?, Encoding::Srgb);
/// let file = texture.encoded(64, ImageCodec::Jpeg(90))?;
/// assert!(texture.fits(ImageCodec::Jpeg(90), 64) && file.starts_with(&[0xff, 0xd8]));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug)]
pub struct LossyTexture {
    texture: Texture,
    /// `true` if any texel is not opaque, and materials read the alpha.
    has_alpha: bool,
}

impl LossyTexture {
    /// Takes a bitmap and the encoding of its texels.
    pub fn new(bitmap: Bitmap, encoding: Encoding) -> Self {
        Self { has_alpha: bitmap.has_alpha(), texture: Texture::new(bitmap, encoding) }
    }

    /// Removes the alpha, for materials that do not read it.
    #[must_use]
    pub(super) fn without_alpha(self) -> Self {
        Self { has_alpha: false, ..self }
    }

    /// Returns the encoding of its texels.
    pub fn encoding(&self) -> Encoding {
        self.texture.encoding()
    }

    /// Returns the bitmap.
    pub fn bitmap(&self) -> &Bitmap {
        self.texture.bitmap()
    }

    /// Returns the longer side in texels.
    pub fn side(&self) -> u32 {
        self.texture.width().max(self.texture.height())
    }

    /// Returns `true` if a format supports it with `side` texels along the longer side: formats without alpha need
    /// opaque texels, KTX2 needs sides that are multiples of 4.
    pub fn fits(&self, codec: ImageCodec, side: u32) -> bool {
        (codec.holds_alpha() || !self.has_alpha) && codec.holds_size(self.texture.resized_size(side))
    }

    /// Returns the number of its texels.
    pub fn texels(&self) -> u64 {
        self.bitmap().texels().len() as u64
    }

    /// Encodes it with `side` texels along the longer side, at most its own size.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if the encoder fails; [`crate::Error::Unsupported`] without the feature `webp`, or
    /// for float texels.
    pub fn encoded(&self, side: u32, codec: ImageCodec) -> Result<Vec<u8>> {
        let stored = Stored { encoding: self.encoding(), alpha: self.has_alpha, quick_webp: false };
        encode(&*self.resized(side)?, stored, codec)
    }

    /// Returns it with `side` texels along the longer side, at most its own size, as passed to encoders.
    ///
    /// # Errors
    /// Those of [`Bitmap::new`].
    pub fn resized(&self, side: u32) -> Result<Cow<'_, Bitmap>> {
        let level = self.texture.resized(side.clamp(1, self.side()));
        match self.encoding() {
            Encoding::Normal if side < self.side() => Ok(Cow::Owned(normals(&level)?)),
            _ => Ok(level),
        }
    }
}

/// Returns the normals of a mip level, which are shorter than 1 where they vary, as unit vectors in 8 bits.
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
