//! The formulas of layers, lights and antialiasing.

use crate::inputs;
use crate::program::{Formula, part};
use crate::recorder::{Recorded, Scope, record};
use taotie_engine::shade::fresnel::{f_conductor, f_dielectric};
use taotie_engine::shade::lights::{inverse_square, range_window, spot_cone};
use taotie_engine::shade::ndf::{alpha_squared_from_divergence_ggx, divergence_ggx};
use taotie_engine::shade::sheen::{d_charlie, v_neubelt};
use taotie_engine::shade::{
    AnisotropicLobe, SubPixelVariance, coat_fresnel, coat_lobe, curvature_variance, specular_occlusion,
};

/// The formulas of layers, lights and antialiasing.
pub(crate) fn layers() -> Vec<Formula> {
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
    vec![coat_lobe(scope.number("roughness"), &inputs::angles(scope))]
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
    vec![lobe.lobe(&inputs::angles(scope), scope.vector("v"), scope.vector("l"))]
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
