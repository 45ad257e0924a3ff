//! The structures that shaders pass on, as `taotie::shade` has them.

use crate::graph::Parameter;
use crate::library::{given_angles, material};
use crate::recorder::record;

/// A structure: the argument that is one, its type, and what it is.
pub(crate) struct Structure {
    pub(crate) argument: &'static str,
    pub(crate) name: &'static str,
    pub(crate) doc: &'static str,
}

/// All structures.
pub(crate) const STRUCTURES: [Structure; 2] = [
    Structure {
        argument: "s",
        name: "MaterialSample",
        doc: "A material sample: the parameters of a surface at a point.",
    },
    Structure { argument: "a", name: "Angles", doc: "The cosines that reflectance depends on." },
];

impl Structure {
    /// The fields, as parameters of a formula that takes the structure.
    pub(crate) fn fields(&self) -> Vec<Parameter> {
        let graph = record(|scope| {
            if self.argument == "s" {
                material(scope);
            } else {
                given_angles(scope);
            }
            Vec::new()
        });
        graph.parameters().to_vec()
    }
}

/// The name of a field in a path, `roughness` of `s.roughness`.
pub(crate) fn field_name(path: &'static str) -> &'static str {
    path.split_once('.').map_or(path, |(_, field)| field)
}

/// What a field holds, with range and unit.
pub(crate) fn field_doc(path: &str) -> &'static str {
    match path {
        "s.base_color" => "ρ, linear RGB in [0, 1]; diffuse colour of `lambert`, `ggx` and `ggx-printed`.",
        "s.metallic" => "[0, 1]; 1 has no diffuse part in `ggx`.",
        "s.roughness" => "The roughness as artists set it, [0, 1]; α is its square",
        "s.f0" => {
            "Reflectance at normal incidence, linear RGB in [0, 1], the mix by `metallic` already done."
        }
        "s.f90" => "Reflectance at grazing incidence, [0, 1]; 1 but for dielectrics made weaker.",
        "s.f82_drop" => "Lazányi coefficient of the reflectance at 82°",
        "s.diffuse" => "k_d or C_diff of the classic models and of Cook-Torrance, linear RGB in [0, 1].",
        "s.specular" => "k_s or C_spec of the classic models and of Cook-Torrance, linear RGB in [0, 1].",
        "s.shininess" => "Exponent of Phong and Blinn-Phong, at least 0.",
        "s.slope" => "Beckmann's rms slope m of Cook-Torrance, above 0.",
        "a.n_dot_l" => "n·l, [−1, 1]; models are dark where it is not above 0.",
        "a.n_dot_v" => "n·v, clamped to [1e-4, 1].",
        "a.n_dot_h" => "n·h, [0, 1].",
        "a.sin2_h" => "sin² of the angle between n and h, [0, 1], from |n × h|²",
        "a.v_dot_h" => "v·h = l·h, [5e-7, 1].",
        "a.r_dot_v" => "r·v, [−1, 1].",
        _ => "",
    }
}
