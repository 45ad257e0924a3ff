//! The formulas of `taotie_engine::shade` as functions of a shader: the list, their names and their documentation.
//!
//! A test checks that each line of documentation also appears in the source of the formula.

use crate::models::{
    angle_parameters, angles, compensated, compensation, environment_weights, model, structures,
};
use crate::program::{Formula, Program, part};
use crate::recorder::{Recorded, Scope, record};
use taotie_engine::names::Named;
use taotie_engine::shade::fresnel::{f_conductor, f_dielectric, f_f82, pow5};
use taotie_engine::shade::lights::{inverse_square, range_window, spot_cone};
use taotie_engine::shade::microfacets::{
    alpha_from_roughness, alpha_squared_from_divergence_ggx, d_beckmann, d_ggx, divergence_ggx,
};
use taotie_engine::shade::microfacets::{g_v_cavity, g1_schlick_ggx, k_for_lights, v_smith_ggx};
use taotie_engine::shade::sampling::mirrored;
use taotie_engine::shade::sheen::{d_charlie, v_neubelt};
use taotie_engine::shade::{
    AnisotropicLobe, Shading, SubPixelVariance, coat_fresnel, coat_lobe, curvature_variance,
    specular_occlusion,
};

/// The models that support energy compensation.
const COMPENSATED: [Shading; 2] = [Shading::CookTorrance, Shading::Ggx];

/// Returns all formulas: the parts of the models, `angles`, `reflect_…` and `environment_weights_…` for each model,
/// both with `_compensated` for microfacet models, and the parts of layers and lights.
pub fn library() -> Program {
    let shadings = || Shading::NAMES.iter().map(|(_, shading)| *shading);
    let mut program = Program { structures: structures(), ..Program::default() };
    parts().into_iter().chain(distributions()).chain(layers()).for_each(|formula| program.add(formula));
    [angles(), compensation()].into_iter().for_each(|formula| program.add(formula));
    shadings().map(model).chain(COMPENSATED.map(compensated)).for_each(|formula| program.add(formula));
    shadings().map(environment_weights).for_each(|formula| program.add(formula));
    program
}

fn parts() -> [Formula; 8] {
    [
        part("normalize_or", "unit", NORMALIZE_OR, record(normalize_or)),
        part("mirrored", "mirror", MIRRORED, record(mirrored_vector)),
        part("pow5", "fifth", "x⁵.", record(|scope| vec![pow5(scope.number("x"))])),
        part("fresnel", "f", FRESNEL, record(fresnel)),
        part("alpha_from_roughness", "alpha", ALPHA, record(alpha)),
        part("masking_v_cavity", "g", CAVITY, record(cavity)),
        part("visibility_smith_ggx", "v", SMITH, record(smith)),
        part("masking_schlick", "g1", SCHLICK, record(schlick)),
    ]
}

fn distributions() -> [Formula; 3] {
    [
        part("distribution_beckmann", "d", BECKMANN, record(beckmann)),
        part("distribution_ggx", "d", GGX, record(ggx)),
        part(
            "masking_k_for_lights",
            "k",
            K_FOR_LIGHTS,
            record(|s| vec![k_for_lights(s.number("roughness"))]),
        ),
    ]
}

fn normalize_or(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    scope.vector("direction").normalize_or(scope.vector("fallback")).to_array().to_vec()
}

fn mirrored_vector(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    mirrored(scope.vector("v"), scope.vector("m")).to_array().to_vec()
}

fn fresnel(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let (f0, f90) = (scope.vector("f0"), scope.number("f90"));
    f_f82(f0, f90, scope.vector("f82_drop"), scope.number("v_dot_h")).to_array().to_vec()
}

fn alpha(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    vec![alpha_from_roughness(scope.number("roughness"))]
}

fn cavity(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let [n_dot_l, n_dot_v, n_dot_h, v_dot_h] =
        ["n_dot_l", "n_dot_v", "n_dot_h", "v_dot_h"].map(|name| scope.number(name));
    vec![g_v_cavity(n_dot_l, n_dot_v, n_dot_h, v_dot_h)]
}

