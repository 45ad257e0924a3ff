//! Materials: glTF's core factors and textures, and the layers added by extensions: index of refraction, unlit, and
//! those of [`LAYERS`]. The factors of layers come from [`material_json::factors`].

use super::super::edit::short;
use super::super::material_json::{self, Emission, STRENGTH};
use super::Writer;
use serde_json::{Map, Value, json};
use taotie_engine::scene::{
    FactorValue, GreenChannel, LAYERS, Layer, Material, NormalMap, NormalSpace, TextureRef, TextureRole,
};

/// The members of a material's extensions, by name.
type Extensions = Map<String, Value>;

impl Writer<'_> {
    /// Returns the JSON of a material; content that glTF cannot express is noted.
    pub(super) fn material(&mut self, material: &Material) -> Value {
        self.note_unsaid(material);
        let mut json = json!({ "doubleSided": material.double_sided });
        if !material.name.is_empty() {
            json["name"] = material.name.as_str().into();
        }
        json["pbrMetallicRoughness"] = self.metallic_roughness(material);
        if let Some(map) = &material.occlusion_texture {
            json["occlusionTexture"] = self.slot(map);
            json["occlusionTexture"]["strength"] = short(material.occlusion_strength).into();
        }
        if let Some(map) = self.normal_map(material.normal.as_ref()) {
            json["normalTexture"] = map;
        }
        if let Some(map) = &material.emissive_texture {
            json["emissiveTexture"] = self.slot(map);
        }
        material_json::say_alpha(&mut json, material.alpha);
        let extensions = self.emission(&mut json, material.emissive);
        let extensions = self.layers(extensions, material);
        if !extensions.is_empty() {
            json["extensions"] = extensions.into();
        }
        json
    }

    fn note_unsaid(&mut self, material: &Material) {
        let authored = material.f0.is_some() || material.f82.is_some();
        self.note("materials with a reflectance (f0, f82) that glTF cannot express", usize::from(authored));
        let classic = material.classic != Default::default();
        self.note("materials with classic-model parameters that glTF cannot express", usize::from(classic));
        self.note("height maps, which glTF does not support", usize::from(material.height.is_some()));
    }

    fn metallic_roughness(&mut self, material: &Material) -> Value {
        let mut pbr = json!({
            "baseColorFactor": self.fractions("base colours", material.base_color),
            "metallicFactor": short(material.metallic),
            "roughnessFactor": short(material.roughness),
        });
        if let Some(map) = &material.base_color_texture {
            pbr["baseColorTexture"] = self.slot(map);
        }
        if let Some(map) = &material.metallic_roughness_texture {
            pbr["metallicRoughnessTexture"] = self.slot(map);
        }
        pbr
    }

    /// Returns colours as fractions; those above 1 are clamped and noted.
    fn fractions<const N: usize>(&mut self, what: &str, values: [f32; N]) -> Vec<f64> {
        self.note_above_one(what, &values);
        values.into_iter().map(|v| short(v.min(1.0))).collect()
    }

    /// Notes colours above 1.
    fn note_above_one(&mut self, what: &str, values: &[f32]) {
        let above = values.iter().any(|v| *v > 1.0);
        self.note(&format!("{what} above 1, which glTF clamps"), usize::from(above));
    }

    /// Writes the emission; above 1 it becomes a colour times a strength.
    fn emission(&mut self, json: &mut Value, emissive: [f32; 3]) -> Extensions {
        let emission = Emission::of(emissive);
        json["emissiveFactor"] = json!(emission.color);
        let mut extensions = Extensions::new();
        if let Some(strength) = emission.extension() {
            self.draft.uses(STRENGTH);
            extensions.insert(STRENGTH.into(), strength);
        }
        extensions
    }

    /// Adds the layers of a material beyond glTF's core factors.
    fn layers(&mut self, mut extensions: Extensions, material: &Material) -> Extensions {
        for (name, mut json) in material_json::factors(material) {
            self.draft.uses(name);
            if let Some(layer) = LAYERS.iter().find(|layer| layer.extension == name) {
                self.layer(layer, material, &mut json);
            }
            extensions.insert(name.into(), json);
        }
        extensions
    }

    /// Adds a layer's textures, and notes factors that glTF clamps.
    fn layer(&mut self, layer: &Layer, material: &Material, json: &mut Value) {
        for factor in layer.factors {
            if let (Some(FactorValue::Color(color)), 1.0) = ((factor.get)(material), factor.most) {
                self.note_above_one(&format!("{}s", factor.name), &color);
            }
        }
        for role in layer.textures {
            let slot = match role {
                TextureRole::ClearcoatNormal => {
                    let coat = material.clearcoat.as_ref();
                    self.normal_map(coat.and_then(|coat| coat.normal.as_ref()))
                }
                _ => role.of(material).map(|texture| self.slot(texture)),
            };
            if let Some(slot) = slot {
                json[role.gltf_member()] = slot;
            }
        }
    }

    /// Returns the JSON of a tangent-space normal map; `None` with a warning for an object-space one.
    fn normal_map(&mut self, map: Option<&NormalMap>) -> Option<Value> {
        let map = map?;
        if map.space == NormalSpace::Object {
            self.note("object-space normal maps, which glTF does not support", 1);
            return None;
        }
        let turned = map.green == GreenChannel::Down;
        let mut json = self.textured(&map.texture, turned);
        json["scale"] = short(map.scale).into();
        Some(json)
    }

    /// Returns the JSON that refers to a texture.
    fn slot(&mut self, used: &TextureRef) -> Value {
        self.textured(used, false)
    }
}
