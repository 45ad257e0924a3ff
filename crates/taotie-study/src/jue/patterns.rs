//! The patterns around the masks: thunder ground, rows of ringlets, banana-leaf blades. Millimetres.
//!
//! They and the masks are drawn with the same cross-sections: height as a smooth function of distance, so that
//! normals are continuous.

/// Half the side of a thunder cell.
const HALF_CELL: f32 = 2.45;
/// A square spiral in half cells, from the outside inwards.
const SPIRAL: [[f32; 2]; 10] = [
    [-0.8, -0.8],
    [0.8, -0.8],
    [0.8, 0.8],
    [-0.8, 0.8],
    [-0.8, -0.4],
    [0.4, -0.4],
    [0.4, 0.4],
    [-0.4, 0.4],
    [-0.4, 0.0],
    [0.05, 0.0],
];

/// The thunder pattern (leiwen): square spirals, each the mirror image of its neighbours. In [0, 1].
pub(super) fn thunder(x: f32, y: f32, half_cell: f32) -> f32 {
    let (x, y) = (x / half_cell, y / half_cell);
    let (i, j) = ((x * 0.5).floor(), (y * 0.5).floor());
    let odd = |k: f32| k - 2.0 * (k * 0.5).floor() != 0.0;
    let (cx, cy) = (x - 2.0 * i - 1.0, y - 2.0 * j - 1.0);
    let (cx, cy) = (if odd(i) { -cx } else { cx }, if odd(j) { -cy } else { cy });
    bump(spiral_distance(cx, cy), 0.2)
}

/// The distance to the spiral in half cells. Its segments are axis-aligned, so clamping finds the nearest point.
fn spiral_distance(x: f32, y: f32) -> f32 {
    let mut nearest = 4.0;
    for pair in SPIRAL.windows(2) {
        let ([ax, ay], [bx, by]) = (pair[0], pair[1]);
        let dx = x - x.clamp(ax.min(bx), ax.max(bx));
        let dy = y - y.clamp(ay.min(by), ay.max(by));
        let squared = dx * dx + dy * dy;
        if squared < nearest {
            nearest = squared;
        }
    }
    nearest.sqrt()
}

/// The thunder ground of the belly.
pub(super) fn belly_thunder(x: f32, y: f32) -> f32 {
    thunder(x, y, HALF_CELL)
}

/// A border of height 4.4: two raised bands with a row of ringlets between them. `y` is measured from its centre.
pub(super) fn ringlets(x: f32, y: f32) -> f32 {
    const PERIOD: f32 = 48.4 / 16.0;
    let band = 0.46 * plateau(((y.abs() - 1.95).abs()) - 0.26, 1.0, 0.34);
    let from_center = x - PERIOD * (x / PERIOD + 0.5).floor();
    let radius = (from_center * from_center + y * y).sqrt();
    let ring = 0.42 * bump(radius - 0.82, 0.40);
    let pearl = 0.42 * smooth(1.0 - radius / 0.45);
    band + ring + pearl
}

/// The distance to the edge of an upright leaf with half width `foot` at its base, y = 0, and the given `height`.
pub(super) fn leaf_distance(x: f32, y: f32, foot: f32, height: f32) -> f32 {
    let t = (y / height).clamp(0.0, 1.2);
    let half = foot * (1.0 - t) * (1.0 + 0.55 * t);
    let slope = foot / height;
    let side = (x.abs() - half) / (1.0 + slope * slope).sqrt();
    if side > -y { side } else { -y }
}

/// A blade drawn as nested outlines.
pub(super) fn blade(distance: f32) -> f32 {
    let body = plateau(distance, 0.46, 0.4);
    let furrow = 0.30 * bump(distance + 1.0, 0.42);
    let second = 0.26 * bump(distance + 2.25, 0.40);
    body - furrow - second
}

/// 0 below 0, 1 above 1, 3t² − 2t³ between.
pub(super) fn smooth(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// `level` inside (negative distance), 0 outside, with a bevel of `width` centred on the edge. Millimetres.
pub(super) fn plateau(distance: f32, level: f32, width: f32) -> f32 {
    level * smooth(0.5 - distance / width)
}

/// 1 at offset 0, falling smoothly to 0 at `half_width` on both sides.
pub(super) fn bump(offset: f32, half_width: f32) -> f32 {
    smooth(1.0 - offset.abs() / half_width)
}

/// A hemisphere over radius [0, 1], flattened at the base: a cheap alternative to the smooth (1 − r²)^1.5.
pub(super) fn dome(radius: f32) -> f32 {
    let t = (1.0 - radius * radius).max(0.0);
    t * t * (1.5 - 0.5 * t)
}

/// A triangle wave of period 1: 0 at whole numbers and 0.5 halfway between.
pub(super) fn from_whole(t: f32) -> f32 {
    (t - (t + 0.5).floor()).abs()
}
