//! A scene's textures on a GPU: their formats, with the same values as on the CPU, bit for bit if possible; their mip
//! chains; and their samplers, with wrap and filter modes.

use crate::gpu::{Gpu, Result, TextureSupport};
use half::f16;
use taotie_engine::image::{Encoding, MipFilter, Sampler, TexelFilter, Texels, Texture, Wrap};
use taotie_engine::scene::{Material, Scene, TextureRef};
use wgpu::{AddressMode, FilterMode, MipmapFilterMode, SamplerDescriptor};
use wgpu::{
    Extent3d, Features, TextureDescriptor, TextureDimension, TextureFormat, TextureUsages, TextureView,
};

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

/// The format for a texture: that of its texels if one holds the same values, otherwise 32-bit floats, or 16-bit
/// floats if those cannot be filtered.
fn format(texture: &Texture, support: TextureSupport) -> TextureFormat {
    let TextureSupport { features, is_coarse } = support;
    let is_wide = features.contains(Features::TEXTURE_FORMAT_16BIT_NORM);
    let floats = match features.contains(Features::FLOAT32_FILTERABLE) {
        true => TextureFormat::Rgba32Float,
        false => TextureFormat::Rgba16Float,
    };
    let levels = || (0..texture.levels()).map(|level| texture.level(level).texels());
    if levels().any(|texels| matches!(texels, Texels::F32(_))) {
        return floats;
    }
    let has_bytes = levels().all(|texels| matches!(texels, Texels::U8(_)));
    match texture.encoding() {
        _ if is_wide && (is_coarse || !has_bytes) => TextureFormat::Rgba16Unorm,
        _ if !has_bytes => floats,
        Encoding::Srgb => TextureFormat::Rgba8UnormSrgb,
        Encoding::Linear | Encoding::Normal => TextureFormat::Rgba8Unorm,
    }
}

/// The bytes per texel in one of the formats of [`format`].
fn texel_bytes(format: TextureFormat) -> u32 {
    match format {
        TextureFormat::Rgba32Float => 16,
        TextureFormat::Rgba16Float | TextureFormat::Rgba16Unorm => 8,
        _ => 4,
    }
}

/// The bytes of a level in the format of [`format`], row by row from the top.
fn level_bytes(texture: &Texture, level: usize, format: TextureFormat) -> Vec<u8> {
    let bitmap = texture.level(level);
    let is_without_variance = texture.encoding() == Encoding::Normal && level == 0;
    match (bitmap.texels(), format) {
        (Texels::U8(texels), TextureFormat::Rgba8Unorm | TextureFormat::Rgba8UnormSrgb) => {
            let mut texels = texels.clone();
            clear_alpha(&mut texels, is_without_variance);
            bytemuck::cast_slice(&texels).to_vec()
        }
        (Texels::U8(_), TextureFormat::Rgba16Unorm) if texture.encoding() == Encoding::Srgb => {
            let codes = linear(texture, level).map(|v| v.map(|v| (v * 65535.0).round() as u16));
            bytemuck::cast_slice(&codes.collect::<Vec<_>>()).to_vec()
        }
        // An 8-bit code and a 16-bit code 257 times as large are the same value.
        (Texels::U8(texels), TextureFormat::Rgba16Unorm) => {
            let mut wide: Vec<[u16; 4]> = texels.iter().map(|t| t.map(|v| u16::from(v) * 257)).collect();
            clear_alpha(&mut wide, is_without_variance);
            bytemuck::cast_slice(&wide).to_vec()
        }
        (Texels::U16(texels), TextureFormat::Rgba16Unorm) => {
            let mut texels = texels.clone();
            clear_alpha(&mut texels, is_without_variance);
            bytemuck::cast_slice(&texels).to_vec()
        }
        _ => float_bytes(texture, level, format),
    }
}

/// A single normal has no variance, whatever alpha a file contains.
fn clear_alpha<T: Default>(texels: &mut [[T; 4]], is_without_variance: bool) {
    if is_without_variance {
        texels.iter_mut().for_each(|texel| texel[3] = T::default());
    }
}

/// The linear values of a level, row by row from the top.
fn linear(texture: &Texture, level: usize) -> impl Iterator<Item = [f32; 4]> {
    let (width, height) = texture.level_size(level);
    let places = (0..height as usize).flat_map(move |y| (0..width as usize).map(move |x| (x, y)));
    places.map(move |(x, y)| texture.texel(level, x, y))
}

/// The linear values of a level as floats.
fn float_bytes(texture: &Texture, level: usize, format: TextureFormat) -> Vec<u8> {
    let values = linear(texture, level);
    match format {
        TextureFormat::Rgba32Float => bytemuck::cast_slice(&values.collect::<Vec<_>>()).to_vec(),
        _ => bytemuck::cast_slice(&values.map(|v| v.map(f16::from_f32)).collect::<Vec<_>>()).to_vec(),
    }
}

/// The samplers created so far.
#[derive(Default)]
pub(crate) struct Samplers {
    made: Vec<(Sampler, wgpu::Sampler)>,
}

impl Samplers {
    /// The sampler of these modes.
    pub(crate) fn get(&mut self, gpu: &Gpu, sampler: &Sampler) -> wgpu::Sampler {
        if let Some((_, made)) = self.made.iter().find(|(modes, _)| modes == sampler) {
            return made.clone();
        }
        let made = gpu.device.create_sampler(&descriptor(sampler));
        self.made.push((*sampler, made.clone()));
        made
    }
}

/// The maximum level of detail that still reads only the finest level while distinguishing minification from
/// magnification.
const FINEST_ALONE: f32 = 0.25;

