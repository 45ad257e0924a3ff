//! The maps of the low-poly mesh: height, normals, colour and the other material values.

use super::relief::{DEPTH, height};
use super::rounded::{Rounded, Welds};
use super::{atlas, patina};
use rayon::prelude::*;
use taotie_engine::bake::{TexelGrid, TexelSurface};
use taotie_engine::image::{Bitmap, Image, Texels as Stored};
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::mesh::Mesh;
use taotie_engine::normal_map::{Storage, store_normals};
use taotie_engine::scene::{GreenChannel, NormalSpace};
use taotie_engine::surface::{
    Relief, ReliefBase, TangentMethod, relief_normal, tangent_space_normal, with_tangents,
};

/// Heights sampled at texel centres, and their atlas.
#[derive(Debug)]
pub(super) struct Bake {
    surface: TexelSurface,
    heights: Vec<f32>,
}

impl Bake {
    /// Samples the relief for maps of `size` × `size`.
    pub fn new(mesh: &Mesh, size: u32) -> Self {
        let surface = laid_out(mesh, size);
        let middle = |i: u32| (i as f32 + 0.5) / size as f32;
        let heights = surface.map(0.0, |x, y, _| height(middle(x), middle(y)));
        Self { surface, heights }
    }

    /// Returns the 16-bit height map; 1 is [`DEPTH`].
    pub fn height_map(&self) -> Bitmap {
        let grey = |h: &f32| {
            let h = (h * 65535.0 + 0.5) as u16;
            [h, h, h, u16::MAX]
        };
        self.bitmap(1, Stored::U16(self.heights.par_iter().map(grey).collect()))
    }

    /// Returns the 16-bit tangent-space normal map, green up.
    pub fn normal_map(&self) -> Bitmap {
        stored(&self.tangent_normals(), NormalSpace::Tangent)
    }

    /// Returns the 16-bit object-space normal map.
    pub fn object_normal_map(&self) -> Bitmap {
        stored(&self.normals([0.0; 4], |_, n| n), NormalSpace::Object)
    }

    /// Returns the normals in tangent space. Where the frame at a tip is so skewed that a normal lies behind it, the
    /// map stays flat.
    fn tangent_normals(&self) -> Image {
        const FLAT: Vec3<f64> = Vec3::new(0.0, 0.0, 1.0);
        self.normals([0.0, 0.0, 1.0, 0.0], |frame, n| {
            let stored = tangent_space_normal(frame.normal, frame.tangent, 1.0, n);
            if stored.z > 0.0 { stored } else { FLAT }
        })
    }

    /// Returns the normals of the rounded mesh displaced along its interpolated normals, Q = B + h n: Q_u × Q_v,
    /// transformed by `store`. Padding extends the border of the UV island; the rest is `fill`.
    fn normals(
        &self,
        fill: [f32; 4],
        store: impl Fn(&InterpolatedFrame, Vec3<f64>) -> Vec3<f64> + Sync,
    ) -> Image {
        let (mesh, coverage) = (self.surface.mesh(), self.surface.coverage());
        let welds = Welds::new(mesh);
        let rounded = Rounded::new(mesh, &welds);
        let size = coverage.width();
        let corners = Corners::new(size);
        let normals = self.surface.map(fill, |x, y, point| {
            let Some(triangle) = coverage.triangle(x, y) else { return fill };
            let triangle = triangle as usize;
            let [u, v] = [x, y].map(|i| (f64::from(i) + 0.5) / f64::from(size));
            let weights = rounded.weights(triangle, Vec2::new(u, v));
            let frame = InterpolatedFrame::new(mesh, triangle, weights);
            let dp = rounded.by_uv(triangle, weights);
            let base = ReliefBase { n: frame.normal, dp, dn: point.normal_by_uv };
            let height = f64::from(self.heights[(y * size + x) as usize]) * DEPTH;
            let [by_u, by_v] = corners.slopes(x, y);
            let n = store(&frame, displaced_normal(base, Relief { height, by_u, by_v })).to_f32();
            [n.x, n.y, n.z, 1.0]
        });
        let mut image = Image::new(size, size, [0.0; 4]).expect("the map is not empty");
        image.pixels_mut().copy_from_slice(&normals);
        image
    }

