//! Materials: factors, texture slots, index of refraction, and the layers of other extensions.
//!
//! A layer whose factor disables it is omitted, together with its textures. The JSON of extensions that the parser
//! does not know is read member by member: an invalid member keeps its default, with a warning.

use super::document::Document;
use super::textures::{Slot, Textures};
use gltf::json::validation::Checked;
use gltf::json::{self, Value, deserialize, material};
use taotie_engine::error::Warnings;
use taotie_engine::image::Encoding;
use taotie_engine::scene::{
    AlphaMode, Factor, FactorValue, GreenChannel, LAYERS, Layer, Light, Material, NormalMap, NormalSpace,
    TextureRef, TextureRole,
};

/// Returns the file's materials in order, followed by glTF's default for primitives without one.
pub(super) fn read(document: &Document, textures: &mut Textures, warnings: &mut Warnings) -> Vec<Material> {
    let json = document.root.materials.iter().enumerate();
    let mut materials: Vec<Material> = json
        .map(|(i, json)| {
            let name = json.name.clone().unwrap_or_else(|| format!("material {i}"));
            MaterialReader { json, textures, warnings, place: format!("material {i}") }.read(name)
        })
        .collect();
    materials.push(default_material());
    materials
}

/// Returns the material of primitives without one. Source: glTF 2.0, 3.9.6.
fn default_material() -> Material {
    Material { name: "default".into(), ..Material::default_of_gltf() }
}

/// Reads one material.
struct MaterialReader<'a, 'b> {
    /// The material being read.
    json: &'a json::Material,
    textures: &'a mut Textures<'b>,
    warnings: &'a mut Warnings,
    place: String,
}

impl MaterialReader<'_, '_> {
    fn read(&mut self, name: String) -> Material {
        let json = self.json;
        let pbr = &json.pbr_metallic_roughness;
        let strength = json.extensions.as_ref().and_then(|e| e.emissive_strength.as_ref());
        let strength = strength.map_or(1.0, |e| e.emissive_strength.0);
        let mut material = Material {
            name,
            base_color: pbr.base_color_factor.0.map(|v| self.fraction("baseColorFactor", v)),
            metallic: self.fraction("metallicFactor", pbr.metallic_factor.0),
            roughness: self.fraction("roughnessFactor", pbr.roughness_factor.0),
            emissive: json.emissive_factor.0.map(|v| self.positive("emissiveFactor", v * strength)),
            alpha: self.alpha(),
            double_sided: json.double_sided,
            unlit: json.extensions.as_ref().is_some_and(|e| e.unlit.is_some()),
            ..default_material()
        };
        material.base_color_texture = self.texture(pbr.base_color_texture.as_ref(), Encoding::Srgb);
        material.metallic_roughness_texture =
            self.texture(pbr.metallic_roughness_texture.as_ref(), Encoding::Linear);
        material.emissive_texture = self.texture(json.emissive_texture.as_ref(), Encoding::Srgb);
        self.occlusion(&mut material);
        material.normal = json.normal_texture.as_ref().and_then(|normal| self.normal_map(normal));
        self.read_layers(&mut material);
        material
    }

    /// Returns the texture of a slot; `None` with a warning if it is unavailable.
    fn texture(&mut self, info: Option<&json::texture::Info>, encoding: Encoding) -> Option<TextureRef> {
        let slot = Slot::from_info(info?);
        self.textures.resolve(&slot, encoding, (&self.place, self.warnings))
    }

    fn occlusion(&mut self, material: &mut Material) {
        let Some(json) = &self.json.occlusion_texture else { return };
        material.occlusion_strength = self.fraction("occlusionTexture.strength", json.strength.0);
        let slot = Slot::new(json.index.value(), json.tex_coord, json.extensions.as_ref().map(|e| &e.others));
        material.occlusion_texture =
            self.textures.resolve(&slot, Encoding::Linear, (&self.place, self.warnings));
    }

    /// Returns a normal map; `None` with a warning if its texture is unavailable.
    fn normal_map(&mut self, json: &json::material::NormalTexture) -> Option<NormalMap> {
        let slot = Slot::new(json.index.value(), json.tex_coord, json.extensions.as_ref().map(|e| &e.others));
        let texture = self.textures.resolve(&slot, Encoding::Normal, (&self.place, self.warnings))?;
        let scale = if json.scale.is_finite() { json.scale } else { 1.0 };
        Some(NormalMap { texture, scale, space: NormalSpace::Tangent, green: GreenChannel::Up })
    }

    fn alpha(&mut self) -> AlphaMode {
        match self.json.alpha_mode {
            Checked::Valid(json::material::AlphaMode::Opaque) => AlphaMode::Opaque,
            Checked::Valid(json::material::AlphaMode::Blend) => AlphaMode::Blend,
            Checked::Valid(json::material::AlphaMode::Mask) => {
                let cutoff = self.json.alpha_cutoff.map_or(0.5, |c| c.0);
                AlphaMode::Mask(self.positive("alphaCutoff", cutoff))
            }
            Checked::Invalid => {
                self.note("unknown alphaMode; using OPAQUE".into());
                AlphaMode::Opaque
            }
        }
    }

    /// Clamps a value to [0, 1].
    fn fraction(&mut self, name: &str, value: f32) -> f32 {
        self.clamped(name, value, 1.0)
    }

    /// Clamps a value to at least 0 and at most [`Light::MOST`].
    fn positive(&mut self, name: &str, value: f32) -> f32 {
        self.clamped(name, value, Light::MOST)
    }

    /// Clamps a value to at least 0 and at most `most`.
    fn clamped(&mut self, name: &str, value: f32, most: f32) -> f32 {
        if (0.0..=most).contains(&value) {
            return value;
        }
        self.note(format!("{name} {value} is out of range; clamped"));
        if value > most { most } else { 0.0 }
    }

    /// Notes a defect of this material.
    fn note(&mut self, what: String) {
        self.warnings.note(format!("{}: {what}", self.place), 1);
    }

    /// Fills in the values of the extensions.
    fn read_layers(&mut self, material: &mut Material) {
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
                layer.remove(material);
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
