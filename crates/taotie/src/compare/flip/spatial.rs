//! The eye's blur: FLIP filters each opponent channel by the contrast sensitivity of the eye.

use super::super::plane::Plane;
use crate::math::{Vec3, scalar};
use std::f64::consts::PI;

/// A sum of Gaussians a·√(π/b)·exp(−π²d²/b), d in degrees: (a, b) of each.
type Sensitivity = &'static [(f64, f64)];

/// Table 1, after Johnson and Fairchild 2003: achromatic, red to green, blue to yellow.
const SENSITIVITIES: [Sensitivity; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];

/// The b of the broadest Gaussian.
const BROADEST: f64 = 0.04;

/// Returns the blurred channels of YCxCz, equations 2 to 4.
pub fn blurred(channels: [Plane; 3], pixels_per_degree: f64) -> Vec<Vec3<f64>> {
    let mut channels =
        channels.iter().zip(SENSITIVITIES).map(|(plane, s)| filtered(plane, s, pixels_per_degree));
    let [y, cx, cz] = std::array::from_fn(|_| channels.next().expect("there are three"));
    y.into_iter().zip(cx).zip(cz).map(|((y, cx), cz)| Vec3::new(y, cx, cz)).collect()
}

/// Each Gaussian separates into rows and columns, so their sum is a weighted sum of separable filters.
fn filtered(plane: &Plane, sensitivity: Sensitivity, pixels_per_degree: f64) -> Vec<f64> {
    let kernels: Vec<_> =
        sensitivity.iter().map(|(a, b)| weighted_gaussian(*a, *b, pixels_per_degree)).collect();
    let total = kernels.iter().fold(0.0, |sum, (weight, _)| sum + weight);
    let mut sum = vec![0.0; plane.values.len()];
    for (weight, kernel) in kernels {
        for (sum, value) in sum.iter_mut().zip(plane.filtered(&kernel, &kernel).values) {
            *sum += weight / total * value;
        }
    }
    sum
}

/// Returns the weight of a Gaussian in two dimensions, and the Gaussian in one dimension normalised to a sum of 1.
fn weighted_gaussian(a: f64, b: f64, pixels_per_degree: f64) -> (f64, Vec<f64>) {
    let radius = (3.0 * (BROADEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i32;
    let value = |x: i32| {
        let degrees = f64::from(x) / pixels_per_degree;
        scalar::exp(-PI * PI * degrees * degrees / b)
    };
    let kernel: Vec<f64> = (-radius..=radius).map(value).collect();
    let sum: f64 = kernel.iter().sum();
    (a * (PI / b).sqrt() * sum * sum, kernel.into_iter().map(|v| v / sum).collect())
}