    /// Returns the colour in sRGB, and occlusion, roughness and metallic in red, green and blue; 8 bits each.
    pub fn material_maps(&self) -> [Bitmap; 2] {
        let size = self.surface.coverage().width() as usize;
        // The radii follow from the size of a texel on the belly, so that maps of all sizes show the same vessel.
        let radius = |millimetres: f64| {
            ((millimetres * 1e-3 * atlas::STRIP_SCALE * size as f64 + 0.5) as usize).max(1)
        };
        let near = blurred(&self.heights, size, radius(0.55));
        let wide = blurred(&self.heights, size, radius(2.2));
        let fill = patina::Surface::default();
        let surfaces = self.surface.map(fill, |x, y, point| {
            let i = y as usize * size + x as usize;
            let h = self.heights[i];
            patina::surface(&patina::PatinaInput {
                position: point.position.to_f32(),
                normal: point.normal.to_f32(),
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
        let size = self.surface.coverage().width();
        Bitmap::new(size, size, channels, texels).expect("the number of texels matches the size")
    }
}

/// Heights at the corners of texels: the slopes between them are those within the texel, while differences between
/// neighbouring texels would blur lines that are only a few texels wide.
struct Corners {
    size: usize,
    heights: Vec<f32>,
}

impl Corners {
    fn new(size: u32) -> Self {
        let side = size as usize + 1;
        let at = |i: usize| i as f32 / size as f32;
        let heights = (0..side * side).into_par_iter().map(|i| height(at(i % side), at(i / side)));
        Self { size: size as usize, heights: heights.collect() }
    }

    /// Returns the derivatives of the height by u and v over a texel, metres.
    fn slopes(&self, x: u32, y: u32) -> [f64; 2] {
        let at = |dx: usize, dy: usize| {
            let corner = (y as usize + dy) * (self.size + 1) + x as usize + dx;
            f64::from(self.heights[corner])
        };
        let [a, b, c, d] = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
        let scale = 0.5 * self.size as f64 * DEPTH;
        [(b + d - a - c) * scale, (c + d - a - b) * scale]
    }
}

/// The interpolated normal and tangent in a triangle, not normalised. No UV island of the vessel is mirrored.
struct InterpolatedFrame {
    normal: Vec3<f64>,
    tangent: Vec3<f64>,
}

impl InterpolatedFrame {
    fn new(mesh: &Mesh, triangle: usize, weights: [f64; 3]) -> Self {
        let corners = mesh.triangles()[triangle].map(|i| i as usize);
        let blend = |of: &dyn Fn(usize) -> Vec3| {
            let [a, b, c] = corners.map(|i| of(i).to_f64());
            a * weights[0] + b * weights[1] + c * weights[2]
        };
        let tangent = |i: usize| {
            let [x, y, z, _] = mesh.tangents()[i];
            Vec3::new(x, y, z)
        };
        Self { normal: blend(&|i| mesh.normals()[i]), tangent: blend(&tangent) }
    }
}

/// The minimum cosine between the rounded mesh's normal and the interpolated one: at tips, the rounding folds over.
const FOLDED: f64 = 0.1;

/// Returns the unit normal of the surface `base.dp` displaced by `relief` along the interpolated normal. If that
/// surface folds over, its facets are ignored, as in [`relief_normal`].
fn displaced_normal(base: ReliefBase<f64>, relief: Relief<f64>) -> Vec3<f64> {
    let length = base.n.length();
    let n = base.n / length;
    let [q_u, q_v] = [(0, relief.by_u), (1, relief.by_v)].map(|(k, slope)| {
        let turned = (base.dn[k] - n * n.dot(base.dn[k])) / length;
        base.dp[k] + turned * relief.height + n * slope
    });
    // v points down the map, so this points outward.
    let q = q_v.cross(q_u).normalize_or(n);
    if base.dp[1].cross(base.dp[0]).normalize_or(n).dot(n) < FOLDED || q.dot(n) < FOLDED {
        return relief_normal(base, relief);
    }
    q
}

/// Returns the mesh with its tangents on a map of `size` × `size`, with padding of 1/128 of a side around UV islands.
fn laid_out(mesh: &Mesh, size: u32) -> TexelSurface {
    let grid = TexelGrid { width: size, height: size, uv_set: 0, padding: (size / 128).max(2) };
    TexelSurface::new(with_frames(mesh), &grid).expect("the vessel has uvs, and the map size is valid")
}

fn stored(normals: &Image, space: NormalSpace) -> Bitmap {
    let storage = Storage { bits: 16, dither: false };
    store_normals(normals, space, GreenChannel::Up, storage).expect("16-bit storage is supported").bitmap
}

/// Returns the mesh with the tangents that glTF renderers use if a file has none.
fn with_frames(mesh: &Mesh) -> Mesh {
    with_tangents(mesh, 0, TangentMethod::MikkTSpace).expect("the vessel has normals and uvs").mesh
}

/// Returns the mean over squares of side 2 · `radius` + 1, with borders extended.
fn blurred(values: &[f32], size: usize, radius: usize) -> Vec<f32> {
    let rows = transposed_row_means(values, size, radius);
    transposed_row_means(&rows, size, radius)
}

/// Returns running means along the rows, transposed.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jue::{base_color_map, displaced, height_map, low_mesh, normal_map, orm_map};
    use taotie_engine::compare::angle_deg;
    use taotie_engine::surface::{decode_normal, tangent_normal};

    /// Returns just the front of the belly, which can be split finely.
    fn front_of_the_belly() -> Mesh {
        let mesh = low_mesh();
        let mut data = mesh.clone().into_data();
        let [left, right] = [3, 5].map(|j| atlas::strip_u(j) as f32);
        let [low, high] = [1, 3].map(|i| atlas::strip_v(atlas::STRIP_ROWS[i]) as f32);
        let inside = |i: &u32| {
            let uv = mesh.uvs()[0][*i as usize];
            uv.x > left - 1e-4 && uv.x < right + 1e-4 && uv.y < low + 1e-4 && uv.y > high - 1e-4
        };
        data.triangles.retain(|t| t.iter().all(inside));
        assert_eq!(data.triangles.len(), 8);
        Mesh::new(data).unwrap()
    }

    #[test]
    fn normal_map_agrees_with_the_displaced_surface() {
        // The finest lines are half a millimetre wide; both sides need to resolve them.
        const SIZE: u32 = 4096;
        let low = low_mesh();
        let surface = laid_out(&low, SIZE);
        let map = normal_map(SIZE);
        let taotie_engine::image::Texels::U16(map) = map.texels() else { panic!("expected 16 bits") };
        let fine = displaced::mesh(&front_of_the_belly(), 0.00006, height);
        let (mut sum, mut count) = (0.0, 0.0);
        for (uv, n) in fine.uvs()[0].iter().zip(fine.normals()) {
            let [x, y] = [uv.x, uv.y].map(|c| c * SIZE as f32);
            // Only near the centre of a texel, where filtering is not needed.
            if [x, y].iter().any(|c| (c - c.floor() - 0.5).abs() > 0.08) {
                continue;
            }
            let (x, y) = (x as u32, y as u32);
            let point = surface.point(x, y).unwrap();
            let [r, g, b, _] = map[(y * SIZE + x) as usize].map(|c| f64::from(c) / 65535.0);
            let stored = decode_normal(Vec3::new(r, g, b), 1.0, 1.0);
            let decoded = tangent_normal(point.normal, point.tangent, point.handedness, stored);
            sum += angle_deg(decoded, n.to_f64());
            count += 1.0;
        }
        assert!(count > 1000.0);
        let mean = sum / count;
        assert!(mean < 1.8, "mean {mean}°");
    }

    #[test]
    fn no_island_is_mirrored() {
        assert!(with_frames(&low_mesh()).tangents().iter().all(|t| t[3] == 1.0));
    }

    #[test]
    fn normal_map_is_unit_and_flat_away_from_relief() {
        let map = normal_map(256);
        let taotie_engine::image::Texels::U16(texels) = map.texels() else { panic!("expected 16 bits") };
        let decode = |t: &[u16; 4]| Vec3::new(t[0], t[1], t[2]).map(|c| f32::from(c) / 65535.0 * 2.0 - 1.0);
        assert!(texels.iter().all(|t| (decode(t).length() - 1.0).abs() < 1e-3 && decode(t).z > 0.0));
        assert!(decode(&texels[0]).z > 0.9999);
    }

    #[test]
    fn maps_do_not_depend_on_the_number_of_threads() {
        let maps = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| (height_map(200), normal_map(200), base_color_map(200), orm_map(200)))
        };
        assert!(maps(1) == maps(3));
    }

    #[test]
    fn patina_is_green_and_dull_in_recesses_and_metal_on_edges() {
        let (color, orm, height) = (base_color_map(1024), orm_map(1024), height_map(1024));
        let (taotie_engine::image::Texels::U8(color), taotie_engine::image::Texels::U8(orm)) =
            (color.texels(), orm.texels())
        else {
            panic!("expected 8 bits")
        };
        let taotie_engine::image::Texels::U16(height) = height.texels() else { panic!("expected 16 bits") };
        // Rows of the mask's panel.
        let rows = 1024 * 750..1024 * 900;
        let mean = |of: &dyn Fn(usize) -> f64, high: bool| {
            let chosen: Vec<usize> = rows.clone().filter(|i| (height[*i][0] > 40_000) == high).collect();
            chosen.iter().map(|i| of(*i)).sum::<f64>() / chosen.len() as f64
        };
        let green = |i: usize| f64::from(color[i][1]) - f64::from(color[i][0]);
        let metallic = |i: usize| f64::from(orm[i][2]);
        let occlusion = |i: usize| f64::from(orm[i][0]);
        assert!(mean(&green, false) > mean(&green, true) + 10.0);
        assert!(mean(&metallic, true) > mean(&metallic, false) + 20.0);
        assert!(mean(&occlusion, true) > mean(&occlusion, false) + 10.0);
    }
}
