//! The layers that extensions of glTF add to a material: one table for reading, writing and checking.
//!
//! The check covers a whole material: it can be shaded if its textures exist, and its factors are in range.

use super::{
    AlphaMode, Anisotropy, Clearcoat, Dispersion, Iridescence, Light, Material, Sheen, TextureRole,
    Transmission, UvTransform, Volume,
};

/// The value of a factor.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(untagged)]
pub enum FactorValue {
    /// A number.
    Number(f32),
    /// Linear RGB.
    Color([f32; 3]),
    /// Radians; serialised in degrees.
    Angle(#[serde(serialize_with = "degrees")] f64),
}

fn degrees<S: serde::Serializer>(angle: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(angle.to_degrees())
}

/// A factor of a layer.
pub struct Factor {
    /// The name in messages.
    pub name: &'static str,
    /// The name of its field, as in reports.
    pub field: &'static str,
    /// The member of the extension's JSON.
    pub member: &'static str,
    /// The largest value that glTF allows; the smallest is 0. Angles have no bounds.
    pub most: f32,
    /// Returns the value; `None` if the material lacks the layer.
    pub get: fn(&Material) -> Option<FactorValue>,
    /// Sets the value, if the material has the layer.
    pub set: fn(&mut Material, FactorValue),
}

/// A layer of a material.
pub struct Layer {
    /// The name in messages.
    pub name: &'static str,
    /// The extension of glTF.
    pub extension: &'static str,
    /// Adds the layer with the values that apply if the JSON lacks their members, without textures.
    pub add: fn(&mut Material),
    /// Copies the layer with its textures, or its absence, from the first material to the second.
    pub copy: fn(&Material, &mut Material),
    /// Returns true if the layer changes how the surface looks; otherwise readers omit it.
    pub is_visible: fn(&Material) -> bool,
    /// Its factors; if the first makes the layer invisible, readers omit it.
    pub factors: &'static [Factor],
    /// Its textures.
    pub textures: &'static [TextureRole],
}

impl Layer {
    /// Returns the name in reports, such as `clearcoat`: the extension without its prefix.
    pub fn key(&self) -> &'static str {
        self.extension.trim_start_matches("KHR_materials_")
    }

    /// Removes the layer.
    pub fn remove(&self, material: &mut Material) {
        (self.copy)(&Material::default(), material);
    }

    /// Returns true if the material has the layer.
    pub fn is_present(&self, material: &Material) -> bool {
        let mut only = Material::default();
        (self.copy)(material, &mut only);
        only != Material::default()
    }

    /// Returns true if a material may lack the layer; each has a specular strength.
    pub fn is_optional(&self) -> bool {
        self.factors.iter().all(|factor| (factor.get)(&Material::default()).is_none())
    }

    /// Returns true if the layer has a direction, which follows the uvs.
    pub fn has_direction(&self) -> bool {
        let mut material = Material::default();
        (self.add)(&mut material);
        material.has_direction()
    }
}

/// The layers, in the order in which they are written.
pub const LAYERS: [Layer; 8] =
    [SPECULAR, CLEARCOAT, ANISOTROPY, SHEEN, TRANSMISSION, VOLUME, IRIDESCENCE, DISPERSION];

/// A factor: its field, the name in messages, the member of the JSON, its kind and the largest value of glTF.
macro_rules! factor {
    (specular.$field:ident, $name:literal, $member:literal, $kind:ident, $most:expr) => {
        Factor {
            name: $name,
            field: stringify!($field),
            member: $member,
            most: $most,
            get: |material| Some(FactorValue::$kind(material.specular.$field)),
            set: |material, value| {
                if let FactorValue::$kind(value) = value {
                    material.specular.$field = value;
                }
            },
        }
    };
    ($layer:ident.$field:ident, $name:literal, $member:literal, $kind:ident, $most:expr) => {
        Factor {
            name: $name,
            field: stringify!($field),
            member: $member,
            most: $most,
            get: |material| material.$layer.as_ref().map(|layer| FactorValue::$kind(layer.$field)),
            set: |material, value| {
                if let (Some(layer), FactorValue::$kind(value)) = (&mut material.$layer, value) {
                    layer.$field = value;
                }
            },
        }
    };
}

/// A layer that a material may lack: its field, which has the extension's name, its type, and when it is visible.
macro_rules! optional {
    ($layer:ident: $kind:ident, $first:ident $differs:tt $zero:expr) => {
        Layer {
            name: stringify!($layer),
            extension: concat!("KHR_materials_", stringify!($layer)),
            add: |material| material.$layer = Some($kind::default()),
            copy: |from, to| to.$layer = from.$layer,
            is_visible: |material| material.$layer.is_some_and(|layer| layer.$first $differs $zero),
            factors: &[],
            textures: &[],
        }
    };
}

