//! Textures from PNG, JPEG, WebP, AVIF, KTX2, TGA, Radiance HDR and OpenEXR, in the precision and encoding of the file.

#[cfg(feature = "avif")]
mod avif;
#[cfg(feature = "exr")]
mod exr;
mod header;
mod jpeg;
#[cfg(feature = "basis")]
mod ktx;
mod limits;
mod png;
mod widen;

pub(super) use header::{ImageHeader, KTX2_TYPE};

use super::limits::Limits;
use super::reading::Reading;
use crate::error::{Error, Result};
use crate::image::{Bitmap, Texels};
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader};
use limits::{
    Failure, KEPT_OF_8_BITS, MAX_TEXELS, MAX_TEXELS_OF_PLAIN, TexelRoom, check_room, check_size, credible,
};
use std::io::Cursor;
use std::path::Path;
use widen::expand;

/// Reads an image file.
///
/// # Errors
/// As [`decode_bitmap`], and [`Error::Io`] if the file cannot be read.
pub fn read_bitmap(path: &Path) -> Result<Bitmap> {
    read_bitmap_within(path, &Limits::default())
}

/// Reads an image file within limits on memory and pixels, which are checked against its header before decoding.
///
/// # Errors
/// As [`read_bitmap`]; [`Error::Limit`] if a limit is exceeded.
pub fn read_bitmap_within(path: &Path, limits: &Limits) -> Result<Bitmap> {
    let reading = Reading::new(path, limits);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let decoded = decode_within(&reading.read_own(path)?, &name, path, &reading);
    reading.check()?;
    decoded
}

/// Reads an image that a model refers to, as part of reading the model.
pub(super) fn read_map(path: &Path, reading: &Reading) -> Result<Bitmap> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    decode_within(&reading.read(path)?, &name, path, reading)
}

/// Decodes an image in memory. The content determines the format, except for TGA, which has no signature and is
/// recognised by the extension of `name`. `path` is the file that errors refer to.
///
/// # Errors
/// [`Error::Unsupported`] for a format that is not read, [`Error::Limit`] for a size beyond [`Bitmap::MAX_SIDE`] per
/// side, 2²⁸ texels, or what `bytes` can hold, [`Error::Parse`] for damaged content.
pub fn decode_bitmap(bytes: &[u8], name: &str, path: &Path) -> Result<Bitmap> {
    let reading = Reading::new(path, &Limits::default());
    let decoded = decode_within(bytes, name, path, &reading);
    reading.check()?;
    decoded
}

/// Like [`decode_bitmap`], but as part of `reading`.
pub(super) fn decode_within(bytes: &[u8], name: &str, path: &Path, reading: &Reading) -> Result<Bitmap> {
    let is_the_file = path.file_name().is_some_and(|file| file.to_string_lossy() == name);
    let at = || if is_the_file { "image".to_owned() } else { format!("image '{name}'") };
    let format = guess_format(bytes, name);
    if let Some((what, feature)) = lacking(bytes, format) {
        return Err(Error::needs_feature(format!("{}: {}: {what}", path.display(), at()), feature));
    }
    #[cfg(feature = "avif")]
    if is_avif(bytes) {
        return avif::decode(bytes, reading).map_err(|failure| failure.into_error(path, at()));
    }
    #[cfg(feature = "basis")]
    if is_ktx2(bytes) {
        return ktx::decode(bytes, reading).map_err(|failure| failure.into_error(path, at()));
    }
    let format = format.ok_or_else(|| {
        Error::unsupported(
            format!("{}: the image format of '{name}'", path.display()),
            "use PNG, JPEG, WebP, AVIF, KTX2, TGA, HDR or EXR",
        )
    })?;
    #[cfg(feature = "exr")]
    if format == ImageFormat::OpenExr {
        return exr::decode(bytes, reading).map_err(|failure| failure.into_error(path, at()));
    }
    let decoded = match format {
        ImageFormat::Png => {
            png::decode(bytes, reading).transpose().unwrap_or_else(|| decode(bytes, format, reading))
        }
        _ => decode(bytes, format, reading),
    };
    decoded.map_err(|failure| failure.into_error(path, at()))
}

