//! The maps of the low mesh: height, tangent-space normals, colour and the rest.

use super::builder::corner_angles;
use super::texels::{Point, Texels};
use super::{DEPTH, patina};
use rayon::prelude::*;
use taotie::image::{Bitmap, Texels as Stored};
use taotie::math::{Vec3, scalar};
use taotie::mesh::Mesh;

/// Heights sampled at texel middles, and the atlas they belong to.
#[derive(Debug)]
pub(super) struct Bake {
    texels: Texels,
    heights: Vec<f32>,
}

impl Bake {
    /// Samples the relief for maps of `size` × `size`.
    pub fn new(mesh: &Mesh, size: u32) -> Self {
        let texels = Texels::new(mesh, &tangents(mesh), size as usize);
        let middle = |i: usize| (i as f32 + 0.5) / size as f32;
        let heights = texels.map(0.0, |x, y, _| super::height(middle(x), middle(y)));
        Self { texels, heights }
    }

    /// The height map, 16 bits; 1 is [`DEPTH`].
    pub fn height_map(&self) -> Bitmap {
        let grey = |h: &f32| {
            let h = (h * 65535.0 + 0.5) as u16;
            [h, h, h, u16::MAX]
        };
        self.bitmap(1, Stored::U16(self.heights.par_iter().map(grey).collect()))
    }

    /// The tangent-space normal map, green up, 16 bits.
    pub fn normal_map(&self) -> Bitmap {
        let flat = [32768, 32768, 65535, u16::MAX];
        let texels = self.texels.map(flat, |x, y, point| {
            let n = tangent_normal(
                point,
                self.heights[y * self.texels.size() + x] * DEPTH as f32,
                self.slope(x, y),
            );
            let [r, g, b] = n.to_array().map(|c| ((c * 0.5 + 0.5) * 65535.0 + 0.5) as u16);
            [r, g, b, u16::MAX]
        });
        self.bitmap(3, Stored::U16(texels))
    }

    /// Colour (to be decoded as sRGB), and occlusion, roughness and metallic in red, green and blue; 8 bits.
    pub fn material_maps(&self) -> [Bitmap; 2] {
        let size = self.texels.size();
        // The radii follow from what a texel measures on the belly, so that every size shows the same vessel.
        let radius = |millimetres: f64| {
            ((millimetres * 1e-3 * super::atlas::STRIP_SCALE * size as f64 + 0.5) as usize).max(1)
        };
        let near = blurred(&self.heights, size, radius(0.55));
        let wide = blurred(&self.heights, size, radius(2.2));
        let fill = patina::Surface::default();
        let surfaces = self.texels.map(fill, |x, y, point| {
            let i = y * size + x;
            let h = self.heights[i];
            patina::surface(&patina::Place {
                point: *point,
                height: h,
                cavity: near[i] - h,
                wide_cavity: wide[i] - h,
            })
        });
        let colors = surfaces.par_iter().map(patina::Surface::srgb).collect();
        let orm = surfaces.par_iter().map(patina::Surface::orm).collect();
        [self.bitmap(3, Stored::U8(colors)), self.bitmap(3, Stored::U8(orm))]
    }

    fn bitmap(&self, channels: u8, texels: Stored) -> Bitmap {
        let size = self.texels.size() as u32;
        Bitmap::new(size, size, channels, texels).expect("the texels were made for this size")
    }

    /// How the height in metres changes with u and v: differences of texels over ±1 and ±2, exact for cubics.
    fn slope(&self, x: usize, y: usize) -> [f32; 2] {
        let size = self.texels.size() as isize;
        let at = |dx: isize, dy: isize| {
            let (x, y) = (x as isize + dx, y as isize + dy);
            self.heights[(y.clamp(0, size - 1) * size + x.clamp(0, size - 1)) as usize]
        };
        let scale = DEPTH as f32 * size as f32 / 12.0;
        let by_u = 8.0 * (at(1, 0) - at(-1, 0)) - (at(2, 0) - at(-2, 0));
        let by_v = 8.0 * (at(0, 1) - at(0, -1)) - (at(0, 2) - at(0, -2));
        [by_u * scale, by_v * scale]
    }
}

