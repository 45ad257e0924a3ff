//! Encodes the image of a texture in each format.

#[cfg(feature = "avif")]
use super::avif;
use super::codec::ImageCodec;
use super::ktx::{self, KtxImage};
use super::webp::WebPLoss;
#[cfg(feature = "webp")]
use super::webp::{self, WebPImage};
use crate::error::{Error, Result};
use crate::image::{Bitmap, Encoding, Texels};
use crate::io::write::png::interleaved;
use crate::io::{PngColor, PngImage, PngSamples, encode_png};
use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use std::borrow::Cow;

/// The encoding of a bitmap, and how to store it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stored {
    pub encoding: Encoding,
    /// `true` if alpha is written; AVIF, KTX2 and JPEG do not support it.
    pub alpha: bool,
    /// As [`GltfFormat::quick_webp`](super::format::GltfFormat).
    pub quick_webp: bool,
}

/// Returns the bytes of an image file.
///
/// # Errors
/// [`Error::Unsupported`] for float texels; the errors of the format.
pub(super) fn encode(bitmap: &Bitmap, stored: Stored, codec: ImageCodec) -> Result<Vec<u8>> {
    match codec {
        ImageCodec::Png => png(bitmap, stored),
        ImageCodec::Jpeg(quality) => jpeg(bitmap, stored, quality),
        ImageCodec::WebP if stored.quick_webp => webp(bitmap, stored, WebPLoss::LosslessQuick),
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
    avif::encode([bitmap.width(), bitmap.height()], &samples, quality)
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
    webp::encode(&WebPImage { size, samples: &samples, has_alpha }, loss)
}

/// Encodes the colours of a bitmap as JPEG, with a quality from 1 to 100.
///
/// # Errors
/// [`Error::Unsupported`] for float texels; [`Error::Invalid`] for a side of more than 65,535.
pub fn encode_jpeg_bitmap(bitmap: &Bitmap, quality: u8) -> Result<Vec<u8>> {
    jpeg(bitmap, Stored { encoding: Encoding::Srgb, alpha: false, quick_webp: false }, quality)
}

/// Encodes the texels of a bitmap as lossless WebP, with alpha if it has any.
///
/// # Errors
/// [`Error::Unsupported`] for texels of more than 8 bits, and without the feature `webp`.
pub fn encode_webp_bitmap(bitmap: &Bitmap) -> Result<Vec<u8>> {
    let alpha = matches!(bitmap.channels(), 2 | 4);
    let stored = Stored { encoding: Encoding::Linear, alpha, quick_webp: false };
    match bitmap.bits() {
        8 => webp(bitmap, stored, WebPLoss::Lossless),
        bits => Err(Error::unsupported(format!("a WebP with {bits} bits per channel"), "write a .png")),
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
