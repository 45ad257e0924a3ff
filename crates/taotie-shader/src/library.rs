//! The formulas of `taotie::shade` as functions of a shader: which there are, their names and their documentation.
//!
//! A test holds that each line of documentation stands where the formula does.

use crate::graph::Graph;
use crate::program::{Formula, Program};
use crate::recorder::{Recorded, Scope, record};
use taotie::names::Named;
use taotie::shade::fresnel::{f_f82, pow5};
use taotie::shade::masking::{g_v_cavity, g1_schlick_ggx, k_for_lights, v_smith_ggx};
use taotie::shade::ndf::{alpha_from_roughness, d_beckmann, d_ggx};
use taotie::shade::{Angles, MaterialSample, Shading, reflect};

/// All formulas: the parts of the models, `angles`, and `reflect_…` for each model.
pub fn library() -> Program {
    let mut program = Program::default();
    parts().into_iter().chain(distributions()).chain([angles()]).for_each(|formula| program.add(formula));
    Shading::NAMES.iter().for_each(|(_, shading)| program.add(model(*shading)));
    program
}

/// The name of the function that computes a model: `reflect_cook_torrance`.
pub fn model_name(shading: Shading) -> String {
    format!("reflect_{}", shading.name().replace('-', "_"))
}

fn part(name: &str, symbol: &'static str, doc: &'static str, graph: Graph) -> Formula {
    Formula { name: name.into(), symbol, doc, structure: None, graph }
}