fn smith(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let [n_dot_l, n_dot_v, alpha] = ["n_dot_l", "n_dot_v", "alpha"].map(|name| scope.number(name));
    vec![v_smith_ggx(n_dot_l, n_dot_v, alpha)]
}

fn schlick(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    vec![g1_schlick_ggx(scope.number("cosine"), scope.number("k"))]
}

fn beckmann(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let [n_dot_h, sin2_h, slope] = ["n_dot_h", "sin2_h", "slope"].map(|name| scope.number(name));
    vec![d_beckmann(n_dot_h, sin2_h, slope)]
}

fn ggx(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let [n_dot_h, sin2_h, alpha] = ["n_dot_h", "sin2_h", "alpha"].map(|name| scope.number(name));
    vec![d_ggx(n_dot_h, sin2_h, alpha)]
}

const NORMALIZE_OR: &str =
    "The unit vector of this direction, or `fallback` if the length is not above 1e-18.";

const MIRRORED: &str = "`v` reflected about the unit vector `m`.";

const FRESNEL: &str = "Schlick with Lazányi's correction for metals.
F = F_schlick(v·h) − a · v·h (1 − v·h)⁶, clamped to [0, 1]
`f0` linear RGB in [0, 1]; `f90` in [0, 1], 1 for metals;
Source: Kutz, Hašan and Edmondson 2021 (F82-tint), as in the OpenPBR Surface specification.";

const ALPHA: &str = "α = roughness², at least 1e-3
`roughness` in [0, 1].
Source: Burley 2012, §5.4, as in glTF 2.0, appendix B.";

const CAVITY: &str = "Masking of V-shaped grooves.
G = min(1, 2 n·h n·v / v·h, 2 n·h n·l / v·h)
`n_dot_l`, `n_dot_v`, `n_dot_h` in [0, 1]; `v_dot_h` in (0, 1].
Source: Cook and Torrance 1982, §4, after Torrance and Sparrow 1967; Guo and Wang 2025, eq. 8.";

const SMITH: &str = "Height-correlated Smith masking of GGX, as V = G / (4 n·l n·v).
V = 0.5 / (n·l √((n·v)²(1 − α²) + α²) + n·v √((n·l)²(1 − α²) + α²))
`n_dot_l` in [0, 1], `n_dot_v` in (0, 1]; `alpha` in [1e-3, 1].
Source: Heitz 2014, eq. 99; the form of Lagarde and de Rousiers 2014, listing 2.";

const SCHLICK: &str = "Schlick's rational approximation of Smith's masking for one direction.
g(x) = x / (k + (1 − k) x)
`cosine` x in [0, 1]; `k` in (0, 1].
Source: Schlick 1994, eq. 19, with the k of Karis 2013.";

const K_FOR_LIGHTS: &str = "k = (roughness + 1)²/8
`roughness` in [0, 1]; k in [1/8, 1/2].
Source: Karis 2013, eq. 4.";

const BECKMANN: &str = "Beckmann's normal distribution, D(h), in sr⁻¹.
D(h) = exp(−tan²θ_h / m²) / (π m² cos⁴θ_h), that is exp(((n·h)² − 1)/(m² (n·h)²)) / (π m² (n·h)⁴)
`n_dot_h` and `sin2_h` in [0, 1]; `slope` m above 0, taken as at least 1e-3.
Source: Cook and Torrance 1982, eq. 5 with today's 1/π; Walter et al. 2007, eq. 25.";

const GGX: &str = "Trowbridge–Reitz (GGX) normal distribution, D(h), in sr⁻¹.
D(h) = α² / (π ((n·h)² (α² − 1) + 1)²), computed as α² / (π ((n·h)² α² + sin²θ_h)²)
`n_dot_h` and `sin2_h` in [0, 1]; `alpha` in [1e-3, 1].
Source: Walter et al. 2007, eq. 33.";

/// The formulas of layers, lights and antialiasing.
fn layers() -> Vec<Formula> {
    [coats().to_vec(), sub_pixel().to_vec(), lights().to_vec()].concat()
}

