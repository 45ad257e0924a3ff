//! The location of each part of the vessel in the unit square of uvs (origin top left), and the ovals of the belly,
//! whose arc lengths divide its strip.
//!
//! ```text
//! ┌──────────────────────────────────────┐
//! │ legs: outer faces, inner faces │inner │
//! │                                │cup   │
//! │┐  ┌────────┐  ┌──────┐  posts  handle┌│
//! ││  │bottom  │  │spout │               ││   ← tail, split by the seam
//! │└──┴────────┴──┘      └───────────────┘│
//! │ neck: blades                          │
//! │ belly: mask band, once around         │
//! └──────────────────────────────────────┘
//! ```
//!
//! The belly takes up the most space: 5 uv units per metre, 0.1 mm per texel at 2048.

use taotie_engine::math::{Vec2, Vec3, scalar};

/// uv units per metre on the belly strip; patterns there are drawn in millimetres at this nominal scale.
pub(super) const STRIP_SCALE: f64 = STRIP_WIDTH / 0.1936;
/// The left edge of the strip, column 0.
pub(super) const STRIP_LEFT: f64 = 0.012;
/// The width of the strip.
pub(super) const STRIP_WIDTH: f64 = 0.976;
/// The lower edge of the strip, row 0.
pub(super) const STRIP_BOTTOM: f64 = 0.988;
/// Nominal heights of the strip's rows above its lower edge, metres; the last is the mouth of the spout.
pub(super) const STRIP_ROWS: [f64; 6] = [0.0, 0.0155, 0.0345, 0.056, 0.078, 0.1335];
/// The nominal height of the tip of the tail, metres.
pub(super) const TAIL_TIP: f64 = 0.111;

/// The scale of the bottom's disk.
pub(super) const BOTTOM_SCALE: f64 = 4.4;
/// The middle of the bottom's disk.
pub(super) const BOTTOM_CENTER: Vec2<f64> = Vec2::new(0.222, 0.462);
/// The scale of the interior's disk.
pub(super) const INSIDE_SCALE: f64 = 2.45;
/// The point at which the vessel's axis meets the interior's UV island.
pub(super) const INSIDE_CENTER: Vec2<f64> = Vec2::new(0.728, 0.112);
/// The centres of the UV islands of the two posts.
pub(super) const POST_CENTERS: [Vec2<f64>; 2] = [Vec2::new(0.690, 0.360), Vec2::new(0.690, 0.500)];
/// Half the side of a post's UV island.
pub(super) const POST_RADIUS: f64 = 0.056;
/// The fraction of a post's UV island that its cap fills.
pub(super) const CAP_FRACTION: f64 = 0.47;
/// The centre of the handle's UV island.
pub(super) const HANDLE_CENTER: Vec2<f64> = Vec2::new(0.846, 0.470);
/// Half the side of the handle's UV island.
pub(super) const HANDLE_RADIUS: f64 = 0.088;
/// uv units per metre along a leg.
pub(super) const LEG_SCALE: f64 = 2.75;
/// The top centres of the legs' outer faces.
pub(super) const LEG_OUTER: [Vec2<f64>; 3] =
    [Vec2::new(0.042, 0.015), Vec2::new(0.106, 0.015), Vec2::new(0.170, 0.015)];
/// The top centres of the legs' pairs of inner faces.
pub(super) const LEG_INNER: [Vec2<f64>; 3] =
    [Vec2::new(0.252, 0.015), Vec2::new(0.351, 0.015), Vec2::new(0.450, 0.015)];

/// Returns the u of column `j` (0 ..= 16) of the strip, proportional to the arc length around the belly.
pub(super) fn strip_u(j: usize) -> f64 {
    let lengths: Vec<f64> =
        (0..COLUMNS).map(|k| (ring_point(2, k + 1) - ring_point(2, k)).length()).collect();
    let total: f64 = lengths.iter().sum();
    STRIP_LEFT + STRIP_WIDTH * lengths[..j].iter().sum::<f64>() / total
}

/// Returns the v at a nominal height above the strip's lower edge, metres.
pub(super) fn strip_v(height: f64) -> f64 {
    STRIP_BOTTOM - height * STRIP_SCALE
}

/// The number of columns around the vessel.
pub(super) const COLUMNS: usize = 16;
/// Height and half axes along x and z of the four rings of the belly. Metres; +x points to the spout, y up.
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
