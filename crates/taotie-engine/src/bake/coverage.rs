//! The triangle of a mesh that each texel of a map belongs to: exact coverage of texel centres in uv space, and
//! dilation of the UV islands.

use crate::error::{Error, Result};
use crate::image::Image;
use crate::math::Vec2;
use crate::mesh::Mesh;
use crate::parallel;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

/// Marks texels that belong to no triangle.
pub(super) const NONE: u32 = u32::MAX;
/// Marks padding texels; the other bits are the triangle.
const PADDING: u32 = 1 << 31;

/// The map on which a mesh is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TexelGrid {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// The uv set of the mesh.
    pub uv_set: usize,
    /// The number of texels by which UV islands are dilated.
    pub padding: u32,
}

/// The triangle that each texel belongs to.
///
/// A texel belongs to the triangle that covers its centre. Corners are rounded to fixed point and the rest is exact:
/// if triangles share an edge, only one of them covers a centre on it. If triangles overlap, the one with the lowest
/// index gets the texel. Uvs outside [0, 1] are wrapped.
///
/// A texel in the padding, which surrounds UV islands and continues across the map's borders, belongs to the triangle
/// of the nearest covered texel, counted in steps to the left, right, up and down.
#[derive(Debug, Clone)]
pub struct Coverage {
    width: u32,
    height: u32,
    /// The triangle, with [`PADDING`] set if its texel is in the padding; [`NONE`].
    texels: Vec<u32>,
    covered: usize,
    shared: usize,
    skipped: usize,
}

impl Coverage {
    /// Lays out the triangles of a mesh.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the mesh has no such uv set or a side of the map is zero, [`Error::Limit`] if a side is
    /// above [`Image::MAX_SIDE`], a triangle's uvs span more than 16 copies of the map, or the mesh has 2³¹
    /// triangles.
    pub fn new(mesh: &Mesh, grid: &TexelGrid) -> Result<Self> {
        let TexelGrid { width, height, .. } = *grid;
        Image::check_size(width, height)?;
        if mesh.triangles().len() >= PADDING as usize {
            return Err(Error::limit("a mesh of 2^31 triangles for a map", "split it"));
        }
        let uvs = uv_set(mesh, grid.uv_set)?;
        let rasterizer = Rasterizer::new(mesh.triangles(), uvs, [width, height])?;
        let canvas = Canvas::new(width, height);
        let skipped = parallel::count(mesh.triangles().len(), |t| !rasterizer.draw(t, &canvas));
        let (mut texels, shared) = canvas.finish();
        let covered = parallel::count(texels.len(), |i| texels[i] != NONE);
        grow(&mut texels, width as usize, grid.padding);
        Ok(Self { width, height, texels, covered, shared, skipped })
    }

    /// Texels across.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Texels down.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Returns the triangle that a texel belongs to, padding included.
    pub fn triangle(&self, x: u32, y: u32) -> Option<u32> {
        let texel = self.texels[self.index(x, y)];
        (texel != NONE).then_some(texel & !PADDING)
    }

    /// Returns `true` if a triangle covers the centre of a texel, excluding padding.
    pub fn is_covered(&self, x: u32, y: u32) -> bool {
        self.texels[self.index(x, y)] < PADDING
    }

    /// Returns a flag per texel, row by row from the top: `true` if a triangle covers its centre.
    pub fn mask(&self) -> Vec<bool> {
        parallel::collect(self.texels.len(), |i| self.texels[i] < PADDING)
    }

    /// Returns the number of texels whose centre is covered by a triangle.
    pub fn covered(&self) -> usize {
        self.covered
    }

    /// Returns the number of texels whose centre is covered by more than one triangle: UV islands that overlap, or
    /// uvs that wrap around.
    pub fn shared(&self) -> usize {
        self.shared
    }

    /// Returns the number of triangles that cannot cover a texel because their uvs span no area or are not finite.
    pub fn skipped(&self) -> usize {
        self.skipped
    }

