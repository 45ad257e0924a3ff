//! Material layers by extensions: index of refraction, specular strength, clearcoat, anisotropy and sheen.
//!
//! A layer whose factor switches it off is not there, so neither are its textures. The JSON of extensions that the
//! parser does not know is read member by member: one that is wrong is left at its default, with a warning.

use super::materials::MaterialReader;
use crate::image::Encoding;
use crate::scene::{Anisotropy, Clearcoat, Material, NormalMap, Sheen, Specular, TextureRef};
use gltf::json::{Value, deserialize, extensions, material};

impl MaterialReader<'_, '_> {
    /// Fills in the values of the extensions.
    pub fn read_layers(&mut self, material: &mut Material) {
        let Some(extensions) = &self.json.extensions else { return };
        if let Some(ior) = &extensions.ior {
            material.ior = self.index_of_refraction(ior.ior.0);
        }
        if let Some(specular) = &extensions.specular {
            material.specular = self.specular(specular);
        }
        let layer = |name: &str| extensions.others.get(name);
        material.clearcoat = layer("KHR_materials_clearcoat").and_then(|json| self.clearcoat(json));
        material.anisotropy = layer("KHR_materials_anisotropy").and_then(|json| self.anisotropy(json));
        material.sheen = layer("KHR_materials_sheen").and_then(|json| self.sheen(json));
    }

    /// Returns the index of refraction. Source: KHR_materials_ior, where 0 means a reflectance of 1.
    fn index_of_refraction(&mut self, ior: f32) -> f32 {
        if ior == 0.0 || (1.0..=f32::MAX).contains(&ior) {
            return ior;
        }
        self.note(format!("ior of {ior} is out of range and clamped"));
        if ior > 1.0 { f32::MAX } else { 1.0 }
    }

    /// Reads the specular layer. Source: KHR_materials_specular.
    fn specular(&mut self, json: &extensions::material::Specular) -> Specular {
        Specular {
            factor: self.fraction("specularFactor", json.specular_factor.0),
            factor_texture: self.texture(json.specular_texture.as_ref(), Encoding::Linear),
            color: json.specular_color_factor.0.map(|v| self.positive("specularColorFactor", v)),
            color_texture: self.texture(json.specular_color_texture.as_ref(), Encoding::Srgb),
        }
    }

    /// Reads the clearcoat. Source: KHR_materials_clearcoat.
    fn clearcoat(&mut self, json: &Value) -> Option<Clearcoat> {
        let factor = self.unit(json, "clearcoatFactor");
        (factor > 0.0).then(|| Clearcoat {
            factor,
            factor_texture: self.slot(json, "clearcoatTexture", Encoding::Linear),
            roughness: self.unit(json, "clearcoatRoughnessFactor"),
            roughness_texture: self.slot(json, "clearcoatRoughnessTexture", Encoding::Linear),
            normal: self.normal_slot(json, "clearcoatNormalTexture"),
        })
    }

    /// Reads the anisotropy. Source: KHR_materials_anisotropy.
    fn anisotropy(&mut self, json: &Value) -> Option<Anisotropy> {
        let strength = self.unit(json, "anisotropyStrength");
        (strength > 0.0).then(|| Anisotropy {
            strength,
            rotation: self.member(json, "anisotropyRotation", as_number).map_or(0.0, f64::from),
            texture: self.slot(json, "anisotropyTexture", Encoding::Linear),
        })
    }

    /// Reads the sheen. Source: KHR_materials_sheen.
    fn sheen(&mut self, json: &Value) -> Option<Sheen> {
        let color = self.member(json, "sheenColorFactor", as_color).unwrap_or([0.0; 3]);
        let color = color.map(|v| self.fraction("sheenColorFactor", v));
        (color != [0.0; 3]).then(|| Sheen {
            color,
            color_texture: self.slot(json, "sheenColorTexture", Encoding::Srgb),
            roughness: self.unit(json, "sheenRoughnessFactor"),
            roughness_texture: self.slot(json, "sheenRoughnessTexture", Encoding::Linear),
        })
    }

    /// Reads a number of [0, 1], by default 0.
    fn unit(&mut self, json: &Value, name: &str) -> f32 {
        let value = self.member(json, name, as_number).unwrap_or(0.0);
        self.fraction(name, value)
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

    /// Reads a member as `read` understands it; `None` where there is none, and with a warning where it is malformed.
    fn member<T>(&mut self, json: &Value, name: &str, read: impl FnOnce(&Value) -> Option<T>) -> Option<T> {
        let value = json.get(name)?;
        let read = read(value);
        if read.is_none() {
            self.note(format!("{name} is malformed and left out"));
        }
        read
    }
}

fn as_number(value: &Value) -> Option<f32> {
    value.as_f64().map(|v| v as f32).filter(|v| v.is_finite())
}

fn as_color(value: &Value) -> Option<[f32; 3]> {
    let numbers: Option<Vec<f32>> = value.as_array()?.iter().map(as_number).collect();
    numbers?.try_into().ok()
}
