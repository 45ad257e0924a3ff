//! The relief as real geometry: the low mesh rounded, subdivided and displaced.
//!
//! Each triangle becomes a cubic patch that touches the vertex normals' planes (Vlachos et al. 2001, "Curved PN
//! triangles"), so that between its relief the surface is as round as the low mesh's smooth shading says. Patches meet
//! without cracks: an edge's curve depends on what both its triangles know, and relief is 0 on chart borders.

use super::DEPTH;
use super::split::{Piece, Split};
use rayon::prelude::*;
use std::collections::HashMap;
use taotie::math::{Vec2, Vec3};
use taotie::mesh::{Mesh, MeshData};

/// How the vertices of the low mesh coincide.
pub(super) struct Welds {
    /// For each vertex, the first at the same place.
    place: Vec<u32>,
    /// For each vertex, the first at the same place with the same normal.
    smooth: Vec<u32>,
}

/// The control points of an edge's curve, from the smaller place to the larger.
type Curve = [Vec3<f64>; 4];

/// The weights of a patch's corners in parts of [`WHOLE`], which they sum to: halving stays exact.
pub(super) type Weights = [u32; 3];

/// One, in parts.
pub(super) const WHOLE: u32 = 1 << 16;

/// A point of the displaced surface.
pub(super) struct Point {
    weights: Weights,
    position: Vec3<f64>,
    uv: Vec2,
    normal: Vec3<f64>,
}

/// What the corners of a patch know.
pub(super) struct Patch<'a> {
    mesh: &'a Mesh,
    welds: &'a Welds,
    corners: [u32; 3],
    /// The curves from corner `i` to corner `i + 1`, in canonical direction.
    curves: [Curve; 3],
}

/// Half the length over which slopes are measured, metres: small against the finest lines, large against rounding.
const DELTA: f64 = 8e-6;

/// The low mesh rounded, without relief.
pub(super) struct Rounded<'a> {
    mesh: &'a Mesh,
    patches: Vec<Patch<'a>>,
}

/// Half the step, in weights, over which the rounded mesh is differentiated.
const STEP: f64 = 1e-4;

impl<'a> Rounded<'a> {
    pub fn new(mesh: &'a Mesh, welds: &'a Welds) -> Self {
        let curves = curves(mesh, welds);
        let corners = mesh.triangles().iter();
        Self { mesh, patches: corners.map(|corners| Patch::new(mesh, welds, &curves, *corners)).collect() }
    }

    /// The weights of a triangle's corners at a uv, or those nearest to it within the triangle.
    pub fn weights(&self, triangle: usize, uv: Vec2<f64>) -> [f64; 3] {
        let [e, f, a] = self.edges(triangle);
        let g = uv - a;
        let det = e.x * f.y - e.y * f.x;
        let w = [(g.x * f.y - g.y * f.x) / det, (e.x * g.y - e.y * g.x) / det];
        let w = [1.0 - w[0] - w[1], w[0], w[1]].map(|w| w.max(0.0));
        let sum: f64 = w.iter().sum();
        w.map(|w| w / sum)
    }

    /// How the position changes with u and v at a place of a triangle.
    pub fn by_uv(&self, triangle: usize, w: [f64; 3]) -> [Vec3<f64>; 2] {
        let patch = &self.patches[triangle];
        let middle = patch.middle();
        let [e, f, _] = self.edges(triangle);
        let det = e.x * f.y - e.y * f.x;
        // Weights of the second and third corner by u, and by v.
        [[f.y / det, -e.y / det], [-f.x / det, e.x / det]].map(|[by_b, by_c]| {
            let size = by_b.abs().max(by_c.abs());
            let moved = |k: f64| {
                let (db, dc) = (by_b / size * k, by_c / size * k);
                patch.inside([w[0] - db - dc, w[1] + db, w[2] + dc], middle).0
            };
            (moved(STEP) - moved(-STEP)) * (size / (2.0 * STEP))
        })
    }

    /// The edges of a triangle from its first corner, and that corner, in uvs.
    fn edges(&self, triangle: usize) -> [Vec2<f64>; 3] {
        let [a, b, c] = self.patches[triangle].corners.map(|i| {
            let uv = self.mesh.uvs()[0][i as usize];
            Vec2::new(f64::from(uv.x), f64::from(uv.y))
        });
        [b - a, c - a, a]
    }
}

/// Every triangle of the low mesh split and displaced by `height`, with the normals of the displaced surface; see
/// [`Split`].
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
    Mesh::new(data).expect("indices count the points and every point is finite")
}

/// The triangles of all pieces, whose points follow one another.
fn joined(pieces: &[Piece]) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    let mut first = 0;
    for piece in pieces {
        triangles.extend(piece.triangles.iter().map(|t| t.map(|i| i + first)));
        first += piece.points.len() as u32;
    }
    triangles
}

