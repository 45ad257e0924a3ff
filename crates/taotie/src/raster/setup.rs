//! One triangle from clip space to the screen: the slow path, for clipped or large ones.

use super::clip::{ClipVertex, ClipVolume};
use super::{Faces, SUBPIXELS, Viewport};

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

/// The inputs for converting clip space to screen triangles.
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
