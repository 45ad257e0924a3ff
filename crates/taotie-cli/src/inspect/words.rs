//! Layers of materials and hints in words.

use taotie::inspection::{AnisotropyReport, ClearcoatReport, Hint, LayersReport};
use taotie_engine::names::Named;
use taotie_engine::scene::NormalSpace;
use taotie_engine::surface::{GreenVerdict, NormalMapKind};

/// Returns a suggestion, or `None` if this program has no option for it.
pub fn hint(hint: &Hint) -> Option<String> {
    Some(match hint {
        Hint::NoNormalMap { material } => {
            format!("the pixels of the normal map of '{material}' do not look like normals")
        }
        Hint::OtherSpace { material, drawn, by_pixels } => {
            let (drawn, kind) = (space(*drawn), space(*by_pixels));
            format!(
                "the pixels of the normal map of '{material}' look {kind}-space, but it is drawn as {drawn}-space; \
                 use --normal-map FILE --normal-space {kind}"
            )
        }
        Hint::OtherGreen { material, drawn, by_pixels } => {
            let (drawn, found) = (drawn.name(), by_pixels.name());
            format!(
                "the pixels of the normal map of '{material}' look green-{found}, but it is drawn green-{drawn}; \
                 try --green {found}"
            )
        }
        Hint::FarFromMikkTSpace { mesh, mean_degrees } => format!(
            "the tangents of '{mesh}' are {mean_degrees:.1} degrees from MikkTSpace's on average; \
             if the map was baked for MikkTSpace, try --tangents mikktspace"
        ),
        _ => return None,
    })
}

/// The space of a normal map.
pub fn space(space: NormalSpace) -> &'static str {
    match space {
        NormalSpace::Tangent => "tangent",
        NormalSpace::Object => "object",
    }
}

/// The kind of a normal map.
pub fn kind(kind: NormalMapKind) -> &'static str {
    match kind {
        NormalMapKind::Tangent => "tangent-space",
        NormalMapKind::Object => "object-space",
        NormalMapKind::No => "not a normal map",
    }
}

/// The green direction that pixels indicate.
pub fn verdict(verdict: GreenVerdict) -> &'static str {
    match verdict {
        GreenVerdict::Up => "up",
        GreenVerdict::Down => "down",
        GreenVerdict::Unclear => "unclear",
    }
}

/// Returns the differences from a plain material.
pub fn layers(layers: &LayersReport) -> Vec<String> {
    let mut words = Vec::new();
    if layers.ior != 1.5 {
        words.push(format!("ior {}", layers.ior));
    }
    if layers.specular.factor != 1.0 {
        words.push(format!("specular factor {}", layers.specular.factor));
    }
    if layers.specular.color != [1.0; 3] {
        words.push(format!("specular colour {}", color(layers.specular.color)));
    }
    if let Some(ClearcoatReport { factor, roughness, normal_scale, .. }) = &layers.clearcoat {
        let normal = normal_scale.map(|scale| format!(" and normal map scale {scale}")).unwrap_or_default();
        words.push(format!("clearcoat {factor} with roughness {roughness}{normal}"));
    }
    if let Some(AnisotropyReport { strength, rotation_deg, .. }) = &layers.anisotropy {
        words.push(format!("anisotropy {strength} at {rotation_deg:.1}°"));
    }
    if let Some(sheen) = &layers.sheen {
        words.push(format!("sheen {} with roughness {}", color(sheen.color), sheen.roughness));
    }
    words
}

fn color(color: [f32; 3]) -> String {
    color.map(|v| v.to_string()).join(" ")
}
