//! A texture: a bitmap with its mip chain, decoded to linear values at each lookup.
//!
//! Each level of the chain is the area-weighted mean of the finer one in linear space, computed row by row, in
//! parallel.

use super::codec::{Codec, Texel, decode_u8};
use super::{Bitmap, Encoding, Texels};
use crate::math::{MOST_LANES, Pack, SimdLevel, dispatch_pack};
use crate::parallel;
use fearless_simd::Level;
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
        let decode_u8 = Arc::new(decode_u8(encoding));
        Self { levels: chain(bitmap, encoding).into(), encoding, decode_u8 }
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
            false => Cow::Owned(shrunk(level, self.encoding, (size, at == 0))),
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

/// All levels, starting with the given one. Each halves the size, rounding down.
fn chain(finest: Bitmap, encoding: Encoding) -> Vec<Bitmap> {
    let level = SimdLevel::fastest();
    chain_at(level, finest, encoding)
}

fn chain_at(level: Level, finest: Bitmap, encoding: Encoding) -> Vec<Bitmap> {
    let mut codec = Codec::new(encoding);
    let mut levels = vec![finest];
    while let Some(last) = levels.last()
        && (last.width(), last.height()) != (1, 1)
    {
        let next = halved(level, &codec, last);
        levels.push(next);
        codec.is_finest = false;
    }
    levels
}

/// Returns a level scaled down to `size`, each side to no less than half. `is_finest` is true for the first of a
/// chain.
fn shrunk(bitmap: &Bitmap, encoding: Encoding, (size, is_finest): ([u32; 2], bool)) -> Bitmap {
    let mut codec = Codec::new(encoding);
    codec.is_finest = is_finest;
    sized(SimdLevel::fastest(), &codec, (bitmap, size))
}

/// The next level.
fn halved(level: Level, codec: &Codec, bitmap: &Bitmap) -> Bitmap {
    sized(level, codec, (bitmap, [bitmap.width(), bitmap.height()].map(|side| (side / 2).max(1))))
}

/// The level at a smaller size. 8-bit normals get 16 bits, since a variance is a small difference of lengths.
fn sized(level: Level, codec: &Codec, (bitmap, size): (&Bitmap, [u32; 2])) -> Bitmap {
    let shrink = Shrink::new([bitmap.width(), bitmap.height()], size);
    let texels = match bitmap.texels() {
        Texels::U8(t) if codec.encoding == Encoding::Normal => Texels::U16(shrink.all(level, codec, t)),
        Texels::U8(t) => Texels::U8(shrink.all(level, codec, t)),
        Texels::U16(t) => Texels::U16(shrink.all(level, codec, t)),
        Texels::F32(t) => Texels::F32(shrink.all(level, codec, t)),
    };
    Bitmap::new(size[0], size[1], bitmap.channels(), texels).expect("a size below a valid one is valid")
}

/// The approximate number of texels computed per task.
const TASK: usize = 1 << 14;

/// The texels of a level that contribute to each texel of the next.
struct Shrink {
    /// Width in texels of both levels.
    width: usize,
    half_width: usize,
    columns: Vec<Span>,
    rows: Vec<Span>,
    /// Whether every texel is the plain mean of 2×2.
    is_plain: bool,
}

/// The rows of the finer level from which a band of the next is computed.
struct FinerRows<'a, S> {
    /// All texels of the level.
    texels: &'a [[S; 4]],
    rows: &'a [Span],
}

impl Shrink {
    fn new([width, height]: [u32; 2], [half_width, half_height]: [u32; 2]) -> Self {
        Self {
            width: width as usize,
            half_width: half_width as usize,
            columns: (0..half_width).map(|x| Span::new(x, half_width, width)).collect(),
            rows: (0..half_height).map(|y| Span::new(y, half_height, height)).collect(),
            is_plain: width == 2 * half_width && height == 2 * half_height,
        }
    }

    /// All texels of the next level.
    fn all<S: Texel, T: Texel>(&self, level: Level, codec: &Codec, texels: &[[S; 4]]) -> Vec<[T; 4]> {
        let mut out = vec![[T::default(); 4]; self.half_width * self.rows.len()];
        let rows = TASK.div_ceil(self.half_width);
        parallel::pieces(&mut out, rows * self.half_width, &|i, out| {
            let from = FinerRows { texels, rows: &self.rows[i * rows..] };
            dispatch_pack!(level, P, token => self.band::<P, S, T>(token, codec, &from, out));
        });
        out
    }

