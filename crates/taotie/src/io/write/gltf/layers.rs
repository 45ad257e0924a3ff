//! The parts of a material that glTF's core leaves to extensions, without their textures: layers, emission beyond 1; and
//! the treatment of alpha. A scene and an asset write them alike.

use super::number::short;
use crate::scene::{AlphaMode, Anisotropy, Clearcoat, Material, Sheen, Specular};
use serde_json::{Value, json};

/// The extension of emission beyond 1.
pub(super) const STRENGTH: &str = "KHR_materials_emissive_strength";
pub(super) const SPECULAR: &str = "KHR_materials_specular";
pub(super) const CLEARCOAT: &str = "KHR_materials_clearcoat";
pub(super) const ANISOTROPY: &str = "KHR_materials_anisotropy";
pub(super) const SHEEN: &str = "KHR_materials_sheen";

/// The index of refraction of materials that name none.
const IOR: f32 = 1.5;

/// Returns the factors of each layer that a material has, by the name of the layer's extension.
pub(super) fn factors(material: &Material) -> Vec<(&'static str, Value)> {
    let layers = [
        ("KHR_materials_unlit", material.unlit.then(|| json!({}))),
        ("KHR_materials_ior", (material.ior != IOR).then(|| json!({ "ior": short(material.ior) }))),
        (SPECULAR, (material.specular != Specular::default()).then(|| specular(&material.specular))),
        (CLEARCOAT, material.clearcoat.as_ref().map(clearcoat)),
        (ANISOTROPY, material.anisotropy.as_ref().map(anisotropy)),
        (SHEEN, material.sheen.as_ref().map(sheen)),
    ];
    layers.into_iter().filter_map(|(name, json)| Some((name, json?))).collect()
}

fn specular(specular: &Specular) -> Value {
    json!({
        "specularFactor": short(specular.factor),
        "specularColorFactor": specular.color.map(short),
    })
}

fn clearcoat(coat: &Clearcoat) -> Value {
    json!({
        "clearcoatFactor": short(coat.factor),
        "clearcoatRoughnessFactor": short(coat.roughness),
    })
}

fn anisotropy(anisotropy: &Anisotropy) -> Value {
    json!({
        "anisotropyStrength": short(anisotropy.strength),
        "anisotropyRotation": anisotropy.rotation,
    })
}

/// Returns the factors of sheen, whose colours glTF clamps at 1.
fn sheen(sheen: &Sheen) -> Value {
    json!({
        "sheenColorFactor": sheen.color.map(|v| short(v.min(1.0))),
        "sheenRoughnessFactor": short(sheen.roughness),
    })
}

/// An emission as glTF says it: a colour, and what it is multiplied by where it is above 1.
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

    /// Returns the member of the strength's extension.
    pub fn extension(&self) -> Option<Value> {
        Some(json!({ "emissiveStrength": self.strength? }))
    }
}

/// Writes the treatment of alpha into a material.
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
