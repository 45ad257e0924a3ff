//! The named models.

mod classic;
mod microfacet;
mod printed;

use super::{Angles, AnisotropicLobe, MaterialSample, Shading};
use crate::math::{Lane, Vec3};

/// Outgoing radiance per unit of irradiance on a plane facing the light, linear RGB.
///
/// This is f · (n·l)⁺ for the physical models and the printed expression for the others. Zero if n·l ≤ 0, except for
/// `ggx-printed`, whose diffuse part has no n·l at all. Finite for every material sample in the ranges of
/// [`MaterialSample`] and any [`Angles::new`].
/// Law: reciprocity and energy of the physical models (`laws::shade`), every value (`oracle::shade`).
#[inline(always)]
pub fn reflect<L: Lane>(shading: Shading, s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    match shading {
        Shading::Lambert => lit(a, classic::lambert(s, a)),
        Shading::Phong => lit(a, classic::phong(s, a)),
        Shading::BlinnPhong => lit(a, classic::blinn_phong(s, a)),
        Shading::BlinnPhongClassic => lit(a, classic::blinn_phong_classic(s, a)),
        Shading::CookTorrance => lit(a, microfacet::cook_torrance(s, a)),
        Shading::Ggx => lit(a, microfacet::ggx(s, a)),
        Shading::CookTorrancePrinted => lit(a, printed::cook_torrance_printed(s, a)),
        Shading::BlinnPhongPrinted => lit(a, printed::blinn_phong_printed(s, a)),
        Shading::GgxPrinted => printed::ggx_printed(s, a),
    }
}

/// Like [`reflect`] with [`Shading::Ggx`], for an anisotropic highlight; `v` and `l` are those of `a`.
#[inline(always)]
pub fn reflect_anisotropic<L: Lane>(
    s: &MaterialSample<L>,
    anisotropic: &AnisotropicLobe<L>,
    a: &Angles<L>,
    [v, l]: [Vec3<L>; 2],
) -> Vec3<L> {
    lit(a, microfacet::ggx_with_lobe(s, a, anisotropic.lobe(a, v, l)))
}

/// `value` if n·l > 0, else zero.
#[inline(always)]
fn lit<L: Lane>(a: &Angles<L>, value: Vec3<L>) -> Vec3<L> {
    let zero = a.n_dot_l.lit(0.0);
    Vec3::select(zero.lt(a.n_dot_l), value, Vec3::splat(zero))
}
