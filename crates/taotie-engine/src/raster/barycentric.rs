//! Perspective-correct barycentric coordinates from clip space, with their derivatives.

use super::Viewport;
use crate::math::{Lane, Mask};

/// A triangle in clip space, from which barycentrics at screen positions are computed.
///
/// A point of the triangle is Σ bᵢ Pᵢ with Pᵢ = (x, y, w) of corner i, and is visible at (X, Y) if it is parallel to
/// (X, Y, 1). So bᵢ/w is (Pⱼ × Pₖ)·(X, Y, 1) over the determinant of the corners, a plane over the screen: Olano and
/// Greer 1997. No clipping is needed.
#[derive(Debug, Clone, Copy)]
pub struct PerspectiveTriangle<L = f32> {
    /// The planes of each corner: value at the origin, step per pixel to the right, step per pixel down.
    pub planes: [[L; 3]; 3],
}

/// Barycentrics at screen positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Barycentric<L = f32> {
    /// Weights of the three corners; their sum is 1.
    pub weights: [L; 3],
    /// Change of the weights one pixel to the right.
    pub d_x: [L; 3],
    /// Change of the weights one pixel down.
    pub d_y: [L; 3],
}

/// The number of triangles whose planes are computed together.
pub const TRIANGLES: usize = 8;

/// Computes the planes of triangles visible in one image.
///
/// Positions are relative to an origin, in pixels from the image's top left corner; accuracy is best near it.
#[derive(Debug, Clone, Copy)]
pub struct PlaneSetup {
    /// One pixel right and down, in halves of the image.
    step: [f64; 2],
    origin: [f64; 2],
}

/// Three numbers for each of three corners of several triangles.
pub type CornerNumbers<T> = [[[T; TRIANGLES]; 3]; 3];

impl PlaneSetup {
    /// Makes positions relative to `origin`, in pixels.
    pub fn new(viewport: &Viewport, origin: [f64; 2]) -> Self {
        Self { step: [2.0 / f64::from(viewport.width), -2.0 / f64::from(viewport.height)], origin }
    }

    /// The planes of triangles whose corners have these (x, y, w) in clip space. One loop over all, which compilers
    /// vectorise.
    #[inline(always)]
    pub fn planes(&self, corners: &CornerNumbers<f64>) -> CornerNumbers<f32> {
        let mut planes = [[[0.0; TRIANGLES]; 3]; 3];
        let [a, b, c] = corners;
        for i in 0..TRIANGLES {
            let at = |corner: &[[f64; TRIANGLES]; 3]| [corner[0][i], corner[1][i], corner[2][i]];
            let [first, second, third] = self.planes_of([at(a), at(b), at(c)]);
            for n in 0..3 {
                (planes[0][n][i], planes[1][n][i], planes[2][n][i]) = (first[n], second[n], third[n]);
            }
        }
        planes
    }

    #[inline(always)]
    fn planes_of(&self, p: [[f64; 3]; 3]) -> [[f32; 3]; 3] {
        let ([sx, sy], [x, y]) = (self.step, self.origin);
        let normals = [cross(p[1], p[2]), cross(p[2], p[0]), cross(p[0], p[1])];
        let determinant = p[0][0] * normals[0][0] + p[0][1] * normals[0][1] + p[0][2] * normals[0][2];
        let scale = 1.0 / determinant;
        let plane = |[a, b, c]: [f64; 3]| {
            let (right, down) = (a * sx, b * sy);
            let value = c - a + b + right * x + down * y;
            [(value * scale) as f32, (right * scale) as f32, (down * scale) as f32]
        };
        [plane(normals[0]), plane(normals[1]), plane(normals[2])]
    }
}

impl<L: Lane> PerspectiveTriangle<L> {
    /// The barycentrics at (x, y) in pixels from the origin.
    ///
    /// Vertices are snapped for coverage, so a covered sample can be slightly outside the exact triangle: its weights
    /// are clamped inside. A sliver seen edge-on has no weights at all and gets the mean of its corners.
    #[inline(always)]
    pub fn at(&self, x: L, y: L) -> Barycentric<L> {
        let [zero, one, third] = [x.lit(0.0), x.lit(1.0), x.lit(1.0 / 3.0)];
        let [p0, p1, p2] = self.planes;
        let (k0, k1, k2) = (plane(p0, x, y).max(zero), plane(p1, x, y).max(zero), plane(p2, x, y).max(zero));
        let sum = k0 + k1 + k2;
        let sound = zero.lt(sum).and(sum.lt(x.lit(f64::from(f32::MAX))));
        let inverse = one / L::select(sound, sum, one);
        let w0 = L::select(sound, k0 * inverse, third);
        let w1 = L::select(sound, k1 * inverse, third);
        let w2 = L::select(sound, k2 * inverse, third);
        let inverse = L::select(sound, inverse, zero);
        let steps = |step: usize| [p0[step], p1[step], p2[step]];
        let d_x = changes(steps(1), [w0, w1, w2], inverse);
        let d_y = changes(steps(2), [w0, w1, w2], inverse);
        Barycentric { weights: [w0, w1, w2], d_x, d_y }
    }
}

