//! A texture: a bitmap with its mip chain, decoded to linear values at each lookup.

use super::{Bitmap, Encoding, Texels, codec, mips};
use crate::parallel;
use std::borrow::Cow;
use std::sync::Arc;

/// A bitmap, its mip chain and the encoding of its channels. Texels stay in stored precision. Copies share them.
#[derive(Debug, Clone)]
pub struct Texture {
    levels: Arc<[Bitmap]>,
    encoding: Encoding,
    decode_u8: Arc<[f32; 256]>,
}

impl Texture {
    /// Builds the mip chain: each level halves the size, rounding down, by the area-weighted mean in linear space.
    /// 16-bit sRGB texels are kept as floats, since half of their precision would be lost otherwise. Levels of
    /// normals use 16 bits, since a variance is a small difference of lengths.
    pub fn new(bitmap: Bitmap, encoding: Encoding) -> Self {
        let bitmap = match (encoding, bitmap.texels()) {
            (Encoding::Srgb, Texels::U16(texels)) => {
                let linear = linear_from_srgb16(&bitmap, texels);
                // Levels are computed without keeping the codes in memory.
                drop(bitmap);
                linear
            }
            _ => bitmap,
        };
        let decode_u8 = Arc::new(codec::decode_u8(encoding));
        Self { levels: mips::chain(bitmap, encoding).into(), encoding, decode_u8 }
    }

    /// The width of the finest level.
    pub fn width(&self) -> u32 {
        self.levels[0].width()
    }

    /// The height of the finest level.
    pub fn height(&self) -> u32 {
        self.levels[0].height()
    }

    /// The finest level as stored.
    pub fn bitmap(&self) -> &Bitmap {
        &self.levels[0]
    }

    /// A level as stored; 0 is the finest.
    ///
    /// # Panics
    /// If the level does not exist.
    #[inline]
    pub fn level(&self, level: usize) -> &Bitmap {
        &self.levels[level]
    }

    /// Returns the texture scaled down to `side` texels along its longer side, computed like mip levels from the next
    /// finer level; the finest level if that has no more. Normals are shorter than 1 wherever they differ.
    pub fn resized(&self, side: u32) -> Cow<'_, Bitmap> {
        let (at, size) = self.resized_from(side);
        let level = &self.levels[at];
        match size == [level.width(), level.height()] {
            true => Cow::Borrowed(level),
            false => Cow::Owned(mips::shrunk(level, self.encoding, (size, at == 0))),
        }
    }

    /// Returns the size of [`Texture::resized`].
    pub fn resized_size(&self, side: u32) -> [u32; 2] {
        self.resized_from(side).1
    }

    /// Returns the index of the next finer level, and the size to compute from it.
    fn resized_from(&self, side: u32) -> (usize, [u32; 2]) {
        let longer = |level: &Bitmap| level.width().max(level.height());
        let at = self.levels.iter().rposition(|level| longer(level) >= side).unwrap_or_default();
        let level = &self.levels[at];
        let (longer, side) = (u64::from(longer(level)), u64::from(side));
        let scaled = |own: u32| (u64::from(own) * side.min(longer)).div_ceil(longer).max(1) as u32;
        (at, [level.width(), level.height()].map(scaled))
    }

    /// The encoding of the stored channels.
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// The number of levels, at least 1.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// Returns the memory that all levels occupy in bytes.
    pub fn bytes(&self) -> u64 {
        self.levels.iter().map(|level| level.texels().bytes()).sum()
    }

    /// Width and height of a level.
    #[inline]
    pub fn level_size(&self, level: usize) -> (u32, u32) {
        (self.levels[level].width(), self.levels[level].height())
    }

    /// The linear RGBA value of a texel.
    #[inline]
    pub fn texel(&self, level: usize, x: usize, y: usize) -> [f32; 4] {
        let [r, g, b, a] = self.stored(level, x, y);
        match (self.encoding, level) {
            (Encoding::Normal, 0) => [r, g, b, 0.0],
            _ => [r, g, b, a],
        }
    }

    /// Returns [`Self::texel`] up to a factor, so that filtering multiplies only once.
    #[inline]
    pub(super) fn unscaled(&self, level: usize, x: usize, y: usize) -> [f32; 4] {
        let bitmap = &self.levels[level];
        let i = y * bitmap.width() as usize + x;
        let [r, g, b, a] = match bitmap.texels() {
            Texels::U8(texels) if self.encoding == Encoding::Srgb => {
                let [r, g, b, a] = texels[i];
                let decode = |v: u8| self.decode_u8[v as usize];
                [decode(r), decode(g), decode(b), f32::from(a)]
            }
            Texels::U8(texels) => texels[i].map(f32::from),
            Texels::U16(texels) => texels[i].map(f32::from),
            Texels::F32(texels) => texels[i],
        };
        match (self.encoding, level) {
            (Encoding::Normal, 0) => [r, g, b, 0.0],
            _ => [r, g, b, a],
        }
    }

    /// The factors of [`Self::unscaled`].
    #[inline]
    pub(super) fn scale(&self, level: usize) -> [f32; 4] {
        match self.levels[level].texels() {
            Texels::U8(_) if self.encoding == Encoding::Srgb => [1.0, 1.0, 1.0, 1.0 / 255.0],
            Texels::U8(_) => [1.0 / 255.0; 4],
            Texels::U16(_) => [1.0 / 65535.0; 4],
            Texels::F32(_) => [1.0; 4],
        }
    }

    #[inline]
    fn stored(&self, level: usize, x: usize, y: usize) -> [f32; 4] {
        let bitmap = &self.levels[level];
        let i = y * bitmap.width() as usize + x;
        match bitmap.texels() {
            Texels::U8(texels) => {
                let [r, g, b, a] = texels[i];
                let decode = |v: u8| self.decode_u8[v as usize];
                [decode(r), decode(g), decode(b), f32::from(a) / 255.0]
            }
            Texels::U16(texels) => texels[i].map(|v| f32::from(v) / 65535.0),
            Texels::F32(texels) => texels[i],
        }
    }
}

