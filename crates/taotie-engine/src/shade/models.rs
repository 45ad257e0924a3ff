//! The reflectance models by name, what each reflects of one light and of light from all directions; the material
//! sample they read, the parameters of a surface at a point; and the energy compensation in it, the light that a lobe
//! loses by single scattering.
//!
//! The functions of the models are called for n·l > 0, except where they say otherwise. Those that end in `printed`
//! compute what Guo and Wang 2025 and an article print, errors included; nothing else may use them.

use super::dfg::Dfg;
use super::fresnel::{f_f82, pow5};
use super::microfacets::{MIN_ALPHA, alpha_from_roughness, d_beckmann, d_ggx};
use super::microfacets::{g_v_cavity, g1_schlick_ggx, k_for_lights, v_smith_ggx};
use super::{Angles, AnisotropicLobe};
use crate::math::{Lane, Vec3};
use crate::names::Named;
use std::f64::consts::{FRAC_1_PI, PI};

/// The smallest n·l by which the printed Cook-Torrance divides. G decreases with n·l, so the quotient stays finite.
const MIN_N_DOT_L: f64 = 1e-6;

/// A reflectance model. The correct models have their standard names; a model ending in `Printed` computes what a
/// paper or article prints, errors included, so that its images can be reproduced and compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shading {
    /// Perfectly diffuse, f = ρ/π.
    Lambert,
    /// Phong 1975: the mirrored light direction against the viewer's.
    Phong,
    /// Blinn-Phong with the energy normalisation (s + 8)/(8π).
    BlinnPhong,
    /// Blinn-Phong without normalisation, as in fixed-function graphics.
    BlinnPhongClassic,
    /// Cook and Torrance 1982 with Beckmann's distribution, in today's normalisation.
    CookTorrance,
    /// Metallic-roughness of glTF 2.0: GGX, height-correlated Smith, Schlick.
    #[default]
    Ggx,
    /// Cook-Torrance as Guo and Wang 2025 print it.
    CookTorrancePrinted,
    /// Blinn-Phong as the article's shader computes it.
    BlinnPhongPrinted,
    /// GGX as the article's shader computes it.
    GgxPrinted,
}

impl Shading {
    /// Returns true if it computes what a paper or article prints, errors included, so that nothing may be corrected.
    pub fn is_printed(self) -> bool {
        matches!(self, Self::CookTorrancePrinted | Self::BlinnPhongPrinted | Self::GgxPrinted)
    }
}

impl Named for Shading {
    const WHAT: &'static str = "shading model";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("lambert", Self::Lambert),
        ("phong", Self::Phong),
        ("blinn-phong", Self::BlinnPhong),
        ("blinn-phong-classic", Self::BlinnPhongClassic),
        ("cook-torrance", Self::CookTorrance),
        ("ggx", Self::Ggx),
        ("cook-torrance-printed", Self::CookTorrancePrinted),
        ("blinn-phong-printed", Self::BlinnPhongPrinted),
        ("ggx-printed", Self::GgxPrinted),
    ];
}

/// Outgoing radiance per unit of irradiance on a plane facing the light, linear RGB.
///
/// This is f · (n·l)⁺ for the physical models and the printed expression for the others. Zero if n·l ≤ 0, except for
/// `ggx-printed`, whose diffuse part has no n·l at all. Finite for every material sample in the ranges of
/// [`MaterialSample`] and any [`Angles::new`].
/// Law: reciprocity and energy of the physical models (`laws::shade`), every value (`oracle::shade`).
#[inline(always)]
pub fn reflect<L: Lane>(shading: Shading, s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    match shading {
        Shading::Lambert => lit(a, lambert(s, a)),
        Shading::Phong => lit(a, phong(s, a)),
        Shading::BlinnPhong => lit(a, blinn_phong(s, a)),
        Shading::BlinnPhongClassic => lit(a, blinn_phong_classic(s, a)),
        Shading::CookTorrance => lit(a, cook_torrance(s, a)),
        Shading::Ggx => lit(a, ggx(s, a)),
        Shading::CookTorrancePrinted => lit(a, cook_torrance_printed(s, a)),
        Shading::BlinnPhongPrinted => lit(a, blinn_phong_printed(s, a)),
        Shading::GgxPrinted => ggx_printed(s, a),
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
    lit(a, ggx_with_lobe(s, a, anisotropic.lobe(a, v, l)))
}

/// The reflection of light from all directions, as weights of two radiances, linear RGB.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnvironmentWeights<L> {
    /// The weight of the radiance gathered by the highlight.
    pub specular: Vec3<L>,
    /// The weight of the mean radiance over the hemisphere, which is the irradiance divided by π.
    pub diffuse: Vec3<L>,
}