fn descriptor(sampler: &Sampler) -> SamplerDescriptor<'static> {
    let (mipmap_filter, lod_max_clamp) = match sampler.mip {
        MipFilter::None => (MipmapFilterMode::Nearest, FINEST_ALONE),
        MipFilter::Nearest => (MipmapFilterMode::Nearest, 32.0),
        MipFilter::Linear => (MipmapFilterMode::Linear, 32.0),
    };
    SamplerDescriptor {
        address_mode_u: address(sampler.wrap_u),
        address_mode_v: address(sampler.wrap_v),
        mag_filter: filter(sampler.magnify),
        min_filter: filter(sampler.minify),
        mipmap_filter,
        lod_max_clamp,
        ..SamplerDescriptor::default()
    }
}

fn address(wrap: Wrap) -> AddressMode {
    match wrap {
        Wrap::Repeat => AddressMode::Repeat,
        Wrap::Mirror => AddressMode::MirrorRepeat,
        Wrap::Clamp => AddressMode::ClampToEdge,
    }
}

fn filter(filter: TexelFilter) -> FilterMode {
    match filter {
        TexelFilter::Nearest => FilterMode::Nearest,
        TexelFilter::Linear => FilterMode::Linear,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::found;
    use taotie_engine::image::Bitmap;
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

    fn texture(texels: Texels, encoding: Encoding) -> Texture {
        Texture::new(Bitmap::new(2, 2, 4, texels).unwrap(), encoding)
    }

    #[test]
    fn formats_hold_what_the_processor_has() {
        let (bytes, words) = (Texels::U8(vec![[200, 100, 50, 255]; 4]), Texels::U16(vec![[9; 4]; 4]));
        let (some, none) = (Features::FLOAT32_FILTERABLE, Features::empty());
        let wide = Features::TEXTURE_FORMAT_16BIT_NORM;
        let cases = [
            (bytes.clone(), Encoding::Srgb, none, TextureFormat::Rgba8UnormSrgb),
            (bytes.clone(), Encoding::Linear, none, TextureFormat::Rgba8Unorm),
            // Coarser levels of normals have 16 bits.
            (bytes.clone(), Encoding::Normal, wide, TextureFormat::Rgba16Unorm),
            (bytes, Encoding::Normal, none, TextureFormat::Rgba16Float),
            (words.clone(), Encoding::Linear, some | wide, TextureFormat::Rgba16Unorm),
            (words.clone(), Encoding::Linear, some, TextureFormat::Rgba32Float),
            // 16-bit colours are kept as floats.
            (words, Encoding::Srgb, some | wide, TextureFormat::Rgba32Float),
            (Texels::F32(vec![[0.5; 4]; 4]), Encoding::Linear, none, TextureFormat::Rgba16Float),
        ];
        let support = |features, is_coarse| TextureSupport { features, is_coarse };
        for (texels, encoding, features, expected) in cases {
            let found = format(&texture(texels, encoding), support(features, false));
            assert_eq!(found, expected, "{encoding:?} {features:?}");
        }
        let codes = || texture(Texels::U8(vec![[9; 4]; 4]), Encoding::Linear);
        assert_eq!(format(&codes(), support(wide, true)), TextureFormat::Rgba16Unorm);
        assert_eq!(format(&codes(), support(none, true)), TextureFormat::Rgba8Unorm);
        let colors = texture(Texels::U8(vec![[9; 4]; 4]), Encoding::Srgb);
        assert_eq!(format(&colors, support(wide, true)), TextureFormat::Rgba16Unorm);
    }

    #[test]
    fn codes_of_16_bits_are_the_values_of_the_texels() {
        for (encoding, apart) in [(Encoding::Normal, 0.0), (Encoding::Srgb, 0.5 / 65535.0 + 1e-7)] {
            let texture = texture(Texels::U8(vec![[128, 3, 255, 77]; 4]), encoding);
            for level in 0..texture.levels() {
                let bytes = level_bytes(&texture, level, TextureFormat::Rgba16Unorm);
                let code = |b: &[u8]| f32::from(u16::from_ne_bytes([b[0], b[1]])) / 65535.0;
                for (code, value) in bytes.chunks_exact(2).map(code).zip(texture.texel(level, 0, 0)) {
                    assert!((code - value).abs() <= apart, "{encoding:?} {level}: {code} {value}");
                }
                let (width, height) = texture.level_size(level);
                let size = width * height * texel_bytes(TextureFormat::Rgba16Unorm);
                assert_eq!(bytes.len(), size as usize);
            }
        }
    }

    #[test]
    fn modes_are_those_of_the_texture() {
        let sampler = Sampler {
            wrap_u: Wrap::Mirror,
            wrap_v: Wrap::Clamp,
            minify: TexelFilter::Nearest,
            mip: MipFilter::None,
            ..Sampler::default()
        };
        let made = descriptor(&sampler);
        assert_eq!(made.address_mode_u, AddressMode::MirrorRepeat);
        assert_eq!(made.address_mode_v, AddressMode::ClampToEdge);
        assert_eq!((made.mag_filter, made.min_filter), (FilterMode::Linear, FilterMode::Nearest));
        // Only the finest level is read, though minification and magnification are distinguished.
        assert!(made.lod_max_clamp > 0.0 && made.lod_max_clamp < 0.5);
        let levels = descriptor(&Sampler::default());
        assert_eq!((levels.mipmap_filter, levels.lod_max_clamp), (MipmapFilterMode::Linear, 32.0));
    }
}