/// The signature at the start of a KTX2 file.
const KTX2: &[u8] = b"\xabKTX 20\xbb\r\n\x1a\n";

fn is_ktx2(bytes: &[u8]) -> bool {
    bytes.starts_with(KTX2)
}

fn is_avif(bytes: &[u8]) -> bool {
    bytes.get(4..12) == Some(b"ftypavif")
}

/// Returns the format of an image that this build does not read, and the feature that reads it.
fn lacking(bytes: &[u8], format: Option<ImageFormat>) -> Option<(&'static str, &'static str)> {
    let kinds = [
        (!cfg!(feature = "avif") && is_avif(bytes), ("AVIF", "avif")),
        (!cfg!(feature = "basis") && is_ktx2(bytes), ("KTX2", "basis")),
        (!cfg!(feature = "exr") && format == Some(ImageFormat::OpenExr), ("OpenEXR", "exr")),
        (!cfg!(feature = "webp") && format == Some(ImageFormat::WebP), ("WebP", "webp")),
    ];
    kinds.into_iter().find_map(|(lacks, kind)| lacks.then_some(kind))
}

fn guess_format(bytes: &[u8], name: &str) -> Option<ImageFormat> {
    use ImageFormat::{Hdr, Jpeg, OpenExr, Png, Tga, WebP};
    match image::guess_format(bytes) {
        Ok(format @ (Png | Jpeg | WebP | Hdr | OpenExr)) => Some(format),
        Ok(_) => None,
        Err(_) => {
            let name = name.to_ascii_lowercase();
            [".tga", ".icb", ".vda", ".vst"].iter().any(|e| name.ends_with(e)).then_some(Tga)
        }
    }
}

fn decode(bytes: &[u8], format: ImageFormat, reading: &Reading) -> std::result::Result<Bitmap, Failure> {
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.no_limits();
    let mut decoder = reader.into_decoder().map_err(failure)?;
    let (width, height) = decoder.dimensions();
    let credible = match format {
        ImageFormat::WebP => credible(bytes).max(MAX_TEXELS_OF_PLAIN),
        _ => credible(bytes),
    };
    check_size(u64::from(width), u64::from(height), credible)?;
    let color = decoder.color_type();
    let depth = u64::from(color.bytes_per_pixel() / color.channel_count());
    let (texels, own) = (u64::from(width) * u64::from(height), u64::from(color.bytes_per_pixel()));
    let scratch = match format {
        ImageFormat::Jpeg => {
            let room = jpeg::room(bytes, own).ok_or_else(|| Failure::Damaged("invalid header".into()))?;
            room.saturating_sub(KEPT_OF_8_BITS * texels)
        }
        // The decoder's own image exists alongside the texels made from it, and some decoders copy it again.
        _ => 2 * own * texels,
    };
    check_room(reading, [width, height], TexelRoom { depth, scratch })?;
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(MAX_TEXELS * 16);
    decoder.set_limits(limits).map_err(failure)?;
    let picture = DynamicImage::from_decoder(decoder).map_err(failure)?;
    bitmap_from(picture)
}

fn failure(error: ImageError) -> Failure {
    match error {
        ImageError::Limits(e) => Failure::TooLarge(e.to_string()),
        ImageError::Unsupported(e) => Failure::Unsupported(e.to_string()),
        other => Failure::Damaged(other.to_string()),
    }
}

