//! Still images: PNG with 8 or 16 bits per channel, and images in linear light, developed for display as PNG or
//! stored as they are in OpenEXR.

use super::file_set::{FileSet, Sink};
use std::borrow::Cow;
use std::path::Path;
use taotie_engine::error::{Error, Result};
use taotie_engine::film::{Development, develop8, develop16};
use taotie_engine::image::{Bitmap, Encoding, Image, Texels};

/// The file format of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ImageFormat {
    /// PNG, sRGB, 8 bits per channel.
    Png8,
    /// PNG, sRGB, 16 bits per channel.
    Png16,
    /// OpenEXR, linear float, undeveloped.
    Exr,
}

/// Writes an image in linear light, developed unless the format stores linear values.
///
/// ```no_run
/// use taotie_engine::film::Development;
/// use taotie_engine::image::Image;
/// use taotie_io::{ImageFormat, write_image};
///
/// let grey = Image::new(64, 64, [0.2, 0.2, 0.2, 1.0])?;
/// write_image("grey.png".as_ref(), &grey, &Development::default(), ImageFormat::Png16)?;
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// Those of the development, [`Error::Unsupported`] for OpenEXR without the feature `exr`, and [`Error::Io`] if the
/// file cannot be written.
pub fn write_image(path: &Path, image: &Image, development: &Development, format: ImageFormat) -> Result<()> {
    FileSet::one(|files| files.write_image(path, image, development, format))
}

impl FileSet {
    /// Writes an image in linear light like [`write_image`].
    ///
    /// # Errors
    /// As [`write_image`].
    pub fn write_image(
        &self,
        path: &Path,
        image: &Image,
        development: &Development,
        format: ImageFormat,
    ) -> Result<()> {
        let texels = match format {
            ImageFormat::Exr => return self.write_linear(path, image),
            ImageFormat::Png8 => Texels::U8(develop8(image, development)?),
            ImageFormat::Png16 => Texels::U16(develop16(image, development)?),
        };
        self.write_developed(path, [image.width(), image.height()], development, texels)
    }

    /// Writes the pixels of a developed image with this width and height as PNG, without alpha if `development` adds
    /// a background.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the size does not match the texels, [`Error::Io`] if the file cannot be
    /// written.
    pub fn write_developed(
        &self,
        path: &Path,
        [width, height]: [u32; 2],
        development: &Development,
        texels: Texels,
    ) -> Result<()> {
        // An image with a background is opaque.
        let channels = if development.background.is_some() { 3 } else { 4 };
        self.write_png_bitmap(path, &Bitmap::new(width, height, channels, texels)?, Encoding::Srgb)
    }

    #[cfg(feature = "exr")]
    fn write_linear(&self, path: &Path, image: &Image) -> Result<()> {
        let samples: Vec<f32> = image.pixels().iter().flatten().copied().collect();
        let layer = super::ExrLayer { name: "", channels: &["R", "G", "B", "A"], samples: &samples };
        self.write_exr(path, (image.width(), image.height()), &[layer])
    }

    #[cfg(not(feature = "exr"))]
    fn write_linear(&self, path: &Path, _: &Image) -> Result<()> {
        Err(Error::needs_feature(format!("{}: OpenEXR", path.display()), "exr"))
    }
}

/// The channels of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PngColor {
    /// One channel.
    Grey,
    /// Red, green, blue.
    Rgb,
    /// Red, green, blue and straight (not premultiplied) alpha.
    Rgba,
}

/// Channel values, interleaved, row by row from the top.
#[derive(Debug, Clone, Copy)]
pub enum PngSamples<'a> {
    /// 8 bits per channel.
    U8(&'a [u8]),
    /// 16 bits per channel.
    U16(&'a [u16]),
}

/// An image to be written as PNG.
#[derive(Debug, Clone, Copy)]
pub struct PngImage<'a> {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The channels.
    pub color: PngColor,
    /// `width · height ·` channels values.
    pub samples: PngSamples<'a>,
    /// [`Encoding::Srgb`] marks the file as sRGB colour; [`Encoding::Linear`] omits the colour space, as is
    /// appropriate for normals, heights and masks.
    pub encoding: Encoding,
}

