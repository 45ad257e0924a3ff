//! Develops an image: every step between scene-referred light and a file.

use super::developer::Developer;
use super::development::Development;
use crate::error::{Error, Result};
use crate::image::Image;
use crate::parallel;

/// Returns the image with 8 bits per channel: sRGB, straight alpha, row by row from the top.
///
/// # Errors
/// [`Error::Invalid`] for an exposure or a background out of range, [`Error::Unsupported`] for a SIMD level that this
/// machine lacks.
pub fn develop8(image: &Image, development: &Development) -> Result<Vec<[u8; 4]>> {
    let mut out = vec![[0; 4]; image.pixels().len()];
    develop8_into(image, development, &mut out)?;
    Ok(out)
}

/// Like [`develop8`], into existing memory: `out` has as many pixels as the image.
///
/// # Errors
/// As for [`develop8`], and [`Error::Invalid`] for an `out` of another size.
pub fn develop8_into(image: &Image, development: &Development, out: &mut [[u8; 4]]) -> Result<()> {
    let developer = Developer::new(development)?;
    let pixels = image.pixels();
    if out.len() != pixels.len() {
        let why = format!("it has {} pixels; the image has {}", out.len(), pixels.len());
        return Err(Error::invalid("output buffer", why));
    }
    parallel::pieces(out, BAND, &|i, band| developer.codes8(&pixels[i * BAND..][..band.len()], band));
    Ok(())
}

/// Returns the image with 16 bits per channel: sRGB, straight alpha, row by row from the top.
///
/// # Errors
/// As for [`develop8`].
pub fn develop16(image: &Image, development: &Development) -> Result<Vec<[u16; 4]>> {
    let developer = Developer::new(development)?;
    let pixels = image.pixels();
    let mut out = vec![[0; 4]; pixels.len()];
    parallel::pieces(&mut out, BAND, &|i, band| developer.codes16(&pixels[i * BAND..][..band.len()], band));
    Ok(out)
}

/// The number of pixels per task; whole packs.
const BAND: usize = 4096;
