//! What glTF's extensions add to a material.

use serde::Serialize;
use taotie::scene::{Material, TextureRef};

/// What glTF's extensions add to a material.
#[derive(Debug, Serialize)]
pub struct LayersReport {
    /// Index of refraction of the dielectric part.
    pub ior: f32,
    /// The strength of the dielectric part's reflection.
    pub specular: SpecularReport,
    /// A clear lacquer.
    pub clearcoat: Option<ClearcoatReport>,
    /// Stretched highlights.
    pub anisotropy: Option<AnisotropyReport>,
    /// Fibres.
    pub sheen: Option<SheenReport>,
}

/// The strength of the dielectric part's reflection.
#[derive(Debug, Serialize)]
pub struct SpecularReport {
    /// [0, 1].
    pub factor: f32,
    /// Linear RGB.
    pub color: [f32; 3],
}

/// A clear lacquer.
#[derive(Debug, Serialize)]
pub struct ClearcoatReport {
    /// [0, 1].
    pub factor: f32,
    /// [0, 1].
    pub roughness: f32,
    /// Of its own normal map, where it has one.
    pub normal_scale: Option<f32>,
}

/// Stretched highlights.
#[derive(Debug, Serialize)]
pub struct AnisotropyReport {
    /// [0, 1].
    pub strength: f32,
    /// Degrees counter-clockwise from the tangent.
    pub rotation_deg: f64,
}

/// Fibres.
#[derive(Debug, Serialize)]
pub struct SheenReport {
    /// Linear RGB.
    pub color: [f32; 3],
    /// [0, 1].
    pub roughness: f32,
}

impl LayersReport {
    /// Of `material`.
    pub fn new(material: &Material) -> Self {
        let specular = &material.specular;
        Self {
            ior: material.ior,
            specular: SpecularReport { factor: specular.factor, color: specular.color },
            clearcoat: material.clearcoat.map(|coat| ClearcoatReport {
                factor: coat.factor,
                roughness: coat.roughness,
                normal_scale: coat.normal.map(|map| map.scale),
            }),
            anisotropy: material.anisotropy.map(|anisotropy| AnisotropyReport {
                strength: anisotropy.strength,
                rotation_deg: anisotropy.rotation.to_degrees(),
            }),
            sheen: material.sheen.map(|sheen| SheenReport { color: sheen.color, roughness: sheen.roughness }),
        }
    }

    /// What differs from a plain material, in words.
    pub fn words(&self) -> Vec<String> {
        let mut words = Vec::new();
        if self.ior != 1.5 {
            words.push(format!("ior {}", self.ior));
        }
        if self.specular.factor != 1.0 {
            words.push(format!("specular factor {}", self.specular.factor));
        }
        if self.specular.color != [1.0; 3] {
            words.push(format!("specular colour {}", color(self.specular.color)));
        }
        if let Some(ClearcoatReport { factor, roughness, normal_scale }) = &self.clearcoat {
            let normal =
                normal_scale.map(|scale| format!(" and normal map scale {scale}")).unwrap_or_default();
            words.push(format!("clearcoat {factor} with roughness {roughness}{normal}"));
        }
        if let Some(AnisotropyReport { strength, rotation_deg }) = &self.anisotropy {
            words.push(format!("anisotropy {strength} at {rotation_deg:.1}°"));
        }
        if let Some(sheen) = &self.sheen {
            words.push(format!("sheen {} with roughness {}", color(sheen.color), sheen.roughness));
        }
        words
    }
}

fn color(color: [f32; 3]) -> String {
    color.map(|v| v.to_string()).join(" ")
}

/// The textures of the layers in their roles.
pub fn textures(material: &Material) -> impl Iterator<Item = (&'static str, Option<TextureRef>)> {
    let specular = &material.specular;
    let (coat, sheen) = (material.clearcoat, material.sheen);
    let roles = [
        ("specular", specular.factor_texture),
        ("specular-color", specular.color_texture),
        ("clearcoat", coat.and_then(|coat| coat.factor_texture)),
        ("clearcoat-roughness", coat.and_then(|coat| coat.roughness_texture)),
        ("clearcoat-normal", coat.and_then(|coat| coat.normal).map(|map| map.texture)),
        ("anisotropy", material.anisotropy.and_then(|anisotropy| anisotropy.texture)),
        ("sheen-color", sheen.and_then(|sheen| sheen.color_texture)),
        ("sheen-roughness", sheen.and_then(|sheen| sheen.roughness_texture)),
    ];
    roles.into_iter()
}
