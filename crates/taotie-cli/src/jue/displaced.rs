//! The relief as real geometry: the low mesh rounded, subdivided and displaced.
//!
//! Each triangle becomes a cubic patch that touches the vertex normals' planes (Vlachos et al. 2001, "Curved PN
//! triangles"), so that between its relief the surface is as round as the low mesh's smooth shading says. Patches meet
//! without cracks: an edge's curve depends on what both its triangles know, and relief is 0 on chart borders.

use super::DEPTH;
use rayon::prelude::*;
use std::collections::HashMap;
use taotie::math::{Vec2, Vec3};
use taotie::mesh::{Mesh, MeshData};

/// How the vertices of the low mesh coincide.
struct Welds {
    /// For each vertex, the first at the same place.
    place: Vec<u32>,
    /// For each vertex, the first at the same place with the same normal.
    smooth: Vec<u32>,
}

/// The control points of an edge's curve, from the smaller place to the larger.
type Curve = [Vec3<f64>; 4];

/// What the corners of a patch know.
struct Patch<'a> {
    mesh: &'a Mesh,
    welds: &'a Welds,
    corners: [u32; 3],
    /// The curves from corner `i` to corner `i + 1`, in canonical direction.
    curves: [Curve; 3],
}

/// Every triangle of the low mesh split into `subdivisions`², displaced by `height`, normals computed anew.
pub(super) fn mesh(low: &Mesh, subdivisions: u32, height: impl Fn(f32, f32) -> f32 + Sync) -> Mesh {
    let n = subdivisions.max(1) as usize;
    let welds = Welds::new(low);
    let curves = curves(low, &welds);
    let points: Vec<Vec<(Vec3<f64>, Vec2)>> = low
        .triangles()
        .par_iter()
        .map(|corners| Patch::new(low, &welds, &curves, *corners).points(n, &height))
        .collect();
    let positions: Vec<Vec3> = points.iter().flatten().map(|(p, _)| p.to_f32()).collect();
    let count = points_of(n);
    let triangles: Vec<[u32; 3]> =
        (0..points.len()).flat_map(|k| grid(n).map(move |t| t.map(|i| (k * count + i) as u32))).collect();
    let normals = normals(&positions, &triangles, &slots(low, &welds, n));
    let uvs = vec![points.iter().flatten().map(|(_, uv)| *uv).collect()];
    let data = MeshData { positions, normals, uvs, triangles, ..MeshData::default() };
    Mesh::new(data).expect("indices count the points and every point is finite")
}

impl Welds {
    fn new(mesh: &Mesh) -> Self {
        let bits = |v: &Vec3| v.to_array().map(|c| (c + 0.0).to_bits());
        let (mut places, mut normals) = (HashMap::new(), HashMap::new());
        let pairs = mesh.positions().iter().zip(mesh.normals()).enumerate();
        let (place, smooth) = pairs
            .map(|(i, (p, n))| {
                let i = i as u32;
                (*places.entry(bits(p)).or_insert(i), *normals.entry((bits(p), bits(n))).or_insert(i))
            })
            .unzip();
        Self { place, smooth }
    }

    /// The corners of an edge, the smaller place first.
    fn ordered(&self, a: u32, b: u32) -> (u32, u32) {
        if self.place[a as usize] < self.place[b as usize] { (a, b) } else { (b, a) }
    }
}

/// The curve of every edge, by the places of its ends.
fn curves(mesh: &Mesh, welds: &Welds) -> HashMap<(u32, u32), Curve> {
    let mut sides: HashMap<(u32, u32), Vec<[Vec3<f64>; 2]>> = HashMap::new();
    let normal = |i: u32| mesh.normals()[i as usize].to_f64();
    for [a, b, c] in mesh.triangles() {
        for (from, to) in [(*a, *b), (*b, *c), (*c, *a)] {
            let (p, q) = welds.ordered(from, to);
            let key = (welds.place[p as usize], welds.place[q as usize]);
            sides.entry(key).or_default().push([normal(p), normal(q)]);
        }
    }
    let position = |i: u32| mesh.positions()[i as usize].to_f64();
    sides
        .into_iter()
        .map(|((a, b), sides)| {
            let (p, q) = (position(a), position(b));
            let (first, last) = (sides[0], sides[sides.len() - 1]);
            let out = handle(q - p, first[0], last[0]);
            let back = handle(p - q, first[1], last[1]);
            ((a, b), [p, p + out, q + back, q])
        })
        .collect()
}

