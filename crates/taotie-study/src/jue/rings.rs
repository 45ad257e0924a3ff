//! The ovals of the belly, divided into columns. Metres; +x points to the spout, y up.

use taotie_engine::math::{Vec3, scalar};

/// The number of columns around the vessel.
pub(super) const COLUMNS: usize = 16;
/// Height and half axes along x and z of the four rings of the belly.
const RINGS: [[f64; 3]; 4] =
    [[0.0875, 0.0240, 0.0208], [0.1000, 0.0322, 0.0280], [0.1190, 0.0342, 0.0293], [0.1400, 0.0330, 0.0283]];

/// Returns the point of column `j` on ring `i`.
pub(super) fn ring_point(i: usize, j: usize) -> Vec3<f64> {
    ellipse(RINGS[i], j)
}

/// Returns the point of column `j` on an ellipse with this height and these half axes along x and z.
pub(super) fn ellipse([y, a, b]: [f64; 3], j: usize) -> Vec3<f64> {
    let (sin, cos) = eighths(j);
    Vec3::new(-a * cos, y, b * sin)
}

/// Returns sine and cosine of j/16 of a turn, mirror-symmetric to the last bit.
fn eighths(j: usize) -> (f64, f64) {
    let j = j % COLUMNS;
    let quarter = |k: usize| scalar::sin(std::f64::consts::PI * k as f64 / 8.0);
    let sin = |j: usize| match j {
        0..=4 => quarter(j),
        5..=8 => quarter(8 - j),
        9..=12 => -quarter(j - 8),
        _ => -quarter(16 - j),
    };
    (if j.is_multiple_of(8) { 0.0 } else { sin(j) }, if j % 8 == 4 { 0.0 } else { sin((j + 4) % COLUMNS) })
}
