//! A clearcoat over a surface, as in glTF: KHR_materials_clearcoat.

use super::Angles;
use super::fresnel::pow5;
use super::masking::v_smith_ggx;
use super::ndf::{alpha_from_roughness, d_ggx};
use crate::math::Lane;

/// Reflectance at normal incidence of a clearcoat with index 1.5.
pub const COAT_F0: f64 = 0.04;

/// The reflection of a clearcoat that covers everything: f · n·l, colourless.
///
/// f = D_ggx V_smith F_schlick
///
/// `roughness` in [0, 1]; the angles are those of the clearcoat's normal.
/// Source: KHR_materials_clearcoat.
#[inline(always)]
pub fn coat_lobe<L: Lane>(roughness: L, a: &Angles<L>) -> L {
    let zero = roughness.lit(0.0);
    let alpha = alpha_from_roughness(roughness);
    let lobe = d_ggx(a.n_dot_h, a.sin2_h, alpha) * v_smith_ggx(a.n_dot_l, a.n_dot_v, alpha);
    L::select(zero.lt(a.n_dot_l), lobe * coat_fresnel(a.v_dot_h) * a.n_dot_l, zero)
}

/// Schlick's reflectance of the clearcoat, [0.04, 1].
///
/// `cosine` in [0, 1].
#[inline(always)]
pub fn coat_fresnel<L: Lane>(cosine: L) -> L {
    let f0 = cosine.lit(COAT_F0);
    let one = cosine.lit(1.0);
    f0 + (one - f0) * pow5(one - cosine)
}
