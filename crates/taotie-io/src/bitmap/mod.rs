//! Images from PNG, JPEG, WebP, AVIF, KTX2, DDS, TGA, TIFF, Radiance HDR and OpenEXR, in the precision and encoding of the file:
//! textures, and environments from float images.

#[cfg(feature = "avif")]
mod avif;
mod dds;
mod decode;
#[cfg(feature = "exr")]
mod exr;
#[cfg(feature = "basis")]
mod ktx;
mod limits;

pub(super) use dds::encode_dds;
pub(super) use limits::{ImageHeader, KTX2_TYPE, combined, count_copy, count_first, texture};

use super::limits::Limits;
use super::reading::Reading;
use decode::{decode, decode_png};
use image::ImageFormat;
use std::path::Path;
use taotie_engine::error::{Error, Result};
use taotie_engine::image::{Bitmap, Image, Texels};

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
    read_with_file(path, limits).map(|(bitmap, _)| bitmap)
}

/// Reads a photograph as [`read_bitmap_within`], turned as its metadata state (EXIF), as viewers show it.
///
/// # Errors
/// As [`read_bitmap_within`].
pub fn read_photograph_within(path: &Path, limits: &Limits) -> Result<Bitmap> {
    read_with_file(path, limits).map(|(bitmap, file)| decode::upright(bitmap, &file))
}

/// Reads an image file, and returns its bytes, too.
fn read_with_file(path: &Path, limits: &Limits) -> Result<(Bitmap, Vec<u8>)> {
    let reading = Reading::new(path, limits);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let file = reading.read_own(path)?;
    let decoded = decode_within(&file, &name, path, &reading);
    reading.check()?;
    Ok((decoded?, file))
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
    if dds::is_dds(bytes) {
        return dds::decode(bytes, reading).map_err(|failure| failure.into_error(path, at()));
    }
    if bytes.is_empty() {
        return Err(Error::parse(path, at(), "the image is empty: save it again, or remove it"));
    }
    let format = format.ok_or_else(|| {
        Error::unsupported(
            format!("{}: the image format of '{name}'", path.display()),
            "use PNG, JPEG, WebP, AVIF, KTX2, DDS, TGA, TIFF, HDR or EXR",
        )
    })?;
    #[cfg(feature = "exr")]
    if format == ImageFormat::OpenExr {
        return exr::decode(bytes, reading).map_err(|failure| failure.into_error(path, at()));
    }
    let decoded = match format {
        ImageFormat::Png => {
            decode_png(bytes, reading).transpose().unwrap_or_else(|| decode(bytes, format, reading))
        }
        _ => decode(bytes, format, reading),
    };
    decoded.map_err(|failure| failure.into_error(path, at()))
}

/// Decodes the equirectangular image of an environment, of any size that is twice as wide as high. `path` is the
/// source file that errors refer to.
///
/// # Errors
/// As [`decode_bitmap`]; [`Error::Unsupported`] for values other than floats, since only floats can hold the
/// brightness of lamps; [`Error::Parse`] for another shape; [`Error::Limit`] above [`Image::MAX_SIDE`].
pub fn decode_environment(bytes: &[u8], path: &Path) -> Result<Image> {
    decode_environment_within(bytes, path, &Limits::default())
}

/// Decodes an environment like [`decode_environment`], within limits on memory and pixels.
///
/// # Errors
/// As [`decode_environment`]; [`Error::Limit`] if a limit is exceeded.
pub fn decode_environment_within(bytes: &[u8], path: &Path, limits: &Limits) -> Result<Image> {
    let reading = Reading::new(path, limits);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let decoded = decode_within(bytes, &name, path, &reading);
    reading.check()?;
    let bitmap = decoded?;
    if !reading.take(filtering_bytes(bitmap.texels().len() as u64)) {
        reading.check()?;
    }
    let (width, height) = (bitmap.width(), bitmap.height());
    let bits = bitmap.bits();
    let Texels::F32(texels) = bitmap.into_texels() else {
        let what = format!("{}: an environment with {bits} bits per channel", path.display());
        return Err(Error::unsupported(what, "use a float image, .hdr or .exr"));
    };
    if width != 2 * height {
        let what = format!(
            "invalid size {width}×{height}: an environment is an equirectangular image twice as wide as high, e.g. \
             2048×1024"
        );
        return Err(Error::parse(path, "image", what));
    }
    Image::from_pixels(width, height, texels).map_err(|error| match error {
        Error::Limit { what, why } => Error::limit(format!("{}: {what}", path.display()), why),
        other => other,
    })
}

