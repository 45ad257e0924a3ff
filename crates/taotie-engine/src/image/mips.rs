//! Mip chains: each level is the area-weighted mean of the finer one in linear space, computed row by row, in
//! parallel.

use super::codec::{Codec, Texel};
use super::{Bitmap, Encoding, Texels};
use crate::math::{MOST_LANES, Pack, SimdLevel, dispatch_pack};
use crate::parallel;
use fearless_simd::Level;

/// All levels, starting with the given one. Each halves the size, rounding down.
pub(super) fn chain(finest: Bitmap, encoding: Encoding) -> Vec<Bitmap> {
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
pub(super) fn shrunk(bitmap: &Bitmap, encoding: Encoding, (size, is_finest): ([u32; 2], bool)) -> Bitmap {
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
