//! Developing an image: every step between scene-referred light and a file.

use super::developer::Developer;
use super::development::Development;
use crate::error::{Error, Result};
use crate::image::Image;
use crate::parallel;

/// The image in 8 bits a channel: sRGB, straight alpha, row by row from the top.
///
/// # Errors
/// [`Error::Invalid`] for an exposure or a background out of range, [`Error::Unsupported`] for a SIMD level that
/// this machine lacks.
pub fn develop8(image: &Image, development: &Development) -> Result<Vec<[u8; 4]>> {
    let mut out = vec![[0; 4]; image.pixels().len()];
    develop8_into(image, development, &mut out)?;
    Ok(out)
}

/// [`develop8`] into memory that is there: `out` has as many pixels as the image.
///
/// # Errors
/// As [`develop8`], and [`Error::Invalid`] for an `out` of another size.
pub fn develop8_into(image: &Image, development: &Development, out: &mut [[u8; 4]]) -> Result<()> {
    let developer = Developer::new(development)?;
    let pixels = image.pixels();
    if out.len() != pixels.len() {
        let why = format!("it has {} pixels, the picture {}", out.len(), pixels.len());
        return Err(Error::invalid("memory for a developed picture", why));
    }
    parallel::pieces(out, BAND, &|i, band| developer.codes8(&pixels[i * BAND..][..band.len()], band));
    Ok(())
}

/// The image in 16 bits a channel: sRGB, straight alpha, row by row from the top.
///
/// # Errors
/// As [`develop8`].
pub fn develop16(image: &Image, development: &Development) -> Result<Vec<[u16; 4]>> {
    let developer = Developer::new(development)?;
    let pixels = image.pixels();
    let mut out = vec![[0; 4]; pixels.len()];
    parallel::pieces(&mut out, BAND, &|i, band| developer.codes16(&pixels[i * BAND..][..band.len()], band));
    Ok(out)
}

/// The number of pixels that one task takes at a time; whole packs.
const BAND: usize = 4096;
