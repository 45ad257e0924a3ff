//! The low mesh rounded by its normals: a cubic patch over each triangle, whose points the relief can raise.

use super::relief::DEPTH;
use std::collections::HashMap;
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::mesh::Mesh;

/// The low mesh rounded, without relief.
pub(super) struct Rounded<'a> {
    mesh: &'a Mesh,
    /// A patch for each triangle.
    pub patches: Vec<Patch<'a>>,
}

/// Half the step, in weights, over which the rounded mesh is differentiated.
const STEP: f64 = 1e-4;

impl<'a> Rounded<'a> {
    /// Computes the curves of all edges first, since neighbours share them.
    pub fn new(mesh: &'a Mesh, welds: &'a Welds) -> Self {
        let all = curves(mesh, welds);
        let patch = |corners: &[u32; 3]| {
            let curve = |i: usize| all[&welds.edge(corners[i], corners[(i + 1) % 3])];
            Patch { mesh, welds, corners: *corners, curves: std::array::from_fn(curve) }
        };
        Self { mesh, patches: mesh.triangles().iter().map(patch).collect() }
    }

    /// Returns the weights of a triangle's corners at a uv, clamped to the triangle.
    pub fn weights(&self, triangle: usize, uv: Vec2<f64>) -> [f64; 3] {
        let [e, f, a] = self.edges(triangle);
        let g = uv - a;
        let det = e.x * f.y - e.y * f.x;
        let w = [(g.x * f.y - g.y * f.x) / det, (e.x * g.y - e.y * g.x) / det];
        let w = [1.0 - w[0] - w[1], w[0], w[1]].map(|w| w.max(0.0));
        let sum: f64 = w.iter().sum();
        w.map(|w| w / sum)
    }

    /// Returns the derivatives of the position by u and v at a point of a triangle.
    pub fn by_uv(&self, triangle: usize, w: [f64; 3]) -> [Vec3<f64>; 2] {
        let patch = &self.patches[triangle];
        let middle = patch.middle();
        let [e, f, _] = self.edges(triangle);
        let det = e.x * f.y - e.y * f.x;
        // Derivatives of the weights of the second and third corner by u, and by v.
        [[f.y / det, -e.y / det], [-f.x / det, e.x / det]].map(|[by_b, by_c]| {
            let size = by_b.abs().max(by_c.abs());
            let moved = |k: f64| {
                let (db, dc) = (by_b / size * k, by_c / size * k);
                patch.inside([w[0] - db - dc, w[1] + db, w[2] + dc], middle).position
            };
            (moved(STEP) - moved(-STEP)) * (size / (2.0 * STEP))
        })
    }

    /// Returns the edges of a triangle from its first corner, and that corner, in uvs.
    fn edges(&self, triangle: usize) -> [Vec2<f64>; 3] {
        let [a, b, c] = self.patches[triangle].corners.map(|i| {
            let uv = self.mesh.uvs()[0][i as usize];
            Vec2::new(f64::from(uv.x), f64::from(uv.y))
        });
        [b - a, c - a, a]
    }
}

/// The weights of a patch's corners in units of 1/[`WHOLE`], which makes halving exact. They sum to [`WHOLE`].
pub(super) type Weights = [u32; 3];

/// The units per 1.
pub(super) const WHOLE: u32 = 1 << 16;

/// A point of the displaced surface: location in its patch, position, uv, and unit normal.
pub(super) struct Point {
    pub weights: Weights,
    pub position: Vec3<f64>,
    pub uv: Vec2,
    pub normal: Vec3<f64>,
}

/// A point of the rounded surface before it is raised; the normal is not normalised.
struct Base {
    position: Vec3<f64>,
    normal: Vec3<f64>,
    uv: Vec2,
}

/// An interpolated normal, not normalised, and uv.
struct Blend {
    normal: Vec3<f64>,
    uv: Vec2,
}

/// A cubic patch over a triangle of a mesh.
pub(super) struct Patch<'a> {
    mesh: &'a Mesh,
    welds: &'a Welds,
    corners: [u32; 3],
    /// The curves from corner `i` to corner `i + 1`, in canonical direction.
    curves: [Curve; 3],
}

/// Half the distance over which slopes are measured, metres: small compared with the finest lines, large compared
/// with rounding errors.
const DELTA: f64 = 8e-6;

