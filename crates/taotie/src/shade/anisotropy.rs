//! Anisotropic highlights, wider along one direction, as of brushed metal.

use super::Angles;
use super::ndf::alpha_from_roughness;
use crate::math::{Lane, Vec3};
use std::f64::consts::PI;

/// A GGX lobe with different widths along a tangent and a bitangent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnisotropicLobe<L> {
    /// The direction of the anisotropy, unit, perpendicular to the normal.
    pub tangent: Vec3<L>,
    /// Unit, perpendicular to both.
    pub bitangent: Vec3<L>,
    /// α along `tangent`, (0, 1].
    pub along: L,
    /// α along `bitangent`, (0, 1].
    pub across: L,
}

impl<L: Lane> AnisotropicLobe<L> {
    /// The widths of glTF: across remains α = roughness², along goes from α to 1 with the square of `strength`.
    ///
    /// `strength` and `roughness` in [0, 1].
    /// Source: KHR_materials_anisotropy.
    #[inline(always)]
    pub fn new(tangent: Vec3<L>, bitangent: Vec3<L>, roughness: L, strength: L) -> Self {
        let across = alpha_from_roughness(roughness);
        let along = across + (across.lit(1.0) - across) * strength * strength;
        Self { tangent, bitangent, along, across }
    }

    /// D V, sr⁻¹, for unit `v` and `l`.
    ///
    /// D(h) = 1 / (π α_t α_b ((t·h/α_t)² + (b·h/α_b)² + (n·h)²)²),
    /// V = 1/2 / (n·l |(α_t t·v, α_b b·v, n·v)| + n·v |(α_t t·l, α_b b·l, n·l)|)
    ///
    /// Law: the isotropic lobe if both widths are equal; ∫ D n·h dh = 1 (`laws::energy`).
    /// Source: Heitz 2014, eq. 85 and 86, height-correlated by eq. 99.
    #[inline(always)]
    pub fn lobe(&self, a: &Angles<L>, v: Vec3<L>, l: Vec3<L>) -> L {
        let half = (v + l).normalize_or(v);
        let (x, y) = (self.tangent.dot(half) / self.along, self.bitangent.dot(half) / self.across);
        let sum = x * x + y * y + a.n_dot_h * a.n_dot_h;
        let d = sum.lit(1.0) / (self.along * self.across * sum * sum * sum.lit(PI));
        let masked = a.n_dot_l * self.projected(v, a.n_dot_v) + a.n_dot_v * self.projected(l, a.n_dot_l);
        d * sum.lit(0.5) / masked.max(sum.lit(1e-7))
    }

    /// The square root of the projected roughness along `w`.
    #[inline(always)]
    fn projected(&self, w: Vec3<L>, cosine: L) -> L {
        let (x, y) = (self.tangent.dot(w) * self.along, self.bitangent.dot(w) * self.across);
        (x * x + y * y + cosine * cosine).sqrt()
    }
}
