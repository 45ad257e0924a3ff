//! A scene's textures on a GPU.

use crate::error::Result;
use crate::gpu::Gpu;
use crate::texture_format::{format, level_bytes, texel_bytes};
use taotie_engine::image::Texture;
use taotie_engine::scene::{Material, Scene, TextureRef};
use wgpu::{Extent3d, TextureDescriptor, TextureDimension, TextureFormat, TextureUsages, TextureView};

/// A scene's textures with their mip chains, each uploaded when a drawn material refers to it.
pub(crate) struct Textures {
    views: Vec<Option<TextureView>>,
}

impl Textures {
    /// Uploads the textures of `materials`.
    ///
    /// # Errors
    /// [`crate::GpuError::TooLarge`] with the texture's index in the scene, or if memory runs out.
    pub(crate) fn new<'m>(
        gpu: &Gpu,
        scene: &Scene,
        materials: impl IntoIterator<Item = &'m Material>,
    ) -> Result<Self> {
        let mut views: Vec<Option<TextureView>> = scene.textures().iter().map(|_| None).collect();
        for material in materials {
            for TextureRef { texture, .. } in material.textures() {
                if views[texture].is_none() {
                    let what = format!("texture {texture} (of material '{}')", material.name);
                    views[texture] = Some(upload(gpu, &scene.textures()[texture], &what)?);
                }
            }
        }
        Ok(Self { views })
    }

    /// The texture with this index, if it exists.
    pub(crate) fn view(&self, texture: usize) -> Option<&TextureView> {
        self.views.get(texture)?.as_ref()
    }
}

fn upload(gpu: &Gpu, texture: &Texture, what: &str) -> Result<TextureView> {
    let levels = texture.levels() as u32;
    let size = [texture.width(), texture.height()];
    let texels = Texels2d { what, size, levels, format: format(texture, gpu.texture_support()) };
    texels.upload(gpu, |level| level_bytes(texture, level as usize, texels.format))
}

/// The shape of a two-dimensional texture.
#[derive(Clone, Copy)]
pub(crate) struct Texels2d<'a> {
    /// Its name in errors.
    pub what: &'a str,
    /// Width and height in texels.
    pub size: [u32; 2],
    /// The number of mip levels.
    pub levels: u32,
    /// The format, one of those known to [`texel_bytes`].
    pub format: TextureFormat,
}

impl Texels2d<'_> {
    /// Creates a texture from the bytes of each level.
    ///
    /// # Errors
    /// As for [`Textures::new`].
    pub(crate) fn upload(&self, gpu: &Gpu, bytes: impl Fn(u32) -> Vec<u8>) -> Result<TextureView> {
        let texture = self.create(gpu, TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST)?;
        gpu.checked(self.what, || {
            for mip_level in 0..self.levels {
                let [width, height] = self.size.map(|side| (side >> mip_level).max(1));
                let layout = wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(width * texel_bytes(self.format)),
                    rows_per_image: None,
                };
                let place = wgpu::TexelCopyTextureInfo { mip_level, ..texture.as_image_copy() };
                gpu.queue.write_texture(place, &bytes(mip_level), layout, extent([width, height]));
            }
        })?;
        Ok(texture.create_view(&wgpu::TextureViewDescriptor::default()))
    }

    /// Creates a texture without content.
    ///
    /// # Errors
    /// As for [`Textures::new`].
    pub(crate) fn create(&self, gpu: &Gpu, usage: TextureUsages) -> Result<wgpu::Texture> {
        let ([width, height], most) = (self.size, gpu.limits.max_texture_dimension_2d);
        if width.max(height) > most {
            return Err(gpu.too_large(self.what, format!("{width}×{height}"), format!("{most}×{most}")));
        }
        let descriptor = TextureDescriptor {
            label: Some(self.what),
            size: extent(self.size),
            mip_level_count: self.levels,
            sample_count: 1,
            dimension: TextureDimension::D2,
            format: self.format,
            usage,
            view_formats: &[],
        };
        gpu.checked(self.what, || gpu.device.create_texture(&descriptor))
    }
}

/// A two-dimensional size for wgpu.
pub(crate) fn extent([width, height]: [u32; 2]) -> Extent3d {
    Extent3d { width, height, depth_or_array_layers: 1 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::found;
    use taotie_engine::image::{Bitmap, Encoding, Texels};
    use taotie_engine::mesh::Mesh;

    #[test]
    fn a_texture_beyond_the_limit_is_named() {
        let Some(mut gpu) = found() else { return };
        let sampler = taotie_engine::image::Sampler::default();
        let base = TextureRef { texture: 0, uv_set: 0, sampler, transform: Default::default() };
        let bronze =
            Material { name: "bronze".into(), base_color_texture: Some(base), ..Material::default() };
        let bitmap = Bitmap::new(48, 8, 3, Texels::U8(vec![[9; 4]; 48 * 8])).unwrap();
        let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default()).unwrap();
        scene.add_texture(Texture::new(bitmap, Encoding::Srgb));
        let textures = |gpu: &Gpu| Textures::new(gpu, &scene, [&bronze]);
        assert!(textures(&gpu).unwrap().view(0).is_some());
        gpu.limits.max_texture_dimension_2d = 32;
        let refused = textures(&gpu).err().unwrap().to_string();
        assert!(refused.starts_with("texture 0 (of material 'bronze'): too large for "), "{refused}");
        assert!(refused.contains("48×8, at most 32×32"), "{refused}");
    }
}
