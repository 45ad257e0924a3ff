//! From clip space to the screen: vertices snapped to its grid, once per vertex, and triangles clipped in homogeneous
//! coordinates.

use super::{Faces, SUBPIXELS, Viewport};
use crate::math::dispatch_registers;
use fearless_simd::{Level, Simd, f32x4, f32x8, f64x4, i32x8, prelude::*};
use rayon::prelude::*;

/// Vertices per task.
const BLOCK: usize = 4096;

/// Vertices processed side by side.
const PACK: usize = 8;

/// Vertices on the screen.
#[derive(Debug, Default)]
pub(super) struct ScreenVertices {
    /// x and y in 1/256 pixel, or, for a vertex outside the clip volume, a pair that is far from all those inside:
    /// only triangles of vertices inside, or all outside the same planes, have corners near one another, and the
    /// latter have no area.
    pub places: Vec<[i32; 2]>,
    /// Reversed depth, z/w; meaningless outside.
    pub depths: Vec<f32>,
}

/// The x of vertices outside; the planes are added to it.
const OUTSIDE: f64 = -1_073_741_824.0;

/// The distance in x between vertices outside different planes.
const OUTSIDE_STEP: f64 = 65536.0;

impl ScreenVertices {
    /// Replaces all vertices, reusing the memory.
    pub fn fill(&mut self, clip: &[[f32; 4]], viewport: &Viewport, level: Level) {
        let volume = ClipVolume::new(viewport);
        let size = [viewport.width, viewport.height].map(f64::from);
        self.places.resize(clip.len(), [0; 2]);
        self.depths.resize(clip.len(), 0.0);
        let places = self.places.par_chunks_mut(BLOCK);
        let depths = self.depths.par_chunks_mut(BLOCK);
        clip.par_chunks(BLOCK).zip(places.zip(depths)).for_each(|(clip, (places, depths))| {
            dispatch_registers!(level, simd => Snap { simd, volume, size }.all(clip, places, depths));
        });
    }
}

/// The inputs for snapping a pack of vertices.
struct Snap<S> {
    simd: S,
    volume: ClipVolume,
    size: [f64; 2],
}

impl<S: Simd> Snap<S> {
    #[inline(always)]
    fn all(&self, clip: &[[f32; 4]], places: &mut [[i32; 2]], depths: &mut [f32]) {
        let whole = clip.len() / PACK * PACK;
        let mut i = 0;
        while i < whole {
            self.pack(&clip[i..i + PACK], &mut places[i..i + PACK], &mut depths[i..i + PACK]);
            i += PACK;
        }
        let rest = clip.len() - whole;
        let mut last = [[0.0; 4]; PACK];
        last[..rest].copy_from_slice(&clip[whole..]);
        let (mut last_places, mut last_depths) = ([[0; 2]; PACK], [0.0; PACK]);
        self.pack(&last, &mut last_places, &mut last_depths);
        places[whole..].copy_from_slice(&last_places[..rest]);
        depths[whole..].copy_from_slice(&last_depths[..rest]);
    }

    #[inline(always)]
    fn pack(&self, clip: &[[f32; 4]], places: &mut [[i32; 2]], depths: &mut [f32]) {
        let (low, high) = clip.as_flattened().split_at(4 * PACK / 2);
        let [x0, y0, z0, w0] = f32x4::load_four_interleaved(self.simd, low);
        let [x1, y1, z1, w1] = f32x4::load_four_interleaved(self.simd, high);
        let (x, y) = (x0.combine(x1).widen(), y0.combine(y1).widen());
        let (z, w) = (z0.combine(z1).widen(), w0.combine(w1).widen());
        let low = self.four([x.0, y.0, z.0, w.0]);
        let high = self.four([x.1, y.1, z.1, w.1]);
        let [x, y, depth] = [low[0].narrow(high[0]), low[1].narrow(high[1]), low[2].narrow(high[2])];
        // Integers of at most 24 bits, or with few bits, are exact as floats.
        let (x, y): (i32x8<S>, i32x8<S>) = (x.to_int_precise(), y.to_int_precise());
        let (first, second) = x.interleave(y);
        let places = places.as_flattened_mut();
        first.store_slice(&mut places[..PACK]);
        second.store_slice(&mut places[PACK..]);
        let depth: f32x8<S> = depth;
        depth.store_slice(depths);
    }