#[inline(always)]
fn plane<L: Lane>([c, a, b]: [L; 3], x: L, y: L) -> L {
    c + x * a + y * b
}

/// The changes of the weights over a step along which the planes change by `steps`.
#[inline(always)]
fn changes<L: Lane>([a, b, c]: [L; 3], [wa, wb, wc]: [L; 3], inverse: L) -> [L; 3] {
    let all = a + b + c;
    [(a - wa * all) * inverse, (b - wb * all) * inverse, (c - wc * all) * inverse]
}

#[inline(always)]
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::SamplePattern;

    fn triangle(corners: [[f32; 4]; 3], viewport: &Viewport, origin: [f64; 2]) -> PerspectiveTriangle {
        let all = corners.map(|[x, y, _, w]| [x, y, w].map(|number| [f64::from(number); TRIANGLES]));
        let planes = PlaneSetup::new(viewport, origin).planes(&all);
        assert!(
            planes.iter().flatten().all(|same| same[1..].iter().all(|n| n.to_bits() == same[0].to_bits()))
        );
        PerspectiveTriangle { planes: planes.map(|plane| plane.map(|number| number[0])) }
    }

    #[test]
    fn corners_and_perspective_midpoint() {
        let viewport = Viewport { width: 100, height: 50, pattern: SamplePattern::new(1).unwrap() };
        // A triangle whose second corner is three times as far away as the others.
        let corners = [[-1.0, -1.0, 0.0, 1.0], [3.0, -3.0, 0.0, 3.0], [-1.0, 1.0, 0.0, 1.0]];
        let triangle = triangle(corners, &viewport, [0.0; 2]);
        let close = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(close(triangle.at(0.0f32, 50.0).weights, [1.0, 0.0, 0.0]));
        assert!(close(triangle.at(100.0f32, 50.0).weights, [0.0, 1.0, 0.0]));
        // Halfway on the screen, the near corner has three times the weight of the far one.
        assert!(close(triangle.at(50.0f32, 50.0).weights, [0.75, 0.25, 0.0]));
    }

    #[test]
    fn weights_never_leave_the_triangle() {
        let viewport = Viewport { width: 100, height: 50, pattern: SamplePattern::new(1).unwrap() };
        let flat = [[-1.0, -1.0, 0.0, 1.0], [1.0, 1.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0]];
        let wide = [[-1.0, -1.0, 0.0, 1.0], [3.0, -3.0, 0.0, 3.0], [-1.0, 1.0, 0.0, 1.0]];
        for (corners, x, y) in
            [(flat, 50.0f32, 25.0f32), (flat, 3.0, 40.0), (wide, -4.0, 60.0), (wide, 120.0, 10.0)]
        {
            let weights = triangle(corners, &viewport, [32.0, 0.0]).at(x - 32.0, y).weights;
            assert!(weights.iter().all(|w: &f32| (0.0..=1.0).contains(w)), "{weights:?}");
            assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{weights:?}");
        }
    }

    #[test]
    fn derivatives_match_differences() {
        let viewport = Viewport { width: 64, height: 64, pattern: SamplePattern::new(1).unwrap() };
        let corners = [[-0.5, -0.7, 0.0, 1.0], [1.5, -0.3, 0.0, 2.0], [0.2, 0.9, 0.0, 1.3]];
        let triangle = triangle(corners, &viewport, [30.0, 31.0]);
        let (h, at) = (0.05f32, triangle.at(0.0f32, 0.0));
        for i in 0..3 {
            let dx = (triangle.at(h, 0.0).weights[i] - triangle.at(-h, 0.0).weights[i]) / (2.0 * h);
            let dy = (triangle.at(0.0, h).weights[i] - triangle.at(0.0, -h).weights[i]) / (2.0 * h);
            assert!((dx - at.d_x[i]).abs() < 1e-4 && (dy - at.d_y[i]).abs() < 1e-4);
        }
    }
}
