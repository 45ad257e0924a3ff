//! The perceived difference of two colours seen side by side, CIEDE2000, and the colour spaces CIE XYZ and CIELAB of
//! linear sRGB.
//!
//! Sharma, Wu and Dalal, "The CIEDE2000 Color-Difference Formula: Implementation Notes, Supplementary Test Data, and
//! Mathematical Observations", Color Research and Application 30(1), 2005. Equation numbers below are the paper's;
//! the parametric factors k_L, k_C and k_H are 1.

use crate::math::{Vec3, scalar};

/// Returns the difference ΔE00 of two CIELAB colours, at least 0; about 1 is just visible. It is symmetric. NaN if
/// one of them has a NaN.
///
/// ```
/// use taotie_engine::compare::ciede2000;
/// use taotie_engine::math::Vec3;
///
/// let [a, b] = [Vec3::new(50.0, 2.5, 0.0), Vec3::new(73.0, 25.0, -18.0)];
/// assert!((ciede2000(a, b) - 27.1492).abs() < 1e-4);
/// ```
pub fn ciede2000(a: Vec3<f64>, b: Vec3<f64>) -> f64 {
    let scale = red_green_scale((chroma(a) + chroma(b)) / 2.0);
    let [a, b] = [a, b].map(|lab| Polar::of(lab, scale));
    let hues = Hues::of(&a, &b);
    let chroma = (a.chroma + b.chroma) / 2.0;
    let lightness = (b.lightness - a.lightness) / lightness_weight((a.lightness + b.lightness) / 2.0);
    let saturation = (b.chroma - a.chroma) / (1.0 + 0.045 * chroma);
    let half_turn = sin_deg(hues.difference / 2.0);
    let hue = 2.0 * (a.chroma * b.chroma).sqrt() * half_turn / hue_weight(chroma, hues.mean);
    let squared = lightness * lightness
        + saturation * saturation
        + hue * hue
        + rotation(chroma, hues.mean) * saturation * hue;
    // Rounding may make a sum of nothing negative. NaN is kept: it does not mean the same colour.
    if squared <= 0.0 { 0.0 } else { squared.sqrt() }
}

/// Returns the difference ΔE00 of two colours in linear RGB, each first clamped to [0, 1]; see [`ciede2000`]. NaN if
/// one of them is not finite.
pub fn color_difference(a: [f32; 3], b: [f32; 3]) -> f64 {
    if !a.iter().chain(&b).all(|v| v.is_finite()) {
        return f64::NAN;
    }
    if a == b {
        return 0.0;
    }
    let lab = |rgb: [f32; 3]| lab_from_linear(Vec3::from_array(rgb.map(|v| f64::from(v).clamp(0.0, 1.0))));
    ciede2000(lab(a), lab(b))
}

/// A colour in terms of lightness, chroma and hue: L', C' and h'.
struct Polar {
    lightness: f64,
    chroma: f64,
    /// Degrees, [0, 360); 0 for greys.
    hue: f64,
    /// a' and b'.
    direction: [f64; 2],
}

impl Polar {
    /// Equations 5 to 7.
    fn of(lab: Vec3<f64>, scale: f64) -> Self {
        let [x, y] = [lab.y * scale, lab.z];
        let chroma = (x * x + y * y).sqrt();
        let angle = if chroma > 0.0 { scalar::atan2(y, x).to_degrees() } else { 0.0 };
        let hue = if angle < 0.0 { angle + 360.0 } else { angle };
        Self { lightness: lab.x, chroma, hue, direction: [x, y] }
    }

    fn is_grey(&self) -> bool {
        self.chroma == 0.0
    }
}

/// Two hues on their circle, degrees.
struct Hues {
    /// From the first to the second, [-180, 180].
    difference: f64,
    mean: f64,
}

impl Hues {
    /// Equations 10 and 14.
    fn of(a: &Polar, b: &Polar) -> Self {
        let (difference, sum) = (b.hue - a.hue, a.hue + b.hue);
        if a.is_grey() || b.is_grey() {
            return Self { difference: 0.0, mean: sum };
        }
        if !is_beyond_half_a_turn(a, b) {
            return Self { difference, mean: sum / 2.0 };
        }
        Self {
            difference: if difference > 0.0 { difference - 360.0 } else { difference + 360.0 },
            mean: if sum < 360.0 { (sum + 360.0) / 2.0 } else { (sum - 360.0) / 2.0 },
        }
    }
}

/// Returns `true` if the hues differ by more than 180°, by the sign of the sine between them: opposite hues, at which
/// the formula is discontinuous, fall on the same side for any rounding of the angles.
fn is_beyond_half_a_turn(a: &Polar, b: &Polar) -> bool {
    let (low, high) = if a.hue <= b.hue { (a, b) } else { (b, a) };
    let ([x, y], [u, v]) = (low.direction, high.direction);
    x * v - y * u < 0.0
}

/// Returns C*ab: equation 2.
fn chroma(lab: Vec3<f64>) -> f64 {
    (lab.y * lab.y + lab.z * lab.z).sqrt()
}

/// Returns 1 + G, the factor that stretches a* near grey: equations 4 and 5.
fn red_green_scale(chroma: f64) -> f64 {
    1.5 - 0.5 * saturated(chroma)
}

