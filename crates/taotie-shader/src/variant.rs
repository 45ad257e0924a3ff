//! The facts known about a surface before any pixel: which parts of the pixel program it needs.

use std::collections::BTreeMap;
use taotie_engine::pixel::{Model, has_packed_occlusion, takes_compensation, takes_roughness};
use taotie_engine::render::{GrazingNormals, RenderSettings, Surface};
use taotie_engine::scene::{AlphaMode, Material, TextureRef, TextureRole, UvTransform};
use taotie_engine::shade::{Energy, Shading};
use taotie_engine::surface::SurfaceMethod;

/// The facts known about a surface before any pixel.
///
/// Surfaces of the same variant are drawn by the same shader; everything else is in its uniforms and textures.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Variant {
    pub(crate) shading: Shading,
    pub(crate) method: SurfaceMethod,
    pub(crate) authored: Authored,
    pub(crate) layers: Layers,
    pub(crate) textures: BTreeMap<TextureRole, Placement>,
    pub(crate) alpha: Alpha,
    /// Whether light passes through the surface.
    pub(crate) transmits: bool,
    pub(crate) unlit: bool,
    /// Whether occlusion is the red channel of the metallic-roughness texture.
    pub(crate) packed_occlusion: bool,
    pub(crate) vertex_color: bool,
    pub(crate) tangents: bool,
    /// Whether the normal turns with the visible side.
    pub(crate) turns: bool,
    pub(crate) compensated: bool,
    pub(crate) softened: bool,
    pub(crate) specular_aa: bool,
    /// Whether subpixel detail widens the roughness.
    pub(crate) widens: bool,
    pub(crate) environment: bool,
    pub(crate) shadows: bool,
}

/// The choices that determine a [`Variant`], in addition to the material.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VariantOptions {
    /// The reflectance model.
    pub shading: Shading,
    /// The source of shading normals.
    pub method: SurfaceMethod,
    /// `true` to add light scattered several times, for models that support it.
    pub compensated: bool,
    /// `true` to soften mapped normals at grazing angles. Has no effect on models as printed.
    pub softened: bool,
    /// `true` to widen the highlight by subpixel relief. Has no effect on models as printed.
    pub specular_aa: bool,
    /// `true` if there is environment lighting.
    pub environment: bool,
    /// `true` to turn the normal of every surface to the visible side, double-sided or not.
    pub both_sides: bool,
    /// `true` to multiply each light by the host's function `visibility`.
    pub shadows: bool,
    /// `true` if the mesh has vertex colours.
    pub vertex_color: bool,
    /// `true` if the vertices have tangents.
    pub tangents: bool,
    /// The number of uv sets of the mesh; a texture that refers to another reads the texel at the origin.
    pub uv_sets: usize,
}

impl Default for VariantOptions {
    /// The defaults of `taotie render`, with one uv set and tangents, and without an environment.
    fn default() -> Self {
        Self {
            shading: Shading::Ggx,
            method: SurfaceMethod::Smooth,
            compensated: true,
            softened: true,
            specular_aa: true,
            environment: false,
            both_sides: false,
            shadows: false,
            vertex_color: false,
            tangents: true,
            uv_sets: 1,
        }
    }
}

impl VariantOptions {
    /// The options for drawing a surface under some settings, without shadows; `environment` is true if there is
    /// environment lighting.
    ///
    /// ```
    /// use taotie_engine::mesh::Mesh;
    /// use taotie_engine::render::{Prepared, RenderSettings};
    /// use taotie_engine::scene::{Material, Scene};
    /// use taotie_engine::surface::SurfaceMethod;
    /// use taotie_shader::VariantOptions;
    ///
    /// let settings = RenderSettings::default();
    /// let scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default())?;
    /// let prepared = Prepared::new(scene, &settings.surface)?;
    /// let options = VariantOptions::of_surface(&prepared.surfaces()[0], &settings, false);
    /// assert_eq!(options.method, SurfaceMethod::Smooth);
    /// # Ok::<(), taotie_engine::Error>(())
    /// ```
    pub fn of_surface(surface: &Surface<'_>, settings: &RenderSettings, environment: bool) -> Self {
        Self {
            method: surface.normal_source.method(),
            vertex_color: !surface.colors.is_empty(),
            tangents: !surface.tangents.is_empty(),
            uv_sets: surface.uvs.len(),
            ..Self::of_settings(settings, environment)
        }
    }

