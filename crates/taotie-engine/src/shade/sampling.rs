//! Samples directions proportionally to a surface's reflection, and computes the density of each choice.
//!
//! Directions are in a local space with the shading normal along +z. A density is per steradian and belongs to the
//! function with the same name; `u` are numbers in [0, 1), uniformly distributed.

use super::microfacets::{MIN_ALPHA, alpha_from_roughness, alpha_from_shininess};
use super::{MIN_N_DOT_V, MaterialSample, Shading, fresnel};
use crate::math::{Lane, Mask, Vec3};
use std::f64::consts::{FRAC_1_PI, PI};

/// Cosine and sine of 2πu.
///
/// Accurate to 3e-8 and the rounding of the number type (`sampling::tests::azimuths_are_on_the_circle`): the series
/// of both around the nearest quarter of the circle.
#[inline(always)]
pub fn azimuth<L: Lane>(u: L) -> [L; 2] {
    let one = u.lit(1.0);
    let quarters = (u * u.lit(4.0) + u.lit(0.5)).floor();
    let a = (u - quarters * u.lit(0.25)) * u.lit(2.0 * PI);
    let a2 = a * a;
    let term = |inner: L, factor: f64| one - a2 * a2.lit(factor) * inner;
    let sin = a * term(term(term(term(one, 1.0 / 72.0), 1.0 / 42.0), 1.0 / 20.0), 1.0 / 6.0);
    let cos = term(term(term(term(one, 1.0 / 56.0), 1.0 / 30.0), 1.0 / 12.0), 0.5);
    let pairs = (quarters * u.lit(0.5)).floor();
    let swaps = u.lit(0.5).lt(quarters - pairs * u.lit(2.0));
    let (x, y) = (L::select(swaps, -sin, cos), L::select(swaps, cos, sin));
    // The second and third quarter are opposite the zeroth and first; the fourth is the zeroth.
    let opposite = u.lit(0.5).lt(pairs).and(pairs.lt(u.lit(1.5)));
    [L::select(opposite, -x, x), L::select(opposite, -y, y)]
}

/// Samples a direction of the hemisphere with a density proportional to its cosine, [`cosine_pdf`].
///
/// Law: histogram (`laws::sampling::directions_follow_their_densities`).
/// Source: Malley's method, in Pharr, Jakob and Humphreys 2023, *Physically Based Rendering*, §A.5.3.
#[inline(always)]
pub fn cosine_direction<L: Lane>(u: [L; 2]) -> Vec3<L> {
    let [x, y] = azimuth(u[1]);
    let radius = u[0].sqrt();
    Vec3::new(radius * x, radius * y, (u[0].lit(1.0) - u[0]).max(u[0].lit(0.0)).sqrt())
}

/// The density of [`cosine_direction`], n·l/π; 0 below the horizon.
#[inline(always)]
pub fn cosine_pdf<L: Lane>(n_dot_l: L) -> L {
    n_dot_l.max(n_dot_l.lit(0.0)) * n_dot_l.lit(FRAC_1_PI)
}

/// Samples a direction of the hemisphere uniformly: the density is 1/(2π).
///
/// Law: histogram (`laws::sampling::directions_follow_their_densities`).
/// Source: Archimedes; Pharr, Jakob and Humphreys 2023, §A.5.2.
#[inline(always)]
pub fn uniform_direction<L: Lane>(u: [L; 2]) -> Vec3<L> {
    let [x, y] = azimuth(u[1]);
    let z = u[0];
    let radius = (z.lit(1.0) - z * z).max(z.lit(0.0)).sqrt();
    Vec3::new(radius * x, radius * y, z)
}

/// Samples a facet of a GGX surface as seen by a viewer, D_v(m) = G₁(v) (v·m)⁺ D(m) / n·v.
///
/// The surface is stretched to a hemisphere, whose visible part, mirrored at its silhouette, is a spherical cap that
/// is sampled uniformly.
///
/// `v` unit, to the viewer, v.z above 0; `alpha` along x and y, each in [[`MIN_ALPHA`], 1].
/// Law: histogram, and the weight G₂/G₁ (`laws::sampling::directions_follow_their_densities`,
/// `laws::sampling::weights_of_visible_normals_are_shadowing_alone`).
/// Source: Dupuy and Benyoub 2023, "Sampling visible GGX normals with spherical caps", listing 3.
#[inline(always)]
pub fn ggx_visible_normal<L: Lane>(v: Vec3<L>, alpha: [L; 2], u: [L; 2]) -> Vec3<L> {
    let one = v.z.lit(1.0);
    let stretched = Vec3::new(v.x * alpha[0], v.y * alpha[1], v.z).normalize();
    let z = (one - u[0]) * (one + stretched.z) - stretched.z;
    let radius = (one - z * z).max(v.z.lit(0.0)).sqrt();
    let [x, y] = azimuth(u[1]);
    let cap = Vec3::new(radius * x, radius * y, z);
    let m = cap + stretched;
    // Straight down only if v is in the plane and u is 0; straight up is equally valid.
    let up = Vec3::new(v.z.lit(0.0), v.z.lit(0.0), one);
    Vec3::new(m.x * alpha[0], m.y * alpha[1], m.z.max(v.z.lit(0.0))).normalize_or(up)
}

