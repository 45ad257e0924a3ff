//! The relief as geometry: the low-poly mesh rounded, subdivided and displaced.
//!
//! Each triangle becomes a cubic patch tangent to the planes of the vertex normals (Vlachos et al. 2001, "Curved PN
//! triangles"), so that the surface without relief is as round as the smooth shading of the low-poly mesh suggests.
//! Patches meet without cracks: the curve of an edge depends only on data shared by both triangles, and relief is 0
//! on UV island borders.
//!
//! A patch is split until its triangles follow the relief. Every decision depends only on a single edge, so that
//! neighbouring patches agree.

use super::relief::DEPTH;
use super::rounded::{Patch, Point, Rounded, WHOLE, Weights, Welds, edge_of};
use rayon::prelude::*;
use std::collections::HashMap;
use taotie_engine::math::Vec3;
use taotie_engine::mesh::{Mesh, MeshData};

/// Returns the low-poly mesh with every triangle split and displaced by `height`, and the normals of the displaced
/// surface; see [`Split`].
pub(super) fn mesh(low: &Mesh, finest: f64, height: impl Fn(f32, f32) -> f32 + Sync) -> Mesh {
    let welds = Welds::new(low);
    let Rounded { patches, .. } = Rounded::new(low, &welds);
    let split = |patch: &Patch<'_>| Split::new(patch, finest, &height).run();
    let pieces: Vec<Piece> = patches.par_iter().map(split).collect();
    let normals = shared(pieces.iter().flat_map(|piece| &piece.points), &slots(&patches, &pieces));
    let points = || pieces.iter().flat_map(|piece| &piece.points);
    let data = MeshData {
        positions: points().map(|point| point.position.to_f32()).collect(),
        normals,
        uvs: vec![points().map(|point| point.uv).collect()],
        triangles: joined(&pieces),
        ..MeshData::default()
    };
    Mesh::new(data).expect("indices are in range and all points are finite")
}

/// Returns the triangles of all pieces, with their points concatenated.
fn joined(pieces: &[Piece]) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    let mut first = 0;
    for piece in pieces {
        triangles.extend(piece.triangles.iter().map(|t| t.map(|i| i + first)));
        first += piece.points.len() as u32;
    }
    triangles
}

/// Returns a slot for every point; points that share their normal have the same slot.
fn slots(patches: &[Patch<'_>], pieces: &[Piece]) -> Vec<u32> {
    let mut shared: HashMap<(u32, u32, u32), u32> = HashMap::new();
    let mut next = 0;
    let mut slots = Vec::new();
    for (patch, piece) in patches.iter().zip(pieces) {
        for point in &piece.points {
            let fresh = next;
            let slot = match edge_of(point.weights) {
                Some((i, k)) => *shared.entry(patch.edge_key(i, k)).or_insert(fresh),
                None => fresh,
            };
            next += u32::from(slot == fresh);
            slots.push(slot);
        }
    }
    slots
}

/// Returns the mean normal of all points with the same slot.
fn shared<'a>(points: impl Iterator<Item = &'a Point>, slots: &[u32]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::splat(0.0); slots.len()];
    for (point, slot) in points.zip(slots) {
        sums[*slot as usize] += point.normal;
    }
    slots.iter().map(|slot| sums[*slot as usize].normalize_or(Vec3::new(0.0, 1.0, 0.0)).to_f32()).collect()
}

/// The maximum edge length on surfaces without relief, metres.
const PLAIN: f64 = 0.0008;

/// An edge follows the relief if they deviate by less than this fraction of its length: kinks stay below about 3°.
const SLACK: f64 = 0.0125;

/// Points along an edge at which the relief is sampled, in quarters of the edge.
const PROBES: [u32; 3] = [1, 2, 3];

/// A split patch.
struct Piece {
    /// Its points.
    points: Vec<Point>,
    /// Its triangles, as indices into `points`, with the orientation of the patch.
    triangles: Vec<[u32; 3]>,
}