/// The unit normal of the relief in the frame (T, B, N) in which a renderer reads it.
///
/// The surface is Q = P + h n, with h in metres and n the unit interpolated normal. Its tangents are
/// Q_u = P_u + h n_u + h_u n, and so for v; the parts along the tangent plane are p_u = P_u + h n_u made perpendicular
/// to n, so that the facets of P do not show. Its normal is n − ∇h, where ∇h · p_u = h_u and ∇h · p_v = h_v
/// (Mikkelsen 2020, "Surface gradient–based bump mapping framework"); p_u and p_v need be neither equal in length
/// nor perpendicular. That vector is then resolved in the interpolated, un-normalised frame, so that decoding gives
/// it back.
pub(super) fn tangent_normal(point: &Point, h: f32, [h_u, h_v]: [f32; 2]) -> Vec3 {
    let (n, scale) = (point.normal.normalize(), h / point.normal.length());
    let [p_u, p_v] = [0, 1].map(|k| {
        let p = point.by_uv[k] + point.normal_by_uv[k] * scale;
        p - n * n.dot(p)
    });
    let area = n.dot(p_u.cross(p_v));
    let gradient = (p_v.cross(n) * h_u + n.cross(p_u) * h_v) * (1.0 / area);
    let (t, b) = (point.tangent, point.normal.cross(point.tangent));
    resolve(n - gradient, [t, b, point.normal]).normalize()
}

/// The coordinates of `v` in a frame that need not be orthonormal (Cramer's rule).
fn resolve(v: Vec3, [t, b, n]: [Vec3; 3]) -> Vec3 {
    let det = t.dot(b.cross(n));
    Vec3::new(v.dot(b.cross(n)), v.dot(n.cross(t)), v.dot(t.cross(b))) * (1.0 / det)
}

/// Vertex tangents as MikkTSpace makes them where no chart is mirrored: the directions of rising u of the triangles
/// around a vertex, made perpendicular to its normal and weighted by angle. The bitangent is then n × t.
pub(super) fn tangents(mesh: &Mesh) -> Vec<Vec3<f64>> {
    let mut sums = vec![Vec3::splat(0.0); mesh.positions().len()];
    for (i, triangle) in mesh.triangles().iter().enumerate() {
        let corners = mesh.corners(i).map(Vec3::to_f64);
        let [a, b, c] = triangle.map(|k| mesh.uvs()[0][k as usize]);
        let (b_v, c_v) = (f64::from(b.y) - f64::from(a.y), f64::from(c.y) - f64::from(a.y));
        // The determinant is negative throughout, since v points down.
        let by_u = (corners[2] - corners[0]) * b_v - (corners[1] - corners[0]) * c_v;
        for (k, corner) in triangle.iter().enumerate() {
            let n = mesh.normals()[*corner as usize].to_f64();
            let flat = |v: Vec3<f64>| (v - n * n.dot(v)).normalize();
            let angle = corner_angle_about(n, corners, k);
            sums[*corner as usize] += flat(by_u) * angle;
        }
    }
    sums.into_iter().map(|t| t.normalize_or(Vec3::new(1.0, 0.0, 0.0))).collect()
}

/// The angle of corner `k` between its edges projected along the normal `n`, as MikkTSpace weighs corners.
fn corner_angle_about(n: Vec3<f64>, corners: [Vec3<f64>; 3], k: usize) -> f64 {
    let flat = |v: Vec3<f64>| (v - n * n.dot(v)).normalize();
    let p = corners[k];
    let (e, f) = (flat(corners[(k + 1) % 3] - p), flat(corners[(k + 2) % 3] - p));
    let angle = scalar::acos(e.dot(f).clamp(-1.0, 1.0));
    if angle.is_nan() { corner_angles(corners)[k] } else { angle }
}

/// The mean over a square of side 2 · `radius` + 1, borders continued.
fn blurred(values: &[f32], size: usize, radius: usize) -> Vec<f32> {
    let rows = transposed_row_means(values, size, radius);
    transposed_row_means(&rows, size, radius)
}

/// Running means along the rows, written as columns.
fn transposed_row_means(values: &[f32], size: usize, radius: usize) -> Vec<f32> {
    let mut means = vec![0.0; values.len()];
    let scale = 1.0 / (2 * radius + 1) as f32;
    means.par_chunks_mut(size).zip(values.par_chunks(size)).for_each(|(out, row)| {
        let at = |i: isize| row[i.clamp(0, size as isize - 1) as usize];
        let r = radius as isize;
        let mut sum: f32 = (-r..=r).map(at).sum();
        for (i, mean) in out.iter_mut().enumerate() {
            *mean = sum * scale;
            sum += at(i as isize + r + 1) - at(i as isize - r);
        }
    });
    transposed(&means, size)
}

fn transposed(values: &[f32], size: usize) -> Vec<f32> {
    const TILE: usize = 32;
    let mut turned = vec![0.0; values.len()];
    turned.par_chunks_mut(size * TILE).enumerate().for_each(|(band, rows)| {
        let height = rows.len() / size;
        for x0 in (0..size).step_by(TILE) {
            for y in 0..height {
                for x in x0..(x0 + TILE).min(size) {
                    rows[y * size + x] = values[x * size + band * TILE + y];
                }
            }
        }
    });
    turned
}
