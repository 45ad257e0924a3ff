//! Environments from Radiance HDR and OpenEXR files.

use super::bitmap::decode_within;
use super::limits::Limits;
use super::reading::Reading;
use crate::error::{Error, Result};
use crate::image::{Image, Texels};
use std::path::Path;

/// Decodes the equirectangular image of an environment, of any size that is twice as wide as high. `path` is the
/// source file that errors refer to.
///
/// # Errors
/// As [`super::decode_bitmap`]; [`Error::Unsupported`] for values other than floats, since only floats can hold the
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

#[cfg(all(test, feature = "exr"))]
mod tests {
    use super::*;
    use crate::image::Encoding;
    use crate::io::{ExrLayer, PngColor, PngImage, PngSamples, encode_png, write_exr};

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
            let bytes = crate::io::encode_exr((2, 1), &[layer]).unwrap();
            let limits = Limits { memory: Some(crate::io::Bytes(memory)), ..Limits::default() };
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
        let png = PngImage { width: 2, height: 1, color: PngColor::Rgb, samples, encoding: Encoding::Srgb };
        let error =
            decode_environment(&encode_png(&png).unwrap(), Path::new("a.hdr")).unwrap_err().to_string();
        assert!(error.contains("a.hdr: an environment with 8 bits") && error.contains(".exr"), "{error}");
    }
}