/// Writes the texels of an 8-bit or 16-bit bitmap unchanged, with its number of channels; grey with alpha becomes
/// RGBA.
///
/// # Errors
/// [`Error::Unsupported`] for float texels, [`Error::Io`] if the file cannot be written.
pub fn write_png_bitmap(path: &Path, bitmap: &Bitmap, encoding: Encoding) -> Result<()> {
    FileSet::one(|files| files.write_png_bitmap(path, bitmap, encoding))
}

/// Returns the bytes that [`write_png_bitmap`] would write.
///
/// # Errors
/// [`Error::Unsupported`] for float texels.
pub fn encode_png_bitmap(bitmap: &Bitmap, encoding: Encoding) -> Result<Vec<u8>> {
    with_image(bitmap, encoding, encode_png)
}

/// Calls `with` with the texels of a bitmap as a PNG image.
pub(super) fn with_image<T>(
    bitmap: &Bitmap,
    encoding: Encoding,
    with: impl FnOnce(&PngImage) -> Result<T>,
) -> Result<T> {
    let (color, channels) = match bitmap.channels() {
        1 => (PngColor::Grey, 1),
        3 => (PngColor::Rgb, 3),
        _ => (PngColor::Rgba, 4),
    };
    let (width, height) = (bitmap.width(), bitmap.height());
    match bitmap.texels() {
        Texels::U8(texels) => {
            let samples = interleaved(texels, channels);
            with(&PngImage { width, height, color, samples: PngSamples::U8(&samples), encoding })
        }
        Texels::U16(texels) => {
            let samples = interleaved(texels, channels);
            with(&PngImage { width, height, color, samples: PngSamples::U16(&samples), encoding })
        }
        Texels::F32(_) => Err(Error::unsupported("PNG with float texels", "use 8 or 16 bits")),
    }
}

/// Returns the first 1 to 4 channels of texels, interleaved.
pub(super) fn interleaved<T: Copy + Default>(texels: &[[T; 4]], channels: usize) -> Cow<'_, [T]> {
    match channels {
        1 => first::<T, 1>(texels).into(),
        2 => first::<T, 2>(texels).into(),
        3 => first::<T, 3>(texels).into(),
        _ => texels.as_flattened().into(),
    }
}

/// Copies a number of channels known at compile time.
fn first<T: Copy + Default, const N: usize>(texels: &[[T; 4]]) -> Vec<T> {
    let mut samples = vec![T::default(); N * texels.len()];
    for (sample, texel) in samples.as_chunks_mut::<N>().0.iter_mut().zip(texels) {
        sample.copy_from_slice(&texel[..N]);
    }
    samples
}

/// Writes an image to `path`, completely or not at all. The same image gives the same bytes.
///
/// # Errors
/// [`Error::Invalid`] if the sample count does not match the size, [`Error::Io`] if the file cannot be written.
pub fn write_png(path: &Path, image: &PngImage) -> Result<()> {
    FileSet::one(|files| files.write_png(path, image))
}

impl FileSet {
    /// Writes an image like [`write_png`].
    ///
    /// # Errors
    /// As [`write_png`].
    pub fn write_png(&self, path: &Path, image: &PngImage) -> Result<()> {
        check(image)?;
        self.write_with(path, |out| encode(image, out).map_err(|e| encoding_error(path, e)))
    }

    /// Writes the texels of a bitmap like [`write_png_bitmap`].
    ///
    /// # Errors
    /// As [`write_png_bitmap`].
    pub fn write_png_bitmap(&self, path: &Path, bitmap: &Bitmap, encoding: Encoding) -> Result<()> {
        with_image(bitmap, encoding, |image| self.write_png(path, image)).map_err(|error| match error {
            Error::Unsupported { what, why } => {
                Error::unsupported(format!("{}: {what}", path.display()), why)
            }
            other => other,
        })
    }
}

/// Returns the bytes that [`write_png`] would write.
///
/// # Errors
/// [`Error::Invalid`] if the sample count does not match the size.
pub fn encode_png(image: &PngImage) -> Result<Vec<u8>> {
    check(image)?;
    let mut bytes = std::io::Cursor::new(Vec::new());
    encode(image, &mut bytes).map_err(|e| Error::invalid("PNG image", e.to_string()))?;
    Ok(bytes.into_inner())
}

