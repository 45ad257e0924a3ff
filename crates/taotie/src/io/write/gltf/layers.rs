//! The parts of a material that glTF's core leaves to extensions, without their textures: layers, emission beyond 1;
//! and the alpha mode. Shared by scenes and assets.

use super::number::short;
use crate::scene::{AlphaMode, Factor, FactorValue, LAYERS, Layer, Material};
use serde_json::{Map, Value, json};

/// The extension of emission beyond 1.
pub(super) const STRENGTH: &str = "KHR_materials_emissive_strength";

/// The default index of refraction of materials.
const IOR: f32 = 1.5;

/// Returns the factors of each layer that a material has, by the name of the layer's extension.
pub(super) fn factors(material: &Material) -> Vec<(&'static str, Value)> {
    let unlit = material.unlit.then(|| ("KHR_materials_unlit", json!({})));
    let ior = (material.ior != IOR).then(|| ("KHR_materials_ior", json!({ "ior": short(material.ior) })));
    let layers = LAYERS.iter().filter(|layer| (layer.is_present)(material));
    let layers = layers.map(|layer| (layer.extension, layer_factors(layer, material)));
    unlit.into_iter().chain(ior).chain(layers).collect()
}

fn layer_factors(layer: &Layer, material: &Material) -> Value {
    let member =
        |factor: &Factor| Some((factor.member.to_owned(), written((factor.get)(material)?, factor.most)));
    layer.factors.iter().filter_map(member).collect::<Map<_, _>>().into()
}

/// Returns the JSON of a factor; glTF clamps values above `most`.
fn written(value: FactorValue, most: f32) -> Value {
    match value {
        FactorValue::Number(number) => short(number.min(most)).into(),
        FactorValue::Color(color) => json!(color.map(|v| short(v.min(most)))),
        FactorValue::Angle(angle) => angle.into(),
    }
}

/// An emission in glTF form: a colour, and its multiplier if the emission exceeds 1.
pub(super) struct Emission {
    pub color: [f64; 3],
    pub strength: Option<f64>,
}

impl Emission {
    /// Splits a radiance, linear RGB.
    pub fn of(radiance: [f32; 3]) -> Self {
        let most = radiance.into_iter().fold(1.0, f32::max);
        Self { color: radiance.map(|v| short(v / most)), strength: (most > 1.0).then(|| short(most)) }
    }

    /// Returns the value of the emissive-strength extension.
    pub fn extension(&self) -> Option<Value> {
        Some(json!({ "emissiveStrength": self.strength? }))
    }
}

/// Writes the alpha mode into a material.
pub(super) fn say_alpha(json: &mut Value, alpha: AlphaMode) {
    match alpha {
        AlphaMode::Opaque => {}
        AlphaMode::Blend => json["alphaMode"] = "BLEND".into(),
        AlphaMode::Mask(cutoff) => {
            json["alphaMode"] = "MASK".into();
            json["alphaCutoff"] = short(cutoff).into();
        }
    }
}
