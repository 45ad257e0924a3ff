//! Reading pictures.

use crate::error::{Error, Result};
use crate::image::{Bitmap, Texels};
use std::path::Path;

/// Reads a picture.
///
/// # Errors
/// [`Error::Io`] or [`Error::Parse`].
pub fn read_bitmap(path: &Path) -> Result<Bitmap> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    let picture =
        image::load_from_memory(&bytes).map_err(|e| Error::parse(path, "picture", e.to_string()))?;
    let channels = picture.color().channel_count();
    let (w, h) = (picture.width(), picture.height());
    let texels = if picture.color().bits_per_pixel() / u16::from(channels) > 8 {
        Texels::U16(picture.to_rgba16().pixels().map(|p| p.0).collect())
    } else {
        Texels::U8(picture.to_rgba8().pixels().map(|p| p.0).collect())
    };
    Bitmap::new(w, h, channels, texels)
}
