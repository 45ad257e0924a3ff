//! Comparison: angles between normals, differences of colours, error metrics and similarity of images, and heat maps.
//!
//! Images are compared as a screen shows them: a [`DisplayImage`], also converted from the texels of a file.
//!
//! Nothing here depends on the number of threads: pixels are independent of one another, and sums run in the order
//! of pixels.

mod color;
mod field;
mod flip;
mod metrics;
mod normals;

pub use color::{ciede2000, color_difference, lab_from_linear};
pub use field::{ColorMap, Field, Summary, heat};
pub use flip::{PIXELS_PER_DEGREE, flip};
pub use metrics::{
    SSIM_WINDOW, difference, psnr, psnr_within, rmse, rmse_within, ssim, ssim_map, ssim_within,
};
pub use normals::{NormalEncoding, StoredNormals, angle_deg, angular_error, stored_normals};

use crate::error::{Error, Result};
use crate::image::{Bitmap, Texels};
use crate::math::Vec3;
use crate::math::srgb::{linear_from_srgb, srgb_from_linear};
use crate::parallel;

/// An image as a screen shows it: sRGB-encoded red, green and blue in [0, 1], row by row from the top.
#[derive(Debug, Clone)]
pub struct DisplayImage {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 3]>,
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

    fn check_same_size(&self, other: &DisplayImage) -> Result<()> {
        same_size((self.width, self.height), (other.width, other.height))
    }
}

/// Returns a file as a screen shows it over `background`, which is linear and in [0, 1], and the number of pixels
/// that were brighter than white or below black and had to be clipped.
///
/// Integer texels are sRGB-encoded with straight alpha, as PNG stores them; float texels are linear and premultiplied
/// by alpha, as OpenEXR stores them. Alpha is composited over the background in linear light; where it is 1, integer
/// texels are unchanged.
///
/// # Errors
/// As [`DisplayImage::new`], none of which can occur for a valid bitmap.
pub fn stored_picture(bitmap: &Bitmap, background: Vec3) -> Result<(DisplayImage, usize)> {
    let linear = matches!(bitmap.texels(), Texels::F32(_));
    let background = background.to_f64().to_array();
    let shown = |i: usize| match (linear, bitmap.stored(i)) {
        (true, texel) => encoded(over(texel.map(f64::from), background)),
        (false, [r, g, b, 1.0]) => ([r, g, b], false),
        (false, texel) => encoded(over(premultiplied(texel.map(f64::from)), background)),
    };
    let texels: Vec<([f32; 3], bool)> = parallel::collect(bitmap.texels().len(), shown);
    let clipped = texels.iter().filter(|(_, clipped)| *clipped).count();
    let pixels = texels.into_iter().map(|(pixel, _)| pixel).collect();
    Ok((DisplayImage::new(bitmap.width(), bitmap.height(), pixels)?, clipped))
}

fn premultiplied([r, g, b, alpha]: [f64; 4]) -> [f64; 4] {
    let [r, g, b] = [r, g, b].map(|v| linear_from_srgb(v) * alpha);
    [r, g, b, alpha]
}

fn over([r, g, b, alpha]: [f64; 4], background: [f64; 3]) -> [f64; 3] {
    let rest = 1.0 - alpha.clamp(0.0, 1.0);
    [r + rest * background[0], g + rest * background[1], b + rest * background[2]]
}

/// Returns the encoded colour, and `true` if it had to be clipped, not merely rounded; NaN is black.
fn encoded(linear: [f64; 3]) -> ([f32; 3], bool) {
    const ROUNDING: f64 = 1e-6;
    let inside = linear.iter().all(|v| (-ROUNDING..=1.0 + ROUNDING).contains(v));
    let screen = |v: f64| if v.is_nan() { 0.0 } else { srgb_from_linear(v.clamp(0.0, 1.0)).clamp(0.0, 1.0) };
    (linear.map(|v| screen(v) as f32), !inside)
}

/// Checks that two sizes are equal.
///
/// # Errors
/// [`Error::Invalid`], which names both.
fn same_size(a: (u32, u32), b: (u32, u32)) -> Result<()> {
    if a == b {
        return Ok(());
    }
    Err(Error::invalid(
        format!("sizes {}x{} and {}x{}", a.0, a.1, b.0, b.1),
        "images must have the same size; render or resample one of them to match the other",
    ))
}

/// Checks that there is one element for each pixel of an image that is not empty.
///
/// # Errors
/// [`Error::Invalid`] if not.
fn one_per_pixel(what: &str, width: u32, height: u32, count: usize) -> Result<()> {
    if width == 0 || height == 0 || count as u64 != u64::from(width) * u64::from(height) {
        return Err(Error::invalid(
            format!("{what} of {width}x{height}"),
            format!("it has {count} elements; it must have one for each pixel, and at least one pixel"),
        ));
    }
    Ok(())
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

    fn floats(texels: &[[f32; 4]]) -> Bitmap {
        Bitmap::new(texels.len() as u32, 1, 4, Texels::F32(texels.to_vec())).unwrap()
    }

    #[test]
    fn opaque_codes_stay_as_they_are() {
        let bitmap = Bitmap::new(1, 1, 3, Texels::U8(vec![[1, 77, 255, 255]])).unwrap();
        let (picture, clipped) = stored_picture(&bitmap, Vec3::splat(0.5)).unwrap();
        assert_eq!((picture.pixels()[0], clipped), ([1, 77, 255].map(|v| v as f32 / 255.0), 0));
    }

    #[test]
    fn alpha_is_laid_over_the_background_in_linear_light() {
        let half = Bitmap::new(1, 1, 4, Texels::U16(vec![[65535, 0, 0, 32768]])).unwrap();
        let premultiplied = floats(&[[0.500_007_6, 0.0, 0.0, 0.500_007_6]]);
        for bitmap in [half, premultiplied] {
            let (picture, clipped) = stored_picture(&bitmap, Vec3::new(0.0, 1.0, 0.0)).unwrap();
            let [r, g, b] = picture.pixels()[0];
            assert!((r - 0.7354).abs() < 1e-4 && (g - 0.7354).abs() < 1e-4 && b == 0.0, "{r} {g} {b}");
            assert_eq!(clipped, 0);
        }
    }

    #[test]
    fn what_no_screen_shows_is_clipped_and_counted() {
        let bitmap = floats(&[[2.0, 0.5, -1.0, 1.0], [1.0, 0.0, 0.0, 1.0], [f32::NAN, 0.0, 0.0, 1.0]]);
        let (picture, clipped) = stored_picture(&bitmap, Vec3::splat(0.0)).unwrap();
        assert_eq!((picture.pixels()[0][0], picture.pixels()[0][2], clipped), (1.0, 0.0, 2));
        assert_eq!(picture.pixels()[2], [0.0; 3]);
    }
}
