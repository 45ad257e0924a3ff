//! The relief of the whole vessel as a function of uv.

use super::atlas;
use super::mask::{HALF_WIDTH, HEIGHT, Mask};
use super::patterns::{
    belly_thunder, blade, bump, from_whole, leaf_distance, plateau, ringlets, smooth, thunder,
};
use std::sync::LazyLock;
use taotie_engine::math::{Vec2, scalar};

/// The displacement from the low mesh for a [`height`] of 1, metres.
pub const DEPTH: f64 = 0.0012;

/// The height of the mask panel's lower edge above that of the strip, nominal millimetres.
const PANEL_BOTTOM: f32 = 14.2;
/// The centre lines of the borders below and above the panel.
const BORDERS: [f32; 2] = [PANEL_BOTTOM - 2.6, PANEL_BOTTOM + HEIGHT + 2.6];
/// The base of the blades on the neck.
const BLADES: f32 = PANEL_BOTTOM + HEIGHT + 5.6;
/// Half the width of a flange.
const FLANGE: f32 = 1.35;

/// The drawings used by [`height`], prepared once.
static RELIEF: LazyLock<Relief> = LazyLock::new(Relief::new);

/// Returns the relief at a uv in [0, 1]², as a fraction of [`DEPTH`] in [0, 1]. It is continuous, and 0 at the
/// borders of UV islands.
pub fn height(u: f32, v: f32) -> f32 {
    RELIEF.height(u, v)
}

/// The height field.
#[derive(Debug)]
struct Relief {
    mask: Mask,
}

impl Relief {
    /// Prepares the drawings.
    pub fn new() -> Self {
        Self { mask: Mask::new() }
    }

    /// Returns the height in [0, 1] at a uv; 0 at and outside the borders of UV islands.
    pub fn height(&self, u: f32, v: f32) -> f32 {
        let scale = 1000.0 / atlas::STRIP_SCALE as f32;
        let (x, y) = ((u - atlas::STRIP_LEFT as f32) * scale, (atlas::STRIP_BOTTOM as f32 - v) * scale);
        // Distance along the belly from the seam at the tail, in either direction.
        let from_tail = if x < 2.0 * HALF_WIDTH { x } else { 4.0 * HALF_WIDTH - x };
        let height = match part_at(u, v, from_tail, y) {
            Part::Strip => self.strip(from_tail, y),
            Part::Leg(leg) => leg_face(leg, u, v),
            Part::Bottom => mould_seams(u, v),
            Part::Cap(post) => whorl(post, u, v),
            Part::Plain => 0.0,
        };
        height.clamp(0.0, 1.0)
    }

    /// The belly, the neck, and the undersides of spout and tail; both panels are the same.
    fn strip(&self, from_tail: f32, y: f32) -> f32 {
        let seam = smooth((from_tail - 0.25) / 0.9);
        if y < BLADES - 0.8 {
            seam * self.belly(from_tail - HALF_WIDTH, y)
        } else {
            seam * neck(from_tail, y - BLADES)
        }
    }

    /// The belly, with `x` measured from the nose and positive towards the spout.
    fn belly(&self, x: f32, y: f32) -> f32 {
        let borders = ringlets(x, y - BORDERS[0]) + ringlets(x, y - BORDERS[1]);
        let (in_panel, fade) = (y - PANEL_BOTTOM, 0.5);
        let inside = smooth(in_panel / fade) * smooth((HEIGHT - in_panel) / fade);
        let (mask, nearest) = self.mask.height(x, in_panel);
        let flange = flange(x, in_panel).max(flange(x - HALF_WIDTH, in_panel));
        let clear = nearest.min(x.abs() - FLANGE).min(HALF_WIDTH - FLANGE - x);
        let ground = 0.27 * belly_thunder(x, in_panel + 0.3) * smooth((clear - 0.28) / 0.35);
        borders.max(inside * mask.max(ground)).max(flange)
    }
}

