//! The reflectance models as functions of a material sample and of angles, and the structures of reflectance.

use crate::graph::Parameter;
use crate::program::{Field, Formula, Structure, part};
use crate::recorder::{Recorded, Scope, record};
use taotie_engine::math::Vec3;
use taotie_engine::names::Named;
use taotie_engine::shade::dfg::Dfg;
use taotie_engine::shade::{
    self, Angles, Compensation, EnvironmentWeights, MaterialSample, Shading, reflect,
};

/// The name of the function that computes a model: `reflect_cook_torrance`.
pub fn model_name(shading: Shading) -> String {
    format!("reflect_{}", shading.name().replace('-', "_"))
}

pub(crate) fn angles() -> Formula {
    let graph = record(|scope| {
        let a = Angles::new(scope.vector("n"), scope.vector("v"), scope.vector("l"));
        vec![a.n_dot_l, a.n_dot_v, a.n_dot_h, a.sin2_h, a.v_dot_h, a.r_dot_v]
    });
    Formula { structure: Some("Angles"), ..part("angles", "a", ANGLES, graph) }
}

/// A model that follows light to its first facet.
pub(crate) fn model(shading: Shading) -> Formula {
    let graph = record(|scope| {
        let (s, a) = (material_parameters(scope), angle_parameters(scope));
        reflect(shading, &s, &a).to_array().to_vec()
    });
    part(&model_name(shading), "radiance", model_doc(shading), graph)
}

