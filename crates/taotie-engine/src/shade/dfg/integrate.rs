//! Computes the tables by quadrature.

use crate::math::{Lane, Vec3, scalar};
use crate::shade::Angles;
use crate::shade::fresnel::{lazanyi, pow5};
use crate::shade::furnace::{over_hemisphere, over_part};
use crate::shade::microfacets::{MIN_ALPHA, d_beckmann, d_ggx};
use crate::shade::microfacets::{g_v_cavity, v_smith_ggx};
use crate::shade::sheen::{d_charlie, v_neubelt};
use std::f64::consts::{FRAC_1_PI, PI};

/// The cosine from which a surface counts as seen edge-on.
const LEAST_COSINE: f64 = 1e-4;

/// Nodes in each interval of the polar angle.
const FINENESS: usize = 10;

/// The fields of [`super::Dfg`] for GGX: `scale`, `bias`, `edge`, `diffuse_edge`.
pub fn ggx(n_dot_v: f64, roughness: f64) -> [f64; 4] {
    let alpha = roughness * roughness;
    numbers(n_dot_v, alpha, |a| d_ggx(a.n_dot_h, a.sin2_h, alpha) * v_smith_ggx(a.n_dot_l, a.n_dot_v, alpha))
}

/// Like [`ggx`], for Beckmann's distribution with V-shaped cavities.
pub fn cook_torrance(n_dot_v: f64, slope: f64) -> [f64; 4] {
    numbers(n_dot_v, slope, |a| {
        let g = g_v_cavity(a.n_dot_l, a.n_dot_v, a.n_dot_h, a.v_dot_h);
        d_beckmann(a.n_dot_h, a.sin2_h, slope) * g / (4.0 * a.n_dot_v * a.n_dot_l)
    })
}

/// The directional albedo of white sheen.
pub fn sheen(n_dot_v: f64, roughness: f64) -> f64 {
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
