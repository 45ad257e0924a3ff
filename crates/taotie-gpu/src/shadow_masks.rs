//! The holes of surfaces, through which shadow rays pass.

use crate::error::Result;
use crate::gpu::Gpu;
use std::collections::HashMap;
use taotie_engine::image::{Sampler, TexelFilter, Texture, Wrap};
use taotie_engine::math::Vec2;
use taotie_engine::render::Surface;
use taotie_engine::scene::{AlphaMode, TextureRef};
use wgpu::Buffer;

/// The masks of a scene's surfaces. A shader that draws one surface cannot read the textures of another, so their
/// opacities are numbers in a buffer.
#[derive(Default)]
pub(crate) struct ShadowMasks {
    /// Size, wrap modes, first texel, filter, factor, cutoff, and whether and where vertices have opacities; floats
    /// as bits.
    masks: Vec<[u32; 10]>,
    /// Opacities of texels and vertices.
    opacities: Vec<f32>,
    /// The index of the first texel of a texture's finest level.
    texels: HashMap<usize, u32>,
}

impl ShadowMasks {
    /// Adds the mask of a surface whose vertices start at index `first`; returns the mask's index.
    pub(crate) fn add(&mut self, textures: &[Texture], surface: &Surface<'_>, first: u32) -> u32 {
        let used = surface.material.base_color_texture.as_ref();
        let size = used.map_or((0, 0), |used| textures[used.texture].level_size(0));
        let texel = used.map_or(0, |used| self.texel(textures, used.texture));
        let sampler = used.map_or(Sampler::default(), |used| used.sampler);
        let cutoff = match surface.material.alpha {
            AlphaMode::Mask(cutoff) => cutoff,
            AlphaMode::Opaque | AlphaMode::Blend => 0.0,
        };
        let color = self.place().wrapping_sub(first);
        self.opacities.extend(surface.colors.iter().map(|color| color[3]));
        self.masks.push([
            size.0,
            size.1,
            wrap(sampler.wrap_u),
            wrap(sampler.wrap_v),
            texel,
            u32::from(sampler.magnify == TexelFilter::Linear),
            surface.material.base_color[3].to_bits(),
            cutoff.to_bits(),
            u32::from(!surface.colors.is_empty()),
            color,
        ]);
        self.masks.len() as u32 - 1
    }

    /// The coordinates of a vertex in the texture that cuts holes.
    pub(crate) fn uv(surface: &Surface<'_>, vertex: usize) -> [f32; 2] {
        let Some(TextureRef { uv_set, transform, .. }) = &surface.material.base_color_texture else {
            return [0.0; 2];
        };
        let uv = surface.uvs.get(*uv_set).map_or(Vec2::default(), |uvs| uvs[vertex]);
        let Vec2 { x, y } = transform.apply(uv);
        [x, y]
    }

    /// Uploads masks and opacities, at least one of each.
    ///
    /// # Errors
    /// [`crate::GpuError::TooLarge`], or if memory runs out.
    pub(crate) fn upload(mut self, gpu: &Gpu) -> Result<[Buffer; 2]> {
        self.masks.resize(self.masks.len().max(1), [0; 10]);
        self.opacities.resize(self.opacities.len().max(1), 0.0);
        Ok([
            gpu.storage("the masks of shadows", bytemuck::cast_slice(&self.masks))?,
            gpu.storage("the opacities of surfaces with holes", bytemuck::cast_slice(&self.opacities))?,
        ])
    }

    /// The index of a texture's first texel.
    fn texel(&mut self, textures: &[Texture], number: usize) -> u32 {
        if let Some(place) = self.texels.get(&number) {
            return *place;
        }
        let (place, texture) = (self.place(), &textures[number]);
        let (width, height) = texture.level_size(0);
        let all = (0..height as usize).flat_map(|y| (0..width as usize).map(move |x| (x, y)));
        self.opacities.extend(all.map(|(x, y)| texture.texel(0, x, y)[3]));
        self.texels.insert(number, place);
        place
    }

    /// The index of the next opacity.
    fn place(&self) -> u32 {
        self.opacities.len() as u32
    }
}

fn wrap(wrap: Wrap) -> u32 {
    match wrap {
        Wrap::Repeat => 0,
        Wrap::Mirror => 1,
        Wrap::Clamp => 2,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::image::{Bitmap, Encoding, Texels};
    use taotie_engine::mesh::Mesh;
    use taotie_engine::render::{Prepared, SurfaceSettings};
    use taotie_engine::scene::{Material, Scene, UvTransform};

    #[test]
    fn textures_are_there_once_and_vertices_follow() {
        let texels = Texels::U8((0..6).map(|i| [9, 9, 9, 51 * i]).collect());
        let texture = Texture::new(Bitmap::new(3, 2, 4, texels).unwrap(), Encoding::Srgb);
        let transform = UvTransform { offset: [0.25, 0.5], ..UvTransform::default() };
        let sampler = Sampler { wrap_v: Wrap::Clamp, magnify: TexelFilter::Nearest, ..Sampler::default() };
        let holes = Material {
            alpha: AlphaMode::Mask(0.5),
            base_color_texture: Some(TextureRef { texture: 0, uv_set: 0, sampler, transform }),
            ..Material::default()
        };
        let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default()).unwrap();
        scene.add_texture(texture);
        scene.edit(|scene| scene.materials = vec![holes]).unwrap();
        let prepared = Prepared::new(scene, &SurfaceSettings::default()).unwrap();
        let surface = &prepared.surfaces()[0];
        let mut masks = ShadowMasks::default();
        let textures = prepared.scene().textures();
        assert_eq!([masks.add(textures, surface, 0), masks.add(textures, surface, 40)], [0, 1]);
        let [half, one] = [0.5f32, 1.0].map(f32::to_bits);
        assert_eq!(masks.masks[0], [3, 2, 0, 2, 0, 0, one, half, 0, 6]);
        assert_eq!(masks.masks[1][4], 0, "the texture was already added");
        assert_eq!(masks.opacities, [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]);
        let uv = surface.uvs[0][3];
        assert_eq!(ShadowMasks::uv(surface, 3), [uv.x + 0.25, uv.y + 0.5]);
    }
}
