//! The direction of green in a scan's normal maps: set by its file, its pixels, or the caller.

use super::scan_options::ScanOptions;
use crate::error::Warnings;
use crate::inspection::Pixels;
use crate::scene::{GreenChannel, NormalMap, NormalSpace, SceneData};
use crate::surface::GreenVerdict;
use std::collections::BTreeMap;

/// Sets the direction of green of all tangent-space normal maps that the scan uses. Without a choice by the caller,
/// maps whose pixels show that green points down are read as such, and noted.
pub(super) fn set(parts: &mut SceneData, options: &ScanOptions, warnings: &mut Warnings) {
    let mut is_used = vec![false; parts.materials.len()];
    parts.instances.iter().for_each(|instance| is_used[instance.material] = true);
    let mut down: BTreeMap<usize, Option<f32>> = BTreeMap::new();
    let mut has_maps = false;
    let textures = &parts.textures;
    for (material, _) in parts.materials.iter_mut().zip(is_used).filter(|(_, is_used)| *is_used) {
        let is_tangent = |map: &&mut NormalMap| map.space == NormalSpace::Tangent;
        let Some(map) = material.normal.as_mut().filter(is_tangent) else { continue };
        has_maps = true;
        if let Some(green) = options.green {
            map.green = green;
            continue;
        }
        if map.green == GreenChannel::Down {
            continue;
        }
        let texture = map.texture.texture;
        let confidence = *down.entry(texture).or_insert_with(|| {
            let pixels = Pixels::of(textures[texture].bitmap());
            let is_down = pixels.green_by_pixels == Some(GreenVerdict::Down);
            pixels.green_confidence.filter(|_| is_down)
        });
        if let Some(confidence) = confidence {
            map.green = GreenChannel::Down;
            let name = if material.name.is_empty() { "a material without a name" } else { &material.name };
            let text = format!(
                "normal map of the scan with green pointing down (DirectX), {}; read as such: {name}; set the direction of \
                 green to up if it bakes inverted relief",
                surely(confidence)
            );
            warnings.note(text, 1);
        }
    }
    if options.green.is_some() && !has_maps {
        warnings.note("the direction of green has no effect: the scan has no tangent-space normal map", 1);
    }
}

/// Returns a confidence in words; it is never certain.
fn surely(confidence: f32) -> String {
    format!("{:.1} % sure from its pixels", (100.0 * f64::from(confidence)).min(99.9))
}
