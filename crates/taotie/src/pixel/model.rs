//! The reflectance models by name: which parts of a surface each of them takes.

use crate::scene::Material;
use crate::shade::Shading;

/// The facts known of a model before any point: where it is a constant, what other models need is not even compiled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Model {
    /// The reflectance model.
    pub shading: Shading,
    /// `true` where there may be clearcoat, sheen or anisotropy.
    pub layered: bool,
}

impl Model {
    /// The model of a material.
    pub fn new(shading: Shading, material: &Material) -> Self {
        let layers =
            material.clearcoat.is_some() || material.sheen.is_some() || material.anisotropy.is_some();
        Self { shading, layered: takes_layers(shading) && layers }
    }
}

/// Says whether the model has clearcoat, sheen and anisotropy.
pub fn takes_layers(shading: Shading) -> bool {
    shading == Shading::Ggx
}

/// Says whether the model multiplies k_s by a Fresnel term made from F0, so that k_s itself is 1 where not authored.
pub(super) fn takes_fresnel(shading: Shading) -> bool {
    is_cook_torrance(shading)
}

/// Says whether the model has a form that adds the light that scatters several times.
pub fn takes_compensation(shading: Shading) -> bool {
    matches!(shading, Shading::Ggx | Shading::CookTorrance)
}

/// Says whether the model has a microfacet lobe, whose directional albedos are in tables.
pub fn takes_albedos(shading: Shading) -> bool {
    takes_compensation(shading) || matches!(shading, Shading::GgxPrinted | Shading::CookTorrancePrinted)
}

/// Says whether reflected light depends on the roughness: slopes and exponents may be given instead.
pub fn takes_roughness(shading: Shading, material: &Material) -> bool {
    match shading {
        Shading::CookTorrance | Shading::CookTorrancePrinted => material.classic.slope.is_none(),
        Shading::Phong | Shading::BlinnPhong => material.classic.shininess.is_none(),
        _ => true,
    }
}

/// Says whether the lobe is Beckmann's.
pub fn is_cook_torrance(shading: Shading) -> bool {
    matches!(shading, Shading::CookTorrance | Shading::CookTorrancePrinted)
}
