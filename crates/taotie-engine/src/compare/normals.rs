//! Normals as stored in a file, and the angle between directions and between the normals of two images.

use super::{Field, same_size};
use crate::error::Result;
use crate::image::{Bitmap, Image};
use crate::math::{Vec3, scalar};
use crate::parallel;

/// Returns the angle between two directions in degrees, [0, 180], whatever their lengths. NaN if one is zero or NaN.
///
/// atan2(|a × b|, a · b), which is exact to a few ulp for the smallest and the largest angles, where the arc cosine
/// of a · b is not: Kahan, "How futile are mindless assessments of roundoff in floating-point computation?" (2006),
/// §12.
pub fn angle_deg(a: Vec3<f64>, b: Vec3<f64>) -> f64 {
    let (Some(a), Some(b)) = (scaled(a), scaled(b)) else { return f64::NAN };
    scalar::atan2(a.cross(b).length(), a.dot(b)).to_degrees()
}

/// Returns the vector divided by its largest component, so that no square overflows or vanishes; `None` without a
/// direction.
fn scaled(v: Vec3<f64>) -> Option<Vec3<f64>> {
    let largest = v.to_array().into_iter().fold(0.0, |most: f64, c| most.max(c.abs()));
    let finite = v.to_array().into_iter().all(f64::is_finite);
    (finite && largest > 0.0).then(|| v / largest)
}

/// Returns the angle in degrees between two images of normals, such as
/// [`Aovs::normals`](crate::render::Aovs::normals): x, y and z in [-1, 1], and a fourth channel above 0 where a
/// normal exists. NaN where one of them has none.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) if the sizes differ.
pub fn angular_error(a: &Image, b: &Image) -> Result<Field> {
    same_size((a.width(), a.height()), (b.width(), b.height()))?;
    let normal = |[x, y, z, _]: [f32; 4]| Vec3::new(x, y, z).to_f64();
    let angle = |a: [f32; 4], b: [f32; 4]| match a[3] > 0.0 && b[3] > 0.0 {
        true => angle_deg(normal(a), normal(b)) as f32,
        false => f32::NAN,
    };
    let values = parallel::collect(a.pixels().len(), |i| angle(a.pixels()[i], b.pixels()[i]));
    Field::new(a.width(), a.height(), values)
}

/// How a file stores unit vectors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Texels;

    fn close(angle: f64, expected: f64) {
        assert!((angle - expected).abs() < 1e-12, "{angle} is not {expected}");
    }

    #[test]
    fn known_angles_of_any_length() {
        let x = Vec3::new(1.0, 0.0, 0.0);
        close(angle_deg(x, Vec3::new(0.0, 5.0, 0.0)), 90.0);
        close(angle_deg(x * 1e200, Vec3::new(1e-200, 1e-200, 0.0)), 45.0);
        close(angle_deg(x, -x), 180.0);
        close(angle_deg(x, x * 3.0), 0.0);
        close(angle_deg(Vec3::splat(1.0), Vec3::new(0.0, 0.0, 1.0)), 54.735_610_317_245_346);
    }

    #[test]
    fn the_smallest_angles_are_kept() {
        let tilt = 1e-9;
        let angle = angle_deg(Vec3::new(0.0, 0.0, 1.0), Vec3::new(tilt, 0.0, 1.0));
        assert!((angle / tilt.to_degrees() - 1.0).abs() < 1e-14, "{angle:e}");
    }

    #[test]
    fn it_is_symmetric_and_has_no_value_without_a_direction() {
        let (a, b) = (Vec3::new(0.1, -0.7, 0.3), Vec3::new(-0.2, 0.5, 0.9));
        assert_eq!(angle_deg(a, b), angle_deg(b, a));
        assert!(angle_deg(a, Vec3::splat(0.0)).is_nan());
        assert!(angle_deg(Vec3::new(f64::NAN, 0.0, 1.0), b).is_nan());
        assert!(angle_deg(Vec3::new(f64::INFINITY, 0.0, 1.0), b).is_nan());
    }

    #[test]
    fn pictures_are_compared_where_both_have_something() {
        let mut a = Image::new(2, 2, [0.0, 0.0, 1.0, 1.0]).unwrap();
        let mut b = a.clone();
        a.pixels_mut()[1] = [0.0, 1.0, 0.0, 1.0];
        a.pixels_mut()[2] = [0.0; 4];
        b.pixels_mut()[3] = [0.0; 4];
        let error = angular_error(&a, &b).unwrap();
        assert_eq!(error.values()[..2], [0.0, 90.0]);
        assert!(error.values()[2..].iter().all(|v| v.is_nan()));
    }

    #[test]
    fn other_sizes_are_named() {
        let (a, b) = (Image::new(2, 3, [0.0; 4]).unwrap(), Image::new(4, 5, [0.0; 4]).unwrap());
        let why = angular_error(&a, &b).unwrap_err().to_string();
        assert!(why.contains("2x3") && why.contains("4x5"), "{why}");
    }

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
}
