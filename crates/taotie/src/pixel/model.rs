//! The parts of a surface that each reflectance model supports.

use crate::scene::Material;
use crate::shade::Shading;

/// The facts about a model that are known before any point. If it is a constant, code for other models is not compiled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Model {
    /// The reflectance model.
    pub shading: Shading,
    /// `true` if there may be clearcoat, sheen or anisotropy.
    pub layered: bool,
}

impl Model {
    /// Returns the model of a material.
    pub fn new(shading: Shading, material: &Material) -> Self {
        let layers =
            material.clearcoat.is_some() || material.sheen.is_some() || material.anisotropy.is_some();
        Self { shading, layered: takes_layers(shading) && layers }
    }
}

/// Returns true if the model has clearcoat, sheen and anisotropy.
pub fn takes_layers(shading: Shading) -> bool {
    shading == Shading::Ggx
}

/// Returns true if the model multiplies k_s by a Fresnel term made from F0, so that k_s is 1 unless authored.
pub(super) fn takes_fresnel(shading: Shading) -> bool {
    is_cook_torrance(shading)
}

/// Returns true if the model can add multiple scattering.
pub fn takes_compensation(shading: Shading) -> bool {
    matches!(shading, Shading::Ggx | Shading::CookTorrance)
}

/// Returns true if the model has a microfacet lobe, whose directional albedos are in tables.
pub fn takes_albedos(shading: Shading) -> bool {
    takes_compensation(shading) || matches!(shading, Shading::GgxPrinted | Shading::CookTorrancePrinted)
}

/// Returns true if reflected light depends on the roughness: slopes and exponents may be authored instead.
pub fn takes_roughness(shading: Shading, material: &Material) -> bool {
    match shading {
        Shading::CookTorrance | Shading::CookTorrancePrinted => material.classic.slope.is_none(),
        Shading::Phong | Shading::BlinnPhong => material.classic.shininess.is_none(),
        _ => true,
    }
}

/// Returns true if the lobe is Beckmann's.
pub fn is_cook_torrance(shading: Shading) -> bool {
    matches!(shading, Shading::CookTorrance | Shading::CookTorrancePrinted)
}
