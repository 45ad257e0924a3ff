//! Flattens UV islands: projects them along their axis, and cuts them if they would overlap themselves.

use super::topology::{NONE, Topology};
use crate::bake::raster::{ALL_ROWS, Rasterizer};
use crate::math::{Vec2, Vec3, scalar};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::FRAC_PI_2;

/// Maximum number of texels on which a UV island is drawn to search it for overlaps.
const MOST_TEXELS: f64 = (1u64 << 22) as f64;
/// Approximate maximum number of pieces into which a UV island is cut for being too long.
const MOST_PIECES: f64 = 8.0;
/// Number of angles between 0 and 90° that are tried for the smallest box.
const ANGLES: usize = 32;

/// Triangles that are laid out together.
#[derive(Debug, Clone)]
pub(super) struct Island {
    pub triangles: Vec<u32>,
    /// The unit direction along which it is seen.
    axis: Vec3<f64>,
    /// A corner's position on the UV island is its product with each of these. The total area is preserved.
    right: Vec3<f64>,
    down: Vec3<f64>,
}

impl Island {
    /// Makes the UV island of triangles projected along a unit axis.
    fn seen(topology: &Topology, triangles: Vec<u32>, axis: Vec3<f64>) -> Self {
        let (mut own, mut seen) = (0.0, 0.0);
        for t in &triangles {
            own += topology.areas[*t as usize];
            seen += topology.areas[*t as usize] * topology.normals[*t as usize].dot(axis).abs();
        }
        // Stretching is limited.
        let scale = (own / seen.max(own * 0.04)).sqrt();
        let right = axis.any_perpendicular();
        Self { triangles, axis, right: right * scale, down: -axis.cross(right) * scale }
    }

    /// Returns the position of a corner, right and down.
    pub fn place(&self, corner: Vec3<f64>) -> [f64; 2] {
        [corner.dot(self.right), corner.dot(self.down)]
    }

    /// Returns the flattened triangles.
    pub fn laid(&self, topology: &Topology) -> Vec<[[f64; 2]; 3]> {
        self.triangles.iter().map(|t| topology.corners[*t as usize].map(|p| self.place(p))).collect()
    }

    /// Cuts the UV island in two, each part closer to one of two of its triangles.
    pub fn cut(self, topology: &Topology, pair: [u32; 2], measure: &Measure) -> Vec<Self> {
        let parts = split(topology, &self.triangles, pair);
        parts.into_iter().flat_map(|part| flatten(topology, part, self.axis, measure)).collect()
    }

    /// Returns the longer side of its box.
    fn length(&self, topology: &Topology) -> f64 {
        let [low, high] = bounds(self.laid(topology).into_iter().flatten());
        (high[0] - low[0]).max(high[1] - low[1])
    }

    /// Returns the UV island rotated so that its axis-aligned box is small.
    pub fn turned(self, topology: &Topology) -> Self {
        let laid = self.laid(topology);
        let (mut best, mut chosen) = (f64::INFINITY, [1.0, 0.0]);
        for i in 0..ANGLES {
            let angle = FRAC_PI_2 * i as f64 / ANGLES as f64;
            let [c, s] = [scalar::cos(angle), scalar::sin(angle)];
            let turned = |[x, y]: [f64; 2]| [c * x - s * y, s * x + c * y];
            let [low, high] = bounds(laid.iter().flatten().map(|p| turned(*p)));
            let area = (high[0] - low[0]) * (high[1] - low[1]);
            if area < best {
                (best, chosen) = (area, [c, s]);
            }
        }
        let [c, s] = chosen;
        let (right, down) = (self.right * c - self.down * s, self.right * s + self.down * c);
        Self { right, down, ..self }
    }
}

/// Returns the minimum and maximum coordinates.
pub(super) fn bounds(points: impl Iterator<Item = [f64; 2]>) -> [[f64; 2]; 2] {
    points.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], p| {
        [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
    })
}

/// The sizes that determine how UV islands are split.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measure {
    /// Texels per unit in the search for overlaps.
    pub density: f64,
    /// The maximum side of a UV island's box, in units.
    pub longest: f64,
}