/// The weights for a material sample with the directional albedos `dfg` of its lobe.
///
/// `ggx` and `cook-torrance`: the split sum, the albedo and the remainder for the diffuse part. The other models have
/// no such lobe: `lambert` reflects its colour, the Phong family k_d and k_s, as if each were normalised.
/// Source: Karis 2013; the article's environment term.
#[inline(always)]
pub fn environment_weights<L: Lane>(
    shading: Shading,
    s: &MaterialSample<L>,
    dfg: &Dfg<L>,
) -> EnvironmentWeights<L> {
    let one = s.f90.lit(1.0);
    let zero = Vec3::splat(one.lit(0.0));
    let ones = Vec3::splat(one);
    let gain = s.compensation.map_or(ones, |c| c.gain);
    match shading {
        Shading::Lambert => EnvironmentWeights { specular: zero, diffuse: s.base_color },
        Shading::Ggx | Shading::GgxPrinted => {
            let diffuse = s.base_color * (one - s.metallic);
            let kept = match s.compensation {
                Some(compensation) => Vec3::splat(compensation.transmitted),
                None => ones - s.f0 - (Vec3::splat(s.f90) - s.f0) * dfg.diffuse_edge,
            };
            let specular = dfg.albedo(s.f0, s.f90, s.f82_drop).mul_elements(gain);
            EnvironmentWeights { specular, diffuse: diffuse.mul_elements(kept) }
        }
        Shading::CookTorrance | Shading::CookTorrancePrinted => {
            let specular = dfg.albedo(s.f0, s.f90, s.f82_drop).mul_elements(gain);
            EnvironmentWeights { specular: s.specular.mul_elements(specular), diffuse: s.diffuse }
        }
        Shading::Phong | Shading::BlinnPhong | Shading::BlinnPhongClassic | Shading::BlinnPhongPrinted => {
            EnvironmentWeights { specular: s.specular, diffuse: s.diffuse }
        }
    }
}

/// The visible fraction of a highlight's environment, if `occlusion` is that of the hemisphere.
///
/// Lobes narrower than the hemisphere are occluded less along the normal and more at grazing angles:
/// (n·v + o)^(2^(−16 r − 1)) − 1 + o, clamped to [0, 1]; r the roughness.
///
/// All in [0, 1]. Law: 1 if `occlusion` is 1, 0 if it is 0 and n·v is 0.
/// Source: Lagarde and de Rousiers 2014, "Moving Frostbite to PBR", listing 26, with the roughness in α's place.
#[inline(always)]
pub fn specular_occlusion<L: Lane>(n_dot_v: L, occlusion: L, roughness: L) -> L {
    let one = n_dot_v.lit(1.0);
    let exponent = (-(roughness * one.lit(16.0)) - one).exp2();
    let power = (n_dot_v + occlusion).max(one.lit(1e-6)).pow(exponent);
    (power - one + occlusion).clamp(0.0, 1.0)
}

/// `value` if n·l > 0, else zero.
#[inline(always)]
fn lit<L: Lane>(a: &Angles<L>, value: Vec3<L>) -> Vec3<L> {
    let zero = a.n_dot_l.lit(0.0);
    Vec3::select(zero.lt(a.n_dot_l), value, Vec3::splat(zero))
}

/// Perfectly diffuse reflection.
///
/// f · n·l = ρ/π · n·l
///
/// ρ is the base colour, regardless of `metallic`.
/// Law: reflects exactly ρ of the light (`laws::shade::lambert_reflects_its_colour`).
/// Source: Lambert 1760.
#[inline(always)]
fn lambert<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    s.base_color * (a.n_dot_l * a.n_dot_l.lit(FRAC_1_PI))
}

/// Phong's model, neither normalised nor reciprocal.
///
/// L = k_d n·l + k_s ((r·v)⁺)^s
///
/// Ambient light is left to the caller.
/// Law: none of the physical ones (`laws::shade::unphysical_models_earn_their_names`).
/// Source: Phong 1975; Guo and Wang 2025, eq. 1, 3 and §1.2.
#[inline(always)]
fn phong<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    s.diffuse * a.n_dot_l + s.specular * a.r_dot_v.pow(s.shininess)
}

