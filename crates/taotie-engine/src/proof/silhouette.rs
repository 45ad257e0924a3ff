//! Outlines of scan and asset from all sides.

use super::Pair;
use super::overview::{SIDE, VIEWS, View};
use crate::bake::{Scan, sphere_directions};
use crate::math::Vec3;
use crate::parallel;
use crate::trace::{EightTriangles, Sweep};

/// The deviation of an asset's outlines from those of its scan over 32 fixed views, the object filling 512² pixels.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct SilhouetteFigures {
    /// The mean distance from the asset's outline to the scan's and back, in pixels.
    pub mean_pixels: f64,
    /// The largest such distance, in pixels.
    pub max_pixels: f64,
    /// The largest such distance, in model units.
    pub max_length: f64,
}

/// Compares the outlines of both surfaces.
pub fn silhouettes(pair: &Pair<'_>) -> SilhouetteFigures {
    let directions = sphere_directions(VIEWS);
    let shapes = [pair.scan, pair.asset].map(|side| Shape::of(side.surface));
    let views = parallel::tasks(VIEWS, &|i| {
        let view = View::fitting(pair, (directions[i], SIDE as f32));
        let [scan, asset] = [0, 1].map(|of| Mask::of(&shapes[of], &view).outline());
        let found = scan.distances(&asset).into_iter().chain(asset.distances(&scan));
        let mut sums = Sums::default();
        found.for_each(|distance| sums.add(distance));
        (sums, f64::from(view.pixel))
    });
    let mut figures = SilhouetteFigures::default();
    let (mut sum, mut count) = (0.0, 0);
    for (sums, pixel) in views {
        (sum, count) = (sum + sums.sum, count + sums.count);
        figures.max_pixels = figures.max_pixels.max(sums.most);
        figures.max_length = figures.max_length.max(sums.most * pixel);
    }
    figures.mean_pixels = sum / f64::from(count.max(1));
    figures
}

#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    sum: f64,
    most: f64,
    count: u32,
}

impl Sums {
    fn add(&mut self, distance: f64) {
        (self.sum, self.most, self.count) = (self.sum + distance, self.most.max(distance), self.count + 1);
    }
}

/// A surface, and which of its triangles are drawn on both sides; empty if none are.
struct Shape<'a> {
    surface: &'a Scan,
    is_double_sided: Vec<bool>,
    /// Rounding of positions, in model units.
    slack: f32,
}

impl<'a> Shape<'a> {
    fn of(surface: &'a Scan) -> Self {
        let mesh = surface.mesh();
        let is_double = |t: usize| surface.surface().material(t as u32).double_sided;
        let mut is_double_sided = parallel::collect(mesh.triangles().len(), is_double);
        if !is_double_sided.contains(&true) {
            is_double_sided.clear();
        }
        Self { surface, is_double_sided, slack: mesh.rounding() }
    }
}

/// Bits of a row of pixels, and of a whole picture.
const WORDS: usize = SIDE / 64;
type Rows = Vec<[u64; WORDS]>;
/// A box with a smaller product of sides is tested pixel by pixel.
const FEW: usize = 16;

/// The pixels whose centres a surface covers in a view. Backfaces are not drawn, except for double-sided materials.
struct Mask {
    rows: Rows,
}

/// A surface being drawn.
struct Drawing<'a> {
    mask: Mask,
    shape: &'a Shape<'a>,
    view: &'a View,
    /// Across and down the picture, in pixels.
    axes: [Vec3; 2],
}

impl Drawing<'_> {
    /// Returns the position of a point in the picture, in pixels; integers are the centres of pixels.
    #[inline(always)]
    fn place(&self, p: Vec3) -> [f32; 2] {
        let away = p - self.view.corner;
        [self.axes[0].dot(away) - 0.5, self.axes[1].dot(away) - 0.5]
    }
}

