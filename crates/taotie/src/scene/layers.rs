//! The layers that extensions of glTF add to a material: one table for reading, writing and checking.

use super::{Anisotropy, Clearcoat, Light, Material, Sheen, Specular, TextureRole};

/// The value of a factor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum FactorValue {
    /// A number.
    Number(f32),
    /// Linear RGB.
    Color([f32; 3]),
    /// Radians.
    Angle(f64),
}

/// A factor of a layer.
pub(crate) struct Factor {
    /// The name in messages.
    pub name: &'static str,
    /// The member of the extension's JSON.
    pub member: &'static str,
    /// The value if the JSON lacks the member.
    pub default: FactorValue,
    /// The largest value that glTF allows; the smallest is 0. Angles have no bounds.
    pub most: f32,
    /// Returns the value; `None` if the material lacks the layer.
    pub get: fn(&Material) -> Option<FactorValue>,
    /// Sets the value, if the material has the layer.
    pub set: fn(&mut Material, FactorValue),
}

/// A layer of a material.
pub(crate) struct Layer {
    /// The extension of glTF.
    pub extension: &'static str,
    /// Adds the layer, without textures.
    pub add: fn(&mut Material),
    /// Removes the layer.
    pub remove: fn(&mut Material),
    /// Returns true if the material has the layer.
    pub is_present: fn(&Material) -> bool,
    /// Returns true if the layer changes how the surface looks; otherwise readers omit it.
    pub is_visible: fn(&Material) -> bool,
    /// Its factors; if the first makes the layer invisible, readers omit it.
    pub factors: &'static [Factor],
    /// Its textures.
    pub textures: &'static [TextureRole],
}

/// The layers, in the order in which they are written.
pub(crate) const LAYERS: [Layer; 4] = [SPECULAR, CLEARCOAT, ANISOTROPY, SHEEN];

/// A factor of the layer that `$layer` gives, an `Option` of a reference.
macro_rules! factor {
    ($name:literal, $member:literal, $kind:ident($default:expr), $most:expr, |$m:ident| $layer:expr, $layer_mut:expr, $field:ident) => {
        Factor {
            name: $name,
            member: $member,
            default: FactorValue::$kind($default),
            most: $most,
            get: |$m| $layer.map(|layer| FactorValue::$kind(layer.$field)),
            set: |$m, value| {
                if let (Some(layer), FactorValue::$kind(value)) = ($layer_mut, value) {
                    layer.$field = value;
                }
            },
        }
    };
}

const SPECULAR: Layer = Layer {
    extension: "KHR_materials_specular",
    add: |_| {},
    remove: |m| m.specular = Specular::default(),
    is_present: |m| m.specular != Specular::default(),
    is_visible: |_| true,
    factors: &[
        factor!(
            "specular factor",
            "specularFactor",
            Number(1.0),
            1.0,
            |m| Some(&m.specular),
            Some(&mut m.specular),
            factor
        ),
        factor!(
            "specular colour",
            "specularColorFactor",
            Color([1.0; 3]),
            Light::MOST,
            |m| Some(&m.specular),
            Some(&mut m.specular),
            color
        ),
    ],
    textures: &[TextureRole::Specular, TextureRole::SpecularColor],
};

const CLEARCOAT: Layer = Layer {
    extension: "KHR_materials_clearcoat",
    add: |m| {
        let plain = Clearcoat {
            factor: 0.0,
            factor_texture: None,
            roughness: 0.0,
            roughness_texture: None,
            normal: None,
        };
        m.clearcoat = Some(plain);
    },
    remove: |m| m.clearcoat = None,
    is_present: |m| m.clearcoat.is_some(),
    is_visible: |m| m.clearcoat.is_some_and(|coat| coat.factor > 0.0),
    factors: &[
        factor!(
            "clearcoat factor",
            "clearcoatFactor",
            Number(0.0),
            1.0,
            |m| m.clearcoat.as_ref(),
            m.clearcoat.as_mut(),
            factor
        ),
        factor!(
            "clearcoat roughness",
            "clearcoatRoughnessFactor",
            Number(0.0),
            1.0,
            |m| m.clearcoat.as_ref(),
            m.clearcoat.as_mut(),
            roughness
        ),
    ],
    textures: &[TextureRole::Clearcoat, TextureRole::ClearcoatRoughness, TextureRole::ClearcoatNormal],
};

const ANISOTROPY: Layer = Layer {
    extension: "KHR_materials_anisotropy",
    add: |m| m.anisotropy = Some(Anisotropy { strength: 0.0, rotation: 0.0, texture: None }),
    remove: |m| m.anisotropy = None,
    is_present: |m| m.anisotropy.is_some(),
    is_visible: |m| m.anisotropy.is_some_and(|anisotropy| anisotropy.strength > 0.0),
    factors: &[
        factor!(
            "anisotropy strength",
            "anisotropyStrength",
            Number(0.0),
            1.0,
            |m| m.anisotropy.as_ref(),
            m.anisotropy.as_mut(),
            strength
        ),
        factor!(
            "anisotropy rotation",
            "anisotropyRotation",
            Angle(0.0),
            f32::MAX,
            |m| m.anisotropy.as_ref(),
            m.anisotropy.as_mut(),
            rotation
        ),
    ],
    textures: &[TextureRole::Anisotropy],
};

const SHEEN: Layer = Layer {
    extension: "KHR_materials_sheen",
    add: |m| {
        m.sheen =
            Some(Sheen { color: [0.0; 3], color_texture: None, roughness: 0.0, roughness_texture: None })
    },
    remove: |m| m.sheen = None,
    is_present: |m| m.sheen.is_some(),
    is_visible: |m| m.sheen.is_some_and(|sheen| sheen.color != [0.0; 3]),
    factors: &[
        factor!(
            "sheen colour",
            "sheenColorFactor",
            Color([0.0; 3]),
            1.0,
            |m| m.sheen.as_ref(),
            m.sheen.as_mut(),
            color
        ),
        factor!(
            "sheen roughness",
            "sheenRoughnessFactor",
            Number(0.0),
            1.0,
            |m| m.sheen.as_ref(),
            m.sheen.as_mut(),
            roughness
        ),
    ],
    textures: &[TextureRole::SheenColor, TextureRole::SheenRoughness],
};

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_layer_can_be_read_and_written() {
        let mut members = BTreeSet::new();
        for layer in &LAYERS {
            let mut material = Material::default();
            (layer.add)(&mut material);
            for factor in layer.factors {
                assert!(members.insert(factor.member), "{}", factor.member);
                assert_eq!((factor.get)(&material), Some(factor.default), "{}", factor.member);
            }
            for role in layer.textures {
                assert!(members.insert(role.gltf_member()), "{role:?}");
                let is_plain = role.place(&mut material).is_some();
                assert!(is_plain != (*role == TextureRole::ClearcoatNormal), "{role:?}");
            }
            (layer.remove)(&mut material);
            assert_eq!(material, Material::default(), "{}", layer.extension);
        }
    }
}
