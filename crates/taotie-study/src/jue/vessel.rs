//! The cup with spout and tail: outside, bottom and inside. Metres; +x points to the spout, y up, −z to the handle.
//!
//! The outside is a grid with columns around the cup and rows upwards. Columns 0 (the tail, −x) to 16 (the same
//! place, at the uv seam) pass +z at column 4, the spout at 8 and the handle at 12. The five columns around the spout
//! continue to a sixth row, its mouth; the column of the tail ends in the tail's tip.

use super::atlas::{self, COLUMNS, ellipse, ring_point};
use super::builder::{Builder, ROUND, Smooth};
use taotie_engine::math::{Vec2, Vec3};

/// Outside and bottom.
const OUTSIDE: Smooth = ROUND;
/// Lip and inside.
const INSIDE: Smooth = Smooth(1);
/// The lowest points of the outside and of the inside.
const POLES: [f64; 2] = [0.0798, 0.0875];
/// Row 4 for columns 0 to 8: the keel of the tail, the rim, half of the spout's section; mirrored in z for the rest.
const ROW_4: [[f64; 3]; 9] = [
    [-0.0470, 0.1630, 0.0],
    [-0.0470, 0.1730, 0.0135],
    [-0.0300, 0.1665, 0.0245],
    [-0.0150, 0.1618, 0.0302],
    [0.0010, 0.1602, 0.0320],
    [0.0185, 0.1622, 0.0290],
    [0.0430, 0.1705, 0.0165],
    [0.0442, 0.1572, 0.0128],
    [0.0450, 0.1500, 0.0],
];
/// The mouth of the spout for columns 6 to 8.
const MOUTH: [[f64; 3]; 3] = [[0.0955, 0.1915, 0.0120], [0.0985, 0.1795, 0.0098], [0.0995, 0.1725, 0.0]];
/// The tip of the tail.
const TAIL: [f64; 3] = [-0.0790, 0.1860, 0.0];
/// The inner edge of the lip for columns 1 to 6; `ROW_4` is its outer edge.
const LIP: [[f64; 3]; 6] = [
    [-0.0466, 0.1732, 0.0103],
    [-0.0283, 0.1667, 0.0221],
    [-0.0142, 0.1620, 0.0273],
    [0.0010, 0.1604, 0.0291],
    [0.0176, 0.1624, 0.0262],
    [0.0422, 0.1707, 0.0136],
];
/// The inner edge of the mouth for columns 6 to 8.
const LIP_MOUTH: [[f64; 3]; 3] = [[0.0950, 0.1917, 0.0091], [0.0972, 0.1812, 0.0072], [0.0980, 0.1753, 0.0]];
/// The inner edge at the tail's tip.
const LIP_TAIL: [f64; 3] = [-0.0742, 0.1853, 0.0];
/// The inside floor of the spout, columns 7 and 8 next to row 4.
const FLOOR: [[f64; 3]; 2] = [[0.0442, 0.1598, 0.0095], [0.0450, 0.1535, 0.0]];
/// A point on the spout's floor between its root and mouth.
const FLOOR_MIDDLE: [f64; 3] = [0.0715, 0.1630, 0.0];
/// The inside floor of the tail.
const TAIL_FLOOR: [f64; 3] = [-0.0455, 0.1665, 0.0];
/// The height and half axes of the inner ring.
const INNER_RING: [f64; 3] = [0.1400, 0.0296, 0.0252];

/// Returns the entry for any column from a table of columns 0 to 8 (or `first` to 8).
fn mirrored(table: &[[f64; 3]], first: usize, j: usize) -> Vec3<f64> {
    let j = j % COLUMNS;
    let (k, side) = if j <= 8 { (j, 1.0) } else { (COLUMNS - j, -1.0) };
    let [x, y, z] = table[k - first];
    Vec3::new(x, y, z * side)
}