fn parts() -> [Formula; 6] {
    [
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

fn angles() -> Formula {
    let graph = record(|scope| {
        let a = Angles::new(scope.vector("n"), scope.vector("v"), scope.vector("l"));
        vec![a.n_dot_l, a.n_dot_v, a.n_dot_h, a.sin2_h, a.v_dot_h, a.r_dot_v]
    });
    Formula { structure: Some("Angles"), ..part("angles", "a", ANGLES, graph) }
}

fn model(shading: Shading) -> Formula {
    let graph = record(|scope| reflect(shading, &material(scope), &given_angles(scope)).to_array().to_vec());
    part(&model_name(shading), "radiance", model_doc(shading), graph)
}

/// The material sample `s` as parameters, in the order of the structure's fields.
pub(crate) fn material(scope: Scope<'_>) -> MaterialSample<Recorded<'_>> {
    MaterialSample {
        base_color: scope.vector("s.base_color"),
        metallic: scope.number("s.metallic"),
        roughness: scope.number("s.roughness"),
        f0: scope.vector("s.f0"),
        f90: scope.number("s.f90"),
        f82_drop: scope.vector("s.f82_drop"),
        diffuse: scope.vector("s.diffuse"),
        specular: scope.vector("s.specular"),
        shininess: scope.number("s.shininess"),
        slope: scope.number("s.slope"),
        compensation: None,
    }
}

/// The angles `a` as parameters, in the order of the structure's fields.
pub(crate) fn given_angles(scope: Scope<'_>) -> Angles<Recorded<'_>> {
    Angles {
        n_dot_l: scope.number("a.n_dot_l"),
        n_dot_v: scope.number("a.n_dot_v"),
        n_dot_h: scope.number("a.n_dot_h"),
        sin2_h: scope.number("a.sin2_h"),
        v_dot_h: scope.number("a.v_dot_h"),
        r_dot_v: scope.number("a.r_dot_v"),
    }
}

fn model_doc(shading: Shading) -> &'static str {
    match shading {
        Shading::Lambert => LAMBERT,
        Shading::Phong => PHONG,
        Shading::BlinnPhong => BLINN_PHONG,
        Shading::BlinnPhongClassic => BLINN_PHONG_CLASSIC,
        Shading::CookTorrance => COOK_TORRANCE,
        Shading::Ggx => METALLIC_ROUGHNESS,
        Shading::CookTorrancePrinted => COOK_TORRANCE_PRINTED,
        Shading::BlinnPhongPrinted => BLINN_PHONG_PRINTED,
        Shading::GgxPrinted => GGX_PRINTED,
    }
}

const FRESNEL: &str = "Schlick with Lazányi's correction for metals.
F = F_schlick(v·h) − a · v·h (1 − v·h)⁶, kept in [0, 1]
Source: Kutz, Hašan and Edmondson 2021 (F82-tint), as in the OpenPBR Surface specification.";

const ALPHA: &str = "α = roughness², at least 1e-3
Source: Burley 2012, §5.4, as in glTF 2.0, appendix B.";

const CAVITY: &str = "Masking of V-shaped grooves.
G = min(1, 2 n·h n·v / v·h, 2 n·h n·l / v·h)
Source: Cook and Torrance 1982, §4, after Torrance and Sparrow 1967; Guo and Wang 2025, eq. 8.";

const SMITH: &str = "Height-correlated Smith masking of GGX, as V = G / (4 n·l n·v).
V = 0.5 / (n·l √((n·v)²(1 − α²) + α²) + n·v √((n·l)²(1 − α²) + α²))
Source: Heitz 2014, eq. 99; the form of Lagarde and de Rousiers 2014, listing 2.";

const SCHLICK: &str = "Schlick's rational stand-in for Smith's masking of one direction.
g(x) = x / (k + (1 − k) x)
Source: Schlick 1994, eq. 19, with the k of Karis 2013.";

const K_FOR_LIGHTS: &str = "k = (roughness + 1)²/8
Source: Karis 2013, eq. 4.";

const BECKMANN: &str = "Beckmann's normal distribution, D(h), in sr⁻¹.
D(h) = exp(−tan²θ_h / m²) / (π m² cos⁴θ_h), that is exp(((n·h)² − 1)/(m² (n·h)²)) / (π m² (n·h)⁴)
Source: Cook and Torrance 1982, eq. 5 with today's 1/π; Walter et al. 2007, eq. 25.";

const GGX: &str = "Trowbridge–Reitz (GGX) normal distribution, D(h), in sr⁻¹.
D(h) = α² / (π ((n·h)² (α² − 1) + 1)²), computed as α² / (π ((n·h)² α² + sin²θ_h)²)
Source: Walter et al. 2007, eq. 33.";

const ANGLES: &str = "The cosines of unit vectors `n`, `v` (to the viewer) and `l` (to the light).
For v = −l, h has no direction; n·h is then 0, so that no model shows a highlight, and v·h is 5e-7.";

const LAMBERT: &str = "Perfectly diffuse reflection.
f · n·l = ρ/π · n·l
Source: Lambert 1760.";

const PHONG: &str = "Phong's model, neither normalised nor reciprocal.
L = k_d n·l + k_s ((r·v)⁺)^s
Source: Phong 1975; Guo and Wang 2025, eq. 1, 3 and §1.2.";

const BLINN_PHONG: &str = "Blinn-Phong with energy normalisation.
f · n·l = (C_diff/π + (s + 8)/(8π) C_spec (n·h)^s) n·l
Source: Blinn 1977; normalisation of Akenine-Möller, Haines and Hoffman, Real-Time Rendering, 3rd ed., eq. 7.49.";

const BLINN_PHONG_CLASSIC: &str = "Blinn-Phong without normalisation, as fixed-function graphics had it.
L = C_diff n·l + C_spec (n·h)^s
Source: Blinn 1977; the article's first formula.";

const COOK_TORRANCE: &str = "Cook and Torrance's model in today's normalisation.
f · n·l = k_d/π · n·l + k_s D_beckmann G_v_cavity F / (4 n·v), the n·l of the denominator cancelled
Source: Cook and Torrance 1982, eq. 1–5, with 4 for their π";

const METALLIC_ROUGHNESS: &str = "Metallic-roughness reflection of glTF 2.0.
f · n·l = ((1 − F)(1 − metallic) ρ/π + D_ggx V_smith F) n·l
Source: glTF 2.0 specification, appendix B.3; Walter et al. 2007; Heitz 2014; Turquin 2019.";

const COOK_TORRANCE_PRINTED: &str = "Cook-Torrance as Guo and Wang 2025 print it; called for n·l > 0.
I = k_d n·l + k_s · F/π · D/(n·l) · G/(n·v) with F = f0 + (1 − f0)(1 − v·h)² and D = exp(…)/(m² (n·h)⁴)
Source: Guo and Wang 2025, eq. 1–8.";

const BLINN_PHONG_PRINTED: &str = "Blinn-Phong as the article's shader computes it; called for n·l > 0.
L = (C_diff/π + (m + 8)/(8π) C_spec (n·h)⁵) n·l
Source: the article's shader `Custom/BlinnPhong`.";

const GGX_PRINTED: &str = "GGX as the article's shader computes it, also where n·l ≤ 0.
L = k_d ρ/π + k_s V F D with n·l and n·v clamped at 0,
D = α²/(π((n·h)²(α² − 1) + 1)²), α = roughness; F = F0 + (1 − F0)(1 − (n·h)⁵);
V = g(n·l) g(n·v) / (4 (n·l/2 + 1/2) n·v), g(x) = x/(k + (1 − k)x), k = (roughness + 1)²/8;
k_d = F0, k_s = (1 − F0)(1 − metallic)
Source: the article's shader `Custom/BRDF`.";