    fn index(&self, x: u32, y: u32) -> usize {
        assert!(x < self.width && y < self.height, "texel ({x}, {y}) of {}x{}", self.width, self.height);
        y as usize * self.width as usize + x as usize
    }
}

/// Returns the uv set `set` of a mesh.
pub(super) fn uv_set(mesh: &Mesh, set: usize) -> Result<&[Vec2]> {
    mesh.uvs().get(set).map(Vec::as_slice).ok_or_else(|| {
        let count = mesh.uvs().len();
        Error::invalid(format!("uv set {set} for a map"), format!("the mesh has {count}; unwrap it first"))
    })
}

/// Dilates every UV island by `steps` texels into free ones, across the map's borders too.
///
/// In each step a free texel takes the triangle of its first neighbour that has one: left, right, above, below.
fn grow(texels: &mut [u32], width: usize, steps: u32) {
    let around = |i: usize| neighbors(i, width, texels.len());
    let is_front = |i: usize| texels[i] == NONE && around(i).into_iter().any(|k| texels[k] != NONE);
    let mut front: Vec<usize> = match steps {
        0 => return,
        _ => parallel::filter(texels.len(), is_front),
    };
    for _ in 0..steps {
        front = grow_by_one(texels, width, &front);
    }
}

/// Assigns the front, each texel of which has a neighbour with a triangle, to these triangles; returns the next
/// front.
fn grow_by_one(texels: &mut [u32], width: usize, front: &[usize]) -> Vec<usize> {
    let count = texels.len();
    let triangle = |i: usize| neighbors(i, width, count).into_iter().map(|k| texels[k]).find(|t| *t != NONE);
    let grown = parallel::collect(front.len(), |i| triangle(front[i]).unwrap_or(NONE) | PADDING);
    for (i, triangle) in front.iter().zip(grown) {
        texels[*i] = triangle;
    }
    let free = parallel::fold(front.len(), |free: &mut Vec<usize>, i| {
        free.extend(neighbors(front[i], width, count).into_iter().filter(|k| texels[*k] == NONE));
    });
    let mut next = free.concat();
    next.par_sort_unstable();
    next.dedup();
    next
}

/// Returns the neighbours: left, right, above, below; wrapped.
fn neighbors(i: usize, width: usize, count: usize) -> [usize; 4] {
    let x = i % width;
    let left = if x == 0 { i + width - 1 } else { i - 1 };
    let right = if x + 1 == width { i + 1 - width } else { i + 1 };
    [left, right, (i + count - width) % count, (i + width) % count]
}

/// The maximum number of copies of the map that a triangle's uvs may span.
const MOST_COPIES: f64 = 16.0;
/// Marks texels covered by more than one triangle.
const SHARED: u32 = 1 << 31;
/// Coordinates are below 2 to this power, so that their products fit in 63 bits.
const COORDINATE_BITS: i32 = 29;

/// Texels written to by many threads. The result does not depend on the order.
struct Canvas {
    width: usize,
    height: usize,
    texels: Vec<AtomicU32>,
}

impl Canvas {
    fn new(width: u32, height: u32) -> Self {
        let (width, height) = (width as usize, height as usize);
        let texels = parallel::collect(width * height, |_| NONE);
        Self { width, height, texels: texels.into_iter().map(AtomicU32::new).collect() }
    }

    /// Returns the triangle of each texel, and the number of texels covered by more than one.
    fn finish(self) -> (Vec<u32>, usize) {
        let mut texels: Vec<u32> = self.texels.into_iter().map(AtomicU32::into_inner).collect();
        let is_shared = |texel: u32| texel != NONE && texel & SHARED != 0;
        let shared = parallel::count(texels.len(), |i| is_shared(texels[i]));
        let plain = |texel: u32| if texel == NONE { NONE } else { texel & !SHARED };
        parallel::change(&mut texels, |_, texel| *texel = plain(*texel));
        (texels, shared)
    }

