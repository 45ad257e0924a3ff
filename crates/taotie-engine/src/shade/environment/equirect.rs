//! The equirectangular image itself: the position of a direction in it, and the radiance from there.

use super::texels::{HalfTexels, MAX_RADIANCE, bilinear};
use crate::image::Image;
use crate::math::{Lane, Number, Vec3, poly, scalar};
use crate::parallel;
use std::f32::consts::PI;

/// An equirectangular image.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Equirect {
    width: usize,
    height: usize,
    texels: HalfTexels,
}

/// The position of a unit direction in the image: u and v in [0, 1] from the top left, u = ½ at +x and ¾ at +z.
pub(super) fn uv_of<L: Number>(direction: Vec3<L>) -> [L; 2] {
    let Vec3 { x, y, z } = direction;
    // Near the poles, the arc cosine of y would lose half of the digits.
    let polar = L::angle((x * x + z * z).sqrt(), y);
    picture_uv(L::angle(z, x), polar)
}

/// [`uv_of`] for many directions at a time, with the same bits.
#[inline(always)]
pub(super) fn uv_of_lanes<L: Lane>(direction: Vec3<L>) -> [L; 2] {
    let Vec3 { x, y, z } = direction;
    let polar = poly::angle((x * x + z * z).sqrt(), y);
    picture_uv(poly::angle(z, x), polar)
}

/// The position in an equirectangular image, [0, 1]² from the top left: `azimuth` is atan2(z, x), in [−π, π], and
/// `polar` the angle from +y, in [0, π].
#[inline(always)]
pub fn picture_uv<L: Lane>(azimuth: L, polar: L) -> [L; 2] {
    let (turns, half) = (azimuth.lit(f64::from(0.5 / PI)), azimuth.lit(0.5));
    [azimuth * turns + half, polar / polar.lit(f64::from(PI))]
}

/// The texels around a position in an equirectangular image: columns and rows, integers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PicturePosition<L> {
    /// The left column.
    pub left: L,
    /// The right column; wraps from the last to the first.
    pub right: L,
    /// The upper row.
    pub top: L,
    /// The lower row.
    pub bottom: L,
    /// The weight of the right column, [0, 1].
    pub across: L,
    /// The weight of the lower row, [0, 1].
    pub down: L,
}

impl<L: Lane> PicturePosition<L> {
    /// Finds the texels around `uv` in [0, 1]² of an image of `size` texels, whose centres are one apart.
    #[inline(always)]
    pub fn of([u, v]: [L; 2], [width, height]: [L; 2]) -> Self {
        let (zero, half, one) = (u.lit(0.0), u.lit(0.5), u.lit(1.0));
        // Shifted by one column, so that truncation rounds down.
        let x = u * width + half;
        let y = (v * height - half).max(zero).min(height - one);
        let (next, top) = (x.floor(), y.floor());
        Self {
            left: L::select(next.lt(one), width - one, next - one),
            right: L::select(next.lt(width), next, zero),
            top,
            bottom: (top + one).min(height - one),
            across: x - next,
            down: y - top,
        }
    }
}

/// The direction with the azimuth of `u` and the height `y`.
pub(super) fn direction_at(u: f64, y: f64) -> Vec3 {
    let azimuth = (u - 0.5) * std::f64::consts::TAU;
    let radius = (1.0 - y * y).max(0.0).sqrt();
    Vec3::new(radius * scalar::cos(azimuth), y, radius * scalar::sin(azimuth)).to_f32()
}

impl Equirect {
    /// Encodes an image whose texels were [`repaired`].
    pub(super) fn new(image: &Image) -> Self {
        let (width, height) = (image.width() as usize, image.height() as usize);
        Self { width, height, texels: HalfTexels::encode(image.pixels()) }
    }

    /// Creates the image from stored texels, `width` · `height` of them.
    pub(super) fn from_texels(width: usize, height: usize, texels: HalfTexels) -> Self {
        Self { width, height, texels }
    }

    pub(super) fn texels(&self) -> &HalfTexels {
        &self.texels
    }

    pub(super) fn width(&self) -> usize {
        self.width
    }

    pub(super) fn height(&self) -> usize {
        self.height
    }

    /// The texel in column `x` of row `y`, linear RGB.
    #[inline(always)]
    pub(super) fn texel(&self, x: usize, y: usize) -> Vec3 {
        self.texels.get(y * self.width + x)
    }

