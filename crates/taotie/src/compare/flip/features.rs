//! FLIP's features: edges and points, whose change is immediately visible.

use super::super::plane::Plane;
use crate::math::scalar;
use crate::parallel;

/// The distance from peak to trough of the eye's edge detector, degrees: §4.2.1.
const EDGE_WIDTH: f64 = 0.082;

/// Returns the strengths of edges and points at each pixel, of a plane of lightness with white being 1: the lengths
/// of the gradient and of the vector of second derivatives of the blurred plane, §4.2.1.
pub fn strengths(lightness: &Plane, pixels_per_degree: f64) -> Vec<[f64; 2]> {
    let kernels = Kernels::new(0.5 * EDGE_WIDTH * pixels_per_degree);
    let length = |derivative: &[f64]| {
        let [x, y] = [(derivative, &kernels.blur[..]), (&kernels.blur[..], derivative)]
            .map(|(across, down)| lightness.filtered(across, down).values);
        parallel::collect(x.len(), |i| (x[i] * x[i] + y[i] * y[i]).sqrt())
    };
    let (edges, points) = (length(&kernels.edge), length(&kernels.point));
    edges.into_iter().zip(points).map(|(edge, point)| [edge, point]).collect()
}

/// Returns the difference of features, [0, 1]: §4.2.2 with the exponent q_f = 0.5.
pub fn difference(a: [f64; 2], b: [f64; 2]) -> f64 {
    let most = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
    (most * std::f64::consts::FRAC_1_SQRT_2).sqrt()
}

/// A Gaussian and its first two derivatives in one dimension.
struct Kernels {
    blur: Vec<f64>,
    edge: Vec<f64>,
    point: Vec<f64>,
}

impl Kernels {
    fn new(deviation: f64) -> Self {
        let radius = (3.0 * deviation).ceil() as i32;
        let kernel = |factor: &dyn Fn(f64) -> f64| {
            let value = |x: i32| {
                factor(f64::from(x)) * scalar::exp(-f64::from(x * x) / (2.0 * deviation * deviation))
            };
            balanced((-radius..=radius).map(value).collect())
        };
        Self {
            blur: kernel(&|_| 1.0),
            edge: kernel(&|x| -x),
            point: kernel(&|x| x * x / (deviation * deviation) - 1.0),
        }
    }
}

/// The kernel with positive weights that sum to 1 and negative ones that sum to −1.
fn balanced(kernel: Vec<f64>) -> Vec<f64> {
    let sum = |sign: f64| kernel.iter().filter(|v| **v * sign > 0.0).fold(0.0, |sum, v| sum + v.abs());
    let (positive, negative) = (sum(1.0), sum(-1.0));
    kernel.iter().map(|v| if *v < 0.0 { v / negative } else { v / positive }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_an_edge_of_full_strength_and_a_flat_plane_is_none() {
        let plane = |value: fn(usize) -> f64| Plane {
            width: 64,
            values: (0..64 * 3).map(|i| value(i % 64)).collect(),
        };
        let step = strengths(&plane(|x| if x < 32 { 0.0 } else { 1.0 }), 67.0);
        let strongest = step.iter().fold(0.0f64, |most, s| most.max(s[0]));
        assert!((0.9..=1.0).contains(&strongest), "{strongest}");
        let flat = strengths(&plane(|_| 0.7), 67.0);
        assert!(flat.iter().flatten().all(|v| *v < 1e-14));
    }

    #[test]
    fn the_largest_change_is_one() {
        assert!((difference([0.0, 2.0f64.sqrt()], [0.0, 0.0]) - 1.0).abs() < 1e-12);
        assert_eq!(difference([0.3, 0.4], [0.3, 0.4]), 0.0);
    }
}