    /// The options for a plain surface under some settings, without shadows; `environment` is true if there is
    /// environment lighting.
    pub fn of_settings(settings: &RenderSettings, environment: bool) -> Self {
        Self {
            shading: settings.shading,
            compensated: settings.energy == Energy::Compensated,
            softened: settings.grazing_normals == GrazingNormals::Soften,
            specular_aa: settings.specular_aa,
            environment,
            ..Self::default()
        }
    }
}

/// The authored parameters that do not follow from the metallic-roughness values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Authored {
    pub f0: bool,
    pub f82: bool,
    pub ambient: bool,
    pub diffuse: bool,
    pub specular: bool,
    pub slope: bool,
    pub shininess: bool,
}

/// The layers of the material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Layers {
    /// Returns true if the model supports layers and the material has any.
    pub taken: bool,
    pub clearcoat: bool,
    pub sheen: bool,
    pub anisotropy: bool,
}

/// The treatment of alpha.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Alpha {
    Opaque,
    Mask,
    Blend,
}

/// The mapping of a texture onto a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Placement {
    /// The uv set; `None` if the mesh has no such set.
    pub uv_set: Option<usize>,
    /// Whether the uv is transformed.
    pub transformed: bool,
}

impl Variant {
    /// Returns the variant of a material under some options.
    pub fn new(material: &Material, options: &VariantOptions) -> Self {
        let (shading, method) = (options.shading, options.method);
        let corrected = !shading.is_printed();
        let model = Model::new(shading, material);
        Self {
            shading,
            method,
            authored: Authored::new(material),
            layers: Layers {
                taken: model.layered,
                clearcoat: material.clearcoat.is_some(),
                sheen: material.sheen.is_some(),
                anisotropy: material.anisotropy.is_some(),
            },
            textures: placements(material, options),
            alpha: match material.alpha {
                AlphaMode::Opaque => Alpha::Opaque,
                AlphaMode::Mask(_) => Alpha::Mask,
                AlphaMode::Blend => Alpha::Blend,
            },
            transmits: material.transmits(),
            unlit: material.unlit,
            packed_occlusion: has_packed_occlusion(material),
            vertex_color: options.vertex_color,
            tangents: options.tangents,
            turns: material.double_sided || options.both_sides,
            compensated: options.compensated && takes_compensation(shading),
            softened: options.softened && corrected && method.is_mapped(),
            specular_aa: options.specular_aa && corrected,
            widens: options.environment || takes_roughness(shading, material),
            environment: options.environment,
            shadows: options.shadows,
        }
    }

    /// The reflectance model.
    pub fn shading(&self) -> Shading {
        self.shading
    }

    /// The source of shading normals.
    pub fn method(&self) -> SurfaceMethod {
        self.method
    }

    /// Returns true if base colour varies over the surface.
    pub(crate) fn is_tinted(&self) -> bool {
        self.vertex_color || self.textures.contains_key(&TextureRole::BaseColor)
    }

    /// Returns true if there is any occlusion.
    pub(crate) fn is_occluded(&self) -> bool {
        self.packed_occlusion || self.textures.contains_key(&TextureRole::Occlusion)
    }

    /// Returns true if the curvature of the surface within a pixel matters.
    pub(crate) fn has_curvature(&self) -> bool {
        self.specular_aa && self.method != SurfaceMethod::Facet
    }

    /// Returns true if there is any subpixel detail.
    pub(crate) fn has_variance(&self) -> bool {
        self.has_curvature() || self.has_normal_variance()
    }

