//! Fresnel reflectance: the fraction of light that a smooth facet mirrors.

use crate::math::{Lane, Vec3};

/// cos 82° as fixed by the F82 model: 1/7, where its correction is largest.
pub const COS_82: f64 = 1.0 / 7.0;

/// x⁵.
#[inline(always)]
pub fn pow5<L: Lane>(x: L) -> L {
    let squared = x * x;
    squared * squared * x
}

/// Schlick's approximation of Fresnel reflectance, with total reflection at grazing incidence.
///
/// F = F0 + (1 − F0)(1 − v·h)⁵
///
/// `f0` linear RGB in [0, 1]; `v_dot_h` in [0, 1].
/// Law: F0 at v·h = 1, 1 at v·h = 0 (`laws::shade::schlick_ends`).
/// Source: Schlick 1994, eq. 15. Guo and Wang 2025, eq. 6, print the exponent 2.
#[inline(always)]
pub fn f_schlick<L: Lane>(f0: Vec3<L>, v_dot_h: L) -> Vec3<L> {
    f_schlick_f90(f0, Vec3::splat(v_dot_h.lit(1.0)), v_dot_h)
}

/// Schlick's approximation between two reflectances.
///
/// F = F0 + (F90 − F0)(1 − v·h)⁵
///
/// `f0`, `f90` linear RGB in [0, 1]; `v_dot_h` in [0, 1].
/// Law: F0 at v·h = 1, F90 at v·h = 0 (`laws::shade::schlick_ends`).
/// Source: Schlick 1994, eq. 15, with the F90 of Lagarde and de Rousiers 2014.
#[inline(always)]
pub fn f_schlick_f90<L: Lane>(f0: Vec3<L>, f90: Vec3<L>, v_dot_h: L) -> Vec3<L> {
    f0 + (f90 - f0) * pow5(v_dot_h.lit(1.0) - v_dot_h)
}

/// Lazányi's coefficient a, such that [`f_f82`] passes through `f82` at cos θ = 1/7.
///
/// a = (F_schlick(1/7) − F82) / (1/7 · (6/7)⁶)
///
/// `f0`, `f82` linear RGB in [0, 1]. Zero if `f82` equals Schlick's value.
/// Law: `laws::shade::f82_passes_through_both_points`.
/// Source: Lazányi and Szirmay-Kalos 2005, eq. 4; Kutz, Hašan and Edmondson 2021 fix it by the colour at 82°.
#[inline(always)]
pub fn f82_drop<L: Lane>(f0: Vec3<L>, f82: Vec3<L>) -> Vec3<L> {
    let mu = f0.x.lit(COS_82);
    (f_schlick(f0, mu) - f82) / lazanyi(mu)
}

/// Schlick with Lazányi's correction for metals.
///
/// F = F_schlick(v·h) − a · v·h (1 − v·h)⁶, clamped to [0, 1]
///
/// `f0` linear RGB in [0, 1]; `f90` in [0, 1], 1 for metals; `drop` is a, from [`f82_drop`]; `v_dot_h` in [0, 1]. The
/// clamp only matters if a strong `drop` would take the curve outside the range of reflectance.
/// Law: `laws::shade::f82_passes_through_both_points`.
/// Source: Kutz, Hašan and Edmondson 2021 (F82-tint), as in the OpenPBR Surface specification.
#[inline(always)]
pub fn f_f82<L: Lane>(f0: Vec3<L>, f90: L, drop: Vec3<L>, v_dot_h: L) -> Vec3<L> {
    let f = f_schlick_f90(f0, Vec3::splat(f90), v_dot_h) - drop * lazanyi(v_dot_h);
    Vec3::new(f.x.clamp(0.0, 1.0), f.y.clamp(0.0, 1.0), f.z.clamp(0.0, 1.0))
}

/// μ(1 − μ)⁶, largest at μ = 1/7.
#[inline(always)]
pub(super) fn lazanyi<L: Lane>(mu: L) -> L {
    let one_less = mu.lit(1.0) - mu;
    mu * one_less * pow5(one_less)
}

/// Fresnel reflectance of a dielectric for unpolarised light, exact.
///
/// sin θ_t = sin θ / η; R_s = (cos θ − η cos θ_t)/(cos θ + η cos θ_t), R_p = (η cos θ − cos θ_t)/(η cos θ + cos θ_t);
/// F = (R_s² + R_p²)/2
///
/// `cos_theta` in [0, 1], taken as at least 1e-6 so that grazing incidence on η = 1 does not divide by zero; `eta` =
/// index behind over index before the surface, above 0. 1 beyond the critical angle.
/// Law: ((η − 1)/(η + 1))² at cos θ = 1 (`laws::shade::exact_fresnel_limits`).
/// Source: Born and Wolf, Principles of Optics, §1.5.2, eq. 21a.
#[inline(always)]
pub fn f_dielectric<L: Lane>(cos_theta: L, eta: L) -> L {
    let one = eta.lit(1.0);
    let c = cos_theta.clamp(1e-6, 1.0);
    let sin2_t = (one - c * c) / (eta * eta);
    let cos_t = (one - sin2_t).max(eta.lit(0.0)).sqrt();
    let r_s = (c - eta * cos_t) / (c + eta * cos_t);
    let r_p = (eta * c - cos_t) / (eta * c + cos_t);
    (r_s * r_s + r_p * r_p) * eta.lit(0.5)
}

/// Fresnel reflectance of a conductor with the complex index η + ik for unpolarised light, exact.
///
/// With a² + b² = √((η² − k² − sin²θ)² + 4η²k²) and a = √((a² + b² + η² − k² − sin²θ)/2):
/// R_s = (a² + b² − 2a cos θ + cos²θ)/(a² + b² + 2a cos θ + cos²θ),
/// R_p = R_s · (cos²θ(a² + b²) − 2a cos θ sin²θ + sin⁴θ)/(cos²θ(a² + b²) + 2a cos θ sin²θ + sin⁴θ), F = (R_s + R_p)/2
///
/// `cos_theta` in [0, 1]; `eta` above 0, `k` at least 0, both relative to the medium before the surface.
/// Law: ((η − 1)² + k²)/((η + 1)² + k²) at cos θ = 1; the dielectric's value at k = 0
/// (`laws::shade::exact_fresnel_limits`).
/// Source: Born and Wolf, Principles of Optics, §14.2 (13.4 in older editions).
#[inline(always)]
pub fn f_conductor<L: Lane>(cos_theta: L, eta: L, k: L) -> L {
    let two = eta.lit(2.0);
    let half = eta.lit(0.5);
    let cos2 = cos_theta * cos_theta;
    let sin2 = eta.lit(1.0) - cos2;
    let difference = eta * eta - k * k - sin2;
    let product = eta * k * two;
    let norm = (difference * difference + product * product).sqrt();
    let a = ((norm + difference) * half).max(eta.lit(0.0)).sqrt();
    let cross = two * a * cos_theta;
    let r_s = (norm - cross + cos2) / (norm + cross + cos2);
    let p_even = cos2 * norm + sin2 * sin2;
    let p_odd = cross * sin2;
    let r_p = r_s * (p_even - p_odd) / (p_even + p_odd);
    (r_s + r_p) * half
}