/// Blinn-Phong with energy normalisation.
///
/// f · n·l = (C_diff/π + (s + 8)/(8π) C_spec (n·h)^s) n·l
///
/// The factor is an approximation: if C_diff + C_spec = 1, up to 7.5 % more light is reflected than arrives (s = 9,
/// seen along the normal).
/// Law: reciprocity; energy ≤ 1.0755 (`laws::shade::physical_models_stay_within_energy`).
/// Source: Blinn 1977; normalisation of Akenine-Möller, Haines and Hoffman, Real-Time Rendering, 3rd ed., eq. 7.49.
#[inline(always)]
fn blinn_phong<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    let scale = normalisation(s.shininess);
    let lobe = a.n_dot_h.pow(s.shininess);
    (s.diffuse * scale.lit(FRAC_1_PI) + s.specular * (scale * lobe)) * a.n_dot_l
}

/// Blinn-Phong without normalisation, as in fixed-function graphics.
///
/// L = C_diff n·l + C_spec (n·h)^s
///
/// Law: none of the physical ones (`laws::shade::unphysical_models_earn_their_names`).
/// Source: Blinn 1977; the article's first formula.
#[inline(always)]
fn blinn_phong_classic<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    s.diffuse * a.n_dot_l + s.specular * a.n_dot_h.pow(s.shininess)
}

/// (s + 8)/(8π).
#[inline(always)]
fn normalisation<L: Lane>(shininess: L) -> L {
    (shininess + shininess.lit(8.0)) * shininess.lit(0.125 * FRAC_1_PI)
}

/// Cook and Torrance's model in today's normalisation.
///
/// f · n·l = k_d/π · n·l + k_s D_beckmann G_v_cavity F / (4 n·v), the n·l of the denominator cancelled
///
/// `diffuse` is k_d times the surface's colour, `specular` is k_s. Ambient light is left to the caller.
/// Law: reciprocity; energy ≤ 1 if k_d + k_s ≤ 1 (`laws::shade`).
/// Source: Cook and Torrance 1982, eq. 1–5, with 4 for their π (Torrance and Sparrow 1967; Walter et al. 2007, eq.
/// 20).
#[inline(always)]
fn cook_torrance<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    let d = d_beckmann(a.n_dot_h, a.sin2_h, s.slope);
    let g = g_v_cavity(a.n_dot_l, a.n_dot_v, a.n_dot_h, a.v_dot_h);
    let f = f_f82(s.f0, s.f90, s.f82_drop, a.v_dot_h);
    let f = s.compensation.map_or(f, |c| f.mul_elements(c.gain));
    let lobe = d * g / (a.n_dot_v * a.n_dot_v.lit(4.0));
    s.diffuse * (a.n_dot_l * a.n_dot_l.lit(FRAC_1_PI)) + s.specular.mul_elements(f) * lobe
}

/// Metallic-roughness reflection of glTF 2.0.
///
/// f · n·l = ((1 − F)(1 − metallic) ρ/π + D_ggx V_smith F) n·l
///
/// Without compensation, the diffuse part is weighted by 1 − F(v·h) as in glTF, not by the light that the highlight
/// leaves: a metal never reflects more than arrives, but a white dielectric at a grazing angle does, up to 1.7 times
/// (1.02 over all angles); and a rough metal loses light: 1 − ln 2 of it remain at roughness 1 along the normal. With
/// compensation, F in the highlight is multiplied by its gain and 1 − F is replaced by the transmitted fraction: both
/// white surfaces then reflect exactly what arrives.
/// Law: reciprocity, energy ≤ 1 for metals, white furnace (`laws::shade::white_furnace_of_ggx`, `laws::energy`,
/// `laws::shade::a_white_dielectric_of_ggx_exceeds_its_energy_at_grazing_view_only`).
/// Source: glTF 2.0 specification, appendix B.3; Walter et al. 2007; Heitz 2014; Turquin 2019.
#[inline(always)]
fn ggx<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    let alpha = alpha_from_roughness(s.roughness);
    ggx_with_lobe(s, a, d_ggx(a.n_dot_h, a.sin2_h, alpha) * v_smith_ggx(a.n_dot_l, a.n_dot_v, alpha))
}

