//! Irradiance as nine numbers per channel.

use super::equirect::Equirect;
use crate::math::{Vec3, scalar};
use crate::parallel;
use std::f64::consts::{PI, TAU};

/// The irradiance as a polynomial of degree 2 in the normal: spherical harmonics up to l = 2, with all constants
/// multiplied in. In the order 1, y, z, x, xy, yz, 3z² − 1, xz, x² − y².
///
/// Law: exact for light of the second degree (`laws::environment::irradiance_of_light_of_the_second_degree_is_exact`).
/// Source: Ramamoorthi and Hanrahan 2001, eq. 7, 8 and 10.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IrradianceHarmonics(pub [Vec3; 9]);

/// Â_l times the square of Y_lm's constant: the factor of the integral of light times a polynomial.
const FACTORS: [f64; 9] = {
    let [constant, linear, quadratic] = [0.25, 0.5, PI / 4.0];
    let product = quadratic * 15.0 / (4.0 * PI);
    let [zz, difference] = [quadratic * 5.0 / (16.0 * PI), quadratic * 15.0 / (16.0 * PI)];
    [constant, linear, linear, linear, product, product, zz, product, difference]
};

impl IrradianceHarmonics {
    /// Computes the harmonics of an image whose texels each have constant radiance.
    pub(super) fn new(picture: &Equirect) -> Self {
        let waves = waves(picture.width());
        let row = |y: usize| {
            let edge = |y: usize| Edge::new(y as f64 * PI / picture.height() as f64);
            moments(sums(picture, y, &waves), edge(y + 1).minus(edge(y)))
        };
        let mut total = [Vec3::default(); 9];
        for row in parallel::tasks(picture.height(), &row) {
            for (total, moment) in total.iter_mut().zip(row) {
                *total += moment;
            }
        }
        let mut coefficients = [Vec3::default(); 9];
        for (i, coefficient) in coefficients.iter_mut().enumerate() {
            *coefficient = (total[i] * FACTORS[i]).to_f32();
        }
        Self(coefficients)
    }

    /// The irradiance on a plane with the unit normal `n`, never negative.
    #[inline]
    pub fn at(&self, n: Vec3) -> Vec3 {
        let Vec3 { x, y, z } = n;
        let polynomials = [y, z, x, x * y, y * z, 3.0 * z * z - 1.0, x * z, x * x - y * y];
        let mut sum = self.0[0];
        for (coefficient, polynomial) in self.0[1..].iter().zip(polynomials) {
            sum += *coefficient * polynomial;
        }
        sum.map(|v| v.max(0.0))
    }
}

/// The integrals of 1, cos φ, sin φ, cos 2φ and sin 2φ over each column.
fn waves(width: usize) -> Vec<[f64; 5]> {
    let half = PI / width as f64;
    let (wide, wide2) = (2.0 * scalar::sin(half), scalar::sin(2.0 * half));
    let wave = |x: usize| {
        let azimuth = ((x as f64 + 0.5) / width as f64 - 0.5) * TAU;
        let (c, s) = (scalar::cos(azimuth), scalar::sin(azimuth));
        [2.0 * half, c * wide, s * wide, (c * c - s * s) * wide2, 2.0 * s * c * wide2]
    };
    (0..width).map(wave).collect()
}

/// A row's light times each wave.
fn sums(picture: &Equirect, y: usize, waves: &[[f64; 5]]) -> [Vec3<f64>; 5] {
    let mut sums = [Vec3::default(); 5];
    for (x, wave) in waves.iter().enumerate() {
        let light = picture.texel(x, y).to_f64();
        for (sum, wave) in sums.iter_mut().zip(wave) {
            *sum += light * *wave;
        }
    }
    sums
}

/// Integrals over the polar angle θ up to a row's edge, and by difference over the row: of sin θ times 1, cos θ, sin
/// θ, sin θ cos θ, sin² θ and cos² θ.
#[derive(Clone, Copy)]
struct Edge([f64; 6]);

impl Edge {
    fn new(polar: f64) -> Self {
        let (s, c) = (scalar::sin(polar), scalar::cos(polar));
        let cube = c * c * c / 3.0;
        Self([-c, s * s * 0.5, (polar - s * c) * 0.5, s * s * s / 3.0, cube - c, -cube])
    }

    fn minus(self, other: Self) -> Self {
        let mut difference = self.0;
        difference.iter_mut().zip(other.0).for_each(|(d, o)| *d -= o);
        Self(difference)
    }
}

/// A row's light times each of the nine polynomials, with n = (sin θ cos φ, cos θ, sin θ sin φ).
fn moments([one, cos, sin, cos2, sin2]: [Vec3<f64>; 5], row: Edge) -> [Vec3<f64>; 9] {
    let Edge([all, c, s, sc, ss, cc]) = row;
    [
        one * all,
        one * c,
        sin * s,
        cos * s,
        cos * sc,
        sin * sc,
        (one - cos2) * (1.5 * ss) - one * all,
        sin2 * (0.5 * ss),
        (one + cos2) * (0.5 * ss) - one * cc,
    ]
}