/// A scored ridge along x = 0 with the height of the panel.
fn flange(x: f32, y: f32) -> f32 {
    let end = smooth((y + 0.4) / 0.8) * smooth((HEIGHT + 0.4 - y) / 0.8);
    let score = 0.30 * bump(y - 4.1 * (y / 4.1).floor() - 2.05, 0.5) * smooth((x.abs() - 0.2) / 0.4);
    end * plateau(x.abs() - FLANGE, 1.0 - score, 0.55)
}

/// The blades of the neck, and the long ones under spout and tail. `y` is measured from their base.
fn neck(from_tail: f32, y: f32) -> f32 {
    const PERIOD: f32 = 12.0;
    let from_nose = from_tail - HALF_WIDTH;
    let x = from_nose - PERIOD * (from_nose / PERIOD + 0.5).floor();
    let small = leaf_distance(x, y, 5.4, 17.5);
    let tail = leaf_distance(from_tail, y, 8.2, 44.0);
    let spout_x = 2.0 * HALF_WIDTH - from_tail;
    let spout = leaf_distance(spout_x, y, 13.0, 66.0);
    let only_small = from_nose > -42.0 && from_nose < 30.0;
    let mut height = 0.0_f32;
    if only_small {
        height = height.max(blade(small));
    }
    let long = |d: f32, x: f32, y: f32| {
        let inner = smooth((-d - 3.1) / 0.5);
        blade(d).max(0.0) - 0.46 * inner + inner * (0.27 * thunder(x, y, 1.9) + 0.1)
    };
    height.max(long(tail, from_tail, y)).max(long(spout, spout_x, y))
}

/// The kinds of UV islands with regard to relief.
enum Part {
    Strip,
    Leg(usize),
    Bottom,
    Cap(usize),
    Plain,
}

fn part_at(u: f32, v: f32, from_tail: f32, y: f32) -> Part {
    let spout = 2.0 * HALF_WIDTH - from_tail < 23.4 && y < 134.0;
    let tail = from_tail < 11.2 * (111.0 - y) / 33.0;
    if from_tail >= 0.0 && y >= 0.0 && (y < 78.0 || spout || tail) {
        return Part::Strip;
    }
    let within = |c: Vec2<f64>, radius: f64| {
        let (x, y) = (f64::from(u) - c.x, f64::from(v) - c.y);
        x * x + y * y < radius * radius
    };
    if let Some(leg) = atlas::LEG_OUTER.iter().position(|c| (f64::from(u) - c.x).abs() < 0.030 && v < 0.31) {
        return Part::Leg(leg);
    }
    if let Some(post) = atlas::POST_CENTERS.iter().position(|c| within(*c, atlas::POST_RADIUS)) {
        return Part::Cap(post);
    }
    if within(atlas::BOTTOM_CENTER, 0.12) { Part::Bottom } else { Part::Plain }
}

/// A hanging blade on the outer face of a leg, filled with a fine thunder pattern.
fn leg_face(leg: usize, u: f32, v: f32) -> f32 {
    let top = atlas::LEG_OUTER[leg];
    let x = (u - top.x as f32) * (1000.0 / (atlas::LEG_SCALE * 1.1)) as f32;
    let down = (v - top.y as f32) * (1000.0 / atlas::LEG_SCALE) as f32;
    let d = leaf_distance(x, down - 15.0, 6.6, 74.0);
    let edge = 0.40 * plateau((d + 0.9).abs() - 0.45, 1.0, 0.4);
    let fill = 0.22 * thunder(x, down, 1.7) * smooth((-d - 1.7) / 0.4);
    edge + fill
}