    /// Some rows of the next level; the source's rows start with theirs.
    #[inline(always)]
    fn band<P: Pack, S: Texel, T: Texel>(
        &self,
        token: P::Token,
        codec: &Codec,
        from: &FinerRows<'_, S>,
        out: &mut [[T; 4]],
    ) {
        let FinerRows { texels, rows } = *from;
        let room = |width: usize| vec![[0.0; 4]; width.next_multiple_of(MOST_LANES)];
        let mut decoded = [room(self.width), room(self.width), room(self.width)];
        let mut means = room(self.half_width);
        for (row, out) in rows.iter().zip(out.chunks_exact_mut(self.half_width)) {
            for (k, decoded) in decoded.iter_mut().take(row.count).enumerate() {
                let start = (row.first + k) * self.width;
                S::decode::<P>(token, codec, &texels[start..start + self.width], decoded);
            }
            if self.is_plain {
                plain_means(&decoded, &mut means);
            } else {
                self.means(row, &decoded, &mut means);
            }
            T::encode::<P>(token, codec, &mut means, out);
        }
    }

    #[inline(always)]
    fn means(&self, row: &Span, decoded: &[Vec<[f32; 4]>; 3], means: &mut [[f32; 4]]) {
        for (column, mean) in self.columns.iter().zip(means) {
            let mut sum = [0.0; 4];
            for (texels, row_weight) in decoded.iter().zip(row.weights).take(row.count) {
                let texels = &texels[column.first..column.first + column.count];
                for (texel, column_weight) in texels.iter().zip(column.weights) {
                    let weight = row_weight * column_weight;
                    for c in 0..4 {
                        sum[c] += texel[c] * weight;
                    }
                }
            }
            *mean = sum;
        }
    }
}

/// Computes [`Shrink::means`] if every texel is the mean of 2×2, bit for bit.
#[inline(always)]
fn plain_means([top, bottom, _]: &[Vec<[f32; 4]>; 3], means: &mut [[f32; 4]]) {
    let pairs = top.as_chunks::<2>().0.iter().zip(bottom.as_chunks::<2>().0);
    for (mean, ([a, b], [c, d])) in means.iter_mut().zip(pairs) {
        for k in 0..4 {
            mean[k] = 0.0 + a[k] * 0.25 + b[k] * 0.25 + c[k] * 0.25 + d[k] * 0.25;
        }
    }
}

/// The texels of a row or column of one level that a texel of the next covers, with weights that sum to one.
struct Span {
    first: usize,
    count: usize,
    weights: [f32; 3],
}

impl Span {
    /// The texels for texel `i` of `halved` in a row of `size`, which is 1 to 3 times as long.
    fn new(i: u32, halved: u32, size: u32) -> Self {
        let (halved, size) = (f64::from(halved), f64::from(size));
        let start = f64::from(i) * size / halved;
        let end = f64::from(i + 1) * size / halved;
        let width = end - start;
        let first = start.floor() as usize;
        let count = end.ceil() as usize - first;
        let covered = |x: f64| ((end.min(x + 1.0) - start.max(x)) / width) as f32;
        let weights = std::array::from_fn(|k| if k < count { covered((first + k) as f64) } else { 0.0 });
        Self { first, count, weights }
    }
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

    /// Numbers without a pattern, in [0, 2^24).
    fn numbers(count: usize) -> Vec<[u32; 4]> {
        let mut state = 1u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state >> 8
        };
        (0..count).map(|_| std::array::from_fn(|_| next())).collect()
    }

    fn bitmaps(width: u32, height: u32) -> [Bitmap; 3] {
        let numbers = numbers((width * height) as usize);
        let texels = [
            Texels::U8(numbers.iter().map(|t| t.map(|v| v as u8)).collect()),
            Texels::U16(numbers.iter().map(|t| t.map(|v| v as u16)).collect()),
            Texels::F32(numbers.iter().map(|t| t.map(|v| v as f32 / 1e6)).collect()),
        ];
        texels.map(|texels| Bitmap::new(width, height, 4, texels).unwrap())
    }

    #[test]
    fn every_level_gives_the_same_bits() {
        for size in [(64, 32), (37, 23), (1, 9), (300, 2)] {
            for encoding in [Encoding::Srgb, Encoding::Linear, Encoding::Normal] {
                for bitmap in bitmaps(size.0, size.1) {
                    let at = |simd: SimdLevel| chain_at(simd.dispatch().unwrap(), bitmap.clone(), encoding);
                    let expected = at(SimdLevel::Scalar);
                    assert_eq!(expected.last().map(|l| (l.width(), l.height())), Some((1, 1)));
                    for simd in SimdLevel::available() {
                        assert!(at(simd) == expected, "{size:?} {encoding:?} {simd:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn plain_means_are_those_of_the_spans() {
        let level = Level::fallback();
        for encoding in [Encoding::Srgb, Encoding::Linear, Encoding::Normal] {
            let codec = Codec::new(encoding);
            let [_, _, bitmap] = bitmaps(64, 32);
            let Texels::F32(texels) = bitmap.texels() else { panic!("floats") };
            let plain = Shrink::new([64, 32], [32, 16]);
            let spans = Shrink { is_plain: false, ..Shrink::new([64, 32], [32, 16]) };
            let of = |shrink: &Shrink| shrink.all::<f32, f32>(level, &codec, texels);
            assert!(plain.is_plain && of(&plain) == of(&spans), "{encoding:?}");
        }
    }
}