    /// Returns snapped x and y, and depth.
    #[inline(always)]
    fn four(&self, [x, y, z, w]: [f64x4<S>; 4]) -> [f64x4<S>; 3] {
        let planes = self.outside([x, y, z, w]);
        let inside = planes.simd_eq(self.splat(0.0));
        let [width, height] = self.size;
        let column = self.snap((x / w + 1.0) * 0.5 * width);
        let row = self.snap((self.splat(1.0) - y / w) * 0.5 * height);
        let far = planes * OUTSIDE_STEP + OUTSIDE;
        [inside.select(column, far), inside.select(row, self.splat(0.0)), z / w]
    }

    #[inline(always)]
    fn snap(&self, v: f64x4<S>) -> f64x4<S> {
        (v * f64::from(SUBPIXELS) + 0.5).floor()
    }

    /// The sum of the bits of the planes that vertices are outside of, as numbers.
    #[inline(always)]
    fn outside(&self, [x, y, z, w]: [f64x4<S>; 4]) -> f64x4<S> {
        let (guard_x, guard_y) = (w * self.volume.guard_x, w * self.volume.guard_y);
        let zero = self.splat(0.0);
        // A NaN distance counts as outside.
        let depth = (w - z).simd_ge(zero).select(zero, self.splat(1.0))
            + z.simd_ge(zero).select(zero, self.splat(2.0));
        let across = (guard_x + x).simd_ge(zero).select(zero, self.splat(4.0))
            + (guard_x - x).simd_ge(zero).select(zero, self.splat(8.0));
        let down = (guard_y + y).simd_ge(zero).select(zero, self.splat(16.0))
            + (guard_y - y).simd_ge(zero).select(zero, self.splat(32.0));
        depth + across + down
    }

    #[inline(always)]
    fn splat(&self, value: f64) -> f64x4<S> {
        f64x4::splat(self.simd, value)
    }
}

/// A triangle on the screen with its corners in clockwise order (y down), positions in 1/256 pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct ScreenTriangle {
    pub x: [i32; 3],
    pub y: [i32; 3],
    /// Reversed depth, z/w.
    pub depth: [f32; 3],
    pub id: u32,
}

impl ScreenTriangle {
    /// Left, top, right and bottom in 1/256 pixel.
    pub fn bounds(&self) -> [i32; 4] {
        let low = |v: [i32; 3]| v[0].min(v[1]).min(v[2]);
        let high = |v: [i32; 3]| v[0].max(v[1]).max(v[2]);
        [low(self.x), low(self.y), high(self.x), high(self.y)]
    }

    /// Returns the triangle with the opposite orientation.
    pub fn turned(mut self) -> Self {
        self.x.swap(1, 2);
        self.y.swap(1, 2);
        self.depth.swap(1, 2);
        self
    }
}

/// The inputs for converting clip space to screen triangles one by one: the slow path, for clipped or large ones.
pub(super) struct Setup<'a> {
    viewport: &'a Viewport,
    volume: ClipVolume,
    faces: Faces,
}

impl<'a> Setup<'a> {
    pub fn new(viewport: &'a Viewport, faces: Faces) -> Self {
        Self { viewport, volume: ClipVolume::new(viewport), faces }
    }