/// Three low ridges left by the joints of the mould on the bottom, between the legs.
fn mould_seams(u: f32, v: f32) -> f32 {
    let c = atlas::BOTTOM_CENTER;
    let scale = (1000.0 / atlas::BOTTOM_SCALE) as f32;
    let (x, z) = ((u - c.x as f32) * scale, (c.y as f32 - v) * scale);
    let radius = (x * x + z * z).sqrt();
    let half_root_3 = 0.866_025_4_f32;
    let mut height = 0.0_f32;
    // Towards +z, and at ±120 degrees from it between the other legs.
    for (dx, dz) in [(0.0, 1.0), (half_root_3, -0.5), (-half_root_3, -0.5)] {
        let (along, across) = (x * dx + z * dz, x * dz - z * dx);
        height = height.max(0.26 * bump(across, 0.8) * smooth((along + 0.6) / 0.6));
    }
    height * smooth((17.5 - radius) / 3.0)
}

/// The whorl on a post's cap: a button and curved spokes between two rings.
fn whorl(post: usize, u: f32, v: f32) -> f32 {
    let c = atlas::POST_CENTERS[post];
    let (x, y) = (f64::from(u) - c.x, f64::from(v) - c.y);
    let radius = ((x * x + y * y).sqrt() / (atlas::POST_RADIUS * atlas::CAP_FRACTION)) as f32;
    let button = 0.5 * smooth((0.20 - radius) / 0.08);
    let ring = 0.38 * bump(radius - 0.30, 0.07) + 0.38 * bump(radius - 0.76, 0.07);
    let turn = scalar::atan2(y, x) as f32 / std::f32::consts::TAU;
    let wave = from_whole(5.0 * turn + 1.1 * radius);
    let inside = smooth((radius - 0.34) / 0.06) * smooth((0.72 - radius) / 0.06);
    button + ring + 0.36 * inside * smooth((0.30 - wave) / 0.14)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jue::low_mesh;
    use std::collections::HashMap;

    #[test]
    fn relief_is_flat_at_the_borders_of_islands() {
        let mesh = low_mesh();
        let mut count: HashMap<(u32, u32), u32> = HashMap::new();
        let edges = |t: &[u32; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
        for (a, b) in mesh.triangles().iter().flat_map(edges) {
            *count.entry((a.min(b), a.max(b))).or_default() += 1;
        }
        let uv = |i: u32| mesh.uvs()[0][i as usize];
        for ((a, b), _) in count.iter().filter(|(_, count)| **count == 1) {
            for k in 0..=200 {
                let t = k as f32 / 200.0;
                let p = uv(*a) + (uv(*b) - uv(*a)) * t;
                assert_eq!(height(p.x, p.y), 0.0, "at uv {p:?}");
            }
        }
    }

    #[test]
    fn relief_is_continuous_and_within_its_range() {
        let mut highest = 0.0_f32;
        for i in 0..400_000_u32 {
            let (u, v) = ((i % 1000) as f32 / 1000.0 + 3e-4, (i / 1000) as f32 / 400.0 + 2e-4);
            let h = height(u, v);
            assert!((0.0..=1.0).contains(&h));
            // No bevel is steeper than 1 per 0.15 mm; 2e-5 in u is 4 micrometres on the belly.
            assert!((height(u + 2e-5, v) - h).abs() < 0.1, "a step at {u} {v}");
            highest = highest.max(h);
        }
        assert!(highest > 0.9);
    }

    #[test]
    fn both_faces_bear_the_same_mask_mirrored_about_its_nose() {
        let [front, back] = [4, 12].map(atlas::strip_u);
        let mut lit = 0;
        for i in 0..2000 {
            let x = (i % 50) as f64 * 0.0043;
            let v = atlas::strip_v(0.016 + (i / 50) as f64 * 0.0008);
            let at = |u: f64| height(u as f32, v as f32);
            let h = at(front + x);
            // Bevels are slightly offset by f32 uvs.
            assert!((at(front - x) - h).abs() < 0.02 || x > 0.215, "left and right differ at {x} {v}");
            assert!((at(back - x) - h).abs() < 0.02, "front and back differ at {x} {v}");
            lit += usize::from(h > 0.5);
        }
        assert!((500..1500).contains(&lit), "{lit} of 2000 samples are raised");
    }
}