/// The density of the directions `l` to which [`ggx_visible_normal`] mirrors the viewer, D_v(h) / (4 v·h) = G₁(v)
/// D(h) / (4 n·v); 0 if h points down.
///
/// Law: integrates to 1 over the sphere (`laws::sampling::densities_integrate_to_one`).
/// Source: Heitz 2018, "Sampling the GGX distribution of visible normals", eq. 3 and 17; D and G₁ of Heitz 2014, eq. 85
/// and 86.
#[inline(always)]
pub fn ggx_visible_pdf<L: Lane>(v: Vec3<L>, l: Vec3<L>, alpha: [L; 2]) -> L {
    let (zero, one) = (v.z.lit(0.0), v.z.lit(1.0));
    let [ax, ay] = alpha;
    let h = (v + l).normalize_or(Vec3::new(zero, zero, -one));
    let sum = (h.x / ax).squared() + (h.y / ay).squared() + h.z.squared();
    let d = one / (ax * ay * sum.squared() * one.lit(PI));
    let root = ((v.x * ax).squared() + (v.y * ay).squared() + v.z.squared()).sqrt();
    L::select(zero.lt(h.z), d * one.lit(0.5) / (v.z + root), zero)
}

/// `v` reflected about the unit vector `m`.
#[inline(always)]
pub fn mirrored<L: Lane>(v: Vec3<L>, m: Vec3<L>) -> Vec3<L> {
    m * (v.dot(m) * v.x.lit(2.0)) - v
}

/// `v` raised as far as densities require: n·v at least 1e-4, the minimum of [`super::Angles`].
///
/// `n` and `v` unit.
#[inline(always)]
pub fn raised<L: Lane>(n: Vec3<L>, v: Vec3<L>) -> Vec3<L> {
    let least = v.x.lit(MIN_N_DOT_V);
    let n_dot_v = n.dot(v);
    let lifted = (v + n * (least - n_dot_v)).normalize_or(n);
    Vec3::select(n_dot_v.lt(least), lifted, v)
}

/// The weight of a direction sampled by one technique that another could also have sampled: p²/(p² + q²).
///
/// `own` above 0 and `other` at least 0 are the densities of both techniques. The two weights of a direction add up
/// to 1.
/// Source: Veach and Guibas 1995, "Optimally combining sampling techniques for Monte Carlo rendering", §3: the power
/// heuristic with β = 2.
#[inline(always)]
pub(crate) fn power_heuristic<L: Lane>(own: L, other: L) -> L {
    let ratio = other / own;
    own.lit(1.0) / (ratio * ratio + own.lit(1.0))
}

/// How directions of reflected light are sampled: by visible facets of a GGX surface, uniformly, or by cosine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lobes<L> {
    /// Widths of the GGX surface along x and y, each in [[`MIN_ALPHA`], 1].
    pub alpha: [L; 2],
    /// The probability of sampling a facet, [0, 1].
    pub glossy: L,
    /// The probability of sampling uniformly, [0, 1 − `glossy`]. The rest is sampled by cosine.
    pub even: L,
}

impl<L: Lane> Lobes<L> {
    /// Returns the sampling for a model: reflectance divided by density stays bounded, except for models whose
    /// highlight has wider tails than GGX.
    ///
    /// `n_dot_v` in (0, 1].
    /// Law: sampled albedos agree with the quadrature (`laws::sampling::the_furnace_by_sampling_is_that_by_quadrature`).
    #[inline(always)]
    pub fn of(shading: Shading, s: &MaterialSample<L>, n_dot_v: L) -> Self {
        let (zero, one) = (n_dot_v.lit(0.0), n_dot_v.lit(1.0));
        let highlight = fresnel::f_f82(s.f0, s.f90, s.f82_drop, n_dot_v);
        let (width, gloss, matt, even) = match shading {
            Shading::Lambert => return Self { alpha: [one; 2], glossy: zero, even: zero },
            Shading::Ggx => {
                let matt = s.base_color * (one - s.metallic);
                (alpha_from_roughness(s.roughness), highlight, matt, 0.0)
            }
            Shading::GgxPrinted => (s.roughness, highlight, s.base_color, 0.4),
            Shading::CookTorrance => (s.slope, s.specular.mul_elements(highlight), s.diffuse, 0.0),
            Shading::CookTorrancePrinted => (s.slope, s.specular.mul_elements(highlight), s.diffuse, 0.2),
            Shading::BlinnPhong => (alpha_from_shininess(s.shininess), s.specular, s.diffuse, 0.0),
            Shading::BlinnPhongClassic => (alpha_from_shininess(s.shininess), s.specular, s.diffuse, 0.2),
            Shading::BlinnPhongPrinted => (alpha_from_shininess(one.lit(5.0)), s.specular, s.diffuse, 0.0),
            // (r·v)^s falls off as fast as (n·h)^4s.
            Shading::Phong => (alpha_from_shininess(s.shininess * one.lit(4.0)), s.specular, s.diffuse, 0.2),
        };
        let (gloss, matt) = (mean(gloss), mean(matt));
        let share = gloss / (gloss + matt).max(one.lit(1e-6));
        // Metal reflects only by its visible facets, and a surface without gloss only by cosine. The highlights of
        // other models have tails that need cosine sampling.
        let share = match shading {
            Shading::Ggx => {
                let both = L::select(zero.lt(gloss), share.clamp(0.1, 0.98), zero);
                L::select(zero.lt(matt), both, one)
            }
            _ => share.clamp(0.1, 0.9),
        };
        let even = one.lit(even);
        Self { alpha: [width.clamp(MIN_ALPHA, 1.0); 2], glossy: share * (one - even), even }
    }

