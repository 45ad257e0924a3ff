//! The reflectance models by name: what each of them takes from a material and from the settings.

use super::settings::{GrazingNormals, RenderSettings};
use crate::scene::Material;
use crate::shade::Shading;

/// The facts known of a model before any fragment: where it is a constant, what other models need is not even compiled.
#[derive(Debug, Clone, Copy)]
pub(super) struct Model {
    pub shading: Shading,
    /// `true` where there may be clearcoat, sheen or anisotropy.
    pub layered: bool,
}

impl Model {
    pub(super) fn new(shading: Shading, material: &Material) -> Self {
        let layers =
            material.clearcoat.is_some() || material.sheen.is_some() || material.anisotropy.is_some();
        Self { shading, layered: takes_layers(shading) && layers }
    }
}

/// The settings as the model takes them: models as printed in the paper take no corrections.
///
/// This is the one place that asks whether an image's model is as printed.
pub(super) fn as_taken(settings: &RenderSettings) -> RenderSettings {
    let corrected = !settings.shading.is_printed();
    RenderSettings {
        specular_aa: settings.specular_aa && corrected,
        grazing_normals: if corrected { settings.grazing_normals } else { GrazingNormals::Keep },
        ..settings.clone()
    }
}

/// Says whether the model has clearcoat, sheen and anisotropy.
pub(super) fn takes_layers(shading: Shading) -> bool {
    shading == Shading::Ggx
}

/// Says whether the model multiplies k_s by a Fresnel term made from F0, so that k_s itself is 1 where not authored.
pub(super) fn takes_fresnel(shading: Shading) -> bool {
    is_cook_torrance(shading)
}

/// Says whether the model has a form that adds the light that scatters several times.
pub(super) fn takes_compensation(shading: Shading) -> bool {
    matches!(shading, Shading::Ggx | Shading::CookTorrance)
}

/// Says whether the model has a microfacet lobe, whose directional albedos are in tables.
pub(super) fn takes_albedos(shading: Shading) -> bool {
    takes_compensation(shading) || matches!(shading, Shading::GgxPrinted | Shading::CookTorrancePrinted)
}

/// Says whether reflected light depends on the roughness: slopes and exponents may be given instead.
pub(super) fn takes_roughness(shading: Shading, material: &Material) -> bool {
    match shading {
        Shading::CookTorrance | Shading::CookTorrancePrinted => material.classic.slope.is_none(),
        Shading::Phong | Shading::BlinnPhong => material.classic.shininess.is_none(),
        _ => true,
    }
}

/// Says whether the lobe is Beckmann's.
pub(super) fn is_cook_torrance(shading: Shading) -> bool {
    matches!(shading, Shading::CookTorrance | Shading::CookTorrancePrinted)
}
