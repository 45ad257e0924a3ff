//! The fraction of incident light that a surface reflects, by numerical integration: the white furnace.
//!
//! A surface that absorbs nothing cannot be distinguished from a uniform sky around it: its albedo is one at every
//! angle. An albedo above one creates light; below, the model loses the light that it does not follow.

use super::{Angles, MaterialSample, Shading, reflect};
use crate::math::integration::nodes;
use crate::math::{Vec3, scalar};
use std::f64::consts::PI;

/// A sky of radiance one above the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Furnace {
    /// Nodes in each interval of the polar angle; the time grows with its square.
    pub fineness: usize,
}

impl Default for Furnace {
    fn default() -> Self {
        Self { fineness: 12 }
    }
}

impl Furnace {
    /// The fraction of light that reaches a viewer at `n_dot_v`, linear RGB; for a reciprocal model, also the
    /// fraction of a beam from there that is reflected in any direction.
    ///
    /// ∫ reflect(l) dl over the hemisphere; lights are at the mirror directions of half vectors, dl = 4 v·h dh.
    ///
    /// `n_dot_v` in (0, 1]. By default its relative error is below 5e-5 for slopes and α of at least 0.01 and n·v of at
    /// least 0.1 (`laws::shade::albedos_are_as_exact_as_stated`).
    /// Law: 1 − ln 2 for a white metal of `ggx` with roughness 1, along the normal (`laws::shade::white_furnace_of_ggx`).
    /// Source: Heitz 2014, §5.1.
    pub fn directional_albedo(self, shading: Shading, s: &MaterialSample<f64>, n_dot_v: f64) -> Vec3<f64> {
        let n = Vec3::new(0.0, 0.0, 1.0);
        let v = Vec3::new((1.0 - n_dot_v * n_dot_v).sqrt(), 0.0, n_dot_v);
        // n·l = 2 (v·h)(n·h) − n·v is above 0 up to this angle of h.
        let horizon = |cos_phi: f64| PI / 4.0 + scalar::atan2(v.x * cos_phi, v.z) / 2.0;
        over_part(self.fineness, horizon, |h| {
            let v_dot_h = v.dot(h);
            let l = h * (2.0 * v_dot_h) - v;
            reflect(shading, s, &Angles::new(n, v, l)) * (4.0 * v_dot_h)
        })
    }

    /// The fraction of the sky's light that is reflected in any direction, linear RGB: 2 ∫ albedo(n·v) n·v d(n·v).
    ///
    /// By default its relative error is below 1e-4 for slopes and α of at least 0.1.
    pub fn hemispherical_albedo(self, shading: Shading, s: &MaterialSample<f64>) -> Vec3<f64> {
        let mut total = Vec3::splat(0.0);
        for (n_dot_v, weight) in nodes(self.fineness, &[0.0, 1.0]) {
            total += self.directional_albedo(shading, s, n_dot_v) * (2.0 * n_dot_v * weight);
        }
        total
    }
}

/// Ends of intervals of the polar angle from 0 to π/2, increasingly fine towards 0 where lobes are, including π/4.
pub fn polar_ends() -> Vec<f64> {
    ladder().into_iter().map(|end| end * PI / 2.0).collect()
}

/// ∫ f(h) dh over the hemisphere of directions about z, with `fineness` nodes in each of the [`polar_ends`] and 16
/// times as many around.
pub fn over_hemisphere(fineness: usize, f: impl FnMut(Vec3<f64>) -> Vec3<f64>) -> Vec3<f64> {
    over_part(fineness, |_| PI / 2.0, f)
}

/// Like [`over_hemisphere`], only to the polar angle `end` of cos φ, so that no step of f is between nodes.
pub(super) fn over_part(
    fineness: usize,
    end: impl Fn(f64) -> f64,
    mut f: impl FnMut(Vec3<f64>) -> Vec3<f64>,
) -> Vec3<f64> {
    let rule = nodes(fineness, &ladder());
    let around = 16 * fineness;
    let step = 2.0 * PI / around as f64;
    let mut total = Vec3::splat(0.0);
    for i in 0..around {
        let phi = step * (i as f64 + 0.5);
        let (sin_phi, cos_phi) = (scalar::sin(phi), scalar::cos(phi));
        let end = end(cos_phi);
        for (share, weight) in &rule {
            let (sin, cos) = (scalar::sin(share * end), scalar::cos(share * end));
            total += f(Vec3::new(sin * cos_phi, sin * sin_phi, cos)) * (weight * end * sin * step);
        }
    }
    total
}

/// Ends of intervals of [0, 1], increasingly fine towards 0, where lobes are.
fn ladder() -> Vec<f64> {
    let mut ends = vec![0.0];
    ends.extend((1..=15).rev().map(|i| 1.0 / f64::from(1u32 << i)));
    ends.extend([0.625, 0.75, 0.875, 1.0]);
    ends
}