/// Returns √(C⁷ / (C⁷ + 25⁷)), [0, 1).
fn saturated(chroma: f64) -> f64 {
    const START: f64 = 6_103_515_625.0;
    let power = scalar::pow(chroma, 7.0);
    (power / (power + START)).sqrt()
}

/// Returns S_L: equation 18.
fn lightness_weight(lightness: f64) -> f64 {
    let squared = (lightness - 50.0) * (lightness - 50.0);
    1.0 + 0.015 * squared / (20.0 + squared).sqrt()
}

/// Returns S_H: equations 15 and 20.
fn hue_weight(chroma: f64, hue: f64) -> f64 {
    let t = 1.0 - 0.17 * cos_deg(hue - 30.0) + 0.24 * cos_deg(2.0 * hue) + 0.32 * cos_deg(3.0 * hue + 6.0)
        - 0.20 * cos_deg(4.0 * hue - 63.0);
    1.0 + 0.015 * chroma * t
}

/// Returns R_T, the rotation of the ellipses of blue: equations 16, 17 and 21.
fn rotation(chroma: f64, hue: f64) -> f64 {
    let off = (hue - 275.0) / 25.0;
    let turn = 30.0 * scalar::exp(-off * off);
    -sin_deg(2.0 * turn) * 2.0 * saturated(chroma)
}

fn sin_deg(degrees: f64) -> f64 {
    scalar::sin(degrees.to_radians())
}

fn cos_deg(degrees: f64) -> f64 {
    scalar::cos(degrees.to_radians())
}

/// Returns CIE XYZ from linear sRGB, white being (1, 1, 1): each row of the matrix divided by its sum.
pub(super) const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [10_135_552.0 / 23_359_437.0, 8_788_810.0 / 23_359_437.0, 4_435_075.0 / 23_359_437.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 80_288_307.0, 8_788_810.0 / 80_288_307.0, 70_074_185.0 / 80_288_307.0],
];

/// Returns L* in [0, 100], a* and b* of a linear RGB colour in [0, 1]; white is (100, 0, 0): ISO/CIE 11664-4.
pub fn lab_from_linear(rgb: Vec3<f64>) -> Vec3<f64> {
    opponent(product(&XYZ_FROM_RGB, rgb).map(lab_curve))
}

/// Returns CIELAB's combination of X, Y and Z: the achromatic component, red against green, yellow against blue.
pub(super) fn opponent(v: Vec3<f64>) -> Vec3<f64> {
    Vec3::new(116.0 * v.y - 16.0, 500.0 * (v.x - v.y), 200.0 * (v.y - v.z))
}

/// Returns the product of a matrix, row by row, and a column.
pub(super) fn product(matrix: &[[f64; 3]; 3], v: Vec3<f64>) -> Vec3<f64> {
    let row = |[a, b, c]: [f64; 3]| a * v.x + b * v.y + c * v.z;
    Vec3::new(row(matrix[0]), row(matrix[1]), row(matrix[2]))
}

/// Returns the cube root of CIELAB with its linear start: ISO/CIE 11664-4.
fn lab_curve(v: f64) -> f64 {
    const DELTA: f64 = 6.0 / 29.0;
    if v > DELTA * DELTA * DELTA { scalar::cbrt(v) } else { v / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_colors_do_not_differ() {
        for lab in [[50.0, 2.5, 0.0], [0.0, 0.0, 0.0], [22.7, 20.1, -46.7], [99.0, -80.0, 90.0]] {
            assert_eq!(ciede2000(Vec3::from_array(lab), Vec3::from_array(lab)), 0.0, "{lab:?}");
        }
    }

    /// S_L is 1 + 0.015 · 0 at the mean lightness of 50.
    #[test]
    fn black_and_white_are_a_hundred_apart() {
        let difference = color_difference([0.0; 3], [1.0; 3]);
        assert!((difference - 100.0).abs() < 1e-6, "{difference}");
    }

    #[test]
    fn colors_beyond_the_screen_are_those_of_its_edge() {
        assert_eq!(color_difference([9.0, 0.2, 0.1], [1.0, 0.2, 0.1]), 0.0);
        assert_eq!(color_difference([-1.0, 0.2, 0.1], [0.0, 0.2, 0.1]), 0.0);
        assert!(color_difference([0.9, 0.2, 0.1], [1.0, 0.2, 0.1]) > 1.0);
    }
    #[test]
    fn what_is_no_color_is_not_the_same_color() {
        for wrong in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for at in 0..3 {
                let mut color = [0.5; 3];
                color[at] = wrong;
                let both = [color_difference(color, [0.5; 3]), color_difference([0.5; 3], color)];
                assert!(both.iter().all(|d| d.is_nan()), "{color:?}: {both:?}");
                assert!(color_difference(color, color).is_nan());
            }
        }
        assert!(ciede2000(Vec3::splat(f64::NAN), Vec3::splat(1.0)).is_nan());
    }

    #[test]
    fn white_black_and_the_middle_grey_have_their_lightness() {
        let lab = |v: f64| lab_from_linear(Vec3::splat(v));
        assert!((lab(1.0) - Vec3::new(100.0, 0.0, 0.0)).length() < 1e-9, "{:?}", lab(1.0));
        assert!(lab(0.0).length() < 1e-9, "{:?}", lab(0.0));
        // 116 · 0.18^(1/3) − 16.
        assert!((lab(0.18).x - 49.496).abs() < 1e-3, "{:?}", lab(0.18));
    }
}
