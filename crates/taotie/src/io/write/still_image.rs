//! Images in linear light, developed for display or stored as they are.

use super::file_set::FileSet;
use crate::error::Result;
use crate::film::{Development, develop8, develop16};
use crate::image::{Bitmap, Encoding, Image, Texels};
use std::path::Path;

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
/// use taotie::film::Development;
/// use taotie::image::Image;
/// use taotie::io::{ImageFormat, write_image};
///
/// let grey = Image::new(64, 64, [0.2, 0.2, 0.2, 1.0])?;
/// write_image("grey.png".as_ref(), &grey, &Development::default(), ImageFormat::Png16)?;
/// # Ok::<(), taotie::Error>(())
/// ```
///
/// # Errors
/// Those of the development, [`crate::Error::Unsupported`] for OpenEXR without the feature `exr`, and
/// [`crate::Error::Io`] if the file cannot be written.
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
    /// [`crate::Error::Invalid`] if the size does not match the texels, [`crate::Error::Io`] if the file cannot be
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
        Err(crate::Error::needs_feature(format!("{}: OpenEXR", path.display()), "exr"))
    }
}
