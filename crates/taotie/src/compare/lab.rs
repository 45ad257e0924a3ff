//! CIE XYZ and CIELAB of linear sRGB.

use crate::math::{Vec3, scalar};

/// Returns CIE XYZ from linear sRGB, white being (1, 1, 1): each row of the matrix divided by its sum.
pub(super) const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [10_135_552.0 / 23_359_437.0, 8_788_810.0 / 23_359_437.0, 4_435_075.0 / 23_359_437.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 80_288_307.0, 8_788_810.0 / 80_288_307.0, 70_074_185.0 / 80_288_307.0],
];

/// Returns L* in [0, 100], a* and b* of a linear RGB colour in [0, 1]; white is (100, 0, 0): ISO/CIE 11664-4.
pub(super) fn lab_from_linear(rgb: Vec3<f64>) -> Vec3<f64> {
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
    fn white_black_and_the_middle_grey_have_their_lightness() {
        let lab = |v: f64| lab_from_linear(Vec3::splat(v));
        assert!((lab(1.0) - Vec3::new(100.0, 0.0, 0.0)).length() < 1e-9, "{:?}", lab(1.0));
        assert!(lab(0.0).length() < 1e-9, "{:?}", lab(0.0));
        // 116 · 0.18^(1/3) − 16.
        assert!((lab(0.18).x - 49.496).abs() < 1e-3, "{:?}", lab(0.18));
    }
}
