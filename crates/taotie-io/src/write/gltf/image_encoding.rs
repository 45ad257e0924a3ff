//! Encodes the image of a texture in each format, at its own size or a smaller one.

use super::codec::ImageCodec;
use super::ktx::{self, KtxImage};
use crate::write::still_image::interleaved;
use crate::{PngColor, PngImage, PngSamples, encode_png};
use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
#[cfg(feature = "avif")]
use ravif::{AlphaColorMode, BitDepth, ColorModel, Img, RGBA8};
use std::borrow::Cow;
use taotie_engine::error::{Error, Result};
use taotie_engine::image::{Bitmap, Encoding, Texels, Texture};
use taotie_engine::math::Vec3;

/// The encoding of a bitmap, and how to store it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stored {
    pub encoding: Encoding,
    /// `true` if alpha is written; AVIF, KTX2 and JPEG do not support it.
    pub alpha: bool,
    /// As [`GltfFormat::for_page`](super::format::GltfFormat).
    pub for_page: bool,
}

/// Returns the bytes of an image file.
///
/// # Errors
/// [`Error::Unsupported`] for float texels; the errors of the format.
pub(super) fn encode(bitmap: &Bitmap, stored: Stored, codec: ImageCodec) -> Result<Vec<u8>> {
    match codec {
        ImageCodec::Png => png(bitmap, stored),
        ImageCodec::Jpeg(quality) => jpeg(bitmap, stored, quality),
        ImageCodec::WebP if stored.for_page => webp(bitmap, stored, WebPLoss::LosslessQuick),
        ImageCodec::WebP => webp(bitmap, stored, WebPLoss::Lossless),
        ImageCodec::LossyWebP(quality) => webp(bitmap, stored, WebPLoss::Quality(quality)),
        ImageCodec::Avif(quality) => avif(bitmap, stored, quality),
        ImageCodec::Ktx2(rdo) => {
            let size = [bitmap.width(), bitmap.height()];
            let texels = eight_bits(bitmap, stored)?.into_owned();
            ktx::encode(KtxImage { size, texels, encoding: stored.encoding, rdo })
        }
    }
}

/// Encodes the colours of a bitmap as JPEG, with a quality from 1 to 100.
///
/// # Errors
/// [`Error::Unsupported`] for float texels; [`Error::Invalid`] for a side of more than 65,535.
pub fn encode_jpeg_bitmap(bitmap: &Bitmap, quality: u8) -> Result<Vec<u8>> {
    jpeg(bitmap, Stored { encoding: Encoding::Srgb, alpha: false, for_page: false }, quality)
}

/// Encodes the texels of a bitmap as lossless WebP, with alpha if it has any.
///
/// # Errors
/// [`Error::Unsupported`] for texels of more than 8 bits, and without the feature `webp`.
pub fn encode_webp_bitmap(bitmap: &Bitmap) -> Result<Vec<u8>> {
    let alpha = matches!(bitmap.channels(), 2 | 4);
    let stored = Stored { encoding: Encoding::Linear, alpha, for_page: false };
    match bitmap.bits() {
        8 => webp(bitmap, stored, WebPLoss::Lossless),
        bits => Err(Error::unsupported(format!("a WebP with {bits} bits per channel"), "write a .png")),
    }
}

