//! The models as functions of a material sample and of angles.

use crate::inputs;
use crate::program::{Formula, part};
use crate::recorder::record;
use taotie_engine::names::Named;
use taotie_engine::shade::{Angles, MaterialSample, Shading, reflect};

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
        let (s, a) = (inputs::material(scope), inputs::angles(scope));
        reflect(shading, &s, &a).to_array().to_vec()
    });
    part(&model_name(shading), "radiance", model_doc(shading), graph)
}

/// A microfacet model with energy compensation.
pub(crate) fn compensated(shading: Shading) -> Formula {
    let graph = record(|scope| {
        let (s, a) = (inputs::material(scope), inputs::angles(scope));
        let s = MaterialSample { compensation: Some(inputs::compensation(scope)), ..s };
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
