//! An image as a screen shows it.

use super::{one_per_pixel, same_size};
use crate::error::{Error, Result};

/// An image as a screen shows it: sRGB-encoded red, green and blue in [0, 1], row by row from the top.
#[derive(Debug, Clone)]
pub struct DisplayImage {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) pixels: Vec<[f32; 3]>,
}

impl DisplayImage {
    /// Makes an image from encoded pixels, row by row from the top.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a side is zero, the count is not `width · height`, or a value is outside [0, 1].
    pub fn new(width: u32, height: u32, pixels: Vec<[f32; 3]>) -> Result<Self> {
        one_per_pixel("a picture", width, height, pixels.len())?;
        let outside = |pixel: &[f32; 3]| !pixel.iter().all(|v| (0.0..=1.0).contains(v));
        if let Some(i) = pixels.iter().position(outside) {
            return Err(Error::invalid(
                format!("pixel ({}, {}) of {:?}", i % width as usize, i / width as usize, pixels[i]),
                "sRGB-encoded values must be from 0 to 1; develop the picture first",
            ));
        }
        Ok(Self { width, height, pixels })
    }

    /// Makes an opaque image from a developed one, ignoring the fourth channel.
    ///
    /// # Errors
    /// As [`DisplayImage::new`].
    pub fn from_developed(width: u32, height: u32, codes: &[[u8; 4]]) -> Result<Self> {
        let pixels: Vec<[u8; 3]> = codes.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
        Self::from_8bit(width, height, &pixels)
    }

    /// Makes an image from the codes of an 8-bit file, row by row from the top.
    ///
    /// # Errors
    /// As [`DisplayImage::new`].
    pub fn from_8bit(width: u32, height: u32, pixels: &[[u8; 3]]) -> Result<Self> {
        Self::new(width, height, pixels.iter().map(|p| p.map(|v| f32::from(v) / 255.0)).collect())
    }

    /// Returns the width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Returns the height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Returns all pixels, row by row from the top.
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    pub(super) fn check_same_size(&self, other: &DisplayImage) -> Result<()> {
        same_size((self.width, self.height), (other.width, other.height))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_become_numbers() {
        let picture = DisplayImage::from_8bit(1, 1, &[[0, 51, 255]]).unwrap();
        assert_eq!(picture.pixels(), [[0.0, 0.2, 1.0]]);
    }

    #[test]
    fn what_no_screen_shows_is_refused() {
        for wrong in [-0.01, 1.01, f32::NAN, f32::INFINITY] {
            let why = DisplayImage::new(2, 1, vec![[0.0; 3], [0.5, wrong, 0.5]]).unwrap_err().to_string();
            assert!(why.contains("(1, 0)"), "{why}");
        }
        assert!(DisplayImage::new(2, 2, vec![[0.0; 3]; 3]).is_err());
    }
}
