//! The formats of a texture's image, and its bytes in each.

use super::format::{GltfFormat, GltfImages, Lossy};
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

/// The format of an image, and what it may lose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ImagePacking {
    Png,
    /// Of a quality, 1 to 100; holds no alpha.
    Jpeg(u8),
    WebP(WebPLoss),
    /// With an RDO as in [`GltfFormat::uastc_rdo`], 0 for none; holds no alpha.
    Ktx2(u8),
}

impl ImagePacking {
    /// Returns the packing that loses least.
    pub fn losing_least(format: &GltfFormat) -> Self {
        match format.images {
            GltfImages::Png => Self::Png,
            GltfImages::WebP if format.quick_webp => Self::WebP(WebPLoss::LosslessQuick),
            GltfImages::WebP => Self::WebP(WebPLoss::Lossless),
            GltfImages::Ktx2 => Self::Ktx2(0),
        }
    }

    /// Returns the packing of an image of some meaning, each of which may lose what is asked for.
    pub fn new(format: &GltfFormat, encoding: Encoding) -> Self {
        let least = Self::losing_least(format);
        let lossy = match encoding {
            Encoding::Srgb => format.webp_quality.map(Lossy::WebP),
            Encoding::Normal => format.normals,
            Encoding::Linear => format.numbers,
        };
        match (least, encoding) {
            (Self::WebP(_), _) => lossy.map_or(least, Self::from),
            (Self::Ktx2(_), Encoding::Srgb | Encoding::Linear) => Self::Ktx2(format.uastc_rdo.unwrap_or(0)),
            _ => least,
        }
    }

    pub fn file_extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Jpeg(_) => "jpg",
            Self::WebP(_) => "webp",
            Self::Ktx2(_) => "ktx2",
        }
    }

    pub fn mime_type(self) -> &'static str {
        match self {
            Self::Png => "image/png",
            Self::Jpeg(_) => "image/jpeg",
            Self::WebP(_) => "image/webp",
            Self::Ktx2(_) => "image/ktx2",
        }
    }

    /// Returns the extension that a texture needs to show such an image.
    pub fn extension(self) -> Option<&'static str> {
        match self {
            Self::Png | Self::Jpeg(_) => None,
            Self::WebP(_) => Some("EXT_texture_webp"),
            Self::Ktx2(_) => Some("KHR_texture_basisu"),
        }
    }
}

impl From<Lossy> for ImagePacking {
    fn from(lossy: Lossy) -> Self {
        match lossy {
            Lossy::WebP(quality) => Self::WebP(WebPLoss::Quality(quality)),
            Lossy::Jpeg(quality) => Self::Jpeg(quality),
        }
    }
}

/// The stored form of a bitmap, and its meaning.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stored {
    pub encoding: Encoding,
    /// `true` where alpha is written; KTX2 and JPEG hold none.
    pub alpha: bool,
}

/// Returns the bytes of an image file.
///
/// # Errors
/// [`Error::Unsupported`] for texels of floats; the errors of the format.
pub(super) fn encode(bitmap: &Bitmap, stored: Stored, packing: ImagePacking) -> Result<Vec<u8>> {
    match packing {
        ImagePacking::Png => png(bitmap, stored),
        ImagePacking::Jpeg(quality) => jpeg(bitmap, stored, quality),
        ImagePacking::WebP(loss) => webp(bitmap, stored, loss),
        ImagePacking::Ktx2(rdo) => {
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

/// Returns the bytes of a progressive JPEG with as many texels of hues as of lightness; it holds 8 bits and no alpha.
fn jpeg(bitmap: &Bitmap, stored: Stored, quality: u8) -> Result<Vec<u8>> {
    let wrong = |why: String| Error::invalid("a texture as JPEG", why);
    let side = |texels: u32| {
        u16::try_from(texels).map_err(|_| wrong(format!("{texels} texels are too long a side")))
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

/// Returns the bytes of a JPEG of a bitmap's colours, of this quality, 1 to 100.
///
/// # Errors
/// [`Error::Unsupported`] for texels of floats; [`Error::Invalid`] for a side of more than 65,535.
pub fn encode_jpeg_bitmap(bitmap: &Bitmap, quality: u8) -> Result<Vec<u8>> {
    jpeg(bitmap, Stored { encoding: Encoding::Srgb, alpha: false }, quality)
}

/// Returns the bytes of a lossless WebP of the texels of a bitmap, with alpha where it has some.
///
/// # Errors
/// [`Error::Unsupported`] for texels of more than 8 bits, and without the feature `webp`.
pub fn encode_webp_bitmap(bitmap: &Bitmap) -> Result<Vec<u8>> {
    let stored = Stored { encoding: Encoding::Linear, alpha: matches!(bitmap.channels(), 2 | 4) };
    match bitmap.bits() {
        8 => webp(bitmap, stored, WebPLoss::Lossless),
        bits => {
            Err(Error::unsupported(format!("a WebP of {bits} bits a channel"), "it holds 8; write a .png"))
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
    Error::unsupported(format!("a {:?} texture of floats in glTF", stored.encoding), "store 8 or 16 bits")
}