/// Like [`ggx`], for another D V.
#[inline(always)]
fn ggx_with_lobe<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>, lobe: L) -> Vec3<L> {
    let one = a.n_dot_l.lit(1.0);
    let f = f_f82(s.f0, s.f90, s.f82_drop, a.v_dot_h);
    let (f, kept) = match s.compensation {
        Some(c) => (f.mul_elements(c.gain), Vec3::splat(c.transmitted)),
        None => (f, Vec3::splat(one) - f),
    };
    let diffuse = s.base_color * ((one - s.metallic) * one.lit(FRAC_1_PI));
    (kept.mul_elements(diffuse) + f * lobe) * a.n_dot_l
}

/// Cook-Torrance as Guo and Wang 2025 print it; called for n·l > 0.
///
/// I = k_d n·l + k_s · F/π · D/(n·l) · G/(n·v) with F = f0 + (1 − f0)(1 − v·h)² and D = exp(…)/(m² (n·h)⁴)
///
/// Against [`cook_torrance`]: the Fresnel exponent is 2 instead of 5; the highlight lacks the
/// factor n·l of the irradiance and is four times as strong; the diffuse part lacks 1/π. (D without 1/π and F/π
/// are the right 1/π in another place.) Ambient light is the caller's.
/// Law: neither reciprocal nor within energy (`laws::shade::unphysical_models_earn_their_names`).
/// Source: Guo and Wang 2025, eq. 1–8.
#[inline(always)]
fn cook_torrance_printed<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    let one = a.n_dot_l.lit(1.0);
    let d = d_beckmann(a.n_dot_h, a.sin2_h, s.slope) * one.lit(PI);
    let g = g_v_cavity(a.n_dot_l, a.n_dot_v, a.n_dot_h, a.v_dot_h);
    let f = s.f0 + (Vec3::splat(one) - s.f0) * (one - a.v_dot_h).squared();
    let n_dot_l = a.n_dot_l.max(one.lit(MIN_N_DOT_L));
    let lobe = one.lit(FRAC_1_PI) * (d / n_dot_l) * (g / a.n_dot_v);
    s.diffuse * a.n_dot_l + s.specular.mul_elements(f) * lobe
}

/// Blinn-Phong as the article's shader computes it; called for n·l > 0.
///
/// L = (C_diff/π + (m + 8)/(8π) C_spec (n·h)⁵) n·l
///
/// The exponent is 5 regardless of m = `shininess`, so a higher m is brighter instead of sharper.
/// Law: not within energy for large m (`laws::shade::unphysical_models_earn_their_names`).
/// Source: the article's shader `Custom/BlinnPhong`.
#[inline(always)]
fn blinn_phong_printed<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    let scale = normalisation(s.shininess);
    (s.diffuse * scale.lit(FRAC_1_PI) + s.specular * (scale * pow5(a.n_dot_h))) * a.n_dot_l
}

/// GGX as the article's shader computes it, also for n·l ≤ 0.
///
/// L = k_d ρ/π + k_s V F D with n·l and n·v clamped at 0,
/// D = α²/(π((n·h)²(α² − 1) + 1)²), α = roughness; F = F0 + (1 − F0)(1 − (n·h)⁵);
/// V = g(n·l) g(n·v) / (4 (n·l/2 + 1/2) n·v), g(x) = x/(k + (1 − k)x), k = (roughness + 1)²/8;
/// k_d = F0, k_s = (1 − F0)(1 − metallic)
///
/// It differs from [`ggx`]: F decreases where it should increase and uses n·h for v·h; k_d and k_s
/// are swapped; the denominator has half-Lambert for n·l; α is not squared; there is no factor n·l, so the side
/// facing away from the light is lit. The shader stores F, k_d and k_s in scalars, which keeps **only the first
/// channel of F0**: so does this, and the highlight is grey. The rounding of its half floats is not imitated. α is at
/// least 1e-3, since the shader's D is 0/0 at roughness 0.
/// Law: neither reciprocal nor dark at n·l = 0 (`laws::shade::unphysical_models_earn_their_names`).
/// Source: the article's shader `Custom/BRDF`.
#[inline(always)]
fn ggx_printed<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    let one = a.n_dot_l.lit(1.0);
    let half = one.lit(0.5);
    let n_dot_l = a.n_dot_l.max(one.lit(0.0));
    let d = d_ggx(a.n_dot_h, a.sin2_h, s.roughness.max(one.lit(MIN_ALPHA)));
    let f0 = s.f0.x;
    let f = f0 + (one - f0) * (one - pow5(a.n_dot_h));
    let half_lambert = n_dot_l * half + half;
    let k = k_for_lights(s.roughness);
    let g = g1_schlick_ggx(n_dot_l, k) * g1_schlick_ggx(a.n_dot_v, k);
    let v = g / (half_lambert * a.n_dot_v * one.lit(4.0));
    let k_diffuse = f0;
    let k_specular = (one - f0) * (one - s.metallic);
    s.base_color * (k_diffuse * one.lit(FRAC_1_PI)) + Vec3::splat(k_specular * v * f * d)
}

