//! The variants of shaders that surfaces are drawn by.

use taotie::render::{GrazingNormals, NormalSource, RenderSettings, Surface};
use taotie::scene::AlphaMode;
use taotie::shade::Energy;
use taotie_shader::{NormalMethod, SurfaceFactors, Variant, VariantOptions};

/// The facts that a surface's pipeline depends on.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct PipelineKey {
    /// The variant of its shader.
    pub variant: Variant,
    /// `true` where front faces are clockwise.
    pub mirrored: bool,
    /// `true` where back faces are drawn.
    pub double_sided: bool,
    /// `true` where it is laid over what is behind.
    pub blended: bool,
    /// `true` where its lights cast shadows.
    pub shadows: bool,
}

impl PipelineKey {
    /// The facts of a surface under some settings; `environment` tells whether there is one.
    pub(crate) fn new(surface: &Surface<'_>, settings: &RenderSettings, environment: bool) -> Self {
        let shadows = settings.shadows && !surface.material.unlit;
        let options = VariantOptions {
            shading: settings.shading,
            method: method(&surface.normal_source),
            compensated: settings.energy == Energy::Compensated,
            softened: settings.grazing_normals == GrazingNormals::Soften,
            specular_aa: settings.specular_aa,
            environment,
            both_sides: false,
            shadows,
            vertex_color: !surface.colors.is_empty(),
            tangents: !surface.tangents.is_empty(),
            uv_sets: surface.uvs.len(),
        };
        Self {
            variant: Variant::new(surface.material, &options),
            mirrored: surface.mirrored,
            double_sided: surface.material.double_sided,
            blended: is_blended(surface),
            shadows,
        }
    }
}

/// Says whether a surface is laid over what is behind.
pub(crate) fn is_blended(surface: &Surface<'_>) -> bool {
    surface.material.alpha == AlphaMode::Blend
}

fn method(source: &NormalSource) -> NormalMethod {
    match source {
        NormalSource::Facet => NormalMethod::Facet,
        NormalSource::Smooth => NormalMethod::Smooth,
        NormalSource::Bump(..) => NormalMethod::Bump,
        NormalSource::BumpPrinted(..) => NormalMethod::BumpPrinted,
        NormalSource::ObjectMap(_) => NormalMethod::ObjectMap,
        NormalSource::TangentMap(_) => NormalMethod::TangentMap,
    }
}

/// The values of a surface's uniform buffer; `levels` tells how many a texture has.
pub(crate) fn factors<'s>(surface: &Surface<'s>, levels: impl Fn(usize) -> usize) -> SurfaceFactors<'s> {
    let (bump, height_levels) = match surface.normal_source {
        NormalSource::Bump(map, factor) | NormalSource::BumpPrinted(map, factor) => {
            (factor, levels(map.texture.texture))
        }
        _ => (0.0, 1),
    };
    SurfaceFactors { material: surface.material, normal_matrix: surface.normal_matrix, bump, height_levels }
}
