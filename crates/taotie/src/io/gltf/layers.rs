//! Material layers from extensions: index of refraction, specular strength, clearcoat, anisotropy and sheen.
//!
//! A layer whose factor disables it is omitted, together with its textures. The JSON of extensions that the parser
//! does not know is read member by member: an invalid member keeps its default, with a warning.

use super::materials::MaterialReader;
use crate::image::Encoding;
use crate::scene::{Factor, FactorValue, LAYERS, Layer, Material, NormalMap, TextureRef, TextureRole};
use gltf::json::{Value, deserialize, material};

impl MaterialReader<'_, '_> {
    /// Fills in the values of the extensions.
    pub fn read_layers(&mut self, material: &mut Material) {
        let Some(extensions) = &self.json.extensions else { return };
        if let Some(ior) = &extensions.ior {
            material.ior = self.index_of_refraction(ior.ior.0);
        }
        for layer in &LAYERS {
            if let Some(json) = extensions.others.get(layer.extension) {
                self.layer(layer, json, material);
            }
        }
    }

    /// Reads a layer: its factors, and, if these do not disable it, its textures.
    fn layer(&mut self, layer: &Layer, json: &Value, material: &mut Material) {
        if !json.is_object() {
            self.note(format!("malformed {}; ignored", layer.extension));
            return;
        }
        (layer.add)(material);
        for factor in layer.factors {
            if let Some(default) = (factor.get)(material) {
                let value = self.factor(factor, default, json);
                (factor.set)(material, value);
            }
            // The first factor may disable the layer; the others have no effect then.
            if !(layer.is_visible)(material) {
                (layer.remove)(material);
                return;
            }
        }
        for role in layer.textures {
            self.layer_texture(*role, json, material);
        }
    }

    fn layer_texture(&mut self, role: TextureRole, json: &Value, material: &mut Material) {
        if role == TextureRole::ClearcoatNormal {
            let normal = self.normal_slot(json, role.gltf_member());
            if let Some(coat) = &mut material.clearcoat {
                coat.normal = normal;
            }
        } else if let Some(place) = role.place(material) {
            *place = self.slot(json, role.gltf_member(), role.encoding());
        }
    }

    /// Reads a factor, clamped to its range.
    fn factor(&mut self, factor: &Factor, default: FactorValue, json: &Value) -> FactorValue {
        let Factor { member: name, most, .. } = *factor;
        match default {
            FactorValue::Number(default) => {
                let value = self.member(json, name, as_number).unwrap_or(default);
                FactorValue::Number(self.clamped(name, value, most))
            }
            FactorValue::Color(default) => {
                let color = self.member(json, name, as_color).unwrap_or(default);
                FactorValue::Color(color.map(|v| self.clamped(name, v, most)))
            }
            FactorValue::Angle(default) => {
                FactorValue::Angle(self.member(json, name, as_angle).unwrap_or(default))
            }
        }
    }

    /// Returns the index of refraction. Source: KHR_materials_ior, where 0 means a reflectance of 1.
    fn index_of_refraction(&mut self, ior: f32) -> f32 {
        if ior == 0.0 || (1.0..=f32::MAX).contains(&ior) {
            return ior;
        }
        self.note(format!("ior {ior} is out of range; clamped"));
        if ior > 1.0 { f32::MAX } else { 1.0 }
    }

    fn slot(&mut self, json: &Value, name: &str, encoding: Encoding) -> Option<TextureRef> {
        let info = self.member(json, name, |value| deserialize::from_value(value.clone()).ok())?;
        self.texture(Some(&info), encoding)
    }

    fn normal_slot(&mut self, json: &Value, name: &str) -> Option<NormalMap> {
        let read = |value: &Value| deserialize::from_value::<material::NormalTexture>(value.clone()).ok();
        let texture = self.member(json, name, read)?;
        self.normal_map(&texture)
    }

    /// Reads a member using `read`; returns `None` if it is absent, or malformed, which adds a warning.
    fn member<T>(&mut self, json: &Value, name: &str, read: impl FnOnce(&Value) -> Option<T>) -> Option<T> {
        let value = json.get(name).filter(|value| !value.is_null())?;
        let read = read(value);
        if read.is_none() {
            self.note(format!("malformed {name}; ignored"));
        }
        read
    }
}

fn as_number(value: &Value) -> Option<f32> {
    value.as_f64().map(|v| v as f32)
}

fn as_angle(value: &Value) -> Option<f64> {
    as_number(value).filter(|v| v.is_finite()).map(f64::from)
}

fn as_color(value: &Value) -> Option<[f32; 3]> {
    let numbers: Option<Vec<f32>> = value.as_array()?.iter().map(as_number).collect();
    numbers?.try_into().ok()
}
