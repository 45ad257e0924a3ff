//! The maps of the low mesh: height, tangent-space normals, colour and the rest.

use super::texels::{Point, Texels};
use super::{DEPTH, patina};
use rayon::prelude::*;
use taotie::image::{Bitmap, Texels as Stored};
use taotie::math::Vec3;
use taotie::mesh::Mesh;
use taotie::surface::{TangentMethod, with_tangents};

/// Heights sampled at texel middles, and the atlas they belong to.
#[derive(Debug)]
pub(super) struct Bake {
    texels: Texels,
    heights: Vec<f32>,
}

impl Bake {
    /// Samples the relief for maps of `size` × `size`.
    pub fn new(mesh: &Mesh, size: u32) -> Self {
        let texels = Texels::new(&with_frames(mesh), size as usize);
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
            let n = tangent_normal(point, self.relief(x, y));
            let [r, g, b] = n.to_array().map(|c| ((c * 0.5 + 0.5) * 65535.0 + 0.5) as u16);
            [r, g, b, u16::MAX]
        });
        self.bitmap(3, Stored::U16(texels))
    }

    /// The object-space normal map, 16 bits.
    pub fn object_normal_map(&self) -> Bitmap {
        let up = [32768, 65535, 32768, u16::MAX];
        let texels = self.texels.map(up, |x, y, point| {
            let n = relief_normal(point, self.relief(x, y)).normalize();
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

    /// The relief at a texel; its changes by differences of texels over ±1 and ±2, exact for cubics.
    fn relief(&self, x: usize, y: usize) -> Relief {
        let size = self.texels.size() as isize;
        let at = |dx: isize, dy: isize| {
            let (x, y) = (x as isize + dx, y as isize + dy);
            self.heights[(y.clamp(0, size - 1) * size + x.clamp(0, size - 1)) as usize]
        };
        let depth = DEPTH as f32;
        let scale = depth * size as f32 / 12.0;
        let by_u = 8.0 * (at(1, 0) - at(-1, 0)) - (at(2, 0) - at(-2, 0));
        let by_v = 8.0 * (at(0, 1) - at(0, -1)) - (at(0, 2) - at(0, -2));
        Relief { height: at(0, 0) * depth, by_u: by_u * scale, by_v: by_v * scale }
    }
}

/// The height at a texel and how it changes with u and v, metres.
#[derive(Debug, Clone, Copy)]
struct Relief {
    height: f32,
    by_u: f32,
    by_v: f32,
}

/// A vector along the normal of the relief, object space.
///
/// The surface is Q = P + h n, with h in metres and n the unit interpolated normal. Its tangents are
/// Q_u = P_u + h n_u + h_u n, and so for v; the parts along the tangent plane are p_u = P_u + h n_u made perpendicular
/// to n, so that the facets of P do not show. Its normal is n − ∇h, where ∇h · p_u = h_u and ∇h · p_v = h_v
/// (Mikkelsen 2020, "Surface gradient–based bump mapping framework"); p_u and p_v need be neither equal in length
/// nor perpendicular.
fn relief_normal(point: &Point, relief: Relief) -> Vec3 {
    let (n, scale) = (point.normal.normalize(), relief.height / point.normal.length());
    let [p_u, p_v] = [0, 1].map(|k| {
        let p = point.by_uv[k] + point.normal_by_uv[k] * scale;
        p - n * n.dot(p)
    });
    let area = n.dot(p_u.cross(p_v));
    n - (p_v.cross(n) * relief.by_u + n.cross(p_u) * relief.by_v) * (1.0 / area)
}

/// The unit normal of the relief in the frame (T, B, N) in which a renderer reads it: interpolated and not
/// normalised, so that decoding gives the relief's normal back.
fn tangent_normal(point: &Point, relief: Relief) -> Vec3 {
    let (t, b) = (point.tangent, point.normal.cross(point.tangent));
    resolve(relief_normal(point, relief), [t, b, point.normal]).normalize()
}

/// The mesh with the tangents that renderers of glTF take where a file has none.
pub(super) fn with_frames(mesh: &Mesh) -> Mesh {
    with_tangents(mesh, 0, TangentMethod::MikkTSpace).expect("the vessel has normals and uvs").mesh
}

/// The coordinates of `v` in a frame that need not be orthonormal (Cramer's rule).
fn resolve(v: Vec3, [t, b, n]: [Vec3; 3]) -> Vec3 {
    let det = t.dot(b.cross(n));
    Vec3::new(v.dot(b.cross(n)), v.dot(n.cross(t)), v.dot(t.cross(b))) * (1.0 / det)
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
