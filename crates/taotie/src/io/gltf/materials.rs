//! Materials: factors, texture slots, and the extensions that a [`Material`] can say.

use super::document::Document;
use super::textures::{Slot, Textures};
use crate::error::Warnings;
use crate::image::Encoding;
use crate::scene::{AlphaMode, GreenChannel, Material, NormalMap, NormalSpace};
use gltf::json;
use gltf::json::validation::Checked;

/// Reflectance of a dielectric of index 1.5 at normal incidence.
const DEFAULT_F0: f32 = 0.04;

/// The file's materials, in order, and after them glTF's default for primitives that name none.
pub(super) fn read(document: &Document, textures: &mut Textures, warnings: &mut Warnings) -> Vec<Material> {
    let json = document.root.materials.iter().enumerate();
    let mut materials: Vec<Material> = json
        .map(|(i, json)| {
            let name = json.name.clone().unwrap_or_else(|| format!("material {i}"));
            Reader { json, textures, warnings, place: format!("material {i}") }.read(name)
        })
        .collect();
    materials.push(default_material());
    materials
}

/// The material of primitives without one. Source: glTF 2.0, 3.9.6.
fn default_material() -> Material {
    Material {
        name: "default".into(),
        base_color: [1.0; 4],
        metallic: 1.0,
        roughness: 1.0,
        ..Material::default()
    }
}

struct Reader<'a, 'b> {
    json: &'a json::Material,
    textures: &'a mut Textures<'b>,
    warnings: &'a mut Warnings,
    place: String,
}

impl Reader<'_, '_> {
    fn read(&mut self, name: String) -> Material {
        let json = self.json;
        let pbr = &json.pbr_metallic_roughness;
        let extensions = json.extensions.clone().unwrap_or_default();
        let strength = extensions.emissive_strength.as_ref().map_or(1.0, |e| e.emissive_strength.0);
        let metallic = self.fraction("metallicFactor", pbr.metallic_factor.0);
        let mut material = Material {
            name,
            base_color: pbr.base_color_factor.0.map(|v| self.fraction("baseColorFactor", v)),
            metallic,
            roughness: self.fraction("roughnessFactor", pbr.roughness_factor.0),
            emissive: json.emissive_factor.0.map(|v| self.positive("emissiveFactor", v * strength)),
            alpha: self.alpha(),
            double_sided: json.double_sided,
            unlit: extensions.unlit.is_some(),
            f0: self.f0(&extensions, metallic),
            ..default_material()
        };
        material.base_color_texture = self.texture(pbr.base_color_texture.as_ref(), Encoding::Srgb);
        material.metallic_roughness_texture =
            self.texture(pbr.metallic_roughness_texture.as_ref(), Encoding::Linear);
        material.emissive_texture = self.texture(json.emissive_texture.as_ref(), Encoding::Srgb);
        self.occlusion(&mut material);
        material.normal = self.normal();
        material
    }

    fn texture(
        &mut self,
        info: Option<&json::texture::Info>,
        encoding: Encoding,
    ) -> Option<super::TextureUse> {
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

    fn normal(&mut self) -> Option<NormalMap> {
        let json = self.json.normal_texture.as_ref()?;
        let slot = Slot::new(json.index.value(), json.tex_coord, json.extensions.as_ref().map(|e| &e.others));
        let texture = self.textures.resolve(&slot, Encoding::Linear, (&self.place, self.warnings))?;
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
                self.warnings.note(format!("{}: unknown alphaMode, taken as OPAQUE", self.place), 1);
                AlphaMode::Opaque
            }
        }
    }

    /// The reflectance at normal incidence after KHR_materials_ior and KHR_materials_specular, where it differs
    /// from the default and holds for the whole surface, which it does on dielectrics only.
    fn f0(&mut self, extensions: &json::extensions::material::Material, metallic: f32) -> Option<[f32; 3]> {
        let ior = extensions.ior.as_ref().map_or(1.5, |e| e.ior.0);
        let mut f0 = [f0_from_ior(ior); 3];
        if let Some(specular) = &extensions.specular {
            let color = specular.specular_color_factor.0;
            f0 = std::array::from_fn(|c| (f0[c] * color[c]).min(1.0) * specular.specular_factor.0);
            let textures = [&specular.specular_texture, &specular.specular_color_texture];
            let count = textures.into_iter().flatten().count();
            self.warnings
                .note("textures of KHR_materials_specular are ignored; only its factors count", count);
        }
        let usual = f0.iter().all(|v| (v - DEFAULT_F0).abs() < 1e-6);
        if usual || metallic == 1.0 && self.json.pbr_metallic_roughness.metallic_roughness_texture.is_none() {
            return None;
        }
        if metallic > 0.0 || f0.iter().any(|v| !(0.0..=1.0).contains(v)) {
            self.warnings.note(
                format!(
                    "{}: KHR_materials_ior and KHR_materials_specular count on dielectrics only",
                    self.place
                ),
                1,
            );
            return None;
        }
        Some(f0)
    }

    /// A value of [0, 1].
    fn fraction(&mut self, name: &str, value: f32) -> f32 {
        self.clamped(name, value, 1.0)
    }

    /// A value of at least 0.
    fn positive(&mut self, name: &str, value: f32) -> f32 {
        self.clamped(name, value, f32::MAX)
    }

    fn clamped(&mut self, name: &str, value: f32, most: f32) -> f32 {
        if (0.0..=most).contains(&value) {
            return value;
        }
        self.warnings.note(format!("{}: {name} of {value} is out of range and clamped", self.place), 1);
        if value > most { most } else { 0.0 }
    }
}

/// Fresnel's equations at normal incidence: ((η − 1) / (η + 1))². An index of 0 means a reflectance of 1.
/// Source: KHR_materials_ior.
fn f0_from_ior(ior: f32) -> f32 {
    let ratio = (ior - 1.0) / (ior + 1.0);
    ratio * ratio
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reflectance_of_glass_and_diamond() {
        assert!((f0_from_ior(1.5) - 0.04).abs() < 1e-7);
        assert!((f0_from_ior(2.42) - 0.172).abs() < 1e-3);
        assert_eq!(f0_from_ior(0.0), 1.0);
    }
}