/// Returns the UV islands of triangles projected along an axis: one, or several if one would overlap itself or be too
/// long.
pub(super) fn flatten(
    topology: &Topology,
    triangles: Vec<u32>,
    axis: Vec3<f64>,
    measure: &Measure,
) -> Vec<Island> {
    let (mut waiting, mut flat) = (vec![triangles], Vec::new());
    // Thread-like shapes stay in a few pieces, however long they are.
    let mut longest = measure.longest;
    while let Some(triangles) = waiting.pop() {
        let island = Island::seen(topology, triangles, axis);
        if let Some(pair) = overlap(topology, &island, measure.density) {
            waiting.extend(split(topology, &island.triangles, pair));
            continue;
        }
        let island = island.turned(topology);
        longest = longest.max(island.length(topology) / MOST_PIECES);
        match far_ends(topology, &island, longest) {
            Some(pair) => waiting.extend(split(topology, &island.triangles, pair)),
            None => flat.push(island),
        }
    }
    flat
}

/// Returns two triangles that overlap each other.
fn overlap(topology: &Topology, island: &Island, density: f64) -> Option<[u32; 2]> {
    if island.triangles.len() < 2 {
        return None;
    }
    let laid = island.laid(topology);
    let [low, high] = bounds(laid.iter().flatten().copied());
    let size = [high[0] - low[0], high[1] - low[1]].map(|v| v.max(1e-9));
    let density = density.min((MOST_TEXELS / (size[0] * size[1])).sqrt());
    let texels = size.map(|v| ((v * density).ceil() as u32).clamp(1, 1 << 14));
    let uv = |p: &[f64; 2]| Vec2::new(((p[0] - low[0]) / size[0]) as f32, ((p[1] - low[1]) / size[1]) as f32);
    let uvs: Vec<Vec2> = laid.iter().flatten().map(uv).collect();
    let triangles: Vec<[u32; 3]> = (0..laid.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let rasterizer = Rasterizer::new(&triangles, &uvs, texels).ok()?;
    let mut owners = vec![NONE; texels[0] as usize * texels[1] as usize];
    for t in 0..triangles.len() {
        let mut other = NONE;
        rasterizer.spans(t, ALL_ROWS, |y, [from, to]| {
            for x in from..=to {
                // A corner at the far end may be rounded into the next texel.
                let at = (y as usize).min(texels[1] as usize - 1) * texels[0] as usize
                    + (x as usize).min(texels[0] as usize - 1);
                match owners[at] {
                    NONE => owners[at] = t as u32,
                    owner => other = owner,
                }
            }
        });
        if other != NONE {
            return Some([island.triangles[other as usize], island.triangles[t]]);
        }
    }
    None
}

/// Returns two triangles at the ends of a UV island whose box is longer than `longest`.
fn far_ends(topology: &Topology, island: &Island, longest: f64) -> Option<[u32; 2]> {
    let laid = island.laid(topology);
    let [low, high] = bounds(laid.iter().flatten().copied());
    let axis = usize::from(high[1] - low[1] > high[0] - low[0]);
    if high[axis] - low[axis] <= longest {
        return None;
    }
    let middle = |i: &usize| laid[*i].iter().map(|p| p[axis]).sum::<f64>();
    let first = (0..laid.len()).min_by(|a, b| middle(a).total_cmp(&middle(b)))?;
    let last = (0..laid.len()).max_by(|a, b| middle(a).total_cmp(&middle(b)))?;
    (first != last).then_some([first, last].map(|i| island.triangles[i]))
}

/// Returns the triangles in two parts, each closer over the surface to one of two of them.
fn split(topology: &Topology, triangles: &[u32], seeds: [u32; 2]) -> [Vec<u32>; 2] {
    let mut sorted = triangles.to_vec();
    sorted.sort_unstable();
    let mut sides = vec![NONE; sorted.len()];
    let mut claims: BinaryHeap<Reverse<(u64, u32, u32)>> =
        seeds.iter().zip(0..).map(|(seed, side)| Reverse((0, *seed, side))).collect();
    while let Some(Reverse((cost, triangle, side))) = claims.pop() {
        let Ok(i) = sorted.binary_search(&triangle) else { continue };
        if sides[i] != NONE {
            continue;
        }
        sides[i] = side;
        let t = triangle as usize;
        for neighbour in topology.neighbours[t].into_iter().filter(|neighbour| *neighbour != NONE) {
            let way = (topology.centres[t] - topology.centres[neighbour as usize]).length();
            claims.push(Reverse(((f64::from_bits(cost) + way).to_bits(), neighbour, side)));
        }
    }
    let part = |wanted: u32| {
        let mine = |side: u32| if side == NONE { wanted == 0 } else { side == wanted };
        sorted.iter().zip(&sides).filter(|(_, side)| mine(**side)).map(|(t, _)| *t).collect()
    };
    [part(0), part(1)]
}