    /// The radiance from the direction at u and v in [0, 1], linear RGB: bilinear interpolation of the four texels
    /// around it.
    #[inline(always)]
    pub(super) fn radiance_at<L: Number>(&self, uv: [L; 2]) -> Vec3<L> {
        let size = [uv[0].lit(self.width as f64), uv[0].lit(self.height as f64)];
        let at = PicturePosition::of(uv, size);
        let [left, right] = [at.left.index(), at.right.index()];
        let [top, bottom] = [at.top.index() * self.width, at.bottom.index() * self.width];
        let texels = [
            self.number(top + left, uv[0]),
            self.number(top + right, uv[0]),
            self.number(bottom + left, uv[0]),
            self.number(bottom + right, uv[0]),
        ];
        bilinear(texels, [at.across, at.down])
    }

    /// Texel `i` as numbers of the type of `like`.
    #[inline(always)]
    fn number<L: Number>(&self, i: usize, like: L) -> Vec3<L> {
        let Vec3 { x, y, z } = self.texels.get(i);
        Vec3::new(like.lit(f64::from(x)), like.lit(f64::from(y)), like.lit(f64::from(z)))
    }
}

/// Replaces texels that light cannot have, and counts them: negative numbers and NaN become 0, infinite ones become
/// 65504, the largest half float, or the largest number of the image if that is more.
pub(super) fn repaired(image: &mut Image) -> usize {
    let sound = |v: f32| (0.0..=MAX_RADIANCE).contains(&v);
    let pixels = image.pixels();
    if parallel::count(pixels.len(), |i| !pixels[i][..3].iter().all(|v| sound(*v))) == 0 {
        return 0;
    }
    let largest = |most: f32, v: f32| if sound(v) && v > most { v } else { most };
    let brightest = image.pixels().iter().flat_map(|p| &p[..3]).fold(65_504.0, |most, v| largest(most, *v));
    let mut count = 0;
    for texel in image.pixels_mut() {
        if texel[..3].iter().all(|v| sound(*v)) {
            continue;
        }
        count += 1;
        for v in &mut texel[..3] {
            *v = match *v {
                v if v > MAX_RADIANCE && v.is_finite() => MAX_RADIANCE,
                f32::INFINITY => brightest,
                v if sound(v) => v,
                _ => 0.0,
            };
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_lie_where_the_convention_says() {
        let close = |d: Vec3, u: f32, v: f32| {
            let [fu, fv] = uv_of(d);
            assert!((fu - u).abs() < 1e-6 && (fv - v).abs() < 1e-6, "{d:?}: {fu} {fv}");
            let back = direction_at(f64::from(u), f64::from(d.y));
            assert!((back - d).length() < 1e-6, "{d:?}: {back:?}");
        };
        close(Vec3::new(1.0, 0.0, 0.0), 0.5, 0.5);
        close(Vec3::new(0.0, 0.0, 1.0), 0.75, 0.5);
        close(Vec3::new(0.0, 0.0, -1.0), 0.25, 0.5);
        close(Vec3::new(0.6, 0.8, 0.0), 0.5, 0.204_832_76);
        assert_eq!(uv_of(Vec3::new(0.0f32, 1.0, 0.0))[1], 0.0);
        assert_eq!(uv_of(Vec3::new(0.0f32, -1.0, 0.0))[1], 1.0);
    }

    #[test]
    fn texels_meet_across_the_seam_and_stop_at_the_poles() {
        let mut image = Image::new(4, 2, [0.0; 4]).unwrap();
        for (i, pixel) in image.pixels_mut().iter_mut().enumerate() {
            *pixel = [i as f32, 0.0, 0.0, 1.0];
        }
        let picture = Equirect::new(&image);
        let red = |u: f32, v: f32| picture.radiance_at([u, v]).x;
        assert!((red(0.125, 0.25) - 0.0).abs() < 1e-5 && (red(0.875, 0.75) - 7.0).abs() < 1e-5);
        assert!((red(0.0, 0.25) - 1.5).abs() < 1e-5 && (red(1.0, 0.25) - 1.5).abs() < 1e-5);
        assert!((red(0.125, 0.01) - 0.0).abs() < 1e-5 && (red(0.125, 0.5) - 2.0).abs() < 1e-5);
    }

    #[test]
    fn what_no_light_can_be_is_repaired_and_counted() {
        let mut image = Image::new(5, 1, [1.0; 4]).unwrap();
        image.pixels_mut()[0] = [f32::NAN, 2.0, -1.0, 1.0];
        image.pixels_mut()[1] = [f32::INFINITY, 3e38, 0.5, 1.0];
        image.pixels_mut()[2] = [f32::NEG_INFINITY, -0.0, 0.0, 1.0];
        image.pixels_mut()[3] = [1e5, 0.0, 0.0, f32::NAN];
        assert_eq!(repaired(&mut image), 3);
        assert_eq!(image.pixels()[0][..3], [0.0, 2.0, 0.0]);
        assert_eq!(image.pixels()[1][..3], [1e5, MAX_RADIANCE, 0.5]);
        assert_eq!(image.pixels()[2][..3], [0.0, 0.0, 0.0]);
    }
}