/// A material sample: the parameters of a surface at a point. Each model reads the fields it knows and ignores the
/// rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaterialSample<L> {
    /// ρ, linear RGB in [0, 1]; diffuse colour of `lambert`, `ggx` and `ggx-printed`.
    pub base_color: Vec3<L>,
    /// [0, 1]; 1 has no diffuse part in `ggx`.
    pub metallic: L,
    /// Perceptual roughness, [0, 1]; α is its square (in `ggx-printed`, α is the roughness itself).
    pub roughness: L,
    /// Reflectance at normal incidence, linear RGB in [0, 1], already mixed by `metallic`.
    pub f0: Vec3<L>,
    /// Reflectance at grazing incidence, [0, 1]; 1 except for weakened dielectrics.
    pub f90: L,
    /// Lazányi coefficient of the reflectance at 82°, see [`super::fresnel::f82_drop`]; 0 means Schlick.
    pub f82_drop: Vec3<L>,
    /// k_d or C_diff of the classic models and of Cook-Torrance, linear RGB in [0, 1].
    pub diffuse: Vec3<L>,
    /// k_s or C_spec of the classic models and of Cook-Torrance, linear RGB in [0, 1].
    pub specular: Vec3<L>,
    /// Exponent of Phong and Blinn-Phong, at least 0.
    pub shininess: L,
    /// Beckmann's rms slope m of Cook-Torrance, above 0.
    pub slope: L,
    /// Light scattered by several facets, for `ggx` and `cook-torrance`; `None` follows light only to its first
    /// facet.
    pub compensation: Option<Compensation<L>>,
}

/// How microfacet models treat energy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Energy {
    /// Light scattered several times is added: a white surface reflects all light at any roughness.
    #[default]
    Compensated,
    /// Light is followed only to its first facet, as in glTF's formulas; rough metals darken.
    Single,
}

impl Named for Energy {
    const WHAT: &'static str = "energy mode";
    const NAMES: &'static [(&'static str, Self)] =
        &[("compensated", Self::Compensated), ("single", Self::Single)];
}

/// The compensation that makes a microfacet model conserve energy, at one n·v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compensation<L> {
    /// Multiplies the highlight, linear RGB, at least 1.
    pub gain: Vec3<L>,
    /// The fraction of light that the highlight leaves for the diffuse reflection below, [0, 1].
    pub transmitted: L,
}

/// The compensation of a lobe whose directional albedos are `dfg`, for Schlick's Fresnel factor between `f0` and `f90`
/// with Lazányi's `drop`.
///
/// gain = 1 + F0 (1 − E)/E with E = scale + bias: light that is not reflected at the first facet meets another and is
/// coloured again, so that a white metal reflects all of it. transmitted = 1 − max(gain · albedo), over the channels,
/// so that a white dielectric reflects all of it too, and no colour more than it receives.
///
/// Law: a white furnace returns 1 within 1 % at roughness 0.1 to 1 (`laws::energy`).
/// Source: Turquin 2019, "Practical multiple scattering compensation for microfacet models", eq. 16; the diffuse
/// fraction as in Jakob et al. 2014 and glTF viewers.
#[inline(always)]
pub fn compensation<L: Lane>(dfg: &Dfg<L>, f0: Vec3<L>, f90: L, drop: Vec3<L>) -> Compensation<L> {
    let one = f90.lit(1.0);
    let total = dfg.total().max(one.lit(1e-3));
    let gain = Vec3::splat(one) + f0 * ((one - total) / total).max(one.lit(0.0));
    let albedo = dfg.albedo(f0, f90, drop).mul_elements(gain);
    let most = albedo.x.max(albedo.y).max(albedo.z);
    Compensation { gain, transmitted: (one - most).clamp(0.0, 1.0) }
}