/// How far a curve's control point may leave its chord, metres: long edges, such as the spout's, stay nearly straight.
const LARGEST_BEND: f64 = 0.0022;

/// A third of the way `d` along a curve whose end has these normals on its two sides.
///
/// Where they agree the way is bent into the tangent plane; at a crease into both planes, along their intersection.
/// Where that leads elsewhere, at tips and corners, the way stays straight.
fn handle(d: Vec3<f64>, n: Vec3<f64>, m: Vec3<f64>) -> Vec3<f64> {
    let crease = n.cross(m);
    let tangent = if crease.length() < 1e-6 {
        d - n * n.dot(d)
    } else {
        let along = crease.normalize();
        let reach = along.dot(d);
        let wayward = reach.abs() < 0.88 * d.length() || crease.length() < 0.3;
        if wayward { d } else { along * reach }
    };
    let bend = (tangent - d) / 3.0;
    let length = bend.length();
    d / 3.0 + if length > LARGEST_BEND { bend * (LARGEST_BEND / length) } else { bend }
}

/// De Casteljau would do; the Bernstein sum is symmetric and short.
fn bezier([a, b, c, d]: &Curve, t: f64) -> Vec3<f64> {
    let s = 1.0 - t;
    *a * (s * s * s) + *b * (3.0 * s * s * t) + *c * (3.0 * s * t * t) + *d * (t * t * t)
}

impl<'a> Patch<'a> {
    fn new(mesh: &'a Mesh, welds: &'a Welds, all: &HashMap<(u32, u32), Curve>, corners: [u32; 3]) -> Self {
        let curves = std::array::from_fn(|i| {
            let (p, q) = welds.ordered(corners[i], corners[(i + 1) % 3]);
            all[&(welds.place[p as usize], welds.place[q as usize])]
        });
        Self { mesh, welds, corners, curves }
    }

    /// The displaced points in the order of [`lattice`].
    fn points(&self, n: usize, height: &(impl Fn(f32, f32) -> f32 + Sync)) -> Vec<(Vec3<f64>, Vec2)> {
        let middle = self.middle();
        lattice(n)
            .map(|weights| {
                let (base, normal, uv) = match edge_of(weights, n) {
                    Some((i, k)) => self.on_edge(i, k, n),
                    None => self.inside(weights.map(|w| w as f64 / n as f64), middle),
                };
                let h = f64::from(height(uv.x, uv.y)) * DEPTH;
                (base + normal.normalize_or(Vec3::splat(0.0)) * h, uv)
            })
            .collect()
    }

    /// The point `k` of `n` steps along the edge from corner `i`; the same bits from both sides.
    fn on_edge(&self, i: usize, k: usize, n: usize) -> (Vec3<f64>, Vec3<f64>, Vec2) {
        let (from, to) = (self.corners[i], self.corners[(i + 1) % 3]);
        let (a, b) = self.welds.ordered(from, to);
        let k = if a == from { k } else { n - k };
        let (s, t) = ((n - k) as f64 / n as f64, k as f64 / n as f64);
        let (normal, uv) = self.blend(&[(a, s), (b, t)]);
        (bezier(&self.curves[i], t), normal, uv)
    }

    fn inside(&self, w: [f64; 3], middle: Vec3<f64>) -> (Vec3<f64>, Vec3<f64>, Vec2) {
        let mut p = middle * (6.0 * w[0] * w[1] * w[2]);
        for i in 0..3 {
            let next = (i + 1) % 3;
            let [near, far] = self.handles(i);
            p += self.position(i) * (w[i] * w[i] * w[i]);
            p += (near * w[i] + far * w[next]) * (3.0 * w[i] * w[next]);
        }
        let (normal, uv) =
            self.blend(&[(self.corners[0], w[0]), (self.corners[1], w[1]), (self.corners[2], w[2])]);
        (p, normal, uv)
    }

    /// The middle control point: the mean of the edges' ones, moved half as far again from the corners' mean.
    fn middle(&self) -> Vec3<f64> {
        let (mut handles, mut corners) = (Vec3::splat(0.0), Vec3::splat(0.0));
        for i in 0..3 {
            let [near, far] = self.handles(i);
            handles += near + far;
            corners += self.position(i);
        }
        let mean = handles / 6.0;
        mean + (mean - corners / 3.0) * 0.5
    }

    /// The inner control points of the edge from corner `i`, the one near that corner first.
    fn handles(&self, i: usize) -> [Vec3<f64>; 2] {
        let [_, p, q, _] = self.curves[i];
        let (first, _) = self.welds.ordered(self.corners[i], self.corners[(i + 1) % 3]);
        if first == self.corners[i] { [p, q] } else { [q, p] }
    }

