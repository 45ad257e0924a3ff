//! The structures passed between shader functions, as in `taotie_engine::shade`.

use crate::graph::{Kind, Parameter};
use crate::inputs;
use crate::recorder::{Scope, record};

/// A structure: its type name, its documentation, the arguments of this type, and its fields.
#[derive(Debug, Clone)]
pub(crate) struct Structure {
    pub(crate) name: &'static str,
    pub(crate) doc: &'static str,
    pub(crate) arguments: &'static [&'static str],
    pub(crate) fields: Vec<Field>,
}

/// A field of a structure: its name, its type, and its meaning with range and unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Field {
    pub(crate) name: &'static str,
    pub(crate) kind: Kind,
    pub(crate) doc: &'static str,
}

impl Structure {
    /// The types of the fields.
    pub(crate) fn layout(&self) -> Vec<Kind> {
        self.fields.iter().map(|field| field.kind).collect()
    }
}

/// The structures of reflectance.
pub(crate) fn structures() -> Vec<Structure> {
    vec![
        structure("MaterialSample", SAMPLE, &["s"], |scope| _ = inputs::material(scope)),
        structure("Angles", ANGLES, &["a"], |scope| _ = inputs::angles(scope)),
        structure("Compensation", COMPENSATION, &["c"], |scope| _ = inputs::compensation(scope)),
        structure("Dfg", DFG, &["dfg", "coat_dfg"], |scope| _ = inputs::dfg(scope)),
        structure("EnvironmentWeights", WEIGHTS, &["w"], |scope| _ = inputs::weights(scope)),
    ]
}

const SAMPLE: &str = "A material sample: the parameters of a surface at a point.";
const ANGLES: &str = "The cosines that reflectance depends on.";
const COMPENSATION: &str = "The compensation that makes a microfacet model conserve energy, at one n·v.";
const DFG: &str = "The directional albedo of a lobe, for each term of its Fresnel factor: F0 `scale` + F90 `bias` − drop `edge`.";
const WEIGHTS: &str = "The reflection of light from all directions, as weights of two radiances, linear RGB.";

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
pub(crate) fn field_name(path: &'static str) -> &'static str {
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