fn check(image: &PngImage) -> Result<()> {
    let channels = match image.color {
        PngColor::Grey => 1,
        PngColor::Rgb => 3,
        PngColor::Rgba => 4,
    };
    let count = match image.samples {
        PngSamples::U8(samples) => samples.len(),
        PngSamples::U16(samples) => samples.len(),
    };
    if image.width == 0
        || image.height == 0
        || count != image.width as usize * image.height as usize * channels
    {
        let why = format!("{count} samples for {}×{}×{channels}", image.width, image.height);
        return Err(Error::invalid("PNG image", why));
    }
    Ok(())
}

fn encode(image: &PngImage, out: &mut dyn Sink) -> std::result::Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(out, image.width, image.height);
    encoder.set_color(match image.color {
        PngColor::Grey => png::ColorType::Grayscale,
        PngColor::Rgb => png::ColorType::Rgb,
        PngColor::Rgba => png::ColorType::Rgba,
    });
    // Renders are smooth: adaptive filters with light deflate give small files quickly.
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    if image.encoding == Encoding::Srgb {
        encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    }
    match image.samples {
        PngSamples::U8(samples) => {
            encoder.set_depth(png::BitDepth::Eight);
            let mut writer = encoder.write_header()?;
            writer.write_image_data(samples)?;
            writer.finish()
        }
        PngSamples::U16(samples) => {
            encoder.set_depth(png::BitDepth::Sixteen);
            let mut bytes = vec![0; 2 * samples.len()];
            for (bytes, sample) in bytes.as_chunks_mut().0.iter_mut().zip(samples) {
                *bytes = sample.to_be_bytes();
            }
            let mut writer = encoder.write_header()?;
            writer.write_image_data(&bytes)?;
            writer.finish()
        }
    }
}

fn encoding_error(path: &Path, error: png::EncodingError) -> Error {
    match error {
        png::EncodingError::IoError(e) => Error::io(path, e),
        other => Error::invalid("PNG image", other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_bitmap;

    #[test]
    fn every_kind_reads_back_as_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.png");
        let bytes: Vec<u8> = (0..3 * 2 * 4).map(|i| i as u8 * 10).collect();
        let words: Vec<u16> = bytes.iter().map(|v| u16::from(*v) * 250 + 7).collect();
        for (color, channels) in [(PngColor::Grey, 1), (PngColor::Rgb, 3), (PngColor::Rgba, 4)] {
            let write = |samples| {
                let image = PngImage { width: 3, height: 2, color, samples, encoding: Encoding::Srgb };
                write_png(&path, &image).unwrap();
                read_bitmap(&path).unwrap()
            };
            let bitmap = write(PngSamples::U8(&bytes[..6 * channels]));
            assert_eq!((bitmap.channels() as usize, bitmap.bits()), (channels, 8));
            let Texels::U8(texels) = bitmap.texels() else { panic!("8 bits") };
            assert_eq!(texels[5][0], bytes[5 * channels]);
            let bitmap = write(PngSamples::U16(&words[..6 * channels]));
            assert_eq!((bitmap.channels() as usize, bitmap.bits()), (channels, 16));
            let Texels::U16(texels) = bitmap.texels() else { panic!("16 bits") };
            assert_eq!(texels[5][0], words[5 * channels]);
        }
    }

    #[test]
    fn only_colour_is_marked_srgb() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.png");
        for (encoding, marked) in [(Encoding::Srgb, true), (Encoding::Linear, false)] {
            let samples = PngSamples::U8(&[1, 2, 3]);
            let image = PngImage { width: 1, height: 1, color: PngColor::Rgb, samples, encoding };
            write_png(&path, &image).unwrap();
            let bytes = std::fs::read(&path).unwrap();
            assert_eq!(bytes.windows(4).any(|w| w == b"sRGB"), marked);
        }
    }

    #[test]
    fn a_wrong_count_is_refused() {
        let samples = PngSamples::U8(&[0; 5]);
        let image =
            PngImage { width: 2, height: 1, color: PngColor::Rgb, samples, encoding: Encoding::Linear };
        assert!(matches!(write_png(Path::new("x.png"), &image), Err(Error::Invalid { .. })));
    }
}
