//! Material layers as extensions: index of refraction, unlit, and those of [`LAYERS`]. Their factors come from
//! [`layers::factors`]; their textures are added here.

use super::super::layers;
use super::materials::Extensions;
use super::writer::Writer;
use crate::scene::{FactorValue, LAYERS, Layer, Material, TextureRole};
use serde_json::Value;

impl Writer<'_> {
    /// Adds the layers of a material beyond glTF's core factors.
    pub(super) fn layers(&mut self, mut extensions: Extensions, material: &Material) -> Extensions {
        for (name, mut json) in layers::factors(material) {
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
}