/// A texture that can be encoded in several ways.
///
/// ```
/// use taotie_engine::image::{Bitmap, Encoding, Texels};
/// use taotie_io::{ImageCodec, LossyTexture};
///
/// let texels = (0..64 * 64).map(|i| [i as u8, (i / 64 * 4) as u8, 0, 255]).collect();
/// let texture = LossyTexture::new(Bitmap::new(64, 64, 3, Texels::U8(texels))?, Encoding::Srgb);
/// let file = texture.encoded(64, ImageCodec::Jpeg(90))?;
/// assert!(texture.fits(ImageCodec::Jpeg(90), 64) && file.starts_with(&[0xff, 0xd8]));
/// # Ok::<(), taotie_engine::Error>(())
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
    /// [`taotie_engine::Error::Invalid`] if the encoder fails; [`taotie_engine::Error::Unsupported`] without the
    /// feature `webp`, or for float texels.
    pub fn encoded(&self, side: u32, codec: ImageCodec) -> Result<Vec<u8>> {
        let stored = Stored { encoding: self.encoding(), alpha: self.has_alpha, for_page: false };
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

fn png(bitmap: &Bitmap, stored: Stored) -> Result<Vec<u8>> {
    let (color, channels) = match bitmap.channels() {
        2 | 4 if stored.alpha => (PngColor::Rgba, 4),
        1 | 2 => (PngColor::Grey, 1),
        _ => (PngColor::Rgb, 3),
    };
    let (width, height, encoding) = (bitmap.width(), bitmap.height(), stored.encoding);
    let encode = |samples| encode_png(&PngImage { width, height, color, samples, encoding });
    match bitmap.texels() {
        Texels::U8(texels) => encode(PngSamples::U8(&interleaved(texels, channels))),
        Texels::U16(texels) => encode(PngSamples::U16(&interleaved(texels, channels))),
        Texels::F32(_) => Err(no_floats(stored)),
    }
}

/// Encodes a progressive JPEG with full-resolution chroma, 8 bits and no alpha.
fn jpeg(bitmap: &Bitmap, stored: Stored, quality: u8) -> Result<Vec<u8>> {
    let wrong = |why: String| Error::invalid("JPEG texture", why);
    let side = |texels: u32| {
        u16::try_from(texels).map_err(|_| wrong(format!("a side of {texels} texels is too long")))
    };
    let (width, height) = (side(bitmap.width())?, side(bitmap.height())?);
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, quality);
    encoder.set_sampling_factor(SamplingFactor::F_1_1);
    encoder.set_progressive(true);
    encoder.set_optimized_huffman_tables(true);
    let texels = eight_bits(bitmap, stored)?;
    let encoded = encoder.encode(&interleaved(&texels, 3), width, height, ColorType::Rgb);
    encoded.map_err(|e| wrong(e.to_string()))?;
    Ok(bytes)
}

#[cfg(not(feature = "avif"))]
fn avif(_: &Bitmap, _: Stored, _: u8) -> Result<Vec<u8>> {
    Err(Error::needs_feature("AVIF", "avif"))
}

#[cfg(feature = "avif")]
fn avif(bitmap: &Bitmap, stored: Stored, quality: u8) -> Result<Vec<u8>> {
    let texels = eight_bits(bitmap, stored)?;
    let samples = interleaved(&texels, 3);
    encode_avif([bitmap.width(), bitmap.height()], &samples, quality)
}

/// rav1e's speed setting, 1 (best quality) to 10 (fastest).
#[cfg(feature = "avif")]
const AVIF_SPEED: u8 = 8;

/// Encodes an image as AVIF from RGB samples, which are kept as RGB (the identity matrix): decoders round luma and
/// chroma in different ways, each with a bias over flat colours. rav1e gets one thread, so that the result does not
/// depend on the number of threads.
///
/// # Errors
/// [`Error::Invalid`] if rav1e rejects the size.
#[cfg(feature = "avif")]
fn encode_avif([width, height]: [u32; 2], samples: &[u8], quality: u8) -> Result<Vec<u8>> {
    // `encode_rgb` is inlined, with a copy of the whole encoder for each bit depth.
    let pixels: Vec<RGBA8> =
        samples.as_chunks::<3>().0.iter().map(|[r, g, b]| RGBA8::new(*r, *g, *b, u8::MAX)).collect();
    let encoder = ravif::Encoder::new()
        .with_quality(quality.into())
        .with_speed(AVIF_SPEED)
        .with_bit_depth(BitDepth::Eight)
        .with_internal_color_model(ColorModel::RGB)
        .with_alpha_color_mode(AlphaColorMode::UnassociatedDirty)
        .with_num_threads(Some(1));
    let encoded = encoder.encode_rgba(Img::new(&pixels[..], width as usize, height as usize));
    let what = || format!("{width}×{height} AVIF texture");
    encoded.map(|image| image.avif_file).map_err(|error| Error::invalid(what(), error.to_string()))
}

