//! Materials: factors and texture slots. [`super::layers`] reads the layers added by extensions.

use super::document::Document;
use super::textures::{Slot, Textures};
use crate::error::Warnings;
use crate::image::Encoding;
use crate::scene::{AlphaMode, GreenChannel, Light, Material, NormalMap, NormalSpace};
use gltf::json;
use gltf::json::validation::Checked;

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
pub(super) struct MaterialReader<'a, 'b> {
    /// The material being read.
    pub json: &'a json::Material,
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
    pub fn texture(
        &mut self,
        info: Option<&json::texture::Info>,
        encoding: Encoding,
    ) -> Option<crate::scene::TextureRef> {
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
    pub fn normal_map(&mut self, json: &json::material::NormalTexture) -> Option<NormalMap> {
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
    pub fn fraction(&mut self, name: &str, value: f32) -> f32 {
        self.clamped(name, value, 1.0)
    }

    /// Clamps a value to at least 0 and at most [`Light::MOST`].
    pub fn positive(&mut self, name: &str, value: f32) -> f32 {
        self.clamped(name, value, Light::MOST)
    }

    /// Clamps a value to at least 0 and at most `most`.
    pub fn clamped(&mut self, name: &str, value: f32, most: f32) -> f32 {
        if (0.0..=most).contains(&value) {
            return value;
        }
        self.note(format!("{name} {value} is out of range; clamped"));
        if value > most { most } else { 0.0 }
    }

    /// Notes a defect of this material.
    pub fn note(&mut self, what: String) {
        self.warnings.note(format!("{}: {what}", self.place), 1);
    }
}
