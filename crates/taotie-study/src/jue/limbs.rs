//! Legs, posts and handle: closed parts whose ends are hidden in the vessel's wall.

use super::atlas;
use super::builder::{Builder, Smooth};
use taotie_engine::math::{Vec2, Vec3, scalar};

/// The angles of the legs about the axis from +x towards +z, in twelfths of a turn: under the handle, then in front.
const LEG_TWELFTHS: [f64; 3] = [9.0, 1.0, 5.0];
/// Half width, distance from the axis and height of a leg's outer face at its three stations.
const LEG_OUTER: [[f64; 3]; 3] = [[0.0082, 0.0264, 0.1015], [0.0066, 0.0325, 0.0520], [0.0, 0.0430, 0.0]];
/// The distance by which the leg under the handle is closer to the axis, where the oval is narrow.
const LEG_INSET: [f64; 3] = [0.0025, 0.0, 0.0];
/// The distance from the axis and the height of a leg's inner ridge.
const LEG_RIDGE: [[f64; 2]; 2] = [[0.0120, 0.0890], [0.0235, 0.0520]];
/// The base of a post on the rim; the other is mirrored in z.
const POST: [f64; 2] = [0.0290, 0.0222];
/// The half side and height of a post's shaft at the bottom and at the top.
const SHAFT: [[f64; 2]; 2] = [[0.0027, 0.1615], [0.0022, 0.1950]];
/// The radius and height of the cap's edge, and the height of its top.
const CAP: [f64; 3] = [0.0096, 0.1935, 0.2048];
/// The handle's centre line in the plane x = 0: y, −z, and the direction of its outer side as (y, −z).
const HANDLE: [[f64; 4]; 5] = [
    [0.1510, 0.0286, 1.0, 0.0],
    [0.1530, 0.0440, 0.8, 0.6],
    [0.1365, 0.0535, -0.1, 0.995],
    [0.1180, 0.0460, -0.8, 0.6],
    [0.1120, 0.0275, -1.0, 0.0],
];
/// Half width and half thickness of the handle at each station.
const HANDLE_SECTION: [[f64; 2]; 5] =
    [[0.0050, 0.0026], [0.0062, 0.0030], [0.0056, 0.0027], [0.0050, 0.0026], [0.0042, 0.0024]];

/// Adds the legs (36 vertices), the posts (34) and the handle (22).
pub(super) fn add(b: &mut Builder) {
    for leg in 0..3 {
        add_leg(b, leg);
    }
    for (post, side) in [1.0, -1.0].into_iter().enumerate() {
        add_post(b, post, side);
    }
    add_handle(b);
}

/// Returns the point at `across` to the right of the leg's centre, seen from outside, and at `out` from the axis.
fn leg_point(leg: usize, across: f64, out: f64, y: f64) -> Vec3<f64> {
    let angle = std::f64::consts::PI / 6.0 * LEG_TWELFTHS[leg];
    let d = Vec3::new(scalar::cos(angle), 0.0, scalar::sin(angle));
    let right = Vec3::new(d.z, 0.0, -d.x);
    d * (out - LEG_INSET[leg]) + right * across + Vec3::new(0.0, y, 0.0)
}

fn add_leg(b: &mut Builder, leg: usize) {
    let outer = Smooth(10 + leg as u32);
    let inner = Smooth(20 + leg as u32);
    let edge = |k: usize, side: f64| {
        let [half, out, y] = LEG_OUTER[k];
        leg_point(leg, half * side, out, y)
    };
    let down = |y: f64| (LEG_OUTER[0][2] - y) * atlas::LEG_SCALE;
    let face_uv = |p: Vec3<f64>, side: f64, half: f64| {
        let top = atlas::LEG_OUTER[leg];
        Vec2::new(top.x + side * half * atlas::LEG_SCALE * 1.1, top.y + down(p.y))
    };
    let mut face = Vec::new();
    for (k, side) in [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0), (2, 0.0)] {
        let p = edge(k, side);
        face.push(b.vertex(p, face_uv(p, side, LEG_OUTER[k][0]), outer));
    }
    b.quad([face[0], face[1], face[3], face[2]], leg == 1);
    b.triangle([face[2], face[3], face[4]]);
    add_leg_inside(b, leg, inner, edge);
}

/// Adds the two inner faces with the ridge between them; the lid at the top fills the notch above the ridge.
fn add_leg_inside(b: &mut Builder, leg: usize, group: Smooth, edge: impl Fn(usize, f64) -> Vec3<f64>) {
    let top = atlas::LEG_INNER[leg];
    let uv = |across: f64, y: f64| {
        let down = (LEG_OUTER[0][2] - y) * atlas::LEG_SCALE;
        Vec2::new(top.x + across * atlas::LEG_SCALE, top.y + down)
    };
    let ridge = LEG_RIDGE.map(|[out, y]| b.vertex(leg_point(leg, 0.0, out, y), uv(0.0, y), group));
    // Seen from inside, the leg's right edge is on the left.
    let sides = [1.0, -1.0].map(|side| {
        [(0, 0.0155), (1, 0.0095)].map(|(k, width)| {
            let p = edge(k, side);
            b.vertex(p, uv(-side * width, p.y), group)
        })
    });
    let tip = edge(2, 0.0);
    let tip = b.vertex(tip, uv(0.0, tip.y), group);
    for [high, low] in sides {
        b.quad([high, ridge[0], ridge[1], low], false);
        b.triangle([low, ridge[1], tip]);
    }
    b.hidden_triangle([sides[0][0], sides[1][0], ridge[0]]);
}