impl Patch<'_> {
    /// Returns the point with these weights, raised by the relief.
    pub fn point(&self, weights: Weights, height: &impl Fn(f32, f32) -> f32) -> Point {
        let middle = self.middle();
        let surface = |w: [f64; 3]| raised(self.inside(w, middle), height);
        let w = weights.map(|w| f64::from(w) / f64::from(WHOLE));
        let (position, uv) = match edge_of(weights) {
            Some((i, k)) => raised(self.on_edge(i, k), height),
            None => surface(w),
        };
        Point { weights, position, uv, normal: self.normal(w, |w| surface(w).0) }
    }

    /// Returns the uv with these weights, bit-identical from both sides of an edge.
    pub fn uv(&self, weights: Weights) -> Vec2 {
        let w = weights.map(|w| f64::from(w) / f64::from(WHOLE));
        match edge_of(weights) {
            Some((i, k)) => self.on_edge(i, k).uv,
            None => self.between(w).uv,
        }
    }

    /// Returns the distance between points of the flat triangle, metres; bit-identical from both sides of an edge.
    pub fn distance(&self, a: Weights, b: Weights) -> f64 {
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

    /// Returns the unit normal of `surface` from differences over [`DELTA`].
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

    /// Returns the point at `k`/[`WHOLE`] along the edge from corner `i`, bit-identical from both sides.
    fn on_edge(&self, i: usize, k: u32) -> Base {
        let (from, to) = (self.corners[i], self.corners[(i + 1) % 3]);
        let (a, b) = self.welds.ordered(from, to);
        let k = if a == from { k } else { WHOLE - k };
        let [s, t] = [WHOLE - k, k].map(|k| f64::from(k) / f64::from(WHOLE));
        self.blend(&[(a, s), (b, t)]).at(bezier(&self.curves[i], t))
    }

    /// Returns a key for the point `k` steps along the edge from corner `i`, the same from all adjacent patches.
    pub fn edge_key(&self, i: usize, k: u32) -> (u32, u32, u32) {
        let [a, b] = [self.corners[i], self.corners[(i + 1) % 3]].map(|v| self.welds.smooth[v as usize]);
        match k {
            0 => (a, a, 0),
            WHOLE => (b, b, 0),
            _ if a < b => (a, b, k),
            _ => (b, a, WHOLE - k),
        }
    }

    /// Returns a point inside the patch, given the weights of its corners and its [`Patch::middle`].
    fn inside(&self, w: [f64; 3], middle: Vec3<f64>) -> Base {
        let mut p = middle * (6.0 * w[0] * w[1] * w[2]);
        for i in 0..3 {
            let next = (i + 1) % 3;
            let [near, far] = self.handles(i);
            p += self.position(i) * (w[i] * w[i] * w[i]);
            p += (near * w[i] + far * w[next]) * (3.0 * w[i] * w[next]);
        }
        self.between(w).at(p)
    }

    /// Returns the middle control point: the mean of the edge control points, moved away from the mean of the corners
    /// by half their distance.
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

    /// Returns the inner control points of the edge from corner `i`, the one near that corner first.
    fn handles(&self, i: usize) -> [Vec3<f64>; 2] {
        let [_, p, q, _] = self.curves[i];
        let (first, _) = self.welds.ordered(self.corners[i], self.corners[(i + 1) % 3]);
        if first == self.corners[i] { [p, q] } else { [q, p] }
    }

    fn position(&self, i: usize) -> Vec3<f64> {
        self.mesh.positions()[self.corners[i] as usize].to_f64()
    }

    /// Interpolates normal and uv between the corners.
    fn between(&self, w: [f64; 3]) -> Blend {
        let [a, b, c] = self.corners;
        self.blend(&[(a, w[0]), (b, w[1]), (c, w[2])])
    }

    /// Interpolates normal and uv like a renderer.
    fn blend(&self, weights: &[(u32, f64)]) -> Blend {
        let (mut normal, mut u, mut v) = (Vec3::splat(0.0), 0.0, 0.0);
        for (i, w) in weights {
            let i = *i as usize;
            let uv = self.mesh.uvs()[0][i];
            normal += self.mesh.normals()[i].to_f64() * *w;
            u += f64::from(uv.x) * w;
            v += f64::from(uv.y) * w;
        }
        Blend { normal, uv: Vec2::new(u as f32, v as f32) }
    }
}

impl Blend {
    fn at(self, position: Vec3<f64>) -> Base {
        Base { position, normal: self.normal, uv: self.uv }
    }
}

/// Returns a point of a patch raised by the relief, and its uv.
fn raised(base: Base, height: &impl Fn(f32, f32) -> f32) -> (Vec3<f64>, Vec2) {
    let h = f64::from(height(base.uv.x, base.uv.y)) * DEPTH;
    (base.position + base.normal.normalize_or(Vec3::splat(0.0)) * h, base.uv)
}

/// Returns the edge that a point lies on, as its first corner and the distance from there in units of 1/[`WHOLE`].
pub(super) fn edge_of([a, b, c]: Weights) -> Option<(usize, u32)> {
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

/// The control points of an edge's curve, from the end with the smaller index to the other.
type Curve = [Vec3<f64>; 4];

/// Returns the curve of every edge, keyed by the positions of its ends.
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

/// The maximum distance of a curve's control point from its chord, metres: long edges, such as those of the spout,
/// stay nearly straight.
const LARGEST_BEND: f64 = 0.0022;

/// Returns the control handle, a third of the edge `d`, at an end with these normals on its two sides.
///
/// If the normals agree, the handle is bent into the tangent plane; at a crease, into both planes along their
/// intersection. If that points elsewhere, as at tips and corners, the handle stays straight.
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

/// Returns the point of a curve at `t`, by the Bernstein sum, which is symmetric and short.
fn bezier([a, b, c, d]: &Curve, t: f64) -> Vec3<f64> {
    let s = 1.0 - t;
    *a * (s * s * s) + *b * (3.0 * s * s * t) + *c * (3.0 * s * t * t) + *d * (t * t * t)
}

/// The coincident vertices of a mesh.
pub(super) struct Welds {
    /// For each vertex, the first at the same position.
    place: Vec<u32>,
    /// For each vertex, the first at the same position with the same normal.
    smooth: Vec<u32>,
}

impl Welds {
    /// Finds coincident vertices by comparing positions and normals bitwise.
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

    /// Returns the key of an edge, the same from both sides: the position indices of its ends, the smaller first.
    fn edge(&self, a: u32, b: u32) -> (u32, u32) {
        let (a, b) = self.ordered(a, b);
        (self.place[a as usize], self.place[b as usize])
    }

    /// Returns the corners of an edge, the one with the smaller position index first.
    fn ordered(&self, a: u32, b: u32) -> (u32, u32) {
        if self.place[a as usize] < self.place[b as usize] { (a, b) } else { (b, a) }
    }
}