fn coats() -> [Formula; 6] {
    [
        part("coat_fresnel", "f", COAT_FRESNEL, record(|scope| vec![coat_fresnel(scope.number("cosine"))])),
        part("coat_lobe", "coat", COAT_LOBE, record(coat)),
        part("distribution_charlie", "d", CHARLIE, record(charlie)),
        part("visibility_neubelt", "v", NEUBELT, record(neubelt)),
        part("anisotropic_lobe", "lobe", ANISOTROPIC, record(anisotropic)),
        part("specular_occlusion", "occluded", OCCLUSION, record(occlusion)),
    ]
}

fn sub_pixel() -> [Formula; 4] {
    [
        part("divergence_ggx", "divergence", DIVERGENCE, record(|s| vec![divergence_ggx(s.number("alpha"))])),
        part("alpha_squared_from_divergence_ggx", "alpha_squared", ALPHA_SQUARED, record(alpha_squared)),
        part("curvature_variance", "curvature", CURVATURE, record(curvature)),
        part("widened_roughness", "widened", WIDENED, record(widened)),
    ]
}

fn lights() -> [Formula; 5] {
    [
        part("inverse_square", "falloff", INVERSE_SQUARE, record(falloff)),
        part("range_window", "window", WINDOW, record(window)),
        part("spot_cone", "cone", CONE, record(cone)),
        part("fresnel_dielectric", "f", DIELECTRIC, record(dielectric)),
        part("fresnel_conductor", "f", CONDUCTOR, record(conductor)),
    ]
}

fn coat(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    vec![coat_lobe(scope.number("roughness"), &angle_parameters(scope))]
}

fn charlie(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    vec![d_charlie(scope.number("sin2_h"), scope.number("roughness"))]
}

fn neubelt(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    vec![v_neubelt(scope.number("n_dot_l"), scope.number("n_dot_v"))]
}

fn anisotropic(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let [tangent, bitangent] = ["tangent", "bitangent"].map(|name| scope.vector(name));
    let [along, across] = ["along", "across"].map(|name| scope.number(name));
    let lobe = AnisotropicLobe { tangent, bitangent, along, across };
    vec![lobe.lobe(&angle_parameters(scope), scope.vector("v"), scope.vector("l"))]
}

fn occlusion(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let [n_dot_v, occlusion, roughness] =
        ["n_dot_v", "occlusion", "roughness"].map(|name| scope.number(name));
    vec![specular_occlusion(n_dot_v, occlusion, roughness)]
}

fn alpha_squared(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    vec![alpha_squared_from_divergence_ggx(scope.number("divergence"))]
}

fn curvature(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    vec![curvature_variance(scope.vector("dx"), scope.vector("dy"))]
}

fn widened(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let roughness = scope.number("roughness");
    let [curvature, normal_variance] = ["curvature", "normal_variance"].map(|name| scope.number(name));
    vec![SubPixelVariance { curvature, normal_variance }.widened(roughness)]
}

fn falloff(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    vec![inverse_square(scope.number("distance_squared"))]
}

fn window(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    vec![range_window(scope.number("distance_squared"), scope.number("range"))]
}

fn cone(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let [cos_angle, cos_inner, cos_outer] =
        ["cos_angle", "cos_inner", "cos_outer"].map(|name| scope.number(name));
    vec![spot_cone(cos_angle, cos_inner, cos_outer)]
}

fn dielectric(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    vec![f_dielectric(scope.number("cos_theta"), scope.number("eta"))]
}

fn conductor(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let [cos_theta, eta, k] = ["cos_theta", "eta", "k"].map(|name| scope.number(name));
    vec![f_conductor(cos_theta, eta, k)]
}

const COAT_FRESNEL: &str = "Schlick's reflectance of the clearcoat, [0.04, 1].
`cosine` in [0, 1].";

const COAT_LOBE: &str = "The reflection of a clearcoat that covers everything: f · n·l, colourless.
f = D_ggx V_smith F_schlick
`roughness` in [0, 1]; the angles are those of the clearcoat's normal.
Source: KHR_materials_clearcoat.";