/// Returns a ring of `count` points around a centre, as offsets in the plane of x and z (and of u and v).
fn ring(count: usize, phase: f64) -> Vec<Vec2<f64>> {
    (0..count)
        .map(|k| {
            let angle = std::f64::consts::TAU * (k as f64 + phase) / count as f64;
            Vec2::new(scalar::cos(angle), scalar::sin(angle))
        })
        .collect()
}

/// Adds a square shaft under a six-sided cone; the UV island is the post seen from above, unrolled.
fn add_post(b: &mut Builder, post: usize, side: f64) {
    let group = Smooth(30 + post as u32);
    let center = atlas::POST_CENTERS[post];
    let mut add = |offset: Vec2<f64>, radius: f64, y: f64, island: Vec2<f64>| {
        let p = Vec3::new(POST[0] + offset.x * radius, y, POST[1] * side + offset.y * radius);
        b.vertex(p, center + island * atlas::POST_RADIUS, group)
    };
    // The square is aligned with the rim, which is at 27 degrees to the x axis here.
    let square = ring(4, 0.5 - side * 0.3);
    let hexagon = ring(6, 0.5 - side * 0.45);
    let apex = add(Vec2::new(0.0, 0.0), 0.0, CAP[2], Vec2::new(0.0, 0.0));
    let cap: Vec<usize> = hexagon.iter().map(|o| add(*o, CAP[0], CAP[1], *o * atlas::CAP_FRACTION)).collect();
    let [foot, head] = [(SHAFT[0], 1.0), (SHAFT[1], 0.73)].map(|([half, y], island)| -> Vec<usize> {
        square.iter().map(|o| add(*o, half * std::f64::consts::SQRT_2, y, *o * island)).collect()
    });
    // The sole is attached to the side from corner 3 to corner 0, so its far corners are copies of 2 and 1.
    let outward = (square[0] + square[3]) * 0.35;
    let [near, far] = [(0, 1), (3, 2)].map(|(hinge, copied)| {
        add(square[copied], SHAFT[0][0] * std::f64::consts::SQRT_2, SHAFT[0][1], square[hinge] + outward)
    });
    for k in 0..6 {
        b.triangle([apex, cap[k], cap[(k + 1) % 6]]);
    }
    stitch(b, &cap, &head);
    for k in 0..4 {
        b.quad([head[k], head[(k + 1) % 4], foot[(k + 1) % 4], foot[k]], side > 0.0);
    }
    b.hidden_triangle([foot[0], foot[3], near]);
    b.hidden_triangle([foot[3], far, near]);
}

/// Fills the UV island between two concentric rings, both in order of ascending angle.
fn stitch(b: &mut Builder, inner: &[usize], outer: &[usize]) {
    let distance = |b: &Builder, i: usize, j: usize| {
        let d = b.uv(i) - b.uv(j);
        d.x * d.x + d.y * d.y
    };
    let nearest = (0..outer.len())
        .min_by(|i, j| distance(b, inner[0], outer[*i]).total_cmp(&distance(b, inner[0], outer[*j])))
        .unwrap_or(0);
    let (mut i, mut j) = (0, 0);
    while i < inner.len() || j < outer.len() {
        let (p, q) = (inner[i % inner.len()], outer[(nearest + j) % outer.len()]);
        let p_next = inner[(i + 1) % inner.len()];
        let q_next = outer[(nearest + j + 1) % outer.len()];
        let step_inside = distance(b, p_next, q) < distance(b, p, q_next);
        if j == outer.len() || (i < inner.len() && step_inside) {
            b.triangle([p, p_next, q]);
            i += 1;
        } else {
            b.triangle([p, q, q_next]);
            j += 1;
        }
    }
}

/// Adds a loop with a square section; the UV island is the loop seen along itself from below, as nested squares.
fn add_handle(b: &mut Builder) {
    let group = Smooth(40);
    let corners = [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)];
    let point = |k: usize, (across, out): (f64, f64)| {
        let ([y, z, dy, dz], [half, thick]) = (HANDLE[k], HANDLE_SECTION[k]);
        Vec3::new(across * half, y + out * thick * dy, -z - out * thick * dz)
    };
    let island = |radius: f64, (x, y): (f64, f64)| {
        atlas::HANDLE_CENTER + Vec2::new(x, y) * (radius * atlas::HANDLE_RADIUS)
    };
    let radii = [0.80, 0.66, 0.49, 0.31, 0.14];
    let rings: Vec<[usize; 4]> =
        (0..5).map(|k| corners.map(|c| b.vertex(point(k, c), island(radii[k], c), group))).collect();
    for pair in rings.windows(2) {
        for k in 0..4 {
            let next = (k + 1) % 4;
            b.quad([pair[0][k], pair[0][next], pair[1][next], pair[1][k]], k >= 2);
        }
    }
    let end = rings[4];
    b.hidden_triangle([end[0], end[1], end[2]]);
    b.hidden_triangle([end[0], end[2], end[3]]);
    // The lid of the upper end is attached to the side of its outer corners.
    let [left, right] =
        [(-1.0, -1.0), (1.0, -1.0)].map(|c| b.vertex(point(0, c), island(1.0, (c.0 * 0.8, 1.0)), group));
    b.hidden_triangle([rings[0][0], rings[0][1], right]);
    b.hidden_triangle([rings[0][0], right, left]);
}