/// A patch being split: edges longer than [`PLAIN`] always, and edges from which the relief deviates if they are
/// longer than `finest`, metres.
struct Split<'a, H> {
    patch: &'a Patch<'a>,
    finest: f64,
    height: &'a H,
    indices: HashMap<Weights, u32>,
    piece: Piece,
}

impl<'a, H: Fn(f32, f32) -> f32> Split<'a, H> {
    /// Creates the initial state.
    fn new(patch: &'a Patch<'a>, finest: f64, height: &'a H) -> Self {
        let piece = Piece { points: Vec::new(), triangles: Vec::new() };
        Self { patch, finest, height, indices: HashMap::new(), piece }
    }

    /// Splits until every edge is short enough.
    fn run(mut self) -> Piece {
        let mut waiting = vec![[[WHOLE, 0, 0], [0, WHOLE, 0], [0, 0, WHOLE]]];
        while let Some(triangle) = waiting.pop() {
            let long = [0, 1, 2].map(|i| self.is_long(triangle[i], triangle[(i + 1) % 3]));
            match parts(triangle, long) {
                Some(parts) => waiting.extend(parts),
                None => {
                    let triangle = triangle.map(|weights| self.index(weights));
                    self.piece.triangles.push(triangle);
                }
            }
        }
        self.piece
    }

    fn is_long(&self, a: Weights, b: Weights) -> bool {
        let halves = (0..3).all(|i| (a[i] + b[i]).is_multiple_of(8));
        let length = self.patch.distance(a, b);
        halves && (length > PLAIN || length > self.finest && self.leaves(a, b, length))
    }

    /// Returns true if the relief between two points deviates from the straight line.
    fn leaves(&self, a: Weights, b: Weights, length: f64) -> bool {
        let height = |weights: Weights| {
            let uv = self.patch.uv(weights);
            f64::from((self.height)(uv.x, uv.y)) * DEPTH
        };
        let (from, to) = (height(a), height(b));
        PROBES.iter().any(|k| {
            let t = f64::from(*k) / 4.0;
            let probe = std::array::from_fn(|i| (a[i] * (4 - k) + b[i] * k) / 4);
            (height(probe) - from * (1.0 - t) - to * t).abs() > SLACK * length
        })
    }

    fn index(&mut self, weights: Weights) -> u32 {
        let next = self.piece.points.len() as u32;
        let index = *self.indices.entry(weights).or_insert(next);
        if index == next {
            self.piece.points.push(self.patch.point(weights, self.height));
        }
        index
    }
}

/// Splits a triangle by halving its long edges (edge `i` starts at corner `i`); `None` if there are none.
fn parts([a, b, c]: [Weights; 3], long: [bool; 3]) -> Option<Vec<[Weights; 3]>> {
    let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
    match long {
        [false, false, false] => None,
        [true, true, true] => Some(vec![[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]),
        [true, false, false] => Some(vec![[a, ab, c], [ab, b, c]]),
        [true, true, false] => Some(vec![[ab, b, bc], [a, ab, bc], [a, bc, c]]),
        // The other cases are rotations of these.
        [x, y, z] => parts([b, c, a], [y, z, x]),
    }
}

fn middle(a: Weights, b: Weights) -> Weights {
    std::array::from_fn(|i| (a[i] + b[i]) / 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_cover_the_triangle_and_keep_its_orientation() {
        let corners = [[WHOLE, 0, 0], [0, WHOLE, 0], [0, 0, WHOLE]];
        let area = |[a, b, c]: [Weights; 3]| {
            let w = |p: Weights| [f64::from(p[0]), f64::from(p[1])];
            let ([ax, ay], [bx, by], [cx, cy]) = (w(a), w(b), w(c));
            (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        };
        for bits in 1..8 {
            let long = [bits & 1 != 0, bits & 2 != 0, bits & 4 != 0];
            let parts = parts(corners, long).unwrap();
            assert_eq!(parts.len(), 1 + long.iter().filter(|l| **l).count());
            assert!(parts.iter().all(|part| area(*part) * area(corners) > 0.0));
            assert_eq!(parts.iter().map(|part| area(*part)).sum::<f64>(), area(corners));
        }
        assert!(parts(corners, [false; 3]).is_none());
    }
}
