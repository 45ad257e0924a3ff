//! The properties of a material, each with the map that stores it if it varies.

use crate::bake::MapKind;
use crate::scene::{AlphaMode, Material};

/// A property of a material.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Property {
    BaseColor,
    Alpha,
    NormalMap,
    HeightMap,
    MetallicRoughness,
    Occlusion,
    Emission,
    RefractiveIndex,
    Specular,
    Clearcoat,
    Sheen,
    Anisotropy,
    Unlit,
    /// The reflectance at 0° and 82°.
    Reflectance,
    /// The parameters of classic models.
    Classic,
}

impl Property {
    /// All properties, in reporting order.
    pub const ALL: [Self; 15] = [
        Self::BaseColor,
        Self::Alpha,
        Self::NormalMap,
        Self::HeightMap,
        Self::MetallicRoughness,
        Self::Occlusion,
        Self::Emission,
        Self::RefractiveIndex,
        Self::Specular,
        Self::Clearcoat,
        Self::Sheen,
        Self::Anisotropy,
        Self::Unlit,
        Self::Reflectance,
        Self::Classic,
    ];

    /// Returns its name in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::BaseColor => "base colour",
            Self::Alpha => "alpha",
            Self::NormalMap => "normal map",
            Self::HeightMap => "height map",
            Self::MetallicRoughness => "metallic-roughness",
            Self::Occlusion => "occlusion texture",
            Self::Emission => "emission",
            Self::RefractiveIndex => "index of refraction",
            Self::Specular => "specular strength",
            Self::Clearcoat => "clearcoat",
            Self::Sheen => "sheen",
            Self::Anisotropy => "anisotropy",
            Self::Unlit => "unlit look",
            Self::Reflectance => "reflectance at 0° or 82°",
            Self::Classic => "parameters of classic models",
        }
    }

    /// Returns the map that stores it if it varies over the surface.
    pub fn map(self) -> Option<MapKind> {
        match self {
            Self::BaseColor => Some(MapKind::Albedo),
            Self::Alpha => Some(MapKind::Alpha),
            Self::NormalMap | Self::HeightMap => Some(MapKind::Normal),
            Self::MetallicRoughness => Some(MapKind::MetallicRoughness),
            Self::Occlusion => Some(MapKind::OcclusionMap),
            Self::Emission => Some(MapKind::Emission),
            _ => None,
        }
    }

    /// Returns true if a factor can store it: if glTF has one that means the same on any uvs. The direction of
    /// anisotropy follows the uvs.
    pub fn has_factor(self) -> bool {
        !matches!(
            self,
            Self::NormalMap
                | Self::HeightMap
                | Self::Occlusion
                | Self::Anisotropy
                | Self::Reflectance
                | Self::Classic
        )
    }

    /// Copies it, with its textures; base colour textures also contain alpha but are copied only as colours.
    pub fn copy(self, from: &Material, to: &mut Material) {
        match self {
            Self::BaseColor => {
                let [r, g, b, _] = from.base_color;
                to.base_color = [r, g, b, to.base_color[3]];
                to.base_color_texture = from.base_color_texture;
            }
            Self::Alpha if from.alpha == AlphaMode::Opaque => {}
            Self::Alpha => {
                to.alpha = from.alpha;
                to.base_color[3] = from.base_color[3];
            }
            Self::NormalMap => to.normal = from.normal,
            // A normal map overrides it.
            Self::HeightMap => to.height = from.height.filter(|_| from.normal.is_none()),
            Self::MetallicRoughness => {
                (to.metallic, to.roughness) = (from.metallic, from.roughness);
                to.metallic_roughness_texture = from.metallic_roughness_texture;
            }
            Self::Occlusion if from.occlusion_strength == 0.0 => {}
            Self::Occlusion => {
                to.occlusion_texture = from.occlusion_texture;
                if from.occlusion_texture.is_some() {
                    to.occlusion_strength = from.occlusion_strength;
                }
            }
            Self::Emission if from.emissive == [0.0; 3] => {}
            Self::Emission => {
                to.emissive = from.emissive;
                to.emissive_texture = from.emissive_texture;
            }
            Self::RefractiveIndex => to.ior = from.ior,
            Self::Specular => to.specular = from.specular,
            Self::Clearcoat => to.clearcoat = from.clearcoat.filter(|coat| coat.factor > 0.0),
            Self::Sheen => to.sheen = from.sheen.filter(|sheen| sheen.color != [0.0; 3]),
            Self::Anisotropy => to.anisotropy = from.anisotropy.filter(|a| a.strength > 0.0),
            Self::Unlit => to.unlit = from.unlit,
            Self::Reflectance => (to.f0, to.f82) = (from.f0, from.f82),
            Self::Classic => to.classic = from.classic,
        }
    }

    /// Returns the default material with this property of another.
    pub fn isolated(self, material: &Material) -> Material {
        let mut only = Material::default();
        self.copy(material, &mut only);
        only
    }

    /// Returns true if a material differs from the default one in it.
    pub fn is_said(self, material: &Material) -> bool {
        self.isolated(material) != Material::default()
    }

    /// Returns true if it is stored in textures.
    pub fn is_textured(self, material: &Material) -> bool {
        !self.isolated(material).textures().is_empty()
    }
}