    /// Adds the parts of a triangle that remain after clipping and culling.
    pub fn push(&self, corners: [ClipVertex; 3], id: u32, out: &mut Vec<ScreenTriangle>) {
        let codes = corners.map(|v| self.volume.outcode(v));
        if codes[0] & codes[1] & codes[2] != 0 {
            return;
        }
        let planes = codes[0] | codes[1] | codes[2];
        if planes == 0 {
            out.extend(self.screen_triangle(corners, id));
            return;
        }
        let polygon = self.volume.clip(corners, planes);
        if let [first, rest @ ..] = polygon.corners() {
            for pair in rest.windows(2) {
                out.extend(self.screen_triangle([*first, pair[0], pair[1]], id));
            }
        }
    }

    fn screen_triangle(&self, corners: [ClipVertex; 3], id: u32) -> Option<ScreenTriangle> {
        let [width, height] = [self.viewport.width, self.viewport.height].map(f64::from);
        let subpixels = f64::from(SUBPIXELS);
        let snap = |v: f64| (v * subpixels + 0.5).floor() as i32;
        let x = corners.map(|[x, _, _, w]| snap((x / w + 1.0) * 0.5 * width));
        let y = corners.map(|[_, y, _, w]| snap((1.0 - y / w) * 0.5 * height));
        let depth = corners.map(|[_, _, z, w]| (z / w) as f32);
        let area = cross(x, y);
        let [clockwise, counter_clockwise] = self.faces.turns();
        if !(clockwise && area > 0 || counter_clockwise && area < 0) {
            return None;
        }
        let triangle = ScreenTriangle { x, y, depth, id };
        let triangle = if area < 0 { triangle.turned() } else { triangle };
        self.may_cover(&triangle).then_some(triangle)
    }

    /// Returns true if the triangle's box contains a sample of the image.
    fn may_cover(&self, triangle: &ScreenTriangle) -> bool {
        let [left, top, right, bottom] = triangle.bounds();
        if right < 0 || bottom < 0 {
            return false;
        }
        if left >= self.viewport.width as i32 * SUBPIXELS || top >= self.viewport.height as i32 * SUBPIXELS {
            return false;
        }
        self.viewport.pattern.offsets().iter().any(|[sx, sy]| {
            let holds = |low: i32, high: i32, offset: i32| {
                (low - offset + SUBPIXELS - 1).div_euclid(SUBPIXELS) <= (high - offset).div_euclid(SUBPIXELS)
            };
            holds(left, right, *sx) && holds(top, bottom, *sy)
        })
    }
}