impl Sweep for Drawing<'_> {
    /// Returns `true` if the box contains the centre of a pixel that is not covered yet.
    fn wants(&self, [low, high]: [Vec3; 2]) -> bool {
        let middle = self.place((low + high) * 0.5);
        let half = (high - low) * 0.5;
        let range = |k: usize| {
            let axis = self.axes[k];
            let reach = axis.x.abs() * half.x + axis.y.abs() * half.y + axis.z.abs() * half.z;
            let reach = reach + self.shape.slack / self.view.pixel + MARGIN;
            whole([middle[k] - reach, middle[k] + reach])
        };
        let (Some([left, right]), Some([top, bottom])) = (range(0), range(1)) else { return false };
        self.mask.rows[top..=bottom].iter().any(|row| !is_set(row, left, right))
    }

    fn take(&mut self, triangles: &[u32], corners: &EightTriangles) {
        // Eight in parallel: absent ones are NaN.
        let mut places = [[[0.0; LANES]; 2]; 3];
        for (place, [x, y, z]) in places.iter_mut().zip(corners) {
            for i in 0..LANES {
                let [across, down] = self.place(Vec3::new(x[i], y[i], z[i]));
                (place[0][i], place[1][i]) = (across, down);
            }
        }
        let [[columns, rows], [last_columns, last_rows]] = pixel_boxes(&places);
        // Most triangles of a scan contain no centre of a pixel.
        let mut some = 0u32;
        for i in 0..LANES {
            some |= u32::from((columns[i] <= last_columns[i]) & (rows[i] <= last_rows[i])) << i;
        }
        while some != 0 {
            let i = some.trailing_zeros() as usize;
            some &= some - 1;
            let Some(triangle) = triangles.get(i) else { break };
            let corners = places.each_ref().map(|[x, y]| [x[i], y[i]]);
            let is_double = || self.shape.is_double_sided.get(*triangle as usize) == Some(&true);
            if faces_viewer(corners) || is_double() {
                let pixels = [columns[i], last_columns[i], rows[i], last_rows[i]];
                self.mask.cover(corners, pixels.map(|v| v as usize));
            }
        }
    }
}

/// Returns the first and the last columns and rows of the pixels whose centres are in the boxes around triangles:
/// `[[columns, rows], [last columns, last rows]]`.
#[inline(always)]
fn pixel_boxes([a, b, c]: &[[[f32; LANES]; 2]; 3]) -> [[[f32; LANES]; 2]; 2] {
    let mut boxes = [[[0.0; LANES]; 2]; 2];
    for axis in 0..2 {
        for i in 0..LANES {
            let [a, b, c] = [a[axis][i], b[axis][i], c[axis][i]];
            let [first, last] = pixels([a.min(b).min(c), a.max(b).max(c)]);
            (boxes[0][axis][i], boxes[1][axis][i]) = (first, last);
        }
    }
    boxes
}

/// Number of triangles placed in one batch.
const LANES: usize = 8;
/// Rounding of positions within a picture, in pixels.
const MARGIN: f32 = 1e-3;

impl Mask {
    fn of(shape: &Shape<'_>, view: &View) -> Self {
        let mask = Self { rows: vec![[0; WORDS]; SIDE] };
        let mut drawing =
            Drawing { mask, shape, view, axes: view.axes.map(|axis| axis * (1.0 / view.pixel)) };
        shape.surface.bvh().sweep(view.toward, &mut drawing);
        drawing.mask
    }

    /// Covers the pixels of a box whose centres, at integers, are inside a triangle or on its border.
    fn cover(&mut self, corners: [[f32; 2]; 3], [left, right, top, bottom]: [usize; 4]) {
        if self.rows[top..=bottom].iter().all(|row| is_set(row, left, right)) {
            return;
        }
        // Spans pay off for larger triangles.
        if (right - left) * (bottom - top) < FEW {
            return self.cover_few(corners, [left, right, top, bottom]);
        }
        for y in top..=bottom {
            let span = across(corners, y as f32);
            if let Some([from, to]) = whole(span).filter(|[from, to]| from.max(&left) <= to.min(&right)) {
                set(&mut self.rows[y], from.max(left), to.min(right));
            }
        }
    }