/// Adds the vessel: 92 vertices outside, 17 on the bottom, 50 inside.
pub(super) fn add(b: &mut Builder) {
    add_outside(b);
    add_bottom(b);
    add_inside(b);
}

fn add_outside(b: &mut Builder) {
    let rows: Vec<Vec<usize>> =
        (0..5).map(|i| (0..=COLUMNS).map(|j| strip_vertex(b, i, j)).collect()).collect();
    for pair in rows.windows(2) {
        for j in 0..COLUMNS {
            b.quad([pair[0][j], pair[0][j + 1], pair[1][j + 1], pair[1][j]], j >= COLUMNS / 2);
        }
    }
    let mouth: Vec<usize> = (6..=10).map(|j| strip_vertex(b, 5, j)).collect();
    for k in 0..4 {
        b.quad([rows[4][k + 6], rows[4][k + 7], mouth[k + 1], mouth[k]], k >= 2);
    }
    for (seam, neighbour) in [(0, 1), (COLUMNS, COLUMNS - 1)] {
        let uv = Vec2::new(atlas::strip_u(seam), atlas::strip_v(atlas::TAIL_TIP));
        let tip = b.vertex(Vec3::from_array(TAIL), uv, OUTSIDE);
        b.triangle([rows[4][seam], rows[4][neighbour], tip]);
    }
}

fn strip_vertex(b: &mut Builder, row: usize, j: usize) -> usize {
    let position = match row {
        0..=3 => ring_point(row, j),
        4 => mirrored(&ROW_4, 0, j),
        _ => mirrored(&MOUTH, 6, j),
    };
    let uv = Vec2::new(atlas::strip_u(j), atlas::strip_v(atlas::STRIP_ROWS[row]));
    b.vertex(position, uv, OUTSIDE)
}

fn add_bottom(b: &mut Builder) {
    let uv = |p: Vec3<f64>| {
        let c = atlas::BOTTOM_CENTER;
        Vec2::new(c.x + p.x * atlas::BOTTOM_SCALE, c.y - p.z * atlas::BOTTOM_SCALE)
    };
    let pole = Vec3::new(0.0, POLES[0], 0.0);
    let pole = b.vertex(pole, uv(pole), OUTSIDE);
    let ring: Vec<usize> = (0..COLUMNS)
        .map(|j| {
            let p = ring_point(0, j);
            b.vertex(p, uv(p), OUTSIDE)
        })
        .collect();
    for j in 0..COLUMNS {
        b.triangle([pole, ring[j], ring[(j + 1) % COLUMNS]]);
    }
}

/// Adds a vertex of the interior. Its UV island is a plan of the vessel with distances from the axis times `spread`.
fn inside_vertex(b: &mut Builder, p: Vec3<f64>, spread: f64) -> usize {
    let c = atlas::INSIDE_CENTER;
    let scale = atlas::INSIDE_SCALE * spread;
    b.vertex(p, Vec2::new(c.x + p.x * scale, c.y + p.z * scale), INSIDE)
}

/// Returns a loop in column order: rim 1–6, mouth 6–10, rim 10–15, tip of the tail.
fn rim_loop(rim: &[[f64; 3]], first: usize, mouth: &[[f64; 3]], tail: [f64; 3]) -> Vec<Vec3<f64>> {
    let mut points: Vec<Vec3<f64>> = (1..=6).map(|j| mirrored(rim, first, j)).collect();
    points.extend((6..=10).map(|j| mirrored(mouth, 6, j)));
    points.extend((10..=15).map(|j| mirrored(rim, first, j)));
    points.push(Vec3::from_array(tail));
    points
}

