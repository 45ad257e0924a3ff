//! The JSON of a material. Scenes and assets share the parts that glTF's core leaves to extensions, which are layers
//! and emission beyond 1, and the alpha mode.

use super::edit::{member, short};
use super::material::{GltfMaterial, Slot};
use super::textures::Encoded;
use serde_json::{Map, Value, json};
use taotie_engine::scene::{AlphaMode, Factor, FactorValue, LAYERS, Layer, Material};

/// The member with the core's factors.
pub(super) const PBR: &str = "pbrMetallicRoughness";

/// The extension of emission beyond 1.
pub(super) const STRENGTH: &str = "KHR_materials_emissive_strength";

/// The default index of refraction of materials.
const IOR: f32 = 1.5;

/// Returns the JSON of the material; texture `i` uses image `i`.
pub(super) fn json(material: &GltfMaterial, images: &[Encoded]) -> Value {
    let mut json = json!({
        "doubleSided": material.double_sided,
        PBR: {
            "baseColorFactor": material.base_color.map(short),
            "metallicFactor": short(material.metallic),
            "roughnessFactor": short(material.roughness),
        },
    });
    if !material.name.is_empty() {
        json["name"] = material.name.into();
    }
    for (texture, image) in images.iter().enumerate() {
        image.slots().iter().for_each(|slot| put_texture(&mut json, *slot, texture, material));
    }
    if material.emissive != [0.0; 3] {
        json["emissiveFactor"] = json!(Emission::of(material.emissive).color);
    }
    say_alpha(&mut json, material.alpha);
    for (name, extension) in extensions(material) {
        json["extensions"][name] = extension;
    }
    json
}

/// Puts a texture, given by index, into a slot of a material. It uses uv set 0, untransformed.
pub(super) fn put_texture(json: &mut Value, slot: Slot, texture: usize, material: &GltfMaterial) {
    let info = json!({ "index": texture });
    match slot {
        Slot::BaseColor => *member(member(json, PBR), "baseColorTexture") = info,
        Slot::MetallicRoughness => {
            *member(member(json, PBR), "metallicRoughnessTexture") = info;
        }
        Slot::Occlusion => {
            let strength = short(material.occlusion_strength);
            *member(json, "occlusionTexture") = json!({ "index": texture, "strength": strength });
        }
        Slot::Normal => {
            let scale = short(material.normal_scale);
            *member(json, "normalTexture") = json!({ "index": texture, "scale": scale });
        }
        Slot::Emissive => *member(json, "emissiveTexture") = info,
    }
}

/// Returns the material's extensions: emission beyond 1, and layers.
pub(super) fn extensions(material: &GltfMaterial) -> Vec<(&'static str, Value)> {
    let strength = Emission::of(material.emissive).extension().map(|json| (STRENGTH, json));
    strength.into_iter().chain(material.layers.into_iter().flat_map(factors)).collect()
}

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
