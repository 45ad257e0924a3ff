//! The exact coverage of texel centres by triangles in uv space.

use super::owner::NONE;
use crate::error::{Error, Result};
use crate::math::Vec2;
use crate::parallel;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

/// The maximum number of copies of the map that a triangle's uvs may span.
const MOST_COPIES: f64 = 16.0;
/// Marks texels covered by more than one triangle.
const SHARED: u32 = 1 << 31;
/// Coordinates are below 2 to this power, so that their products fit in 63 bits.
const COORDINATE_BITS: i32 = 29;

/// Texels written to by many threads. The result does not depend on the order.
pub(super) struct Canvas {
    width: usize,
    height: usize,
    texels: Vec<AtomicU32>,
}

impl Canvas {
    pub fn new(width: u32, height: u32) -> Self {
        let (width, height) = (width as usize, height as usize);
        let texels = parallel::collect(width * height, |_| NONE);
        Self { width, height, texels: texels.into_iter().map(AtomicU32::new).collect() }
    }

    /// Returns the triangle of each texel, and the number of texels covered by more than one.
    pub fn finish(self) -> (Vec<u32>, usize) {
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
    pub fn draw(&self, triangle: usize, canvas: &Canvas) -> bool {
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