fn add_inside(b: &mut Builder) {
    let inner = rim_loop(&LIP, 1, &LIP_MOUTH, LIP_TAIL);
    let outer = rim_loop(&ROW_4, 0, &MOUTH, TAIL);
    let lip: Vec<usize> = inner.iter().map(|p| inside_vertex(b, *p, 1.0)).collect();
    let edge: Vec<usize> = (0..outer.len()).map(|k| edge_vertex(b, outer[k], &lip, k)).collect();
    for k in 0..lip.len() {
        let next = (k + 1) % lip.len();
        b.quad([edge[k], edge[next], lip[next], lip[k]], k < lip.len() / 2);
    }
    let ring: Vec<usize> = (0..8).map(|k| inside_vertex(b, ellipse(INNER_RING, 2 * k), 0.62)).collect();
    let pole = inside_vertex(b, Vec3::new(0.0, POLES[1], 0.0), 1.0);
    for k in 0..8 {
        b.triangle([pole, ring[k], ring[(k + 1) % 8]]);
    }
    add_floors(b, &lip, &ring);
    add_walls(b, &lip, &ring);
}

/// Adds a vertex of the outer edge of the lip, offset from its inner edge in the UV island to make room for the lip.
fn edge_vertex(b: &mut Builder, p: Vec3<f64>, lip: &[usize], k: usize) -> usize {
    let at = |i: usize| b.uv(lip[(i + lip.len()) % lip.len()]);
    let (here, before, after) = (at(k), at(k + lip.len() - 1), at(k + 1));
    let along = (unit(after - here), unit(here - before));
    let sum = along.0 + along.1;
    // The columns run clockwise in the UV island (u right, v down), so outward is to the right of their direction.
    let out = unit(Vec2::new(-sum.y, sum.x));
    b.vertex(p, here + out * 0.010, INSIDE)
}

fn unit(v: Vec2<f64>) -> Vec2<f64> {
    v * (1.0 / (v.x * v.x + v.y * v.y).sqrt())
}

/// Adds the floors of spout and tail. `lip` is a [`rim_loop`]; `ring` contains every second column.
fn add_floors(b: &mut Builder, lip: &[usize], ring: &[usize]) {
    let [near, low, far] = [7, 8, 9].map(|j| inside_vertex(b, mirrored(&FLOOR, 7, j), 1.0));
    let middle = inside_vertex(b, Vec3::from_array(FLOOR_MIDDLE), 1.0);
    for side in [[lip[5], lip[6], lip[7], near], [lip[11], lip[10], lip[9], far]] {
        b.triangle([side[0], side[1], side[3]]);
        b.triangle([side[1], side[2], side[3]]);
        b.triangle([side[2], middle, side[3]]);
        b.triangle([side[3], middle, low]);
        b.triangle([side[2], lip[8], middle]);
    }
    for (edge, floor, corner) in [(lip[5], near, ring[3]), (lip[11], far, ring[5])] {
        b.triangle([edge, floor, corner]);
        b.triangle([floor, low, ring[4]]);
        b.triangle([floor, ring[4], corner]);
    }
    let tail = inside_vertex(b, Vec3::from_array(TAIL_FLOOR), 1.0);
    for (edge, corner) in [(lip[0], ring[1]), (lip[16], ring[7])] {
        b.triangle([edge, tail, lip[17]]);
        b.triangle([edge, corner, tail]);
        b.triangle([tail, corner, ring[0]]);
    }
}

/// Adds the walls between the lip and the ring, on both sides.
fn add_walls(b: &mut Builder, lip: &[usize], ring: &[usize]) {
    for (rim, low) in [([0, 1, 2, 3, 4, 5], [1, 2, 3]), ([16, 15, 14, 13, 12, 11], [7, 6, 5])] {
        let (rim, low) = (rim.map(|k| lip[k]), low.map(|k| ring[k]));
        for (x, y, z) in [
            (rim[0], rim[1], low[0]),
            (rim[1], rim[2], low[0]),
            (rim[2], low[1], low[0]),
            (rim[2], rim[3], low[1]),
            (rim[3], rim[4], low[1]),
            (rim[4], low[2], low[1]),
            (rim[4], rim[5], low[2]),
        ] {
            b.triangle([x, y, z]);
        }
    }
}
