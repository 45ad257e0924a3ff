//! Perspective-correct barycentric coordinates from clip space, with their derivatives.

use super::Viewport;

/// A triangle in clip space, ready to be asked for barycentrics at any point of the screen.
///
/// A point of the triangle is Σ bᵢ Pᵢ with Pᵢ = (x, y, w) of corner i, and is seen at (X, Y) where it is parallel
/// to (X, Y, 1). So bᵢ is proportional to (Pⱼ × Pₖ)·(X, Y, 1): Olano and Greer 1997. No clipping is needed.
#[derive(Debug, Clone, Copy)]
pub struct PerspectiveTriangle {
    /// For each corner: value at the picture's top left, step a pixel right, step a pixel down.
    planes: [[f64; 3]; 3],
}

/// Barycentrics at a point of the screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Barycentric {
    /// Weights of the three corners; their sum is 1.
    pub weights: [f32; 3],
    /// Change of the weights a pixel to the right.
    pub d_x: [f32; 3],
    /// Change of the weights a pixel down.
    pub d_y: [f32; 3],
}

impl PerspectiveTriangle {
    /// From the corners' (x, y, z, w).
    pub fn new(corners: [[f32; 4]; 3], viewport: &Viewport) -> Self {
        let p = corners.map(|[x, y, _, w]| [x, y, w].map(f64::from));
        let (sx, sy) = (2.0 / f64::from(viewport.width), -2.0 / f64::from(viewport.height));
        let plane = |j: usize, k: usize| {
            let [a, b, c] = cross(p[j], p[k]);
            [c - a + b, a * sx, b * sy]
        };
        Self { planes: [plane(1, 2), plane(2, 0), plane(0, 1)] }
    }

    /// The barycentrics at (x, y) in pixels from the picture's top left corner.
    pub fn at(&self, x: f64, y: f64) -> Barycentric {
        let values = self.planes.map(|[c, a, b]| c + a * x + b * y);
        let inverse = 1.0 / (values[0] + values[1] + values[2]);
        let weights = values.map(|v| v * inverse);
        let derivative = |step: usize| {
            let sum = self.planes[0][step] + self.planes[1][step] + self.planes[2][step];
            std::array::from_fn(|i| ((self.planes[i][step] - weights[i] * sum) * inverse) as f32)
        };
        Barycentric { weights: inside(weights), d_x: derivative(1), d_y: derivative(2) }
    }
}

/// The weights brought into the triangle. Vertices are snapped for coverage, so a covered sample can lie a little
/// outside the exact triangle, and a sliver seen edge-on has no weights at all.
fn inside(weights: [f64; 3]) -> [f32; 3] {
    let kept = weights.map(|w| w.max(0.0));
    let sum = kept[0] + kept[1] + kept[2];
    match sum > 0.0 && sum.is_finite() {
        true => kept.map(|w| (w / sum) as f32),
        false => [1.0 / 3.0; 3],
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::SamplePattern;

    #[test]
    fn corners_and_perspective_midpoint() {
        let viewport = Viewport { width: 100, height: 50, pattern: SamplePattern::new(1).unwrap() };
        // A triangle whose second corner is three times as far as the others.
        let corners = [[-1.0, -1.0, 0.0, 1.0], [3.0, -3.0, 0.0, 3.0], [-1.0, 1.0, 0.0, 1.0]];
        let triangle = PerspectiveTriangle::new(corners, &viewport);
        let close = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(close(triangle.at(0.0, 50.0).weights, [1.0, 0.0, 0.0]));
        assert!(close(triangle.at(100.0, 50.0).weights, [0.0, 1.0, 0.0]));
        // Halfway on the screen the near corner weighs three times the far one.
        assert!(close(triangle.at(50.0, 50.0).weights, [0.75, 0.25, 0.0]));
    }

    #[test]
    fn weights_never_leave_the_triangle() {
        let viewport = Viewport { width: 100, height: 50, pattern: SamplePattern::new(1).unwrap() };
        let flat = [[-1.0, -1.0, 0.0, 1.0], [1.0, 1.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0]];
        let wide = [[-1.0, -1.0, 0.0, 1.0], [3.0, -3.0, 0.0, 3.0], [-1.0, 1.0, 0.0, 1.0]];
        for (corners, x, y) in
            [(flat, 50.0, 25.0), (flat, 3.0, 40.0), (wide, -4.0, 60.0), (wide, 120.0, 10.0)]
        {
            let weights = PerspectiveTriangle::new(corners, &viewport).at(x, y).weights;
            assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)), "{weights:?}");
            assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{weights:?}");
        }
    }

    #[test]
    fn derivatives_match_differences() {
        let viewport = Viewport { width: 64, height: 64, pattern: SamplePattern::new(1).unwrap() };
        let corners = [[-0.5, -0.7, 0.0, 1.0], [1.5, -0.3, 0.0, 2.0], [0.2, 0.9, 0.0, 1.3]];
        let triangle = PerspectiveTriangle::new(corners, &viewport);
        let (h, at) = (1e-3, triangle.at(30.0, 31.0));
        for i in 0..3 {
            let dx = (triangle.at(30.0 + h, 31.0).weights[i] - triangle.at(30.0 - h, 31.0).weights[i])
                / (2.0 * h as f32);
            let dy = (triangle.at(30.0, 31.0 + h).weights[i] - triangle.at(30.0, 31.0 - h).weights[i])
                / (2.0 * h as f32);
            assert!((dx - at.d_x[i]).abs() < 1e-4 && (dy - at.d_y[i]).abs() < 1e-4);
        }
    }
}