#[cfg(not(feature = "webp"))]
fn webp(_: &Bitmap, _: Stored, _: WebPLoss) -> Result<Vec<u8>> {
    Err(Error::needs_feature("WebP", "webp"))
}

#[cfg(feature = "webp")]
fn webp(bitmap: &Bitmap, stored: Stored, loss: WebPLoss) -> Result<Vec<u8>> {
    let (size, has_alpha) = ([bitmap.width(), bitmap.height()], stored.alpha);
    let texels = eight_bits(bitmap, stored)?;
    let samples = interleaved(&texels, if has_alpha { 4 } else { 3 });
    encode_webp(&WebPImage { size, samples: &samples, has_alpha }, loss)
}

/// The compression of a WebP.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum WebPLoss {
    /// Lossless.
    Lossless,
    /// Lossless, with a shorter search for repetitions.
    LosslessQuick,
    /// Lossy with a quality from 1 to 100; alpha is lossless.
    Quality(u8),
}

/// An image to be encoded as WebP.
#[cfg(feature = "webp")]
struct WebPImage<'a> {
    /// Width and height in texels.
    size: [u32; 2],
    /// RGB, or RGBA with alpha.
    samples: &'a [u8],
    has_alpha: bool,
}

/// Encodes an image with libwebp, which gets one thread, so that the result does not depend on the number of threads.
///
/// # Errors
/// [`Error::Invalid`] if a side is longer than 16383 texels.
#[cfg(feature = "webp")]
fn encode_webp(image: &WebPImage<'_>, loss: WebPLoss) -> Result<Vec<u8>> {
    let [width, height] = image.size;
    let config = webp_options(loss);
    let bytes = if image.has_alpha {
        config.encode_rgba(image.samples, width, height, webpx::Unstoppable)
    } else {
        config.encode_rgb(image.samples, width, height, webpx::Unstoppable)
    };
    let what = || format!("{width}×{height} WebP texture");
    bytes.map_err(|e| Error::invalid(what(), e.error().to_string()))
}

/// Returns libwebp's options. Colours of transparent texels are kept, since texture filtering reads them.
#[cfg(feature = "webp")]
fn webp_options(loss: WebPLoss) -> webpx::EncoderConfig {
    /// Encoder effort, of 6. Measured on colours of 2048²: 6 takes twice the time and gives 2 % fewer bytes.
    const SEARCH: u8 = 4;
    /// Encoder effort for the shorter search, of 100. Measured on a normal map of 2048²: it takes 0.70 s and gives
    /// 3.4 % more bytes, while the default effort of 75 takes 1.76 s.
    const QUICK_EFFORT: f32 = 20.0;
    let lossless = webpx::EncoderConfig::new_lossless().exact(true);
    match loss {
        WebPLoss::Lossless => lossless,
        WebPLoss::LosslessQuick => lossless.quality(QUICK_EFFORT),
        WebPLoss::Quality(quality) => {
            webpx::EncoderConfig::new().quality(quality.into()).method(SEARCH).sharp_yuv(true).exact(true)
        }
    }
}

/// Returns the texels rounded to 8 bits.
fn eight_bits(bitmap: &Bitmap, stored: Stored) -> Result<Cow<'_, [[u8; 4]]>> {
    let rounded = |v: u16| ((u32::from(v) * 255 + 32767) / 65535) as u8;
    match bitmap.texels() {
        Texels::U8(texels) => Ok(Cow::Borrowed(texels)),
        Texels::U16(texels) => Ok(Cow::Owned(texels.iter().map(|texel| texel.map(rounded)).collect())),
        Texels::F32(_) => Err(no_floats(stored)),
    }
}

fn no_floats(stored: Stored) -> Error {
    Error::unsupported(format!("a float {:?} texture in glTF", stored.encoding), "use 8 or 16 bits")
}
