//! Conversion of texels stored in a file to values for comparison.

use super::DisplayImage;
use crate::error::Result;
use crate::image::{Bitmap, Image, Texels};
use crate::math::Vec3;
use crate::math::srgb::{linear_from_srgb, srgb_from_linear};
use crate::parallel;

/// How a file stores unit vectors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum NormalEncoding {
    /// As (n + 1) / 2, so that they fit [0, 1]: an ordinary normal map.
    Unit,
    /// Unchanged, components in [-1, 1]; only possible in float files.
    Signed,
}

/// Stored normals, and counts of texels without one.
#[derive(Debug, Clone)]
pub struct StoredNormals {
    /// x, y and z as stored, not normalised; the fourth channel is 1 where there is a normal, else 0.
    pub normals: Image,
    /// Texels without a normal because their alpha is 0.
    pub transparent: usize,
    /// Texels without a normal because their vector is more than 0.2 from unit length: padding, mostly.
    pub not_unit: usize,
}

/// The largest difference of a stored normal's length from 1.
const NEAR_UNIT: f32 = 0.2;

/// Returns the normals stored in a file, in any space.
///
/// # Errors
/// [`Error::Limit`](crate::Error::Limit) if a side is above [`Image::MAX_SIDE`].
pub fn stored_normals(bitmap: &Bitmap, encoding: NormalEncoding) -> Result<StoredNormals> {
    let mut normals = Image::new(bitmap.width(), bitmap.height(), [0.0; 4])?;
    parallel::change(normals.pixels_mut(), |i, pixel| {
        let [x, y, z, alpha] = bitmap.stored(i);
        let v = match encoding {
            NormalEncoding::Unit => Vec3::new(2.0 * x - 1.0, 2.0 * y - 1.0, 2.0 * z - 1.0),
            NormalEncoding::Signed => Vec3::new(x, y, z),
        };
        let is_normal = alpha > 0.0 && (v.length() - 1.0).abs() < NEAR_UNIT;
        *pixel = [v.x, v.y, v.z, if is_normal { 1.0 } else { 0.0 }];
    });
    let pixels = normals.pixels();
    let transparent = parallel::count(pixels.len(), |i| bitmap.stored(i)[3] <= 0.0);
    let without = parallel::count(pixels.len(), |i| pixels[i][3] == 0.0);
    Ok(StoredNormals { normals, transparent, not_unit: without - transparent })
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

#[cfg(test)]
mod tests {
    use super::*;

    fn floats(texels: &[[f32; 4]]) -> Bitmap {
        Bitmap::new(texels.len() as u32, 1, 4, Texels::F32(texels.to_vec())).unwrap()
    }

    #[test]
    fn normals_are_told_from_padding_and_holes() {
        let texels = vec![[128, 128, 255, 255], [128, 128, 255, 0], [128, 128, 128, 255], [0, 0, 0, 255]];
        let bitmap = Bitmap::new(4, 1, 4, Texels::U8(texels)).unwrap();
        let stored = stored_normals(&bitmap, NormalEncoding::Unit).unwrap();
        assert_eq!((stored.transparent, stored.not_unit), (1, 2));
        let [x, _, z, mask] = stored.normals.pixels()[0];
        assert!((x - 1.0 / 255.0).abs() < 1e-6 && z == 1.0 && mask == 1.0);
        let signed = floats(&[[0.6, 0.0, -0.8, 1.0], [0.0, 0.0, 0.0, 0.0], [f32::NAN, 0.0, 0.0, 1.0]]);
        let stored = stored_normals(&signed, NormalEncoding::Signed).unwrap();
        assert_eq!(stored.normals.pixels()[0], [0.6, 0.0, -0.8, 1.0]);
        assert_eq!((stored.transparent, stored.not_unit), (1, 1));
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
