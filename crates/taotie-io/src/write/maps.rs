//! Maps without a model, in the file formats of other programs.

use super::super::bitmap::encode_dds;
use super::gltf::encode_webp_bitmap;
use super::still_image::{PngColor, PngImage, PngSamples, encode_png_bitmap, interleaved, with_image};
use std::path::Path;
use taotie_engine::error::{Error, Result};
use taotie_engine::image::{Bitmap, Encoding, Texels};
use taotie_engine::names::Named;
use tiff::encoder::colortype::ColorType;
use tiff::encoder::{Compression, DeflateLevel, Predictor, TiffEncoder, TiffValue};
use tiff::tags::{ExtraSamples, Tag};

/// A file format of maps without a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapFormat {
    /// PNG, 8 or 16 bits per channel.
    Png,
    /// WebP, lossless, 8 bits.
    WebP,
    /// OpenEXR, floats.
    Exr,
    /// Truevision TGA without compression, 8 bits.
    Tga,
    /// DDS with mip levels: BC5 for tangent-space normals, BC4 for one channel, BC7 for others; 8 bits.
    Dds,
    /// TIFF with deflate compression, 8 or 16 bits, or floats.
    Tiff,
}

impl Named for MapFormat {
    const WHAT: &'static str = "format of maps";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("png", Self::Png),
        ("webp", Self::WebP),
        ("exr", Self::Exr),
        ("tga", Self::Tga),
        ("dds", Self::Dds),
        ("tiff", Self::Tiff),
        ("tif", Self::Tiff),
    ];
}

impl MapFormat {
    /// Returns the format of a file by its extension, in any case; `None` for others.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_string_lossy().to_ascii_lowercase();
        Self::from_name(&extension).ok()
    }

    /// Returns the maximum number of bits per channel: 8, 16 or 32.
    pub fn bits(self) -> u8 {
        match self {
            Self::WebP | Self::Tga | Self::Dds => 8,
            Self::Png => 16,
            Self::Exr | Self::Tiff => 32,
        }
    }
}

/// Encodes the texels of a bitmap as stored, in any of the formats except OpenEXR, which stores numbers rather than
/// codes. Only PNG notes the encoding.
///
/// # Errors
/// [`Error::Unsupported`] for more bits than the format has, for float texels, and for OpenEXR.
pub fn encode_map(bitmap: &Bitmap, encoding: Encoding, format: MapFormat) -> Result<Vec<u8>> {
    let refused = || {
        let what = format!("a {} with {} bits per channel", format.name().to_uppercase(), bitmap.bits());
        Error::unsupported(what, "write a .png")
    };
    match (format, bitmap.texels()) {
        (MapFormat::Png, _) => encode_png_bitmap(bitmap, encoding),
        (MapFormat::WebP, _) => encode_webp_bitmap(bitmap),
        (MapFormat::Dds, _) => encode_dds(bitmap, encoding),
        (MapFormat::Tga, Texels::U8(texels)) => tga(bitmap, texels),
        (MapFormat::Tiff, Texels::U8(_) | Texels::U16(_)) => with_image(bitmap, encoding, tiff),
        (MapFormat::Exr | MapFormat::Tga | MapFormat::Tiff, _) => Err(refused()),
    }
}

/// Encodes floats as TIFF, row by row from the top, with 1, 3 or 4 channels.
///
/// # Errors
/// [`Error::Invalid`] for another number of samples or channels.
pub fn encode_tiff_floats((width, height): (u32, u32), channels: u8, samples: &[f32]) -> Result<Vec<u8>> {
    use tiff::encoder::colortype::{Gray32Float, RGB32Float, RGBA32Float};
    let mut bytes = std::io::Cursor::new(Vec::new());
    let encoder = TiffEncoder::new(&mut bytes).map(|encoder| encoder.with_compression(DEFLATE));
    let encoded = encoder.and_then(|mut encoder| match channels {
        1 => encoder.write_image::<Gray32Float>(width, height, samples),
        3 => encoder.write_image::<RGB32Float>(width, height, samples),
        _ => write_rgba::<RGBA32Float>(&mut encoder, [width, height], samples),
    });
    encoded.map_err(|error| Error::invalid("a TIFF", error.to_string()))?;
    Ok(bytes.into_inner())
}

/// The buffer of a TIFF file.
type TiffBuffer<'a> = TiffEncoder<&'a mut std::io::Cursor<Vec<u8>>>;

