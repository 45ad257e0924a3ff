//! The formulas of `taotie_engine::shade` as functions of a shader: the list, their names and their documentation.
//!
//! A test checks that each line of documentation also appears in the source of the formula.

use crate::environment::{compensation, environment_weights};
use crate::layers::layers;
use crate::models::{angles, compensated, model};
use crate::program::{Formula, Program, part};
use crate::recorder::{Recorded, Scope, record};
use crate::structures::structures;
use taotie_engine::names::Named;
use taotie_engine::shade::Shading;
use taotie_engine::shade::fresnel::{f_f82, pow5};
use taotie_engine::shade::masking::{g_v_cavity, g1_schlick_ggx, k_for_lights, v_smith_ggx};
use taotie_engine::shade::ndf::{alpha_from_roughness, d_beckmann, d_ggx};
use taotie_engine::shade::sampling::mirrored;

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