    /// Assigns texels `from` to `to` of row `y`, wrapped, to a triangle, unless one with a lower index has them.
    fn give(&self, y: i64, [from, to]: [i64; 2], triangle: u32) {
        let row = &self.texels[y as usize % self.height * self.width..][..self.width];
        for x in from..=to {
            let claim = |held: u32| match held {
                NONE => triangle,
                held => SHARED | triangle.min(held & !SHARED),
            };
            // The closure never declines.
            let _ = row[x as usize % self.width]
                .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |held| Some(claim(held)));
        }
    }
}

/// The triangles of a mesh laid out on a map.
pub(super) struct Rasterizer<'a> {
    triangles: &'a [[u32; 3]],
    uvs: &'a [Vec2],
    size: [f64; 2],
    /// Corners are rounded to this fraction of a texel: 2 to the power −`bits`.
    bits: u32,
}

/// An unlimited range of rows.
pub(super) const ALL_ROWS: Range<i64> = i64::MIN..i64::MAX;

/// A fixed-point position, in texels.
type Fixed = [i64; 2];

impl<'a> Rasterizer<'a> {
    /// Chooses one fixed-point precision for all triangles, so that shared corners stay shared.
    pub fn new(triangles: &'a [[u32; 3]], uvs: &'a [Vec2], [width, height]: [u32; 2]) -> Result<Self> {
        let mut rasterizer = Self { triangles, uvs, size: [width.into(), height.into()], bits: 0 };
        let reach =
            |t: usize| rasterizer.corners(t).map_or(0.0, |c| c.into_iter().flatten().fold(0.0, f64::max));
        let reaches = parallel::fold(triangles.len(), |most: &mut f64, t| *most = most.max(reach(t)));
        let reach = reaches.into_iter().fold(1.0, f64::max);
        let most = MOST_COPIES * f64::from(width.max(height));
        if reach > most {
            return Err(Error::limit(
                format!(
                    "a triangle whose uvs span {:.0} copies of the map",
                    reach / f64::from(width.max(height))
                ),
                format!("at most {MOST_COPIES}; unwrap it into UV islands instead of repeating the map"),
            ));
        }
        let mut bits = COORDINATE_BITS;
        while f64::from(1u32 << (COORDINATE_BITS - bits)) <= reach {
            bits -= 1;
        }
        rasterizer.bits = bits.min(20) as u32;
        Ok(rasterizer)
    }

    /// Draws a triangle; returns `false` if its uvs span no area or are not finite.
    fn draw(&self, triangle: usize, canvas: &Canvas) -> bool {
        self.spans(triangle, ALL_ROWS, |y, span| canvas.give(y, span, triangle as u32))
    }

    /// Calls `give` with each row of a triangle among `rows` and the first and last of its columns there; rows and
    /// columns extend beyond the map if the triangle does. Returns `false` in the same cases as [`Rasterizer::draw`].
    #[inline]
    pub fn spans(&self, triangle: usize, rows: Range<i64>, mut give: impl FnMut(i64, [i64; 2])) -> bool {
        let Some(corners) = self.corners(triangle) else { return false };
        let scale = f64::from(1u32 << self.bits);
        let [a, b, c] = corners.map(|p| p.map(|v| (v * scale + 0.5).floor() as i64));
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        match area {
            0 => return false,
            area if area > 0 => self.fill([a, b, c], rows, &mut give),
            _ => self.fill([a, c, b], rows, &mut give),
        }
        true
    }

    /// Returns the corners in texels, moved by whole copies of the map so that their minimum is in the first copy.
    pub fn corners(&self, triangle: usize) -> Option<[[f64; 2]; 3]> {
        let uvs = self.triangles[triangle].map(|v| self.uvs[v as usize]);
        let wide = uvs.map(|uv| [f64::from(uv.x), f64::from(uv.y)]);
        let [a, b, c] = wide;
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if !area.is_finite() || area == 0.0 {
            return None;
        }
        let least = |k: usize| a[k].min(b[k]).min(c[k]).floor();
        let first = [least(0), least(1)];
        Some(wide.map(|p| [0, 1].map(|k| (p[k] - first[k]) * self.size[k])))
    }

