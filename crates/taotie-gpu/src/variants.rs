//! The shader variants of surfaces.

use taotie_engine::render::{RenderSettings, Surface};
use taotie_engine::scene::AlphaMode;
use taotie_shader::{Variant, VariantOptions};

/// The facts that a surface's pipeline depends on.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct PipelineKey {
    /// The variant of its shader.
    pub variant: Variant,
    /// `true` if front faces are clockwise.
    pub mirrored: bool,
    /// `true` if back faces are drawn.
    pub double_sided: bool,
    /// `true` if it is blended.
    pub blended: bool,
    /// `true` if its lights cast shadows.
    pub shadows: bool,
}

impl PipelineKey {
    /// The facts of a surface under some settings; `environment` is true if there is one.
    pub(crate) fn new(surface: &Surface<'_>, settings: &RenderSettings, environment: bool) -> Self {
        let shadows = settings.shadows && !surface.material.unlit;
        let options =
            VariantOptions { shadows, ..VariantOptions::of_surface(surface, settings, environment) };
        Self {
            variant: Variant::new(surface.material, &options),
            mirrored: surface.mirrored,
            double_sided: surface.material.double_sided,
            blended: is_blended(surface),
            shadows,
        }
    }
}

/// Returns true if a surface is blended.
pub(crate) fn is_blended(surface: &Surface<'_>) -> bool {
    surface.material.alpha == AlphaMode::Blend
}