    /// Samples a direction for a viewer `v` (unit, v.z above 0); it may be below the horizon. `u` in [0, 1)².
    #[inline(always)]
    pub fn direction(&self, v: Vec3<L>, [u, around]: [L; 2]) -> Vec3<L> {
        let glossy = mirrored(v, ggx_visible_normal(v, self.alpha, [stretched(u, self.glossy), around]));
        let rest = u - self.glossy;
        let even = uniform_direction([stretched(rest, self.even), around]);
        let matt = u.lit(1.0) - self.glossy - self.even;
        let matt = cosine_direction([stretched(rest - self.even, matt), around]);
        Vec3::select(rest.lt(u.lit(0.0)), glossy, Vec3::select(rest.lt(self.even), even, matt))
    }

    /// The density of [`Self::direction`] at `l` (unit) for the same viewer.
    ///
    /// Law: integrates to 1 (`laws::sampling::densities_integrate_to_one`).
    #[inline(always)]
    pub fn pdf(&self, v: Vec3<L>, l: Vec3<L>) -> L {
        let (zero, one) = (l.z.lit(0.0), l.z.lit(1.0));
        let even = L::select(zero.lt(l.z), self.even * one.lit(0.5 * FRAC_1_PI), zero);
        let matt = (one - self.glossy - self.even) * cosine_pdf(l.z);
        self.glossy * ggx_visible_pdf(v, l, self.alpha) + even + matt
    }
}

/// Rescales `u` within the part of [0, 1) that is `size` wide and begins at 0: so one number chooses a technique and
/// the direction within it, and evenly distributed numbers stay so. In [0, 1) for any input.
#[inline(always)]
pub fn stretched<L: Lane>(u: L, size: L) -> L {
    let most = 1.0 - f64::from(f32::EPSILON);
    (u / size.max(u.lit(1e-6))).clamp(0.0, most)
}

#[inline(always)]
fn mean<L: Lane>(rgb: Vec3<L>) -> L {
    (rgb.x + rgb.y + rgb.z) * rgb.x.lit(1.0 / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar;

    #[test]
    fn azimuths_are_on_the_circle() {
        for i in 0..4096 {
            let u = f64::from(i) / 4096.0;
            let [x, y] = azimuth(u);
            let turn = 2.0 * PI * u;
            assert!((x - scalar::cos(turn)).abs() < 3e-8 && (y - scalar::sin(turn)).abs() < 3e-8, "{u}");
            let [x, y] = azimuth(u as f32).map(f64::from);
            assert!((x - scalar::cos(turn)).abs() < 2e-7 && (y - scalar::sin(turn)).abs() < 2e-7, "{u}");
        }
    }

    #[test]
    fn both_weights_of_a_direction_add_up_to_one() {
        for (p, q) in [(1.0, 0.0), (1e-8, 3.0), (1e8, 1e-8), (2.0, 2.0)] {
            let sum = if q > 0.0 { power_heuristic(q, p) } else { 0.0 };
            assert!((power_heuristic(p, q) + sum - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn raising_changes_only_what_lies_low() {
        let n = Vec3::new(0.0, 0.0, 1.0);
        let high = Vec3::new(0.6, 0.0, 0.8);
        assert_eq!(raised(n, high), high);
        for low in [Vec3::new(0.6, 0.0, -0.8), Vec3::new(1.0, 0.0, 0.0), -n] {
            let v = raised(n, low);
            assert!((v.length() - 1.0).abs() < 1e-12 && v.z > 0.99e-4, "{v:?}");
        }
    }
}