    /// Passes on the texels whose centres are inside the triangle, whose corners run clockwise in the image.
    fn fill(&self, corners: [Fixed; 3], rows: Range<i64>, give: &mut impl FnMut(i64, [i64; 2])) {
        let (unit, half) = (1i64 << self.bits, (1i64 << self.bits) >> 1);
        let [a, b, c] = corners;
        let (top, bottom) = (a[1].min(b[1]).min(c[1]), a[1].max(b[1]).max(c[1]));
        let first = ceil_div(top - half, unit).max(rows.start);
        for y in first..((bottom - half).div_euclid(unit) + 1).min(rows.end) {
            let mut span = [i64::MIN, i64::MAX];
            for (p, q) in [(a, b), (b, c), (c, a)] {
                narrow(&mut span, p, q, [half, y * unit + half, unit]);
            }
            if span[0] <= span[1] {
                give(y, span);
            }
        }
    }
}

/// Narrows the columns of a row to those whose centres are inside an edge.
///
/// The centre of column i is (half + i · unit, y). Inside is where E(i) = d.x (y − p.y) − d.y (x − p.x) is above 0; a
/// centre on the edge is inside if the edge runs down, or straight to the left: of two triangles that run along an
/// edge in opposite directions, exactly one gets it.
fn narrow(span: &mut [i64; 2], p: Fixed, q: Fixed, [half, y, unit]: [i64; 3]) {
    let d = [q[0] - p[0], q[1] - p[1]];
    let on_edge_is_inside = d[1] > 0 || (d[1] == 0 && d[0] < 0);
    let start = d[0] * (y - p[1]) - d[1] * (half - p[0]) - i64::from(!on_edge_is_inside);
    let step = d[1] * unit;
    match step {
        0 if start >= 0 => {}
        0 => *span = [0, -1],
        step if step > 0 => span[1] = span[1].min(start.div_euclid(step)),
        step => span[0] = span[0].max(ceil_div(-start, -step)),
    }
}

