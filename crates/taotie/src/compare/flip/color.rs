//! FLIP's colours: the opponent space in which the eye's blur acts, and the distance of two colours.

use crate::compare::lab::{XYZ_FROM_RGB, lab_from_linear, opponent, product};
use crate::math::srgb::linear_from_srgb;
use crate::math::{Vec3, scalar};

/// The exponent q_c and the bend (p_c, p_t) of the scale of differences, §4.1.3.
const EXPONENT: f64 = 0.7;
const BEND: (f64, f64) = (0.4, 0.95);

/// Decodes sRGB colours; the linear values of 8-bit codes are precomputed.
pub struct Decoder {
    /// The linear value of each 8-bit code.
    linear: Vec<f64>,
}

impl Decoder {
    pub fn new() -> Self {
        Self { linear: (0..=255).map(|code| linear_from_srgb(of_code(code).into())).collect() }
    }

    /// Returns the colour in YCxCz, which is CIELAB without its cube root, from one in [0, 1]: §4.1.1.
    pub fn opponent(&self, encoded: [f32; 3]) -> Vec3<f64> {
        opponent(product(&XYZ_FROM_RGB, Vec3::from_array(encoded.map(|v| self.linear(v)))))
    }

    fn linear(&self, encoded: f32) -> f64 {
        let code = (encoded * 255.0 + 0.5) as u8;
        match of_code(code) == encoded {
            true => self.linear[usize::from(code)],
            false => linear_from_srgb(encoded.into()),
        }
    }
}

/// Returns the linear value of an 8-bit code.
fn of_code(code: u8) -> f32 {
    f32::from(code) / 255.0
}

/// Returns L*, and a* and b* adjusted for Hunt's effect, of a colour in YCxCz that is first clamped to the gamut of a
/// screen: §4.1.2.
pub fn hunt_lab_from_opponent(color: Vec3<f64>) -> Vec3<f64> {
    let y = (color.x + 16.0) / 116.0;
    let xyz = Vec3::new(y + color.y / 500.0, y, y - color.z / 200.0);
    hunt_lab_from_rgb(rgb_from_xyz(xyz).map(|v| v.clamp(0.0, 1.0)))
}

/// Returns the distance of two colours: city block in lightness, Euclidean in chroma (HyAB), to the power q_c.
pub fn difference(a: Vec3<f64>, b: Vec3<f64>) -> f64 {
    let d = a - b;
    scalar::pow(d.x.abs() + (d.y * d.y + d.z * d.z).sqrt(), EXPONENT)
}

/// Returns the largest distance that a screen can show: that of its green and its blue.
pub fn largest_difference() -> f64 {
    let [green, blue] = [Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)].map(hunt_lab_from_rgb);
    difference(green, blue)
}

/// Maps a distance to FLIP's scale, [0, 1]: the lower 40 % of `largest` take 95 % of it.
pub fn redistributed(difference: f64, largest: f64) -> f64 {
    let (low, bend) = (BEND.0 * largest, BEND.1);
    match difference < low {
        true => bend / low * difference,
        // Colours are rounded: two that come close to the extremes may be farther apart than the maximum.
        false => (bend + (difference - low) / (largest - low) * (1.0 - bend)).min(1.0),
    }
}

fn hunt_lab_from_rgb(linear: Vec3<f64>) -> Vec3<f64> {
    let lab = lab_from_linear(linear);
    Vec3::new(lab.x, 0.01 * lab.x * lab.y, 0.01 * lab.x * lab.z)
}

/// Linear sRGB from XYZ by Cramer's rule.
fn rgb_from_xyz(v: Vec3<f64>) -> Vec3<f64> {
    let [x, y, z] = XYZ_FROM_RGB;
    let column = |c: usize| Vec3::new(x[c], y[c], z[c]);
    let (r, g, b) = (column(0), column(1), column(2));
    let (gb, br, rg) = (g.cross(b), b.cross(r), r.cross(g));
    Vec3::new(v.dot(gb), v.dot(br), v.dot(rg)) / r.dot(gb)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_a_hundred_and_has_no_hue() {
        let lab = hunt_lab_from_opponent(Decoder::new().opponent([1.0; 3]));
        assert!((lab - Vec3::new(100.0, 0.0, 0.0)).length() < 1e-9, "{lab:?}");
    }

    #[test]
    fn values_of_codes_and_between_them_are_decoded_alike() {
        let decoder = Decoder::new();
        let between = (0..=255u8).map(|code| of_code(code) * 0.999);
        for value in (0..=255).map(of_code).chain(between) {
            assert_eq!(decoder.linear(value), linear_from_srgb(value.into()), "{value}");
        }
    }

    #[test]
    fn the_way_to_the_opponent_space_has_a_way_back() {
        let rgb = Vec3::new(0.9, 0.2, 0.4);
        assert!((rgb_from_xyz(product(&XYZ_FROM_RGB, rgb)) - rgb).length() < 1e-12);
    }

    #[test]
    fn the_scale_has_its_bend_and_its_ends() {
        assert_eq!(redistributed(0.0, 50.0), 0.0);
        assert!((redistributed(20.0, 50.0) - 0.95).abs() < 1e-12);
        assert!((redistributed(50.0, 50.0) - 1.0).abs() < 1e-12);
    }
}
