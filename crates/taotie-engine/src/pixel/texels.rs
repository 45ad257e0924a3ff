//! The texels of a material: for each value that a texture or the vertices supply, its texture, its channels, and the
//! factor that multiplies it.
//!
//! `render` reads textures into columns by this table, and shaders are recorded by it.

use crate::scene::{Material, TextureRole as Role};

/// The factor of a texel, a number three times; `None` if the material lacks the layer.
type Factor = fn(&Material) -> Option<[f32; 3]>;

struct Row {
    name: &'static str,
    parameters: [&'static str; 2],
    role: Option<Role>,
    channels: &'static str,
    meaning: &'static str,
    factor: Option<Factor>,
}

/// Defines the texels: name, role, channels, meaning and factor of each.
macro_rules! texels {
    ($($texel:ident $name:literal [$role:expr] $channels:literal $meaning:literal $factor:expr;)*) => {
        /// A value at a point that a texture supplies, or the vertices.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Texel {
            $(#[doc = $meaning] $texel,)*
        }

        const ROWS: &[Row] = &[$(Row {
            name: $name,
            parameters: [concat!("t.", $name), concat!("u.", $name)],
            role: $role,
            channels: $channels,
            meaning: $meaning,
            factor: $factor,
        }),*];

        impl Texel {
            /// Every texel, in the order of the fields of shaders.
            pub const ALL: &'static [Self] = &[$(Self::$texel),*];
        }
    };
}

/// Texels that nothing multiplies, and that are 1 without a texture.
const WHITE: Factor = |_| Some([1.0; 3]);

texels! {
    BaseColor "base_color" [Some(Role::BaseColor)] "rgb" "Linear RGB." Some(WHITE);
    Alpha "alpha" [Some(Role::BaseColor)] "a" "Opacity, [0, 1]." Some(|m| Some([m.base_color[3]; 3]));
    Color "color" [None] "rgb" "The vertex colour, linear RGB." None;
    ColorAlpha "color_alpha" [None] "a" "The vertex colour's alpha, [0, 1]." None;
    Metallic "metallic" [Some(Role::MetallicRoughness)] "b" "[0, 1]." Some(|m| Some([m.metallic; 3]));
    Roughness "roughness" [Some(Role::MetallicRoughness)] "g" "[0, 1]." Some(|m| Some([m.roughness; 3]));
    Occlusion "occlusion" [Some(Role::Occlusion)] "r" "[0, 1]." Some(WHITE);
    Emissive "emissive" [Some(Role::Emissive)] "rgb" "Linear RGB." Some(|m| Some(m.emissive));
    Normal "normal" [Some(Role::Normal)] "rgb"
        "The normal map's vector as stored, each component in [0, 1]." None;
    NormalVariance "normal_variance" [Some(Role::Normal)] "a"
        "The variance of the normal map's vectors, [0, 1]." None;
    HeightDu "height_du" [Some(Role::Height)] "x" "The derivative of the height map by u." None;
    HeightDv "height_dv" [Some(Role::Height)] "y" "The derivative of the height map by v." None;
    Specular "specular" [Some(Role::Specular)] "a" "[0, 1]." Some(|m| Some([m.specular.factor; 3]));
    SpecularColor "specular_color" [Some(Role::SpecularColor)] "rgb" "Linear RGB." Some(|m| Some(m.specular.color));
    Clearcoat "clearcoat" [Some(Role::Clearcoat)] "r" "[0, 1]." Some(|m| Some([m.clearcoat?.factor; 3]));
    ClearcoatRoughness "clearcoat_roughness" [Some(Role::ClearcoatRoughness)] "g" "[0, 1]."
        Some(|m| Some([m.clearcoat?.roughness; 3]));
    ClearcoatNormal "clearcoat_normal" [Some(Role::ClearcoatNormal)] "rgb"
        "The clearcoat's normal map's vector as stored, each component in [0, 1]." None;
    ClearcoatVariance "clearcoat_variance" [Some(Role::ClearcoatNormal)] "a"
        "The variance of the clearcoat's normal map's vectors, [0, 1]." None;
    SheenColor "sheen_color" [Some(Role::SheenColor)] "rgb" "Linear RGB." Some(|m| Some(m.sheen?.color));
    SheenRoughness "sheen_roughness" [Some(Role::SheenRoughness)] "a" "[0, 1]."
        Some(|m| Some([m.sheen?.roughness; 3]));
    Anisotropy "anisotropy" [Some(Role::Anisotropy)] "b" "[0, 1]." Some(|m| Some([m.anisotropy?.strength; 3]));
    AnisotropyRed "anisotropy_red" [Some(Role::Anisotropy)] "r"
        "The stored cosine of the anisotropy's rotation, [0, 1]." None;
    AnisotropyGreen "anisotropy_green" [Some(Role::Anisotropy)] "g"
        "The stored sine of the anisotropy's rotation, [0, 1]." None;
    Transmission "transmission" [Some(Role::Transmission)] "r" "[0, 1]." Some(|m| Some([m.transmission?.factor; 3]));
}

impl Texel {
    /// Returns its name, such as `metallic`, which its factor shares.
    pub fn name(self) -> &'static str {
        ROWS[self as usize].name
    }

    /// Returns the texel with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|texel| texel.name() == name)
    }

    /// Returns the parameters of a recorded formula for the texel and its factor: `t.metallic` and `u.metallic`.
    pub fn parameters(self) -> [&'static str; 2] {
        ROWS[self as usize].parameters
    }

    /// Returns its texture; `None` for the values of vertices. `packed` is [`has_packed_occlusion`].
    #[inline]
    pub fn role(self, packed: bool) -> Option<Role> {
        match self {
            Self::Occlusion if packed => Some(Role::MetallicRoughness),
            _ => ROWS[self as usize].role,
        }
    }

    /// Returns its channels: `rgb` or one of `r`, `g`, `b` and `a`; `x` and `y` are the slopes of a height map.
    pub fn channels(self) -> &'static str {
        ROWS[self as usize].channels
    }

    /// Returns the index of its first channel.
    #[inline]
    pub fn first_channel(self) -> usize {
        match self.channels().as_bytes()[0] {
            b'g' | b'y' => 1,
            b'b' => 2,
            b'a' => 3,
            _ => 0,
        }
    }

    /// Returns its meaning.
    pub fn meaning(self) -> &'static str {
        ROWS[self as usize].meaning
    }

    /// Returns its factor, a number three times: it multiplies the texel, and is the value without a texture. `None`
    /// if there is none, or the material lacks the layer.
    #[inline]
    pub fn factor(self, material: &Material) -> Option<[f32; 3]> {
        ROWS[self as usize].factor.and_then(|factor| factor(material))
    }
}

/// Returns true if occlusion is in the red channel of the metallic-roughness texture.
pub fn has_packed_occlusion(material: &Material) -> bool {
    material.occlusion_texture.is_some() && material.occlusion_texture == material.metallic_roughness_texture
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn no_two_texels_share_a_name_or_a_channel() {
        for packed in [false, true] {
            let (mut names, mut channels) = (BTreeSet::new(), BTreeSet::new());
            for texel in Texel::ALL {
                assert_eq!(Texel::named(texel.name()), Some(*texel));
                assert!(names.insert(texel.name()), "{texel:?}");
                for channel in (texel.first_channel()..).take(texel.channels().len()) {
                    assert!(channel < 4 && channels.insert((texel.role(packed), channel)), "{texel:?}");
                }
            }
        }
    }
}