    /// Covers the pixels of a small box that are inside a triangle or on its border.
    fn cover_few(&mut self, [a, b, c]: [[f32; 2]; 3], [left, right, top, bottom]: [usize; 4]) {
        let edge = |p: [f32; 2], q: [f32; 2], [x, y]: [f32; 2]| {
            (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
        };
        for y in top..=bottom {
            for x in left..=right {
                let at = [x as f32, y as f32];
                let sides = [edge(a, b, at), edge(b, c, at), edge(c, a, at)];
                let is_inside = sides[0] >= 0.0 && sides[1] >= 0.0 && sides[2] >= 0.0
                    || sides[0] <= 0.0 && sides[1] <= 0.0 && sides[2] <= 0.0;
                self.rows[y][x / 64] |= u64::from(is_inside) << (x % 64);
            }
        }
    }

    /// Returns the covered pixels that have an uncovered neighbour.
    fn outline(&self) -> Outline {
        let rows = &self.rows;
        let row = |y: usize| {
            let none = &[0; WORDS];
            let above = if y == 0 { none } else { &rows[y - 1] };
            let below = rows.get(y + 1).unwrap_or(none);
            std::array::from_fn(|w| {
                let before = if w == 0 { 0 } else { rows[y][w - 1] >> 63 };
                let after = rows[y].get(w + 1).map_or(0, |word| word << 63);
                let own = rows[y][w];
                own & !((own << 1 | before) & (own >> 1 | after) & above[w] & below[w])
            })
        };
        Outline { rows: (0..SIDE).map(row).collect() }
    }
}

/// Returns `true` if the corners have the winding of a front face: the axes across, down the picture and towards the
/// viewer are right-handed.
fn faces_viewer([a, b, c]: [[f32; 2]; 3]) -> bool {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) >= 0.0
}

/// Returns the first and the last integer of a range that are pixels; `None` if there are none.
fn whole(range: [f32; 2]) -> Option<[usize; 2]> {
    let [first, last] = pixels(range);
    (first <= last).then_some([first as usize, last as usize])
}

/// Returns the first and the last integer of a range that are pixels; if there are none, the last is less than the
/// first. Without branches, and with conversions, which are faster than rounding.
#[inline(always)]
fn pixels([from, to]: [f32; 2]) -> [f32; 2] {
    let from = from.max(0.0);
    let below = from as i32 as f32;
    let first = if below < from { below + 1.0 } else { below };
    let last = to.min(SIDE as f32 - 1.0) as i32 as f32;
    [first, if to >= 0.0 { last } else { -1.0 }]
}

/// Returns where a row enters and leaves a triangle; nothing if it does not intersect it.
fn across(corners: [[f32; 2]; 3], y: f32) -> [f32; 2] {
    let mut span = [f32::INFINITY, f32::NEG_INFINITY];
    for (k, [x, from]) in corners.into_iter().enumerate() {
        let [next, to] = corners[(k + 1) % 3];
        if from.min(to) <= y && y <= from.max(to) {
            let part = if to == from { 0.0 } else { (y - from) / (to - from) };
            let at = x + (next - x) * part;
            span = [span[0].min(at), span[1].max(at)];
            // Along the row, from one corner to the other.
            if to == from {
                span = [span[0].min(next), span[1].max(next)];
            }
        }
    }
    span
}

/// Sets the bits of the columns `from` to `to`, inclusive.
fn set(row: &mut [u64; WORDS], from: usize, to: usize) {
    for (i, word) in row.iter_mut().enumerate().take(to / 64 + 1).skip(from / 64) {
        *word |= bits(i, from, to);
    }
}

/// Returns `true` if the bits of the columns `from` to `to`, inclusive, are set.
fn is_set(row: &[u64; WORDS], from: usize, to: usize) -> bool {
    (from / 64..=to / 64).all(|i| !row[i] & bits(i, from, to) == 0)
}

/// Returns the bits of word `i` that belong to the columns `from` to `to`.
fn bits(i: usize, from: usize, to: usize) -> u64 {
    let low = if i == from / 64 { u64::MAX << (from % 64) } else { u64::MAX };
    let high = if i == to / 64 { u64::MAX >> (63 - to % 64) } else { u64::MAX };
    low & high
}

/// The pixels of an outline.
struct Outline {
    rows: Rows,
}

impl Outline {
    fn holds(&self, x: isize, y: isize) -> bool {
        let side = 0..SIDE as isize;
        side.contains(&x)
            && side.contains(&y)
            && self.rows[y as usize][x as usize / 64] >> (x as usize % 64) & 1 != 0
    }

