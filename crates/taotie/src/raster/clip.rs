//! Clipping polygons in homogeneous coordinates.

use super::Viewport;

/// The distance outside the image at which vertices are clipped, in pixels.
const GUARD: f64 = 8192.0;

/// A vertex in clip space: x, y, z, w.
pub(super) type ClipVertex = [f64; 4];

/// The maximum number of corners of a triangle after six planes.
const MAX_CORNERS: usize = 9;

/// A convex polygon of at most nine corners.
#[derive(Debug, Clone, Copy)]
pub(super) struct Polygon {
    corners: [ClipVertex; MAX_CORNERS],
    count: usize,
}

/// The half-spaces that contain the geometry: near, far, and four guard planes outside the image that keep screen
/// coordinates small enough for exact edge functions.
#[derive(Debug, Clone, Copy)]
pub(super) struct ClipVolume {
    /// The limit of |x/w|.
    pub guard_x: f64,
    /// The limit of |y/w|.
    pub guard_y: f64,
}

impl ClipVolume {
    pub(super) fn new(viewport: &Viewport) -> Self {
        let guard = |side: u32| 1.0 + 2.0 * GUARD / f64::from(side);
        Self { guard_x: guard(viewport.width), guard_y: guard(viewport.height) }
    }

    /// The signed distances to the planes, positive inside.
    fn distances(&self, [x, y, z, w]: ClipVertex) -> [f64; 6] {
        [w - z, z, self.guard_x * w + x, self.guard_x * w - x, self.guard_y * w + y, self.guard_y * w - y]
    }

    /// Returns one bit for each plane that the vertex is outside of.
    pub(super) fn outcode(&self, vertex: ClipVertex) -> u8 {
        let mut code = 0;
        for (plane, distance) in self.distances(vertex).into_iter().enumerate() {
            // A NaN distance counts as outside.
            code |= u8::from(distance < 0.0 || distance.is_nan()) << plane;
        }
        code
    }

    /// The part of the triangle inside the planes in `planes`.
    pub(super) fn clip(&self, triangle: [ClipVertex; 3], planes: u8) -> Polygon {
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
    pub(super) fn corners(&self) -> &[ClipVertex] {
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
