//! The textures of a material by the part they play.

use taotie::scene::{Material, TextureRef};

/// The part that a texture plays in a material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum TextureRole {
    /// Colour, and alpha.
    BaseColor,
    /// Green is roughness, blue is metallic; red may be occlusion.
    MetallicRoughness,
    /// Red is occlusion.
    Occlusion,
    /// Emission.
    Emissive,
    /// The normal map; alpha is the variance of its vectors.
    Normal,
    /// The height map, in red.
    Height,
    /// Alpha multiplies the strength of a dielectric's reflection.
    Specular,
    /// The colour of a dielectric's reflection.
    SpecularColor,
    /// Red multiplies the clearcoat's share.
    Clearcoat,
    /// Green multiplies the clearcoat's roughness.
    ClearcoatRoughness,
    /// The clearcoat's normal map; alpha is the variance of its vectors.
    ClearcoatNormal,
    /// The colour of the sheen.
    SheenColor,
    /// Alpha multiplies the sheen's roughness.
    SheenRoughness,
    /// Red and green turn the anisotropy, blue multiplies its strength.
    Anisotropy,
}

impl TextureRole {
    /// All roles, in the order of bindings.
    pub const ALL: [Self; 14] = [
        Self::BaseColor,
        Self::MetallicRoughness,
        Self::Occlusion,
        Self::Emissive,
        Self::Normal,
        Self::Height,
        Self::Specular,
        Self::SpecularColor,
        Self::Clearcoat,
        Self::ClearcoatRoughness,
        Self::ClearcoatNormal,
        Self::SheenColor,
        Self::SheenRoughness,
        Self::Anisotropy,
    ];

    /// The name of the texture in a shader: `base_color_texture`.
    pub fn name(self) -> &'static str {
        match self {
            Self::BaseColor => "base_color_texture",
            Self::MetallicRoughness => "metallic_roughness_texture",
            Self::Occlusion => "occlusion_texture",
            Self::Emissive => "emissive_texture",
            Self::Normal => "normal_texture",
            Self::Height => "height_texture",
            Self::Specular => "specular_texture",
            Self::SpecularColor => "specular_color_texture",
            Self::Clearcoat => "clearcoat_texture",
            Self::ClearcoatRoughness => "clearcoat_roughness_texture",
            Self::ClearcoatNormal => "clearcoat_normal_texture",
            Self::SheenColor => "sheen_color_texture",
            Self::SheenRoughness => "sheen_roughness_texture",
            Self::Anisotropy => "anisotropy_texture",
        }
    }

    /// The role of the texture of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|role| role.name() == name)
    }

    /// The meaning of its channels, once decoded to linear values.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::BaseColor => "Linear RGB and alpha, decoded from sRGB before they are filtered.",
            Self::MetallicRoughness => "Green is roughness, blue is metallic, red may be occlusion; linear.",
            Self::Occlusion => "Red is occlusion; linear.",
            Self::Emissive => "Linear RGB, decoded from sRGB before it is filtered.",
            Self::Normal => {
                "RGB is the vector, each component in [0, 1]; alpha is the variance of the vectors, 1 − |mean|², and 0 in the finest level."
            }
            Self::Height => "Red is the height in [0, 1]; linear.",
            Self::Specular => "Alpha multiplies the strength of a dielectric's reflection; linear.",
            Self::SpecularColor => "Linear RGB, decoded from sRGB before it is filtered.",
            Self::Clearcoat => "Red multiplies the clearcoat's share; linear.",
            Self::ClearcoatRoughness => "Green multiplies the clearcoat's roughness; linear.",
            Self::ClearcoatNormal => {
                "RGB is the clearcoat's vector, each component in [0, 1]; alpha is the variance of the vectors, and 0 in the finest level."
            }
            Self::SheenColor => "Linear RGB, decoded from sRGB before it is filtered.",
            Self::SheenRoughness => "Alpha multiplies the sheen's roughness; linear.",
            Self::Anisotropy => "Red and green turn the direction, blue multiplies the strength; linear.",
        }
    }

    /// The texture of a material that plays this part.
    pub fn of(self, material: &Material) -> Option<&TextureRef> {
        let clearcoat = material.clearcoat.as_ref();
        let sheen = material.sheen.as_ref();
        match self {
            Self::BaseColor => material.base_color_texture.as_ref(),
            Self::MetallicRoughness => material.metallic_roughness_texture.as_ref(),
            Self::Occlusion => material.occlusion_texture.as_ref(),
            Self::Emissive => material.emissive_texture.as_ref(),
            Self::Normal => material.normal.as_ref().map(|map| &map.texture),
            Self::Height => material.height.as_ref().map(|map| &map.texture),
            Self::Specular => material.specular.factor_texture.as_ref(),
            Self::SpecularColor => material.specular.color_texture.as_ref(),
            Self::Clearcoat => clearcoat?.factor_texture.as_ref(),
            Self::ClearcoatRoughness => clearcoat?.roughness_texture.as_ref(),
            Self::ClearcoatNormal => clearcoat?.normal.as_ref().map(|map| &map.texture),
            Self::SheenColor => sheen?.color_texture.as_ref(),
            Self::SheenRoughness => sheen?.roughness_texture.as_ref(),
            Self::Anisotropy => material.anisotropy.as_ref()?.texture.as_ref(),
        }
    }
}