/// Returns a / b rounded up; b must be above 0.
fn ceil_div(a: i64, b: i64) -> i64 {
    -(-a).div_euclid(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::mesh::MeshData;

    /// Makes a mesh with these uvs, three per triangle.
    fn mesh(uvs: &[[f32; 2]]) -> Mesh {
        let uvs: Vec<Vec2> = uvs.iter().map(|[u, v]| Vec2::new(*u, *v)).collect();
        let positions = vec![Vec3::splat(0.0); uvs.len()];
        let triangles = (0..uvs.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Mesh::new(MeshData { positions, uvs: vec![uvs], triangles, ..MeshData::default() }).unwrap()
    }

    fn grid(width: u32, height: u32, padding: u32) -> TexelGrid {
        TexelGrid { width, height, uv_set: 0, padding }
    }

    /// Returns the map as text: triangle indices as digits, as letters in the padding, and dots for free texels.
    fn text(coverage: &Coverage) -> String {
        let texel = |y: u32, x: u32| match (coverage.triangle(x, y), coverage.is_covered(x, y)) {
            (None, _) => '.',
            (Some(t), true) => char::from(b'0' + t as u8),
            (Some(t), false) => char::from(b'a' + t as u8),
        };
        let row = |y: u32| (0..coverage.width()).map(|x| texel(y, x)).collect::<String>();
        (0..coverage.height()).map(row).collect::<Vec<_>>().join("/")
    }

    #[test]
    fn the_two_halves_of_a_square_share_no_texel_and_leave_none() {
        let square = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.0, 0.0], [1.0, 1.0], [1.0, 0.0]];
        let coverage = Coverage::new(&mesh(&square), &grid(4, 4, 0)).unwrap();
        assert_eq!((coverage.covered(), coverage.shared()), (16, 0), "{}", text(&coverage));
        // The same, mirrored.
        let mirrored: Vec<[f32; 2]> = square.iter().map(|[u, v]| [1.0 - u, *v]).collect();
        let coverage = Coverage::new(&mesh(&mirrored), &grid(4, 4, 0)).unwrap();
        assert_eq!((coverage.covered(), coverage.shared()), (16, 0), "{}", text(&coverage));
    }

    #[test]
    fn the_lowest_number_has_a_texel_that_is_shared() {
        let corner = [[0.0, 0.0], [0.0, 0.45], [0.45, 0.0]];
        let all = [[0.0, 0.0], [0.0, 2.0], [2.0, 0.0]];
        let both = |first: [[f32; 2]; 3], second: [[f32; 2]; 3]| {
            let coverage = Coverage::new(&mesh(&[first, second].concat()), &grid(4, 4, 0)).unwrap();
            (text(&coverage), coverage.shared())
        };
        let (small_first, shared) = both(corner, all);
        assert_eq!(small_first, "0111/1111/1111/1111");
        assert!(shared >= 1);
        assert_eq!(both(all, corner).0, "0000/0000/0000/0000");
    }

    #[test]
    fn padding_goes_around_islands_and_across_borders() {
        let left = [[0.0, 0.25], [0.0, 0.45], [0.2, 0.25]];
        let coverage = Coverage::new(&mesh(&left), &grid(8, 8, 0)).unwrap();
        assert_eq!(
            text(&coverage),
            "......../......../0......./......../......../......../......../........"
        );
        let coverage = Coverage::new(&mesh(&left), &grid(8, 8, 1)).unwrap();
        assert_eq!(
            text(&coverage),
            "......../a......./0a.....a/a......./......../......../......../........"
        );
        assert_eq!((coverage.covered(), coverage.mask().iter().filter(|m| **m).count()), (1, 1));
    }

    #[test]
    fn uvs_outside_are_wrapped() {
        let plain = [[0.125, 0.125], [0.125, 0.875], [0.875, 0.125]];
        let moved: Vec<[f32; 2]> = plain.iter().map(|[u, v]| [u + 3.0, v - 2.0]).collect();
        let [a, b] =
            [&plain[..], &moved].map(|uvs| text(&Coverage::new(&mesh(uvs), &grid(16, 16, 2)).unwrap()));
        assert_eq!(a, b);
        // Across the border: half of a square on the left, half on the right.
        let across = [[0.75, 0.0], [0.75, 1.0], [1.25, 1.0], [0.75, 0.0], [1.25, 1.0], [1.25, 0.0]];
        let coverage = Coverage::new(&mesh(&across), &grid(4, 1, 0)).unwrap();
        assert_eq!((text(&coverage).replace('1', "0").as_str(), coverage.shared()), ("0..0", 0));
    }

    #[test]
    fn triangles_without_area_cover_nothing_and_are_counted() {
        let uvs = [[0.1, 0.1], [0.2, 0.2], [0.3, 0.3], [f32::NAN, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let coverage = Coverage::new(&mesh(&uvs), &grid(8, 8, 3)).unwrap();
        assert_eq!((coverage.covered(), coverage.skipped()), (0, 2));
    }

    #[test]
    fn what_cannot_be_laid_out_is_refused() {
        let sound = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let far = [[0.0, 0.0], [0.0, 1.0], [40.0, 1.0]];
        let refused =
            |uvs: &[[f32; 2]], grid: TexelGrid| Coverage::new(&mesh(uvs), &grid).unwrap_err().to_string();
        assert!(refused(&sound, TexelGrid { uv_set: 1, ..grid(4, 4, 0) }).contains("uv set 1"));
        assert!(refused(&sound, grid(0, 4, 0)).contains("0x4"));
        assert!(refused(&far, grid(4, 4, 0)).contains("copies of the map"));
    }
}
