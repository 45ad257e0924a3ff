//! The fraction of incident light that a surface reflects, by numerical integration: the white furnace.
//!
//! A surface that absorbs nothing cannot be distinguished from a uniform sky around it: its albedo is one at every
//! angle. An albedo above one creates light; below, the model loses the light that it does not follow. The same integrals,
//! for each term of the Fresnel factor, make the tables of [`super::dfg`].

use super::fresnel::{lazanyi, pow5};
use super::microfacets::{MIN_ALPHA, d_beckmann, d_ggx, g_v_cavity, v_smith_ggx};
use super::sheen::{d_charlie, v_neubelt};
use super::{Angles, MaterialSample, Shading, reflect};
use crate::math::integration::nodes;
use crate::math::{Lane, Vec3, scalar};
use std::f64::consts::{FRAC_1_PI, PI};

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
fn over_part(
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

/// The cosine from which a surface counts as seen edge-on.
const LEAST_COSINE: f64 = 1e-4;

/// Nodes in each interval of the polar angle.
const FINENESS: usize = 10;

/// The fields of [`super::dfg::Dfg`] for GGX: `scale`, `bias`, `edge`, `diffuse_edge`.
pub fn dfg_of_ggx(n_dot_v: f64, roughness: f64) -> [f64; 4] {
    let alpha = roughness * roughness;
    numbers(n_dot_v, alpha, |a| d_ggx(a.n_dot_h, a.sin2_h, alpha) * v_smith_ggx(a.n_dot_l, a.n_dot_v, alpha))
}

/// Like [`dfg_of_ggx`], for Beckmann's distribution with V-shaped cavities.
pub fn dfg_of_cook_torrance(n_dot_v: f64, slope: f64) -> [f64; 4] {
    numbers(n_dot_v, slope, |a| {
        let g = g_v_cavity(a.n_dot_l, a.n_dot_v, a.n_dot_h, a.v_dot_h);
        d_beckmann(a.n_dot_h, a.sin2_h, slope) * g / (4.0 * a.n_dot_v * a.n_dot_l)
    })
}

/// The directional albedo of white sheen.
pub fn albedo_of_sheen(n_dot_v: f64, roughness: f64) -> f64 {
    let (n, v) = directions(n_dot_v.max(LEAST_COSINE));
    over_hemisphere(FINENESS, |l| {
        let a = Angles::new(n, v, l);
        let lobe = d_charlie(a.sin2_h, roughness) * v_neubelt(a.n_dot_l, a.n_dot_v);
        Vec3::splat(lobe * a.n_dot_l)
    })
    .x
}

/// `width` is α or the slope; `lobe` returns D V.
fn numbers(n_dot_v: f64, width: f64, lobe: impl Fn(&Angles<f64>) -> f64) -> [f64; 4] {
    let n_dot_v = n_dot_v.max(LEAST_COSINE);
    let (n, v) = directions(n_dot_v);
    let diffuse = over_hemisphere(FINENESS, |l| {
        let a = Angles::new(n, v, l);
        Vec3::splat(pow5(1.0 - a.v_dot_h) * a.n_dot_l * FRAC_1_PI)
    });
    if width < MIN_ALPHA {
        // A mirror.
        let edge = pow5(1.0 - n_dot_v);
        return [1.0 - edge, edge, lazanyi(n_dot_v), diffuse.x];
    }
    let horizon = |cos_phi: f64| PI / 4.0 + scalar::atan2(v.x * cos_phi, v.z) / 2.0;
    let specular = over_part(FINENESS, horizon, |h| {
        let v_dot_h = v.dot(h);
        let a = Angles::new(n, v, h * (2.0 * v_dot_h) - v);
        if a.n_dot_l <= 0.0 {
            return Vec3::splat(0.0);
        }
        let share = lobe(&a) * a.n_dot_l * 4.0 * v_dot_h;
        let edge = pow5(1.0 - a.v_dot_h);
        Vec3::new(1.0 - edge, edge, lazanyi(a.v_dot_h)) * share
    });
    let Vec3 { x, y, z } = specular;
    [x, y, z, diffuse.x]
}

/// The normal and a viewer.
fn directions(n_dot_v: f64) -> (Vec3<f64>, Vec3<f64>) {
    let sine = (1.0 - n_dot_v.squared()).max(0.0).sqrt();
    (Vec3::new(0.0, 0.0, 1.0), Vec3::new(sine, 0.0, n_dot_v))
}