const SPECULAR: Layer = Layer {
    name: "specular strength",
    extension: "KHR_materials_specular",
    add: |_| {},
    copy: |from, to| to.specular = from.specular,
    is_visible: |_| true,
    factors: &[
        factor!(specular.factor, "specular factor", "specularFactor", Number, 1.0),
        factor!(specular.color, "specular colour", "specularColorFactor", Color, Light::MOST),
    ],
    textures: &[TextureRole::Specular, TextureRole::SpecularColor],
};

const CLEARCOAT: Layer = Layer {
    factors: &[
        factor!(clearcoat.factor, "clearcoat factor", "clearcoatFactor", Number, 1.0),
        factor!(clearcoat.roughness, "clearcoat roughness", "clearcoatRoughnessFactor", Number, 1.0),
    ],
    textures: &[TextureRole::Clearcoat, TextureRole::ClearcoatRoughness, TextureRole::ClearcoatNormal],
    ..optional!(clearcoat: Clearcoat, factor > 0.0)
};

const ANISOTROPY: Layer = Layer {
    factors: &[
        factor!(anisotropy.strength, "anisotropy strength", "anisotropyStrength", Number, 1.0),
        factor!(anisotropy.rotation, "anisotropy rotation", "anisotropyRotation", Angle, f32::MAX),
    ],
    textures: &[TextureRole::Anisotropy],
    ..optional!(anisotropy: Anisotropy, strength > 0.0)
};

const SHEEN: Layer = Layer {
    factors: &[
        factor!(sheen.color, "sheen colour", "sheenColorFactor", Color, 1.0),
        factor!(sheen.roughness, "sheen roughness", "sheenRoughnessFactor", Number, 1.0),
    ],
    textures: &[TextureRole::SheenColor, TextureRole::SheenRoughness],
    ..optional!(sheen: Sheen, color != [0.0; 3])
};

const TRANSMISSION: Layer = Layer {
    factors: &[factor!(transmission.factor, "transmission factor", "transmissionFactor", Number, 1.0)],
    textures: &[TextureRole::Transmission],
    ..optional!(transmission: Transmission, factor > 0.0)
};

const VOLUME: Layer = Layer {
    factors: &[
        factor!(volume.thickness, "volume thickness", "thicknessFactor", Number, Light::MOST),
        factor!(
            volume.attenuation_distance,
            "attenuation distance",
            "attenuationDistance",
            Number,
            Light::MOST
        ),
        factor!(volume.attenuation_color, "attenuation colour", "attenuationColor", Color, 1.0),
    ],
    textures: &[TextureRole::Thickness],
    ..optional!(volume: Volume, thickness > 0.0)
};

const IRIDESCENCE: Layer = Layer {
    factors: &[
        factor!(iridescence.factor, "iridescence factor", "iridescenceFactor", Number, 1.0),
        factor!(iridescence.ior, "iridescence ior", "iridescenceIor", Number, Light::MOST),
        factor!(
            iridescence.thickness_minimum,
            "iridescence minimum thickness",
            "iridescenceThicknessMinimum",
            Number,
            Light::MOST
        ),
        factor!(
            iridescence.thickness_maximum,
            "iridescence maximum thickness",
            "iridescenceThicknessMaximum",
            Number,
            Light::MOST
        ),
    ],
    textures: &[TextureRole::Iridescence, TextureRole::IridescenceThickness],
    ..optional!(iridescence: Iridescence, factor > 0.0)
};

const DISPERSION: Layer = Layer {
    factors: &[factor!(dispersion.factor, "dispersion", "dispersion", Number, Light::MOST)],
    textures: &[],
    ..optional!(dispersion: Dispersion, factor > 0.0)
};

