//! Materials: their description, with notes on what glTF cannot express.

use super::super::material_json::{self, CORE_TEXTURES, MaterialParts, TextureInfo};
use super::Writer;
use serde_json::Value;
use taotie_engine::scene::{FactorValue, GreenChannel, LAYERS, Layer, Material, NormalSpace, TextureRole};

impl Writer<'_> {
    /// Returns the JSON of a material; content that glTF cannot express is noted.
    pub(super) fn material(&mut self, material: &Material) -> Value {
        self.note_unsaid(material);
        self.note_above_one("base colours", &material.base_color);
        let parts = MaterialParts {
            name: &material.name,
            double_sided: Some(material.double_sided),
            base_color: Some(material.base_color),
            metallic: Some(material.metallic),
            roughness: Some(material.roughness),
            emissive: Some(material.emissive),
            alpha: Some(material.alpha),
            layers: material_json::layers(material),
            textures: self.texture_uses(material),
        };
        parts.into_json(&mut self.draft)
    }

    fn note_unsaid(&mut self, material: &Material) {
        let authored = material.f0.is_some() || material.f82.is_some();
        self.note("materials with a reflectance (f0, f82) that glTF cannot express", usize::from(authored));
        let classic = material.classic != Default::default();
        self.note("materials with classic-model parameters that glTF cannot express", usize::from(classic));
        self.note("height maps, which glTF does not support", usize::from(material.height.is_some()));
    }

    /// Notes colours above 1.
    fn note_above_one(&mut self, what: &str, values: &[f32]) {
        let above = values.iter().any(|v| *v > 1.0);
        self.note(&format!("{what} above 1, which glTF clamps"), usize::from(above));
    }

    /// Notes factors of a layer that glTF clamps.
    fn note_clamped(&mut self, layer: &Layer, material: &Material) {
        for factor in layer.factors {
            if let (Some(FactorValue::Color(color)), 1.0) = ((factor.get)(material), factor.most) {
                self.note_above_one(&format!("{}s", factor.name), &color);
            }
        }
    }

    /// Describes all textures of a material that glTF can express.
    fn texture_uses(&mut self, material: &Material) -> Vec<TextureInfo> {
        let mut uses: Vec<TextureInfo> =
            CORE_TEXTURES.iter().filter_map(|role| self.texture_use(*role, material)).collect();
        for layer in &LAYERS {
            self.note_clamped(layer, material);
            uses.extend(layer.textures.iter().filter_map(|role| self.texture_use(*role, material)));
        }
        uses
    }

    /// Describes a texture; `None` if the material has none in this role, or with a warning if it is an object-space
    /// normal map.
    fn texture_use(&mut self, role: TextureRole, material: &Material) -> Option<TextureInfo> {
        let used = role.of(material)?;
        let map = match role {
            TextureRole::Normal => material.normal.as_ref(),
            TextureRole::ClearcoatNormal => material.clearcoat.as_ref()?.normal.as_ref(),
            _ => None,
        };
        if map.is_some_and(|map| map.space == NormalSpace::Object) {
            self.note("object-space normal maps, which glTF does not support", 1);
            return None;
        }
        let texture = self.texture(used, map.is_some_and(|map| map.green == GreenChannel::Down));
        let weight = map.map_or(material.occlusion_strength, |map| map.scale);
        let info = TextureInfo { role, texture, uv_set: used.uv_set, transform: used.transform, weight };
        self.note("sheared texture uvs, which glTF does not support", usize::from(info.is_sheared()));
        Some(info)
    }
}
