//! Which point of the low mesh each texel of the atlas shows.

use rayon::prelude::*;
use taotie::math::{Vec2, Vec3};
use taotie::mesh::Mesh;

/// No triangle is near.
const NONE: u16 = u16::MAX;

/// A point of the low mesh as the renderer sees it: interpolated, not normalised.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    /// Object space, metres.
    pub position: Vec3,
    /// The interpolated vertex normal.
    pub normal: Vec3,
    /// The interpolated vertex tangent.
    pub tangent: Vec3,
    /// How the position changes with u and v on the flat triangle, metres.
    pub by_uv: [Vec3; 2],
    /// How the interpolated normal changes with u and v.
    pub normal_by_uv: [Vec3; 2],
}

/// A quantity linear in uv over a triangle: its value at uv (0, 0) and its changes with u and v.
#[derive(Debug, Clone, Copy)]
struct Linear {
    origin: Vec3<f64>,
    by_u: Vec3<f64>,
    by_v: Vec3<f64>,
}

impl Linear {
    fn new(values: [Vec3<f64>; 3], [a, b, c]: [Vec2<f64>; 3]) -> Self {
        let (e, f) = (b - a, c - a);
        let det = e.x * f.y - e.y * f.x;
        let (p, q) = (values[1] - values[0], values[2] - values[0]);
        let by_u = (p * f.y - q * e.y) / det;
        let by_v = (q * e.x - p * f.x) / det;
        Self { origin: values[0] - by_u * a.x - by_v * a.y, by_u, by_v }
    }

    fn at(&self, u: f64, v: f64) -> Vec3 {
        (self.origin + self.by_u * u + self.by_v * v).to_f32()
    }
}

/// The atlas of a square map, with every chart grown a little beyond its border.
#[derive(Debug)]
pub(super) struct Texels {
    size: usize,
    triangles: Vec<u16>,
    /// Position, normal and tangent of each triangle.
    linears: Vec<[Linear; 3]>,
}

impl Texels {
    /// Assigns triangles of a mesh with tangents to the texels of a map of `size` × `size`.
    pub fn new(mesh: &Mesh, size: usize) -> Self {
        let uvs: Vec<Vec2<f64>> =
            mesh.uvs()[0].iter().map(|uv| Vec2::new(f64::from(uv.x), f64::from(uv.y))).collect();
        let linears = mesh.triangles().iter().map(|triangle| {
            let [a, b, c] = triangle.map(|i| i as usize);
            let corners = [uvs[a], uvs[b], uvs[c]];
            let normal = |i: usize| mesh.normals()[i].to_f64();
            let tangent = |i: usize| {
                let [x, y, z, _] = mesh.tangents()[i];
                Vec3::new(x, y, z).to_f64()
            };
            [
                Linear::new([a, b, c].map(|i| mesh.positions()[i].to_f64()), corners),
                Linear::new([a, b, c].map(normal), corners),
                Linear::new([a, b, c].map(tangent), corners),
            ]
        });
        let linears = linears.collect();
        let mut triangles = vec![NONE; size * size];
        for (i, triangle) in mesh.triangles().iter().enumerate() {
            cover(&mut triangles, size, triangle.map(|k| uvs[k as usize]), i as u16);
        }
        let padding = (size / 128).max(2);
        dilate(&mut triangles, size, padding);
        Self { size, triangles, linears }
    }

    /// The texels a side.
    pub fn size(&self) -> usize {
        self.size
    }

    /// The point at the middle of a texel, or `None` away from all charts.
    pub fn point(&self, x: usize, y: usize) -> Option<Point> {
        let triangle = self.triangles[y * self.size + x];
        if triangle == NONE {
            return None;
        }
        let [position, normal, tangent] = &self.linears[triangle as usize];
        let (u, v) = ((x as f64 + 0.5) / self.size as f64, (y as f64 + 0.5) / self.size as f64);
        Some(Point {
            position: position.at(u, v),
            normal: normal.at(u, v),
            tangent: tangent.at(u, v),
            by_uv: [position.by_u.to_f32(), position.by_v.to_f32()],
            normal_by_uv: [normal.by_u.to_f32(), normal.by_v.to_f32()],
        })
    }

    /// Makes a map texel by texel; `fill` is the value away from all charts.
    pub fn map<T: Copy + Send + Sync>(
        &self,
        fill: T,
        texel: impl Fn(usize, usize, &Point) -> T + Sync,
    ) -> Vec<T> {
        let mut texels = vec![fill; self.size * self.size];
        texels.par_chunks_mut(self.size).enumerate().for_each(|(y, row)| {
            for (x, value) in row.iter_mut().enumerate() {
                if let Some(point) = self.point(x, y) {
                    *value = texel(x, y, &point);
                }
            }
        });
        texels
    }
}

/// Writes `id` to the texels whose middles lie in the triangle.
fn cover(texels: &mut [u16], size: usize, corners: [Vec2<f64>; 3], id: u16) {
    let [a, b, c] = corners.map(|p| p * size as f64);
    let clamp = |v: f64| v.max(0.0).min(size as f64) as usize;
    let (x0, x1) = (clamp(a.x.min(b.x).min(c.x)), clamp(a.x.max(b.x).max(c.x).ceil()));
    let (y0, y1) = (clamp(a.y.min(b.y).min(c.y)), clamp(a.y.max(b.y).max(c.y).ceil()));
    let side = |p: Vec2<f64>, q: Vec2<f64>, x: f64, y: f64| (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x);
    for y in y0..y1 {
        for x in x0..x1 {
            let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
            // Charts are counter-clockwise in the picture, whose v points down.
            if side(a, b, px, py) <= 0.0 && side(b, c, px, py) <= 0.0 && side(c, a, px, py) <= 0.0 {
                texels[y * size + x] = id;
            }
        }
    }
}

/// Grows every chart by `rounds` texels into free ones, as if its outermost triangles went on.
fn dilate(texels: &mut [u16], size: usize, rounds: usize) {
    let neighbours = |i: usize| {
        let (x, y) = (i % size, i / size);
        [
            (x > 0).then(|| i - 1),
            (x + 1 < size).then(|| i + 1),
            (y > 0).then(|| i - size),
            (y + 1 < size).then(|| i + size),
        ]
    };
    let touches = |texels: &[u16], i: usize| {
        texels[i] == NONE && neighbours(i).into_iter().flatten().any(|k| texels[k] != NONE)
    };
    let mut front: Vec<usize> = (0..texels.len()).filter(|i| touches(texels, *i)).collect();
    for _ in 0..rounds {
        let grown: Vec<(usize, u16)> = front
            .iter()
            .filter_map(|i| {
                neighbours(*i).into_iter().flatten().map(|k| texels[k]).find(|t| *t != NONE).map(|t| (*i, t))
            })
            .collect();
        for (i, triangle) in &grown {
            texels[*i] = *triangle;
        }
        let mut next: Vec<usize> =
            grown.iter().flat_map(|(i, _)| neighbours(*i)).flatten().filter(|k| texels[*k] == NONE).collect();
        next.sort_unstable();
        next.dedup();
        front = next;
    }
}