/// A number with its name.
type NamedNumber = (&'static str, f32);

impl Material {
    /// Checks the material for a scene with this number of `textures`.
    ///
    /// # Errors
    /// The first texture that does not exist, or factor outside the range documented at [`Material`].
    pub(super) fn check(&self, textures: usize) -> Result<(), String> {
        if let Some(lost) = self.textures().into_iter().find(|used| used.texture >= textures) {
            return Err(format!("it refers to texture {}, but there are {textures}", lost.texture));
        }
        if self.textures().iter().any(|used| !used.transform.is_bounded()) {
            return Err(format!(
                "a texture transform has a number beyond the limit of ±{:e}",
                UvTransform::MOST
            ));
        }
        within(&self.fractions(), "between 0 and 1", |v| (0.0..=1.0).contains(&v))?;
        within(&self.amounts(), "between 0 and 1e12", |v| (0.0..=Light::MOST).contains(&v))?;
        within(&self.numbers(), "finite", f32::is_finite)?;
        within(&[("ior", self.ior)], "0, or at least 1", |v| v == 0.0 || (1.0..=f32::MAX).contains(&v))?;
        let slope = self.classic.slope.unwrap_or(1.0);
        within(&[("slope", slope)], "above 0", |v| v > 0.0 && v.is_finite())
    }

    /// Returns true if a layer has a direction, which follows the tangents.
    pub fn has_direction(&self) -> bool {
        self.layer_factors().any(|(_, value)| matches!(value, FactorValue::Angle(_)))
    }

    fn fractions(&self) -> Vec<NamedNumber> {
        let mut factors = vec![
            ("metallic", self.metallic),
            ("roughness", self.roughness),
            ("occlusion strength", self.occlusion_strength),
        ];
        factors.extend(self.layer_numbers().filter(|(factor, _)| factor.most == 1.0).map(named));
        factors
    }

    /// Returns the factors of all layers of the material.
    fn layer_factors(&self) -> impl Iterator<Item = (&'static Factor, FactorValue)> {
        let factors = LAYERS.iter().flat_map(|layer| layer.factors);
        factors.filter_map(|factor| Some((factor, (factor.get)(self)?)))
    }

    fn layer_numbers(&self) -> impl Iterator<Item = (&'static Factor, f32)> {
        self.layer_factors().filter_map(|(factor, value)| match value {
            FactorValue::Number(number) => Some((factor, number)),
            _ => None,
        })
    }

    fn amounts(&self) -> Vec<NamedNumber> {
        let classic = &self.classic;
        let colors = [
            ("f0", self.f0),
            ("f82", self.f82),
            ("emissive", Some(self.emissive)),
            ("ambient", classic.ambient),
            ("diffuse", classic.diffuse),
            ("specular", classic.specular),
        ];
        let of_layers = self.layer_factors().filter_map(|(factor, value)| match value {
            FactorValue::Color(color) => Some((factor.name, Some(color))),
            _ => None,
        });
        let channels =
            |(name, color): (_, Option<[f32; 3]>)| color.into_iter().flatten().map(move |v| (name, v));
        let mut factors: Vec<NamedNumber> = colors.into_iter().chain(of_layers).flat_map(channels).collect();
        factors.extend(self.layer_numbers().filter(|(factor, _)| factor.most > 1.0).map(named));
        factors.extend(self.base_color.map(|v| ("base colour", v)));
        factors.extend(classic.shininess.map(|v| ("shininess", v)));
        if let AlphaMode::Mask(cutoff) = self.alpha {
            factors.push(("alpha cutoff", cutoff));
        }
        factors
    }

    fn numbers(&self) -> Vec<NamedNumber> {
        let maps = TextureRole::ALL.into_iter().filter_map(|role| role.normal_map(self));
        let maps = maps.map(|map| ("normal scale", map.scale));
        let heights = self.height.iter().map(|map| ("height scale", map.scale));
        maps.chain(heights).collect()
    }
}

fn named((factor, number): (&'static Factor, f32)) -> NamedNumber {
    (factor.name, number)
}

fn within(factors: &[NamedNumber], range: &str, holds: impl Fn(f32) -> bool) -> Result<(), String> {
    match factors.iter().find(|(_, value)| !holds(*value)) {
        None => Ok(()),
        Some((name, value)) => Err(format!("its {name} is {value}; it must be {range}")),
    }
}

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
            assert_eq!(
                (layer.is_visible)(&material),
                layer.extension == SPECULAR.extension,
                "{}",
                layer.name
            );
            for factor in layer.factors {
                assert!(members.insert(factor.member), "{}", factor.member);
                let default = (factor.get)(&material).expect("the layer was added");
                (factor.set)(&mut material, default);
                assert_eq!((factor.get)(&material), Some(default), "{}", factor.member);
            }
            assert_eq!(material.check(0), Ok(()), "{}", layer.name);
            for role in layer.textures {
                assert!(members.insert(role.gltf_member()), "{role:?}");
                let is_plain = role.place(&mut material).is_some();
                assert!(is_plain != (*role == TextureRole::ClearcoatNormal), "{role:?}");
            }
            layer.remove(&mut material);
            assert_eq!(material, Material::default(), "{}", layer.extension);
        }
    }
}