    fn position(&self, i: usize) -> Vec3<f64> {
        self.mesh.positions()[self.corners[i] as usize].to_f64()
    }

    /// Normal and uv as a renderer interpolates them.
    fn blend(&self, weights: &[(u32, f64)]) -> (Vec3<f64>, Vec2) {
        let (mut normal, mut u, mut v) = (Vec3::splat(0.0), 0.0, 0.0);
        for (i, w) in weights {
            let i = *i as usize;
            let uv = self.mesh.uvs()[0][i];
            normal += self.mesh.normals()[i].to_f64() * *w;
            u += f64::from(uv.x) * w;
            v += f64::from(uv.y) * w;
        }
        (normal, Vec2::new(u as f32, v as f32))
    }
}

/// How many points a patch has.
fn points_of(n: usize) -> usize {
    (n + 1) * (n + 2) / 2
}

/// The whole weights (they sum to `n`) of a patch's points, row by row from corner 0.
fn lattice(n: usize) -> impl Iterator<Item = [usize; 3]> {
    (0..=n).flat_map(move |row| (0..=row).map(move |k| [n - row, row - k, k]))
}

/// The place of a point in [`lattice`]'s order.
fn index([_, b, c]: [usize; 3]) -> usize {
    let row = b + c;
    row * (row + 1) / 2 + c
}

/// The small triangles of a patch, oriented as it is.
fn grid(n: usize) -> impl Iterator<Item = [usize; 3]> {
    (0..n).flat_map(move |row| {
        (0..=row).flat_map(move |k| {
            let (a, b, c) = (n - row, row - k, k);
            let up = [index([a, b, c]), index([a - 1, b + 1, c]), index([a - 1, b, c + 1])];
            let down =
                (b > 0).then(|| [index([a, b, c]), index([a - 1, b, c + 1]), index([a, b - 1, c + 1])]);
            std::iter::once(up).chain(down)
        })
    })
}

/// The edge a lattice point lies on, as its first corner and the steps from there.
fn edge_of([a, b, c]: [usize; 3], n: usize) -> Option<(usize, usize)> {
    if c == 0 {
        Some((0, b))
    } else if a == 0 {
        Some((1, c))
    } else if b == 0 {
        Some((2, n - c))
    } else {
        None
    }
}

/// For every point, which points it shares its normal with: all have the same number.
fn slots(low: &Mesh, welds: &Welds, n: usize) -> Vec<u32> {
    let mut shared: HashMap<(u32, u32, usize), u32> = HashMap::new();
    let mut next = 0;
    let mut slots = Vec::with_capacity(low.triangles().len() * points_of(n));
    for corners in low.triangles() {
        for weights in lattice(n) {
            let key =
                edge_of(weights, n).map(|(i, k)| edge_key(welds, corners[i], corners[(i + 1) % 3], k, n));
            let fresh = next;
            let slot = match key {
                Some(key) => *shared.entry(key).or_insert(fresh),
                None => fresh,
            };
            next += u32::from(slot == fresh);
            slots.push(slot);
        }
    }
    slots
}

/// What names a point of an edge from both sides, and a corner from all.
fn edge_key(welds: &Welds, from: u32, to: u32, k: usize, n: usize) -> (u32, u32, usize) {
    let (a, b) = (welds.smooth[from as usize], welds.smooth[to as usize]);
    match k {
        0 => (a, a, 0),
        _ if k == n => (b, b, 0),
        _ if a < b => (a, b, k),
        _ => (b, a, n - k),
    }
}

/// Vertex normals weighted by area, shared as `slots` says.
fn normals(positions: &[Vec3], triangles: &[[u32; 3]], slots: &[u32]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::splat(0.0); positions.len()];
    for triangle in triangles {
        let [p, q, r] = triangle.map(|i| positions[i as usize].to_f64());
        let n = (q - p).cross(r - p);
        for i in triangle {
            sums[slots[*i as usize] as usize] += n;
        }
    }
    slots.iter().map(|slot| sums[*slot as usize].normalize_or(Vec3::new(0.0, 1.0, 0.0)).to_f32()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lattice_and_index_agree() {
        for n in [1, 2, 5] {
            assert!(lattice(n).enumerate().all(|(i, w)| index(w) == i && w.iter().sum::<usize>() == n));
            assert_eq!(lattice(n).count(), points_of(n));
            assert_eq!(grid(n).count(), n * n);
        }
    }
}