impl Welds {
    pub fn new(mesh: &Mesh) -> Self {
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

    /// What an edge is called from both sides: the places of its ends, the smaller first.
    fn edge(&self, a: u32, b: u32) -> (u32, u32) {
        let (a, b) = self.ordered(a, b);
        (self.place[a as usize], self.place[b as usize])
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
            sides.entry(welds.edge(p, q)).or_default().push([normal(p), normal(q)]);
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
        let curves = std::array::from_fn(|i| all[&welds.edge(corners[i], corners[(i + 1) % 3])]);
        Self { mesh, welds, corners, curves }
    }

    /// The point with these weights, raised by the relief.
    pub(super) fn point(&self, weights: Weights, height: &impl Fn(f32, f32) -> f32) -> Point {
        let middle = self.middle();
        let surface = |w: [f64; 3]| raised(self.inside(w, middle), height);
        let w = weights.map(|w| f64::from(w) / f64::from(WHOLE));
        let (position, uv) = match edge_of(weights) {
            Some((i, k)) => raised(self.on_edge(i, k), height),
            None => surface(w),
        };
        Point { weights, position, uv, normal: self.normal(w, |w| surface(w).0) }
    }

    /// The uv with these weights; the same bits from both sides of an edge.
    pub(super) fn uv(&self, weights: Weights) -> Vec2 {
        let w = weights.map(|w| f64::from(w) / f64::from(WHOLE));
        match edge_of(weights) {
            Some((i, k)) => self.on_edge(i, k).2,
            None => self.between(w).1,
        }
    }

    /// How far apart two points of the flat triangle are, metres; the same bits from both sides of an edge.
    pub(super) fn distance(&self, a: Weights, b: Weights) -> f64 {
        if let Some(opposite) = (0..3).find(|corner| a[*corner] == 0 && b[*corner] == 0) {
            let edge = (opposite + 1) % 3;
            let (from, to) = self.welds.ordered(self.corners[edge], self.corners[(edge + 1) % 3]);
            let position = |v: u32| self.mesh.positions()[v as usize].to_f64();
            let part = f64::from(a[edge].abs_diff(b[edge])) / f64::from(WHOLE);
            return (position(to) - position(from)).length() * part;
        }
        let difference = (0..3).fold(Vec3::splat(0.0), |sum: Vec3<f64>, i| {
            sum + self.position(i) * ((f64::from(a[i]) - f64::from(b[i])) / f64::from(WHOLE))
        });
        difference.length()
    }

    /// The unit normal of `surface` by differences over [`DELTA`].
    fn normal(&self, w: [f64; 3], surface: impl Fn([f64; 3]) -> Vec3<f64>) -> Vec3<f64> {
        let along = |i: usize| {
            let step = DELTA / (self.position(i) - self.position(0)).length();
            let moved = |step: f64| {
                let mut moved = w;
                moved[0] -= step;
                moved[i] += step;
                surface(moved)
            };
            moved(step) - moved(-step)
        };
        along(1).cross(along(2)).normalize_or(Vec3::splat(0.0))
    }

    /// The point `k` steps of [`WHOLE`] along the edge from corner `i`; the same bits from both sides.
    fn on_edge(&self, i: usize, k: u32) -> (Vec3<f64>, Vec3<f64>, Vec2) {
        let (from, to) = (self.corners[i], self.corners[(i + 1) % 3]);
        let (a, b) = self.welds.ordered(from, to);
        let k = if a == from { k } else { WHOLE - k };
        let [s, t] = [WHOLE - k, k].map(|k| f64::from(k) / f64::from(WHOLE));
        let (normal, uv) = self.blend(&[(a, s), (b, t)]);
        (bezier(&self.curves[i], t), normal, uv)
    }

    /// What names the point `k` steps along the edge from corner `i` from both sides, and a corner from all.
    fn edge_key(&self, i: usize, k: u32) -> (u32, u32, u32) {
        let [a, b] = [self.corners[i], self.corners[(i + 1) % 3]].map(|v| self.welds.smooth[v as usize]);
        match k {
            0 => (a, a, 0),
            WHOLE => (b, b, 0),
            _ if a < b => (a, b, k),
            _ => (b, a, WHOLE - k),
        }
    }

    fn inside(&self, w: [f64; 3], middle: Vec3<f64>) -> (Vec3<f64>, Vec3<f64>, Vec2) {
        let mut p = middle * (6.0 * w[0] * w[1] * w[2]);
        for i in 0..3 {
            let next = (i + 1) % 3;
            let [near, far] = self.handles(i);
            p += self.position(i) * (w[i] * w[i] * w[i]);
            p += (near * w[i] + far * w[next]) * (3.0 * w[i] * w[next]);
        }
        let (normal, uv) = self.between(w);
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

    /// Normal and uv between the corners.
    fn between(&self, w: [f64; 3]) -> (Vec3<f64>, Vec2) {
        let [a, b, c] = self.corners;
        self.blend(&[(a, w[0]), (b, w[1]), (c, w[2])])
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

/// A point of a patch raised by the relief, and its uv.
fn raised(
    (base, normal, uv): (Vec3<f64>, Vec3<f64>, Vec2),
    height: &impl Fn(f32, f32) -> f32,
) -> (Vec3<f64>, Vec2) {
    let h = f64::from(height(uv.x, uv.y)) * DEPTH;
    (base + normal.normalize_or(Vec3::splat(0.0)) * h, uv)
}

/// The edge that a point lies on, as its first corner and the steps of [`WHOLE`] from there.
fn edge_of([a, b, c]: Weights) -> Option<(usize, u32)> {
    if c == 0 {
        Some((0, b))
    } else if a == 0 {
        Some((1, c))
    } else if b == 0 {
        Some((2, a))
    } else {
        None
    }
}

/// For every point, which points it shares its normal with: all have the same number.
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

/// The mean normal of all points that `slots` lets share one.
fn shared<'a>(points: impl Iterator<Item = &'a Point>, slots: &[u32]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::splat(0.0); slots.len()];
    for (point, slot) in points.zip(slots) {
        sums[*slot as usize] += point.normal;
    }
    slots.iter().map(|slot| sums[*slot as usize].normalize_or(Vec3::new(0.0, 1.0, 0.0)).to_f32()).collect()
}