const CHARLIE: &str = "The \"Charlie\" distribution of inverted Gaussian-like fibres, D(h), in sr⁻¹.
D(h) = (2 + 1/α) sin^(1/α) θ_h / (2π), α = roughness²
`sin2_h` in [0, 1]; `roughness` in [0, 1], taken as at least 0.07.
Source: Estevez and Kulla 2017, \"Production Friendly Microfacet Sheen BRDF\", eq. 2.";

const NEUBELT: &str = "The visibility of sheen, V in sr⁻¹.
V = 1 / (4 (n·l + n·v − n·l n·v)), at most 1
Both cosines in (0, 1].
Source: Neubelt and Pettineo 2013, \"Crafting a Next-Gen Material Pipeline for The Order: 1886\", after Ashikhmin.";

const ANISOTROPIC: &str = "D V, sr⁻¹, for unit `v` and `l`.
D(h) = 1 / (π α_t α_b ((t·h/α_t)² + (b·h/α_b)² + (n·h)²)²),
V = 1/2 / (n·l |(α_t t·v, α_b b·v, n·v)| + n·v |(α_t t·l, α_b b·l, n·l)|)
Source: Heitz 2014, eq. 85 and 86, height-correlated by eq. 99.";

const OCCLUSION: &str = "Lobes narrower than the hemisphere are occluded less along the normal and more at grazing angles:
(n·v + o)^(2^(−16 r − 1)) − 1 + o, clamped to [0, 1]; r the roughness.
All in [0, 1].
Source: Lagarde and de Rousiers 2014, \"Moving Frostbite to PBR\", listing 26, with the roughness in α's place.";

const DIVERGENCE: &str =
    "The divergence of the facets of a GGX surface: 1 − ∫ D(m) (n·m)² dm, one minus the length of their mean normal.
α²/k (artanh(√k)/√k − 1) with k = 1 − α²: 0 at α = 0, 1/3 at α = 1, increasing.
`alpha` in [1e-3, 1].";

const ALPHA_SQUARED: &str =
    "The α² of the GGX surface whose facets have this divergence; 1 for 1/3 and beyond.
With r² = 3 · divergence, α/r is a ratio of two polynomials, within 6e-5.";

const CURVATURE: &str = "The addition to α² by the curvature of the smooth surface within a pixel
Source: Tokuyoshi and Kaplanyan 2019, \"Improved Geometric Specular Antialiasing\", eq. 9 and §4 (σ² = 1/4, κ = 0.18)";

const WIDENED: &str = "The roughness of a GGX lobe with this `roughness`, widened by this variance.
Source: Toksvig 2005, \"Mipmapping Normal Maps\", for the length as a measure; Mardia and Jupp 2000";

const INVERSE_SQUARE: &str = "The falloff of a point light.
E = I · 1/d²
`distance_squared` d² at least 0, in squared model units, taken as at least 1e-12.";

const WINDOW: &str = "The window that fades a light to zero at its range
w = max(min(1 − (d/range)⁴, 1), 0)
`distance_squared` d² at least 0, in squared model units; `range` above 0, in model units.
Source: glTF extension KHR_lights_punctual, \"Range Property\".";

const CONE: &str = "The fraction of a spot light's intensity at an angle to its axis.
a = clamp((cos θ − cos outer) / max(10⁻³, cos inner − cos outer), 0, 1), squared
`cos_inner` ≥ `cos_outer`, the cosines of the angles from the axis where the light begins to fade and ends.
Source: glTF extension KHR_lights_punctual, \"Inner and Outer Cone Angles\": the reference code squares.";

const DIELECTRIC: &str = "Fresnel reflectance of a dielectric for unpolarised light, exact.
`eta` = index behind over index before the surface, above 0. 1 beyond the critical angle.
`cos_theta` in [0, 1], taken as at least 1e-6
Source: Born and Wolf, Principles of Optics, §1.5.2, eq. 21a.";

const CONDUCTOR: &str =
    "Fresnel reflectance of a conductor with the complex index η + ik for unpolarised light, exact.
`cos_theta` in [0, 1]; `eta` above 0, `k` at least 0, both relative to the medium before the surface.
Source: Born and Wolf, Principles of Optics, §14.2 (13.4 in older editions).";