fn linear_from_srgb16(bitmap: &Bitmap, texels: &[[u16; 4]]) -> Bitmap {
    let table: Vec<f32> =
        (0..=65535u32).map(|v| crate::math::srgb::linear_from_srgb(f64::from(v) / 65535.0) as f32).collect();
    let linear = parallel::collect(texels.len(), |i| {
        let [r, g, b, a] = texels[i];
        [table[r as usize], table[g as usize], table[b as usize], f32::from(a) / 65535.0]
    });
    Bitmap::new(bitmap.width(), bitmap.height(), bitmap.channels(), Texels::F32(linear))
        .expect("the size is that of a valid bitmap")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mip_levels_keep_the_mean() {
        let texels = (0..15).map(|i| [(i * 16) as u8; 4]).collect();
        let texture = Texture::new(Bitmap::new(5, 3, 4, Texels::U8(texels)).unwrap(), Encoding::Linear);
        assert_eq!(texture.levels(), 3);
        assert_eq!(texture.level_size(1), (2, 1));
        let mean = texture.texel(2, 0, 0)[0] * 255.0;
        assert!((mean - 112.0).abs() <= 1.0, "{mean}");
    }

    #[test]
    fn levels_of_normals_know_how_far_they_diverge() {
        // Two unit vectors 2θ apart have a mean of length cos θ, and the variance sin² θ.
        let (sin, cos) = (0.28f32, 0.96f32);
        let code = |v: f32| ((v + 1.0) * 0.5 * 65535.0).round() as u16;
        let texels = vec![[code(sin), code(0.0), code(cos), 9], [code(-sin), code(0.0), code(cos), 9]];
        let bitmap = Bitmap::new(2, 1, 4, Texels::U16(texels)).unwrap();
        let texture = Texture::new(bitmap, Encoding::Normal);
        assert_eq!(texture.texel(0, 0, 0)[3], 0.0, "a single normal has no variance, whatever its alpha is");
        let [_, _, b, variance] = texture.texel(1, 0, 0);
        assert!((2.0 * b - 1.0 - cos).abs() < 1e-4 && (variance - sin * sin).abs() < 1e-4, "{b} {variance}");
    }

    #[test]
    fn eight_bit_normals_have_finer_levels_and_flat_ones_no_variance() {
        let flat = Bitmap::new(4, 4, 3, Texels::U8(vec![[128, 128, 255, 255]; 16])).unwrap();
        let texture = Texture::new(flat, Encoding::Normal);
        assert!((1..texture.levels()).all(|level| texture.texel(level, 0, 0)[3] < 1e-4));
        assert!(matches!(texture.levels[1].texels(), Texels::U16(_)));
    }

    #[test]
    fn srgb_levels_average_light_not_code_values() {
        let texels = vec![[0, 0, 0, 255], [255, 255, 255, 255]];
        let texture = Texture::new(Bitmap::new(2, 1, 4, Texels::U8(texels)).unwrap(), Encoding::Srgb);
        assert!(matches!(texture.levels[1].texels(), Texels::U8(t) if t[0] == [188, 188, 188, 255]));
    }
}