/// Returns the bytes that filtering `pixels` pixels needs, in addition to those already counted for decoding, which
/// comes first.
fn filtering_bytes(pixels: u64) -> u64 {
    /// Texels as decoded, counted with mip levels that are not generated here.
    const DECODED: u64 = 22;
    /// Texels as decoded, and as an image.
    const COPIED: u64 = 16 + 16 + 2;
    /// Half floats.
    const KEPT: u64 = 8;
    /// Means of the image in ever coarser cells, and the levels made from them, whose number is bounded.
    const FILTERED: u64 = 220;
    const MOST_FILTERED: u64 = 330 << 20;
    let filtered = pixels * KEPT + (pixels * FILTERED).min(MOST_FILTERED);
    filtered.max(pixels * COPIED) - pixels * DECODED
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
    use ImageFormat::{Hdr, Jpeg, OpenExr, Png, Tga, Tiff, WebP};
    match image::guess_format(bytes) {
        Ok(format @ (Png | Jpeg | WebP | Tiff | Hdr | OpenExr)) => Some(format),
        Ok(_) => None,
        Err(_) => {
            let name = name.to_ascii_lowercase();
            [".tga", ".icb", ".vda", ".vst"].iter().any(|e| name.ends_with(e)).then_some(Tga)
        }
    }
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

    #[cfg(feature = "exr")]
    mod environments {
        use super::*;
        use crate::{ExrLayer, PngColor, PngImage, PngSamples, encode_png, write_exr};
        use taotie_engine::image::Encoding;

        fn exr(width: u32, height: u32) -> Result<Image> {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("sky.exr");
            let mut image = Image::new(width, height, [0.25, 0.5, 70_000.0, 1.0])?;
            image.pixels_mut()[0] = [1.0, 2.0, 3.0, 1.0];
            let samples = image.pixels().as_flattened();
            let layer = ExrLayer { name: "", channels: &["R", "G", "B", "A"], samples };
            write_exr(&path, (width, height), &[layer])?;
            decode_environment(&std::fs::read(&path).unwrap(), &path)
        }

        #[test]
        fn any_size_twice_as_wide_as_high_is_read() {
            for height in [1, 3, 50] {
                let image = exr(2 * height, height).unwrap();
                assert_eq!((image.width(), image.height()), (2 * height, height));
                assert_eq!(image.pixel(0, 0)[..3], [1.0, 2.0, 3.0]);
                assert_eq!(image.pixel(1, 0)[..3], [0.25, 0.5, 70_000.0]);
            }
        }

        #[test]
        fn what_filtering_takes_is_counted() {
            assert_eq!(filtering_bytes(100), 100 * (8 + 220 - 22));
            assert_eq!(filtering_bytes(1 << 28), (1 << 28) * (34 - 22));
            let within = |memory: u64| {
                let path = std::path::PathBuf::from("sky.exr");
                let samples = [0.5; 2 * 4];
                let layer = ExrLayer { name: "", channels: &["R", "G", "B", "A"], samples: &samples };
                let bytes = crate::encode_exr((2, 1), &[layer]).unwrap();
                let limits = Limits { memory: Some(crate::Bytes(memory)), ..Limits::default() };
                decode_environment_within(&bytes, &path, &limits)
            };
            // 22 + 16 bytes per pixel during decoding, 206 afterwards.
            assert!(within(2 * (38 + 206)).is_ok() && within(2 * (38 + 206) - 1).is_err());
        }

        #[test]
        fn other_shapes_are_refused_with_what_is_expected() {
            let error = exr(4, 4).unwrap_err().to_string();
            assert!(
                error.contains("sky.exr: image: invalid size 4×4") && error.contains("twice as wide as high"),
                "{error}"
            );
        }

        #[test]
        fn pictures_for_screens_are_refused() {
            let samples = PngSamples::U8(&[0; 2 * 3]);
            let png =
                PngImage { width: 2, height: 1, color: PngColor::Rgb, samples, encoding: Encoding::Srgb };
            let error =
                decode_environment(&encode_png(&png).unwrap(), Path::new("a.hdr")).unwrap_err().to_string();
            assert!(error.contains("a.hdr: an environment with 8 bits") && error.contains(".exr"), "{error}");
        }
    }
}
