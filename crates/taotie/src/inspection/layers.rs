//! The layers that glTF's extensions add to a material.

use crate::scene::Material;

/// The layers that glTF's extensions add to a material.
///
/// ```
/// use taotie::inspection::LayersReport;
///
/// /// Returns `true` if a viewer without extensions shows the same.
/// fn is_plain(layers: &LayersReport) -> bool {
///     layers.ior == 1.5
///         && layers.specular.factor == 1.0
///         && layers.specular.color == [1.0; 3]
///         && layers.clearcoat.is_none()
///         && layers.anisotropy.is_none()
///         && layers.sheen.is_none()
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LayersReport {
    /// Index of refraction of the dielectric part.
    pub ior: f32,
    /// The strength of the dielectric part's reflection.
    pub specular: SpecularReport,
    /// A clearcoat.
    pub clearcoat: Option<ClearcoatReport>,
    /// Anisotropic highlights.
    pub anisotropy: Option<AnisotropyReport>,
    /// The sheen layer.
    pub sheen: Option<SheenReport>,
}

/// The strength of the dielectric part's reflection.
///
/// ```
/// use taotie::inspection::SpecularReport;
///
/// /// Returns `true` if the dielectric part reflects nothing.
/// fn is_dull(specular: &SpecularReport) -> bool {
///     specular.factor == 0.0 || specular.color == [0.0; 3]
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SpecularReport {
    /// [0, 1].
    pub factor: f32,
    /// Linear RGB.
    pub color: [f32; 3],
}

/// A clearcoat.
///
/// ```
/// use taotie::inspection::ClearcoatReport;
///
/// /// Returns `true` if the clearcoat is flat and mirrors.
/// fn is_mirror(coat: &ClearcoatReport) -> bool {
///     coat.normal_scale.is_none() && coat.roughness == 0.0
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ClearcoatReport {
    /// [0, 1].
    pub factor: f32,
    /// [0, 1].
    pub roughness: f32,
    /// The scale of its normal map, if it has one.
    pub normal_scale: Option<f32>,
}

/// Anisotropic highlights.
///
/// ```
/// use taotie::inspection::AnisotropyReport;
///
/// /// Returns `true` if highlights run along the tangent.
/// fn runs_along_tangent(anisotropy: &AnisotropyReport) -> bool {
///     anisotropy.strength > 0.0 && anisotropy.rotation_deg == 0.0
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct AnisotropyReport {
    /// [0, 1].
    pub strength: f32,
    /// Degrees counter-clockwise from the tangent.
    pub rotation_deg: f64,
}

/// A sheen layer.
///
/// ```
/// use taotie::inspection::SheenReport;
///
/// /// Returns the brightest channel of the sheen.
/// fn brightest(sheen: &SheenReport) -> f32 {
///     sheen.color.into_iter().fold(0.0, f32::max)
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SheenReport {
    /// Linear RGB.
    pub color: [f32; 3],
    /// [0, 1].
    pub roughness: f32,
}

impl LayersReport {
    pub(super) fn new(material: &Material) -> Self {
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
}