/// A microfacet model with energy compensation.
pub(crate) fn compensated(shading: Shading) -> Formula {
    let graph = record(|scope| {
        let (s, a) = (material_parameters(scope), angle_parameters(scope));
        let s = MaterialSample { compensation: Some(compensation_parameters(scope)), ..s };
        reflect(shading, &s, &a).to_array().to_vec()
    });
    part(&format!("{}_compensated", model_name(shading)), "radiance", model_doc(shading), graph)
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

const BLINN_PHONG_CLASSIC: &str = "Blinn-Phong without normalisation, as in fixed-function graphics.
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

const GGX_PRINTED: &str = "GGX as the article's shader computes it, also for n·l ≤ 0.
L = k_d ρ/π + k_s V F D with n·l and n·v clamped at 0,
D = α²/(π((n·h)²(α² − 1) + 1)²), α = roughness; F = F0 + (1 − F0)(1 − (n·h)⁵);
V = g(n·l) g(n·v) / (4 (n·l/2 + 1/2) n·v), g(x) = x/(k + (1 − k)x), k = (roughness + 1)²/8;
k_d = F0, k_s = (1 − F0)(1 − metallic)
Source: the article's shader `Custom/BRDF`.";

/// The energy compensation of a lobe, given its directional albedos.
pub(crate) fn compensation() -> Formula {
    let graph = record(|scope| {
        let (dfg, f0) = (dfg_parameters(scope), scope.vector("f0"));
        let c = shade::compensation(&dfg, f0, scope.number("f90"), scope.vector("f82_drop"));
        [numbers([c.gain]), vec![c.transmitted]].concat()
    });
    Formula { structure: Some("Compensation"), ..part("compensation", "c", COMPENSATION, graph) }
}

/// The environment weights of a model that follows light to its first facet.
pub(crate) fn environment_weights(shading: Shading) -> Formula {
    let graph = record(|scope| {
        let weights =
            shade::environment_weights(shading, &material_parameters(scope), &dfg_parameters(scope));
        numbers([weights.specular, weights.diffuse])
    });
    let name = format!("environment_weights_{}", shading.name().replace('-', "_"));
    Formula { structure: Some("EnvironmentWeights"), ..part(&name, "weights", WEIGHTS, graph) }
}

const COMPENSATION: &str =
    "The compensation of a lobe whose directional albedos are `dfg`, for Schlick's Fresnel factor between `f0` and `f90`
Source: Turquin 2019, \"Practical multiple scattering compensation for microfacet models\", eq. 16";

const WEIGHTS: &str = "The weights for a material sample with the directional albedos `dfg` of its lobe.
Source: Karis 2013; the article's environment term.";

/// The structures of reflectance.
pub(crate) fn structures() -> Vec<Structure> {
    vec![
        structure("MaterialSample", SAMPLE_STRUCTURE, &["s"], |scope| _ = material_parameters(scope)),
        structure("Angles", ANGLES_STRUCTURE, &["a"], |scope| _ = angle_parameters(scope)),
        structure("Compensation", COMPENSATION_STRUCTURE, &["c"], |scope| _ = compensation_parameters(scope)),
        structure("Dfg", DFG_STRUCTURE, &["dfg", "coat_dfg"], |scope| _ = dfg_parameters(scope)),
        structure("EnvironmentWeights", WEIGHTS_STRUCTURE, &["w"], |scope| _ = weight_parameters(scope)),
    ]
}

const SAMPLE_STRUCTURE: &str = "A material sample: the parameters of a surface at a point.";
const ANGLES_STRUCTURE: &str = "The cosines that reflectance depends on.";
const COMPENSATION_STRUCTURE: &str =
    "The compensation that makes a microfacet model conserve energy, at one n·v.";
const DFG_STRUCTURE: &str = "The directional albedo of a lobe, for each term of its Fresnel factor: F0 `scale` + F90 `bias` − drop `edge`.";
const WEIGHTS_STRUCTURE: &str =
    "The reflection of light from all directions, as weights of two radiances, linear RGB.";

/// A structure with the parameters that `declare` declares as fields.
fn structure(
    name: &'static str,
    doc: &'static str,
    arguments: &'static [&'static str],
    declare: fn(Scope<'_>),
) -> Structure {
    let graph = record(|scope| {
        declare(scope);
        Vec::new()
    });
    let field = |parameter: &Parameter| Field {
        name: field_name(parameter.path),
        kind: parameter.kind,
        doc: field_doc(parameter.path),
    };
    Structure { name, doc, arguments, fields: graph.parameters().iter().map(field).collect() }
}

/// The name of a field in a path, `roughness` of `s.roughness`.
fn field_name(path: &'static str) -> &'static str {
    path.split_once('.').map_or(path, |(_, field)| field)
}

/// The meaning of a field, with range and unit.
fn field_doc(path: &str) -> &'static str {
    match path {
        "s.base_color" => "ρ, linear RGB in [0, 1]; diffuse colour of `lambert`, `ggx` and `ggx-printed`.",
        "s.metallic" => "[0, 1]; 1 has no diffuse part in `ggx`.",
        "s.roughness" => "Perceptual roughness, [0, 1]; α is its square",
        "s.f0" => "Reflectance at normal incidence, linear RGB in [0, 1], already mixed by `metallic`.",
        "s.f90" => "Reflectance at grazing incidence, [0, 1]; 1 except for weakened dielectrics.",
        "s.f82_drop" => "Lazányi coefficient of the reflectance at 82°",
        "s.diffuse" => "k_d or C_diff of the classic models and of Cook-Torrance, linear RGB in [0, 1].",
        "s.specular" => "k_s or C_spec of the classic models and of Cook-Torrance, linear RGB in [0, 1].",
        "s.shininess" => "Exponent of Phong and Blinn-Phong, at least 0.",
        "s.slope" => "Beckmann's rms slope m of Cook-Torrance, above 0.",
        "a.n_dot_l" => "n·l, [−1, 1]; models are black unless it is above 0.",
        "a.n_dot_v" => "n·v, clamped to [1e-4, 1].",
        "a.n_dot_h" => "n·h, [0, 1].",
        "a.sin2_h" => "sin² of the angle between n and h, [0, 1], from |n × h|²",
        "a.v_dot_h" => "v·h = l·h, [5e-7, 1].",
        "a.r_dot_v" => "r·v, [−1, 1].",
        "c.gain" => "Multiplies the highlight, linear RGB, at least 1.",
        "c.transmitted" => {
            "The fraction of light that the highlight leaves for the diffuse reflection below, [0, 1]."
        }
        "dfg.scale" => "∫ D V (1 − (1 − v·h)⁵) n·l dl, [0, 1].",
        "dfg.bias" => "∫ D V (1 − v·h)⁵ n·l dl, [0, 1].",
        "dfg.edge" => "∫ D V v·h (1 − v·h)⁶ n·l dl, [0, 0.06].",
        "dfg.diffuse_edge" => {
            "∫ (1 − v·h)⁵ n·l / π dl, [0, 1]: Schlick's rise averaged over a diffuse reflection."
        }
        "w.specular" => "The weight of the radiance gathered by the highlight.",
        "w.diffuse" => {
            "The weight of the mean radiance over the hemisphere, which is the irradiance divided by π."
        }
        _ => "",
    }
}

/// The material sample `s`, without energy compensation.
fn material_parameters(scope: Scope<'_>) -> MaterialSample<Recorded<'_>> {
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

/// The angles `a`.
pub(crate) fn angle_parameters(scope: Scope<'_>) -> Angles<Recorded<'_>> {
    Angles {
        n_dot_l: scope.number("a.n_dot_l"),
        n_dot_v: scope.number("a.n_dot_v"),
        n_dot_h: scope.number("a.n_dot_h"),
        sin2_h: scope.number("a.sin2_h"),
        v_dot_h: scope.number("a.v_dot_h"),
        r_dot_v: scope.number("a.r_dot_v"),
    }
}

/// The energy compensation `c`.
fn compensation_parameters(scope: Scope<'_>) -> Compensation<Recorded<'_>> {
    Compensation { gain: scope.vector("c.gain"), transmitted: scope.number("c.transmitted") }
}

/// The directional albedos `dfg`.
fn dfg_parameters(scope: Scope<'_>) -> Dfg<Recorded<'_>> {
    Dfg {
        scale: scope.number("dfg.scale"),
        bias: scope.number("dfg.bias"),
        edge: scope.number("dfg.edge"),
        diffuse_edge: scope.number("dfg.diffuse_edge"),
    }
}

/// The environment weights `w`, which formulas return.
fn weight_parameters(scope: Scope<'_>) -> EnvironmentWeights<Recorded<'_>> {
    EnvironmentWeights { specular: scope.vector("w.specular"), diffuse: scope.vector("w.diffuse") }
}

/// The scalars of these vectors, one after the other.
fn numbers<'g, const N: usize>(vectors: [Vec3<Recorded<'g>>; N]) -> Vec<Recorded<'g>> {
    vectors.iter().flat_map(|vector| vector.to_array()).collect()
}