    fn pixels(&self) -> Vec<[isize; 2]> {
        let mut pixels = Vec::new();
        for (y, row) in self.rows.iter().enumerate() {
            for (w, word) in row.iter().enumerate() {
                let mut rest = *word;
                while rest != 0 {
                    pixels.push([(w * 64) as isize + rest.trailing_zeros() as isize, y as isize]);
                    rest &= rest - 1;
                }
            }
        }
        pixels
    }

    /// Returns the distance of each of its pixels from another outline, in pixels; the width of the picture if that
    /// is empty.
    fn distances(&self, other: &Self) -> Vec<f64> {
        /// Pixels are searched one by one up to this distance.
        const REACH: isize = 4;
        let around = (-REACH..=REACH).flat_map(|v| (-REACH..=REACH).map(move |u| [u, v]));
        let mut near: Vec<(isize, [isize; 2])> = around.map(|[u, v]| (u * u + v * v, [u, v])).collect();
        near.retain(|(squared, _)| *squared <= REACH * REACH);
        near.sort_unstable();
        let others = other.pixels();
        let distance = |[x, y]: [isize; 2]| {
            let close =
                near.iter().find(|(_, [u, v])| other.holds(x + u, y + v)).map(|(squared, _)| *squared);
            let far = || others.iter().map(|[u, v]| (u - x).pow(2) + (v - y).pow(2)).min();
            close.or_else(far).map_or(SIDE as f64, |squared| (squared as f64).sqrt())
        };
        self.pixels().into_iter().map(distance).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn masked(triangles: &[[[f32; 2]; 3]]) -> Mask {
        let mut mask = Mask { rows: vec![[0; WORDS]; SIDE] };
        for triangle in triangles {
            let range = |k: usize| {
                let [a, b, c] = triangle.map(|corner| corner[k]);
                whole([a.min(b).min(c), a.max(b).max(c)])
            };
            if let (Some([left, right]), Some([top, bottom])) = (range(0), range(1)) {
                mask.cover(*triangle, [left, right, top, bottom]);
            }
        }
        mask
    }

    #[test]
    fn pixels_whose_middles_lie_inside_are_covered() {
        let triangles = [
            [[3.2, 4.7], [130.4, 60.1], [20.9, 200.3]],
            [[-50.0, 300.0], [600.0, 310.5], [70.0, 511.9]],
            [[200.5, 100.5], [200.9, 100.6], [200.7, 100.9]],
        ];
        for triangle in triangles {
            let mask = masked(&[triangle]);
            let edge = |p: [f32; 2], q: [f32; 2], x: f32, y: f32| {
                (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
            };
            for y in 0..SIDE {
                for x in 0..SIDE {
                    let sides =
                        [0, 1, 2].map(|k| edge(triangle[k], triangle[(k + 1) % 3], x as f32, y as f32));
                    let is_inside =
                        sides.iter().all(|side| *side > 0.5) || sides.iter().all(|side| *side < -0.5);
                    let is_outside =
                        sides.iter().any(|side| *side > 0.5) && sides.iter().any(|side| *side < -0.5);
                    let is_covered = mask.rows[y][x / 64] >> (x % 64) & 1 != 0;
                    assert!(!is_inside || is_covered, "({x}, {y}) of {triangle:?}");
                    assert!(!is_outside || !is_covered, "({x}, {y}) of {triangle:?}");
                }
            }
        }
    }

    #[test]
    fn outlines_that_are_moved_lie_that_far_apart() {
        let square = |x: f32, side: f32| {
            let [a, b] = [[x, 100.0], [x + side, 100.0]];
            let [c, d] = [[x + side, 100.0 + side], [x, 100.0 + side]];
            masked(&[[a, b, c], [a, c, d]]).outline()
        };
        let one = square(60.0, 80.0);
        assert_eq!(one.pixels().len(), 4 * 80);
        assert!(one.distances(&square(60.0, 80.0)).iter().all(|distance| *distance == 0.0));
        let most = |other: &Outline| one.distances(other).into_iter().fold(0.0, f64::max);
        assert_eq!((most(&square(63.0, 80.0)), most(&square(67.0, 80.0))), (3.0, 7.0));
        assert_eq!(most(&masked(&[]).outline()), SIDE as f64);
    }
}
