//! The textures of a material by their role: one table for reading, writing, inspection and shaders.

use super::{Material, NormalMap, TextureRef};
use crate::image::Encoding;

/// The role of a texture in a material.
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
    /// Red multiplies the transmission.
    Transmission,
    /// Green multiplies the thickness of the volume.
    Thickness,
    /// Red multiplies the iridescence.
    Iridescence,
    /// Green interpolates the thickness of the iridescent film.
    IridescenceThickness,
}

/// A row of the table: role, name, member of glTF's JSON, encoding, and the meaning of its channels.
type Row = (TextureRole, &'static str, &'static str, Encoding, &'static str);

const COLOR: &str = "Linear RGB, decoded from sRGB before it is filtered.";

use TextureRole as Role;
const ROWS: [Row; 18] = [
    (
        Role::BaseColor,
        "base_color_texture",
        "baseColorTexture",
        Encoding::Srgb,
        "Linear RGB and alpha, decoded from sRGB before they are filtered.",
    ),
    (
        Role::MetallicRoughness,
        "metallic_roughness_texture",
        "metallicRoughnessTexture",
        Encoding::Linear,
        "Green is roughness, blue is metallic, red may be occlusion; linear.",
    ),
    (Role::Occlusion, "occlusion_texture", "occlusionTexture", Encoding::Linear, "Red is occlusion; linear."),
    (Role::Emissive, "emissive_texture", "emissiveTexture", Encoding::Srgb, COLOR),
    (
        Role::Normal,
        "normal_texture",
        "normalTexture",
        Encoding::Normal,
        "RGB is the vector, each component in [0, 1]; alpha is the variance of the vectors, 1 − |mean|², and 0 in the \
         finest level.",
    ),
    (Role::Height, "height_texture", "", Encoding::Linear, "Red is the height in [0, 1]; linear."),
    (
        Role::Specular,
        "specular_texture",
        "specularTexture",
        Encoding::Linear,
        "Alpha multiplies the strength of a dielectric's reflection; linear.",
    ),
    (Role::SpecularColor, "specular_color_texture", "specularColorTexture", Encoding::Srgb, COLOR),
    (
        Role::Clearcoat,
        "clearcoat_texture",
        "clearcoatTexture",
        Encoding::Linear,
        "Red multiplies the clearcoat's share; linear.",
    ),
    (
        Role::ClearcoatRoughness,
        "clearcoat_roughness_texture",
        "clearcoatRoughnessTexture",
        Encoding::Linear,
        "Green multiplies the clearcoat's roughness; linear.",
    ),
    (
        Role::ClearcoatNormal,
        "clearcoat_normal_texture",
        "clearcoatNormalTexture",
        Encoding::Normal,
        "RGB is the clearcoat's vector, each component in [0, 1]; alpha is the variance of the vectors, and 0 in the \
         finest level.",
    ),
    (Role::SheenColor, "sheen_color_texture", "sheenColorTexture", Encoding::Srgb, COLOR),
    (
        Role::SheenRoughness,
        "sheen_roughness_texture",
        "sheenRoughnessTexture",
        Encoding::Linear,
        "Alpha multiplies the sheen's roughness; linear.",
    ),
    (
        Role::Anisotropy,
        "anisotropy_texture",
        "anisotropyTexture",
        Encoding::Linear,
        "Red and green turn the direction, blue multiplies the strength; linear.",
    ),
    (
        Role::Transmission,
        "transmission_texture",
        "transmissionTexture",
        Encoding::Linear,
        "Red multiplies the share of light that passes; linear.",
    ),
    (
        Role::Thickness,
        "thickness_texture",
        "thicknessTexture",
        Encoding::Linear,
        "Green multiplies the thickness of the volume; linear.",
    ),
    (
        Role::Iridescence,
        "iridescence_texture",
        "iridescenceTexture",
        Encoding::Linear,
        "Red multiplies the iridescence; linear.",
    ),
    (
        Role::IridescenceThickness,
        "iridescence_thickness_texture",
        "iridescenceThicknessTexture",
        Encoding::Linear,
        "Green interpolates the thickness of the iridescent film; linear.",
    ),
];

impl TextureRole {
    /// Every role, in the order of the bindings of shaders.
    pub const ALL: [Self; ROWS.len()] = {
        let (mut all, mut i) = ([Self::BaseColor; ROWS.len()], 0);
        while i < ROWS.len() {
            all[i] = ROWS[i].0;
            i += 1;
        }
        all
    };

    /// Returns the name of the texture, such as `base_color_texture`.
    pub fn name(self) -> &'static str {
        ROWS[self as usize].1
    }

    /// Returns the role of the texture with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|role| role.name() == name)
    }

    /// Returns the name of the role in reports, such as `base-color`.
    pub fn label(self) -> String {
        self.name().trim_end_matches("_texture").replace('_', "-")
    }

    /// Returns the member of a glTF material, or of its extension, such as `baseColorTexture`; empty if glTF has none.
    pub fn gltf_member(self) -> &'static str {
        ROWS[self as usize].2
    }

    /// Returns the encoding of its texels.
    pub fn encoding(self) -> Encoding {
        ROWS[self as usize].3
    }

    /// Returns the meaning of its channels, once decoded to linear values.
    pub fn meaning(self) -> &'static str {
        ROWS[self as usize].4
    }

    /// Returns the texture of a material in this role.
    pub fn of(self, material: &Material) -> Option<&TextureRef> {
        let (coat, sheen) = (material.clearcoat.as_ref(), material.sheen.as_ref());
        match self {
            Self::BaseColor => material.base_color_texture.as_ref(),
            Self::MetallicRoughness => material.metallic_roughness_texture.as_ref(),
            Self::Occlusion => material.occlusion_texture.as_ref(),
            Self::Emissive => material.emissive_texture.as_ref(),
            Self::Specular => material.specular.factor_texture.as_ref(),
            Self::SpecularColor => material.specular.color_texture.as_ref(),
            Self::Clearcoat => coat?.factor_texture.as_ref(),
            Self::ClearcoatRoughness => coat?.roughness_texture.as_ref(),
            Self::Anisotropy => material.anisotropy.as_ref()?.texture.as_ref(),
            Self::SheenColor => sheen?.color_texture.as_ref(),
            Self::SheenRoughness => sheen?.roughness_texture.as_ref(),
            Self::Transmission => material.transmission.as_ref()?.texture.as_ref(),
            Self::Thickness => material.volume.as_ref()?.thickness_texture.as_ref(),
            Self::Iridescence => material.iridescence.as_ref()?.factor_texture.as_ref(),
            Self::IridescenceThickness => material.iridescence.as_ref()?.thickness_texture.as_ref(),
            Self::Normal | Self::ClearcoatNormal => self.normal_map(material).map(|map| &map.texture),
            Self::Height => material.height.as_ref().map(|map| &map.texture),
        }
    }

    /// Returns the normal map of a material in this role.
    pub fn normal_map(self, material: &Material) -> Option<&NormalMap> {
        match self {
            Self::Normal => material.normal.as_ref(),
            Self::ClearcoatNormal => material.clearcoat.as_ref()?.normal.as_ref(),
            _ => None,
        }
    }

    /// Returns the place of a plain texture, which holds neither normals nor heights; `None` if the material lacks the
    /// layer.
    pub fn place(self, material: &mut Material) -> Option<&mut Option<TextureRef>> {
        match self {
            Self::BaseColor => Some(&mut material.base_color_texture),
            Self::MetallicRoughness => Some(&mut material.metallic_roughness_texture),
            Self::Occlusion => Some(&mut material.occlusion_texture),
            Self::Emissive => Some(&mut material.emissive_texture),
            Self::Specular => Some(&mut material.specular.factor_texture),
            Self::SpecularColor => Some(&mut material.specular.color_texture),
            Self::Clearcoat => material.clearcoat.as_mut().map(|coat| &mut coat.factor_texture),
            Self::ClearcoatRoughness => material.clearcoat.as_mut().map(|coat| &mut coat.roughness_texture),
            Self::Anisotropy => material.anisotropy.as_mut().map(|anisotropy| &mut anisotropy.texture),
            Self::SheenColor => material.sheen.as_mut().map(|sheen| &mut sheen.color_texture),
            Self::SheenRoughness => material.sheen.as_mut().map(|sheen| &mut sheen.roughness_texture),
            Self::Transmission => {
                material.transmission.as_mut().map(|transmission| &mut transmission.texture)
            }
            Self::Thickness => material.volume.as_mut().map(|volume| &mut volume.thickness_texture),
            Self::Iridescence => material.iridescence.as_mut().map(|film| &mut film.factor_texture),
            Self::IridescenceThickness => {
                material.iridescence.as_mut().map(|film| &mut film.thickness_texture)
            }
            Self::ClearcoatNormal | Self::Normal | Self::Height => None,
        }
    }
}

impl Material {
    /// Returns every texture in use, normal and height maps last.
    pub fn textures(&self) -> Vec<TextureRef> {
        let mut textures = Vec::new();
        self.clone().retain_textures(|texture| {
            textures.push(*texture);
            true
        });
        textures
    }

    /// Lets `keep` see and change every texture in use, and removes those for which it returns `false`; normal and
    /// height maps are removed as a whole.
    pub fn retain_textures(&mut self, mut keep: impl FnMut(&mut TextureRef) -> bool) {
        for role in TextureRole::ALL {
            if let Some(place) = role.place(self) {
                place.take_if(|texture| !keep(texture));
            }
        }
        let coat = self.clearcoat.as_mut().map(|coat| &mut coat.normal);
        for map in [&mut self.normal].into_iter().chain(coat) {
            map.take_if(|map| !keep(&mut map.texture));
        }
        self.height.take_if(|map| !keep(&mut map.texture));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn rows_are_in_the_order_of_roles_and_names_are_unique() {
        assert!(ROWS.iter().enumerate().all(|(at, row)| row.0 as usize == at));
        let names: BTreeSet<_> = ROWS.iter().map(|row| row.1).collect();
        assert_eq!(names.len(), ROWS.len());
    }
}