fn bitmap_from(picture: DynamicImage) -> std::result::Result<Bitmap, Failure> {
    let (width, height) = (picture.width(), picture.height());
    let channels = picture.color().channel_count();
    let texels = match &picture {
        DynamicImage::ImageLuma8(p) => Texels::U8(expand(p, channels, u8::MAX)),
        DynamicImage::ImageLumaA8(p) => Texels::U8(expand(p, channels, u8::MAX)),
        DynamicImage::ImageRgb8(p) => Texels::U8(expand(p, channels, u8::MAX)),
        DynamicImage::ImageRgba8(p) => Texels::U8(expand(p, channels, u8::MAX)),
        DynamicImage::ImageLuma16(p) => Texels::U16(expand(p, channels, u16::MAX)),
        DynamicImage::ImageLumaA16(p) => Texels::U16(expand(p, channels, u16::MAX)),
        DynamicImage::ImageRgb16(p) => Texels::U16(expand(p, channels, u16::MAX)),
        DynamicImage::ImageRgba16(p) => Texels::U16(expand(p, channels, u16::MAX)),
        DynamicImage::ImageRgb32F(p) => Texels::F32(expand(p, channels, 1.0)),
        DynamicImage::ImageRgba32F(p) => Texels::F32(expand(p, channels, 1.0)),
        other => return Err(Failure::Unsupported(format!("pixel type {:?}", other.color()))),
    };
    Bitmap::new(width, height, channels, texels).map_err(|e| Failure::Damaged(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Tga {
        kind: u8,
        size: [u8; 2],
        bits: u8,
        descriptor: u8,
    }

    fn tga(head: Tga, data: &[u8]) -> Result<Bitmap> {
        let Tga { kind, size: [width, height], bits, descriptor } = head;
        let mut bytes = vec![0, 0, kind, 0, 0, 0, 0, 0, 0, 0, 0, 0, width, 0, height, 0, bits, descriptor];
        bytes.extend_from_slice(data);
        decode_bitmap(&bytes, "x.TGA", Path::new("x.TGA"))
    }

    fn reds(bitmap: &Bitmap) -> Vec<u8> {
        let Texels::U8(texels) = bitmap.texels() else { panic!("8 bits") };
        texels.iter().map(|t| t[0]).collect()
    }

    #[test]
    fn tga_origins() {
        let data = [0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0, 4]; // blue, green, red of a 2×2 image
        let order =
            |descriptor| reds(&tga(Tga { kind: 2, size: [2, 2], bits: 24, descriptor }, &data).unwrap());
        assert_eq!(order(0x20), [1, 2, 3, 4], "top left");
        assert_eq!(order(0x00), [3, 4, 1, 2], "bottom left");
        assert_eq!(order(0x30), [2, 1, 4, 3], "top right");
        assert_eq!(order(0x10), [4, 3, 2, 1], "bottom right");
    }

    #[test]
    fn tga_run_lengths_and_truncation() {
        let packets = [0x82, 9, 9, 7, 0x00, 9, 9, 5]; // red 7 three times, then red 5 once
        let head = || Tga { kind: 10, size: [2, 2], bits: 24, descriptor: 0x20 };
        let bitmap = tga(head(), &packets).unwrap();
        assert_eq!(reds(&bitmap), [7, 7, 7, 5]);
        let error = tga(head(), &packets[..6]).unwrap_err();
        assert!(matches!(error, Error::Parse { .. }), "{error}");
        let head = Tga { kind: 3, size: [2, 1], bits: 8, descriptor: 0x20 };
        let grey = tga(head, &[3, 250]).unwrap();
        assert_eq!((grey.channels(), reds(&grey)), (1, vec![3, 250]));
    }

    #[test]
    fn absurd_sizes_are_refused_before_allocation() {
        let mut header = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
        header.extend_from_slice(&[0, 0, 0x40, 0, 0, 0, 0x40, 0, 8, 6, 0, 0, 0]); // 16384 × 16384 RGBA
        let crc = crc32(&header[12..]);
        header.extend_from_slice(&crc.to_be_bytes());
        header.extend_from_slice(b"\0\0\0\0IDAT\x35\xaf\x06\x1e");
        let error = decode_bitmap(&header, "bomb.png", Path::new("bomb.png")).unwrap_err().to_string();
        assert!(error.contains("cannot hold"), "{error}");
    }

    fn crc32(bytes: &[u8]) -> u32 {
        let step = |crc: u32| if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 };
        !bytes.iter().fold(!0, |crc, b| (0..8).fold(crc ^ u32::from(*b), |crc, _| step(crc)))
    }

    #[test]
    fn unknown_content_is_named() {
        let error = decode_bitmap(b"GIF89a....", "a.png", Path::new("m.gltf")).unwrap_err().to_string();
        assert!(error.contains("a.png") && error.contains("m.gltf"), "{error}");
        assert!(decode_bitmap(b"", "a.png", Path::new("a.png")).is_err());
        assert!(decode_bitmap(b"", "a.tga", Path::new("a.tga")).is_err());
    }
}
