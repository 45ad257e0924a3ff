//! Prepared surfaces of `taotie_engine::render` as variants and their values.

use crate::factors::SurfaceFactors;
use crate::variant::VariantOptions;
use taotie_engine::render::{GrazingNormals, RenderSettings, Surface};
use taotie_engine::scene::{HeightMap, Scene};
use taotie_engine::shade::Energy;

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

impl<'s> SurfaceFactors<'s> {
    /// The factors of a surface of a scene.
    pub fn of_surface(surface: &Surface<'s>, scene: &Scene) -> Self {
        let levels =
            |map: &HeightMap| scene.textures().get(map.texture.texture).map_or(1, |texture| texture.levels());
        let height = surface.normal_source.height_map();
        let (bump, height_levels) = height.map_or((0.0, 1), |(map, factor)| (factor, levels(map)));
        Self { material: surface.material, normal_matrix: surface.normal_matrix, bump, height_levels }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::image::{Bitmap, Encoding, Sampler, Texels, Texture};
    use taotie_engine::mesh::Mesh;
    use taotie_engine::render::{Prepared, SurfaceSettings};
    use taotie_engine::scene::{HeightMap, Material, TextureRef, UvTransform};
    use taotie_engine::surface::SurfaceMethod;

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