/// Writes an image whose fourth channel is alpha with which colours are not premultiplied: without that tag, readers
/// take it for premultiplied, or for no alpha.
fn write_rgba<C: ColorType>(
    encoder: &mut TiffBuffer<'_>,
    [width, height]: [u32; 2],
    samples: &[C::Inner],
) -> tiff::TiffResult<()>
where
    [C::Inner]: TiffValue,
{
    let mut image = encoder.new_image::<C>(width, height)?;
    image.encoder().write_tag(Tag::ExtraSamples, &[ExtraSamples::UnassociatedAlpha][..])?;
    image.write_data(samples)
}

/// The compression of TIFF files.
const DEFLATE: Compression = Compression::Deflate(DeflateLevel::Balanced);

fn tga(bitmap: &Bitmap, texels: &[[u8; 4]]) -> Result<Vec<u8>> {
    let (color, channels) = match bitmap.channels() {
        1 => (image::ExtendedColorType::L8, 1),
        3 => (image::ExtendedColorType::Rgb8, 3),
        _ => (image::ExtendedColorType::Rgba8, 4),
    };
    let (samples, mut bytes) = (interleaved(texels, channels), Vec::new());
    // The encoder's run lengths cross rows, which TGA 2.0 forbids and some readers refuse.
    let encoder = image::codecs::tga::TgaEncoder::new(&mut bytes).disable_rle();
    let encoded = encoder.encode(&samples, bitmap.width(), bitmap.height(), color);
    encoded.map_err(|error| Error::invalid("a TGA", error.to_string()))?;
    Ok(bytes)
}

fn tiff(image: &PngImage) -> Result<Vec<u8>> {
    use tiff::encoder::colortype::{Gray8, Gray16, RGB8, RGB16, RGBA8, RGBA16};
    let mut bytes = std::io::Cursor::new(Vec::new());
    let encoder = TiffEncoder::new(&mut bytes)
        .map(|encoder| encoder.with_compression(DEFLATE).with_predictor(Predictor::Horizontal));
    let (width, height) = (image.width, image.height);
    let encoded = encoder.and_then(|mut encoder| match (image.samples, image.color) {
        (PngSamples::U8(samples), PngColor::Grey) => encoder.write_image::<Gray8>(width, height, samples),
        (PngSamples::U8(samples), PngColor::Rgb) => encoder.write_image::<RGB8>(width, height, samples),
        (PngSamples::U8(samples), PngColor::Rgba) => {
            write_rgba::<RGBA8>(&mut encoder, [width, height], samples)
        }
        (PngSamples::U16(samples), PngColor::Grey) => encoder.write_image::<Gray16>(width, height, samples),
        (PngSamples::U16(samples), PngColor::Rgb) => encoder.write_image::<RGB16>(width, height, samples),
        (PngSamples::U16(samples), PngColor::Rgba) => {
            write_rgba::<RGBA16>(&mut encoder, [width, height], samples)
        }
    });
    encoded.map_err(|error| Error::invalid("a TIFF", error.to_string()))?;
    Ok(bytes.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_of_tiff_is_not_premultiplied() {
        let bitmap = Bitmap::new(1, 1, 4, Texels::U8(vec![[9, 8, 7, 6]])).unwrap();
        let by_codes = encode_map(&bitmap, Encoding::Linear, MapFormat::Tiff).unwrap();
        for bytes in [by_codes, encode_tiff_floats((1, 1), 4, &[0.1, 0.2, 0.3, 0.4]).unwrap()] {
            let mut decoder = tiff::decoder::Decoder::new(std::io::Cursor::new(bytes)).unwrap();
            assert_eq!(decoder.get_tag_u16_vec(Tag::ExtraSamples).unwrap(), [2]);
        }
    }

    /// Rows of equal texels, whose run lengths would continue in the next row.
    #[test]
    fn tga_has_no_packets() {
        for channels in [1, 3, 4] {
            let texel = [1, 2, 3, 4].map(|code| if code <= channels { code } else { 0 });
            let bitmap = Bitmap::new(3, 2, channels, Texels::U8(vec![texel; 6])).unwrap();
            let bytes = encode_map(&bitmap, Encoding::Linear, MapFormat::Tga).unwrap();
            let (kind, bgra) = match channels {
                1 => (3, vec![1]),
                3 => (2, vec![3, 2, 1]),
                _ => (2, vec![3, 2, 1, 4]),
            };
            assert_eq!((bytes[2], &bytes[12..16]), (kind, [3, 0, 2, 0].as_slice()));
            assert_eq!(bytes[18..], bgra.repeat(6), "{channels} channels, after the header");
        }
    }
}