/// Returns twice the signed area, positive clockwise with y down.
fn cross(x: [i32; 3], y: [i32; 3]) -> i64 {
    let [x, y] = [x.map(i64::from), y.map(i64::from)];
    (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
}

/// The distance outside the image at which vertices are clipped, in pixels.
const GUARD: f64 = 8192.0;

/// A vertex in clip space: x, y, z, w.
type ClipVertex = [f64; 4];

/// The maximum number of corners of a triangle after six planes.
const MAX_CORNERS: usize = 9;

/// A convex polygon of at most nine corners.
#[derive(Debug, Clone, Copy)]
struct Polygon {
    corners: [ClipVertex; MAX_CORNERS],
    count: usize,
}

/// The half-spaces that contain the geometry: near, far, and four guard planes outside the image that keep screen
/// coordinates small enough for exact edge functions.
#[derive(Debug, Clone, Copy)]
struct ClipVolume {
    /// The limit of |x/w|.
    guard_x: f64,
    /// The limit of |y/w|.
    guard_y: f64,
}

impl ClipVolume {
    fn new(viewport: &Viewport) -> Self {
        let guard = |side: u32| 1.0 + 2.0 * GUARD / f64::from(side);
        Self { guard_x: guard(viewport.width), guard_y: guard(viewport.height) }
    }

    /// The signed distances to the planes, positive inside.
    fn distances(&self, [x, y, z, w]: ClipVertex) -> [f64; 6] {
        [w - z, z, self.guard_x * w + x, self.guard_x * w - x, self.guard_y * w + y, self.guard_y * w - y]
    }

    /// Returns one bit for each plane that the vertex is outside of.
    fn outcode(&self, vertex: ClipVertex) -> u8 {
        let mut code = 0;
        for (plane, distance) in self.distances(vertex).into_iter().enumerate() {
            // A NaN distance counts as outside.
            code |= u8::from(distance < 0.0 || distance.is_nan()) << plane;
        }
        code
    }

    /// The part of the triangle inside the planes in `planes`.
    fn clip(&self, triangle: [ClipVertex; 3], planes: u8) -> Polygon {
        let mut polygon = Polygon::triangle(triangle);
        for plane in (0..6).filter(|plane| planes & (1 << plane) != 0) {
            polygon = polygon.clipped(|vertex| self.distances(vertex)[plane]);
        }
        polygon
    }
}

impl Polygon {
    fn triangle([a, b, c]: [ClipVertex; 3]) -> Self {
        let mut corners = [[0.0; 4]; MAX_CORNERS];
        corners[..3].copy_from_slice(&[a, b, c]);
        Self { corners, count: 3 }
    }

    /// The corners, in order.
    fn corners(&self) -> &[ClipVertex] {
        &self.corners[..self.count]
    }

    fn push(&mut self, corner: ClipVertex) {
        // Rounding can in theory make a polygon cross a plane more than twice; further corners are dropped.
        if self.count < MAX_CORNERS {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }

    /// Clips against one plane. Source: Sutherland and Hodgman 1974.
    fn clipped(&self, distance: impl Fn(ClipVertex) -> f64) -> Self {
        let mut result = Self { corners: [[0.0; 4]; MAX_CORNERS], count: 0 };
        for (i, &current) in self.corners().iter().enumerate() {
            let next = self.corners()[(i + 1) % self.count];
            let (d_current, d_next) = (distance(current), distance(next));
            if d_current >= 0.0 {
                result.push(current);
            }
            // Always cut from the inner to the outer vertex, so that neighbours get the same point.
            match (d_current >= 0.0, d_next >= 0.0) {
                (true, false) => result.push(cut(current, next, d_current, d_next)),
                (false, true) => result.push(cut(next, current, d_next, d_current)),
                _ => {}
            }
        }
        result
    }
}

fn cut(inner: ClipVertex, outer: ClipVertex, d_inner: f64, d_outer: f64) -> ClipVertex {
    let t = d_inner / (d_inner - d_outer);
    std::array::from_fn(|i| inner[i] + (outer[i] - inner[i]) * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    const VOLUME: ClipVolume = ClipVolume { guard_x: 2.0, guard_y: 2.0 };

    #[test]
    fn inside_is_untouched() {
        let triangle = [[0.0, 0.0, 0.5, 1.0], [1.0, 0.0, 0.5, 1.0], [0.0, 1.0, 0.5, 1.0]];
        assert!(triangle.iter().all(|v| VOLUME.outcode(*v) == 0));
        assert_eq!(VOLUME.clip(triangle, 0).corners(), triangle);
    }

    #[test]
    fn a_corner_behind_the_eye_is_cut_off() {
        let triangle = [[0.0, 0.0, 0.1, 1.0], [1.0, 0.0, 0.1, 1.0], [0.0, 1.0, 0.1, -1.0]];
        let planes = triangle.iter().fold(0, |code, v| code | VOLUME.outcode(*v));
        let polygon = VOLUME.clip(triangle, planes);
        assert!(polygon.corners().len() >= 4);
        assert!(polygon.corners().iter().all(|[_, _, z, w]| *w >= *z - 1e-12));
    }

    #[test]
    fn all_outside_leaves_nothing() {
        let triangle = [[5.0, 0.0, 0.5, 1.0], [6.0, 0.0, 0.5, 1.0], [5.0, 1.0, 0.5, 1.0]];
        assert!(VOLUME.clip(triangle, 0x3f).corners().is_empty());
    }
}
