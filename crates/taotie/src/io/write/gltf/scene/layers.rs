//! Material layers by extensions: index of refraction, specular strength, clearcoat, anisotropy, sheen, no light.

use super::super::material::short;
use super::materials::Extensions;
use super::writer::Writer;
use crate::scene::{Anisotropy, Clearcoat, Material, Sheen, Specular, TextureRef};
use serde_json::{Value, json};

/// The index of refraction of materials that name none.
const IOR: f32 = 1.5;

impl Writer<'_> {
    /// Adds the layers of a material beyond glTF's own factors.
    pub(super) fn layers(&mut self, mut extensions: Extensions, material: &Material) -> Extensions {
        let mut layers: Vec<(&'static str, Value)> = Vec::new();
        if material.unlit {
            layers.push(("KHR_materials_unlit", json!({})));
        }
        if material.ior != IOR {
            layers.push(("KHR_materials_ior", json!({ "ior": short(material.ior) })));
        }
        if material.specular != Specular::default() {
            layers.push(("KHR_materials_specular", self.specular(&material.specular)));
        }
        if let Some(coat) = &material.clearcoat {
            layers.push(("KHR_materials_clearcoat", self.clearcoat(coat)));
        }
        if let Some(anisotropy) = &material.anisotropy {
            layers.push(("KHR_materials_anisotropy", self.anisotropy(anisotropy)));
        }
        if let Some(sheen) = &material.sheen {
            layers.push(("KHR_materials_sheen", self.sheen(sheen)));
        }
        for (name, json) in layers {
            self.draft.uses(name);
            extensions.insert(name.into(), json);
        }
        extensions
    }

    fn specular(&mut self, specular: &Specular) -> Value {
        let json = json!({
            "specularFactor": short(specular.factor),
            "specularColorFactor": specular.color.map(short),
        });
        let maps =
            [("specularTexture", specular.factor_texture), ("specularColorTexture", specular.color_texture)];
        self.with_maps(json, maps)
    }

    fn clearcoat(&mut self, coat: &Clearcoat) -> Value {
        let json = json!({
            "clearcoatFactor": short(coat.factor),
            "clearcoatRoughnessFactor": short(coat.roughness),
        });
        let maps = [
            ("clearcoatTexture", coat.factor_texture),
            ("clearcoatRoughnessTexture", coat.roughness_texture),
        ];
        let mut json = self.with_maps(json, maps);
        if let Some(map) = self.normal_map(coat.normal.as_ref()) {
            json["clearcoatNormalTexture"] = map;
        }
        json
    }

    fn anisotropy(&mut self, anisotropy: &Anisotropy) -> Value {
        let json = json!({
            "anisotropyStrength": short(anisotropy.strength),
            "anisotropyRotation": anisotropy.rotation,
        });
        self.with_maps(json, [("anisotropyTexture", anisotropy.texture)])
    }

    fn sheen(&mut self, sheen: &Sheen) -> Value {
        let json = json!({
            "sheenColorFactor": self.fractions("colours of sheen", sheen.color),
            "sheenRoughnessFactor": short(sheen.roughness),
        });
        let maps =
            [("sheenColorTexture", sheen.color_texture), ("sheenRoughnessTexture", sheen.roughness_texture)];
        self.with_maps(json, maps)
    }

    fn with_maps<const N: usize>(
        &mut self,
        mut json: Value,
        maps: [(&'static str, Option<TextureRef>); N],
    ) -> Value {
        for (name, map) in maps {
            if let Some(map) = map {
                json[name] = self.slot(&map);
            }
        }
        json
    }
}
