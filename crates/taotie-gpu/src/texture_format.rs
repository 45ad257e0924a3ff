//! The formats of textures on a GPU: the same values as on the CPU, bit for bit if possible.

use half::f16;
use taotie_engine::image::{Encoding, Texels, Texture};
use wgpu::{Features, TextureFormat};

/// The texture capabilities of a GPU.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TextureSupport {
    /// Its features.
    pub features: Features,
    /// `true` if 8-bit texels are filtered with 8 bits and decoded with an approximation of sRGB, as software
    /// implementations do.
    pub is_coarse: bool,
}

/// The format for a texture: that of its texels if one holds the same values, otherwise 32-bit floats, or 16-bit
/// floats if those cannot be filtered.
pub(crate) fn format(texture: &Texture, support: TextureSupport) -> TextureFormat {
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
pub(crate) fn texel_bytes(format: TextureFormat) -> u32 {
    match format {
        TextureFormat::Rgba32Float => 16,
        TextureFormat::Rgba16Float | TextureFormat::Rgba16Unorm => 8,
        _ => 4,
    }
}

/// The bytes of a level in the format of [`format`], row by row from the top.
pub(crate) fn level_bytes(texture: &Texture, level: usize, format: TextureFormat) -> Vec<u8> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::image::Bitmap;

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
}
