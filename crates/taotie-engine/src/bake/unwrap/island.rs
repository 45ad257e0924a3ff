//! UV islands, flattened and as silhouettes: projects them along their axis, cuts them if they would overlap
//! themselves, and finds every cell that they touch.

use super::regions::{NONE, Topology};
use crate::bake::coverage::{ALL_ROWS, Rasterizer};
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
    fn turned(self, topology: &Topology) -> Self {
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

/// Columns from the first, inclusive, to the last, exclusive.
pub(super) type Run = [u32; 2];

/// A silhouette, row by row.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Mask {
    pub width: u32,
    pub rows: Vec<Vec<Run>>,
}

/// Returns a point after clockwise quarter turns.
pub(super) fn quarter_turned([x, y]: [f64; 2], quarters: u8) -> [f64; 2] {
    match quarters % 4 {
        0 => [x, y],
        1 => [-y, x],
        2 => [-x, -y],
        _ => [y, -x],
    }
}

/// Returns the minimum coordinates of triangles after quarter turns: the position of a mask's corner.
pub(super) fn mask_corner(laid: &[[[f64; 2]; 3]], quarters: u8) -> [f64; 2] {
    bounds(laid.iter().flatten().map(|p| quarter_turned(*p, quarters)))[0]
}

impl Mask {
    /// Draws triangles, rotated and with `scale` cells per unit. Gaps in a row no wider than `gap` are filled.
    pub fn new(laid: &[[[f64; 2]; 3]], quarters: u8, scale: f64, gap: u32) -> Self {
        let [low, high] = bounds(laid.iter().flatten().map(|p| quarter_turned(*p, quarters)));
        let cells = |k: usize| ((high[k] - low[k]) * scale).max(0.0) as usize + 1;
        let (width, height) = (cells(0), cells(1));
        let mut rows = vec![Vec::new(); height];
        for triangle in laid {
            let place = |p: [f64; 2]| {
                let [x, y] = quarter_turned(p, quarters);
                [(x - low[0]) * scale, (y - low[1]) * scale]
            };
            touch(triangle.map(place), &mut rows);
        }
        rows.iter_mut().for_each(|row| join(row, gap));
        Self { width: width as u32, rows }
    }

    pub fn height(&self) -> u32 {
        self.rows.len() as u32
    }

    /// Returns the number of cells.
    pub fn cells(&self) -> usize {
        self.rows.iter().flatten().map(|[from, to]| (to - from) as usize).sum()
    }
}

/// Adds the cells that a triangle touches.
fn touch(corners: [[f64; 2]; 3], rows: &mut [Vec<Run>]) {
    let [[_, top], [_, bottom]] = bounds(corners.into_iter());
    let [first, last] = [top, bottom].map(|y| (y.max(0.0) as usize).min(rows.len() - 1));
    for (y, row) in rows.iter_mut().enumerate().take(last + 1).skip(first) {
        let [left, right] = extent(corners, y as f64);
        if left <= right {
            row.push([left.max(0.0) as u32, right.max(0.0) as u32 + 1]);
        }
    }
}

/// Returns the minimum and maximum x of a triangle between y and y + 1.
fn extent(corners: [[f64; 2]; 3], y: f64) -> [f64; 2] {
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    let mut add = |x: f64| range = [range[0].min(x), range[1].max(x)];
    for i in 0..3 {
        let (p, q) = (corners[i], corners[(i + 1) % 3]);
        if p[1] >= y && p[1] <= y + 1.0 {
            add(p[0]);
        }
        for line in [y, y + 1.0] {
            if (p[1] < line) != (q[1] < line) {
                add(p[0] + (q[0] - p[0]) * (line - p[1]) / (q[1] - p[1]));
            }
        }
    }
    range
}

/// Sorts runs and joins those that touch, overlap or have a gap of at most `gap`.
fn join(row: &mut Vec<Run>, gap: u32) {
    row.sort_unstable();
    row.dedup_by(|next, run| {
        let joined = next[0] <= run[1] + gap;
        if joined {
            run[1] = run[1].max(next[1]);
        }
        joined
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_touched_cell_is_in_the_mask() {
        let triangle = [[[0.0, 0.0], [4.0, 0.0], [0.0, 2.0]]];
        let mask = Mask::new(&triangle, 0, 1.0, 0);
        assert_eq!(
            (mask.width, mask.rows.as_slice()),
            (5, [vec![[0, 5]], vec![[0, 3]], vec![[0, 1]]].as_slice())
        );
        let upright = Mask::new(&triangle, 1, 1.0, 0);
        assert_eq!((upright.width, upright.height()), (3, 5));
        assert_eq!(mask_corner(&triangle, 1), [-2.0, 0.0]);
    }

    #[test]
    fn small_gaps_are_filled() {
        let mut row = vec![[5, 6], [0, 2], [1, 3], [9, 10]];
        join(&mut row, 2);
        assert_eq!(row, [[0, 6], [9, 10]]);
    }
}