    /// Returns true if the variance of the normal map matters.
    pub(crate) fn has_normal_variance(&self) -> bool {
        self.specular_aa && self.textures.contains_key(&TextureRole::Normal)
    }

    /// The mapping of a texture, if the material has it.
    pub(crate) fn texture(&self, role: TextureRole) -> Option<Placement> {
        self.textures.get(&role).copied()
    }
}

impl Authored {
    fn new(material: &Material) -> Self {
        let classic = &material.classic;
        Self {
            f0: material.f0.is_some(),
            f82: material.f82.is_some(),
            ambient: classic.ambient.is_some(),
            diffuse: classic.diffuse.is_some(),
            specular: classic.specular.is_some(),
            slope: classic.slope.is_some(),
            shininess: classic.shininess.is_some(),
        }
    }
}

/// The textures that a surface may read, and their mappings.
fn placements(material: &Material, options: &VariantOptions) -> BTreeMap<TextureRole, Placement> {
    let placed = |role: TextureRole| {
        let texture = role.of(material).filter(|_| is_read(role, material, options))?;
        Some((role, Placement::new(texture, options.uv_sets)))
    };
    TextureRole::ALL.into_iter().filter_map(placed).collect()
}

/// Returns true if the method and the mesh allow a texture to be read.
fn is_read(role: TextureRole, material: &Material, options: &VariantOptions) -> bool {
    match role {
        TextureRole::Normal => {
            matches!(options.method, SurfaceMethod::ObjectNormal | SurfaceMethod::TangentNormal)
        }
        TextureRole::Height => matches!(options.method, SurfaceMethod::Bump | SurfaceMethod::BumpPrinted),
        TextureRole::Occlusion => !has_packed_occlusion(material),
        TextureRole::Transmission => material.transmits(),
        TextureRole::Thickness | TextureRole::Iridescence | TextureRole::IridescenceThickness => false,
        _ => true,
    }
}

impl Placement {
    fn new(texture: &TextureRef, uv_sets: usize) -> Self {
        let uv_set = Some(texture.uv_set).filter(|set| *set < uv_sets);
        Self { uv_set, transformed: texture.transform != UvTransform::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::factors::SurfaceFactors;
    use taotie_engine::image::{Bitmap, Encoding, Sampler, Texels, Texture};
    use taotie_engine::mesh::Mesh;
    use taotie_engine::render::{Prepared, SurfaceSettings};
    use taotie_engine::scene::{HeightMap, Scene};

    /// A sphere with a height map of 8 by 8 texels.
    fn raised() -> Scene {
        let bitmap = Bitmap::new(8, 8, 1, Texels::U8(vec![[7, 7, 7, 255]; 64])).unwrap();
        let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default()).unwrap();
        let texture = TextureRef {
            texture: scene.add_texture(Texture::new(bitmap, Encoding::Linear)),
            uv_set: 0,
            sampler: Sampler::default(),
            transform: UvTransform::default(),
        };
        scene.edit(|data| data.materials[0].height = Some(HeightMap { texture, scale: 0.25 })).unwrap();
        scene
    }

    #[test]
    fn surfaces_are_drawn_as_they_are_prepared() {
        for (bump_scale, expected) in [(None, 0.25), (Some(2.0), 2.0)] {
            let surface = SurfaceSettings { bump_scale, ..SurfaceSettings::default() };
            let settings = RenderSettings { specular_aa: false, surface, ..RenderSettings::default() };
            let prepared = Prepared::new(raised(), &settings.surface).unwrap();
            let sphere = &prepared.surfaces()[0];
            let options = VariantOptions::of_surface(sphere, &settings, true);
            assert_eq!((options.method, options.uv_sets), (SurfaceMethod::Bump, 1));
            assert!(options.environment && options.softened && !options.specular_aa && !options.tangents);
            let factors = SurfaceFactors::of_surface(sphere, prepared.scene());
            assert_eq!((factors.bump, factors.height_levels), (expected, 4));
        }
    }
}
