//! Filtered lookup of many points at once: places in packs, texels one by one, and decoding and filtering in packs.

use super::decode::linear_from_code;
use super::sampler::{MipFilter, Sampler, TexelFilter, Wrap};
use super::{Encoding, Texels, Texture};
use crate::math::{BATCH, COLUMN, Column, Lane, Mask, Pack, Words, dispatch_pack};
use fearless_simd::Level;
use std::ops::Range;

/// The most words of a texel.
const MOST_WORDS: usize = 4;

/// The words of a texel.
type TexelWords = [Words; MOST_WORDS];

/// Of each of the four texels around the points.
type Texel4 = [TexelWords; 4];

/// Where [`BATCH`] points are looked up in textures of one size: levels, texels and weights. It serves every texture
/// that has this size and is read by the same sampler at the same places.
#[derive(Debug, Clone)]
pub struct Lookup {
    len: usize,
    /// 1 where texels are combined by nearness, 0 where the nearest is taken.
    smooth: Column,
    fine: Taps,
    coarse: Taps,
    /// How much of the coarse level is in the mean.
    share: Column,
    /// Whether any point needs the coarse level.
    blended: bool,
    /// What was last read.
    words: Texel4,
}

/// The four texels around each point, in one level.
#[derive(Debug, Clone)]
struct Taps {
    level: Words,
    /// Neighbours of one level: the level, and where they end.
    runs: Vec<(usize, usize)>,
    /// Whether no point lies between the last texel of a row and what follows by wrapping.
    neighbours: bool,
    width: Column,
    height: Column,
    /// Top left, top right, bottom left, bottom right: indices in the level.
    place: [Words; 4],
    /// How far the point is on the way to the right and to the lower texels.
    across: Column,
    down: Column,
    /// What [`Format::Wide`] texels are multiplied by.
    scale: Column,
}

/// How the words of a texel are stored.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Format {
    /// Four codes of 8 bits.
    Codes,
    /// The same, with colour in sRGB.
    Srgb,
    /// Two words with two codes of 16 bits each, or of 8 where the point's level has no more.
    Wide,
    /// Four floats.
    Floats,
}

impl Default for Lookup {
    fn default() -> Self {
        let taps = Taps {
            level: Words::ZERO,
            runs: Vec::new(),
            neighbours: false,
            width: Column::ZERO,
            height: Column::ZERO,
            place: [Words::ZERO; 4],
            across: Column::ZERO,
            down: Column::ZERO,
            scale: Column::ZERO,
        };
        Self {
            len: 0,
            smooth: Column::ZERO,
            fine: taps.clone(),
            coarse: taps,
            share: Column::ZERO,
            blended: false,
            words: [[Words::ZERO; MOST_WORDS]; 4],
        }
    }
}

impl Lookup {
    /// Finds the texels for the first `len` entries of `uv` (origin top left), at most [`BATCH`]; `lod` is log2 of the
    /// texels of the finest level that a pixel covers. `texture` is any of the textures that are to be read.
    pub fn place(
        &mut self,
        level: Level,
        (texture, sampler): (&Texture, &Sampler),
        uv: [&Column; 2],
        lod: &Column,
        len: usize,
    ) {
        self.len = len.min(BATCH);
        let last = (texture.levels() - 1) as f32;
        dispatch_pack!(level, P, token => self.choose_levels::<P>(token, sampler, last, lod));
        self.blended = self.share[..self.len].iter().any(|share| *share > 0.0);
        let smooth = &self.smooth;
        for taps in [&mut self.fine].into_iter().chain(self.blended.then_some(&mut self.coarse)) {
            taps.look_up_sizes(texture, self.len);
            dispatch_pack!(level, P, token => taps.place::<P>(token, sampler, smooth, uv, self.len));
        }
    }

    /// The linear RGBA values of `texture`, column by column; the last of `out`, where it has no alpha, is 1.
    pub fn read(&mut self, level: Level, texture: &Texture, out: [&mut Column; 4]) {
        let alpha = has_alpha(texture);
        let [r, g, b, a] = out;
        if !alpha {
            a.fill(1.0);
        }
        let mut out = [r, g, b, a];
        let channels = if alpha { 4 } else { 3 };
        let format = self.fine.fetch(texture, &mut self.words);
        let filter = Filter { words: &self.words, format, len: self.len };
        dispatch_pack!(level, P, token => filter.fill::<P>(token, &self.fine, &mut out[..channels]));
        if self.blended {
            let format = self.coarse.fetch(texture, &mut self.words);
            let filter = Filter { words: &self.words, format, len: self.len };
            let taps = (&self.coarse, &self.share);
            dispatch_pack!(level, P, token => filter.blend::<P>(token, taps, &mut out[..channels]));
        }
    }

    /// Levels and their shares, as OpenGL 4.6, 8.14.
    #[inline(always)]
    fn choose_levels<P: Pack>(&mut self, token: P::Token, sampler: &Sampler, last: f32, lod: &Column) {
        let smooth = |filter| if filter == TexelFilter::Linear { 1.0 } else { 0.0 };
        let [magnify, minify] = [smooth(sampler.magnify), smooth(sampler.minify)];
        let (magnify, minify) = (P::splat(token, magnify), P::splat(token, minify));
        let (zero, one, half) = (P::splat(token, 0.0), P::splat(token, 1.0), P::splat(token, 0.5));
        let (last, switch) = (P::splat(token, last), P::splat(token, sampler.switch()));
        for i in (0..self.len).step_by(P::LANES) {
            let lod = P::load(token, &lod[i..]);
            let minified = switch.lt(lod);
            let kept = P::select(minified, lod, zero).min(last);
            let fine = match sampler.mip {
                MipFilter::None => zero,
                MipFilter::Nearest => P::select(minified, (kept + half).floor().min(last), zero),
                MipFilter::Linear => kept.floor(),
            };
            let share = if sampler.mip == MipFilter::Linear { kept - fine } else { zero };
            P::select(minified, minify, magnify).store(&mut self.smooth[i..]);
            fine.store_words(&mut self.fine.level[i..]);
            (fine + one).min(last).store_words(&mut self.coarse.level[i..]);
            share.store(&mut self.share[i..]);
        }
    }
}

impl Taps {
    /// Fills the sizes of the levels, and finds neighbours of one level.
    fn look_up_sizes(&mut self, texture: &Texture, len: usize) {
        self.runs.clear();
        let mut start = 0;
        for same in self.level[..len].chunk_by(|a, b| a == b) {
            let (level, end) = (same[0] as usize, start + same.len());
            self.runs.push((level, end));
            // Packs read on beyond the last.
            let end = if end == len { COLUMN } else { end };
            let (width, height) = texture.level_size(level);
            self.width[start..end].fill(width as f32);
            self.height[start..end].fill(height as f32);
            start = end;
        }
    }

    #[inline(always)]
    fn place<P: Pack>(
        &mut self,
        token: P::Token,
        sampler: &Sampler,
        smooth: &Column,
        [u, v]: [&Column; 2],
        len: usize,
    ) {
        self.neighbours = true;
        for i in (0..len).step_by(P::LANES) {
            let smooth = P::load(token, &smooth[i..]);
            let (width, height) = (P::load(token, &self.width[i..]), P::load(token, &self.height[i..]));
            let [left, right, across] = around(sampler.wrap_u, P::load(token, &u[i..]), width, smooth);
            let [top, bottom, down] = around(sampler.wrap_v, P::load(token, &v[i..]), height, smooth);
            // Lanes beyond `len` may say so too; that costs time alone.
            let parted = (right - left).lt(P::splat(token, 1.0)).or(P::splat(token, 1.0).lt(right - left));
            self.neighbours &= !parted.any();
            left.store_place(top, width, &mut self.place[0][i..]);
            right.store_place(top, width, &mut self.place[1][i..]);
            left.store_place(bottom, width, &mut self.place[2][i..]);
            right.store_place(bottom, width, &mut self.place[3][i..]);
            across.store(&mut self.across[i..]);
            down.store(&mut self.down[i..]);
        }
    }

    /// Reads the texels.
    fn fetch(&mut self, texture: &Texture, words: &mut Texel4) -> Format {
        let is_coded = |(level, _): &(usize, usize)| matches!(texture.level(*level).texels(), Texels::U8(_));
        // A texel of the finest level of a normal map has no variance, whatever its alpha says.
        let normals = texture.encoding() == Encoding::Normal;
        let format = match texture.bitmap().texels() {
            Texels::F32(_) => Format::Floats,
            _ if !self.runs.iter().all(is_coded) => Format::Wide,
            _ if texture.encoding() == Encoding::Srgb => Format::Srgb,
            _ => Format::Codes,
        };
        let mut start = 0;
        for (level, end) in self.runs.iter().copied() {
            let (stored, alpha) = (texture.level(level).texels(), !(normals && level == 0));
            self.scale[start..end].fill(texture.scale(level)[0]);
            for (row, words) in words.chunks_exact_mut(2).enumerate() {
                let [left, right] = words else { continue };
                let row = Row {
                    places: [&self.place[2 * row][start..end], &self.place[2 * row + 1][start..end]],
                    neighbours: self.neighbours,
                    alpha,
                };
                let span = start..end;
                match stored {
                    Texels::U8(texels) if format == Format::Wide => {
                        row.fetch_mixed(texels, [left, right], span)
                    }
                    Texels::U8(texels) => row.fetch_codes(texels, [left, right], span),
                    Texels::U16(texels) => row.fetch_wide(texels, [left, right], span),
                    Texels::F32(texels) => row.fetch_floats(texels, [left, right], span),
                }
            }
            start = end;
        }
        format
    }
}

/// The left and right texels of points in one row of texels.
struct Row<'t> {
    places: [&'t [u32]; 2],
    /// Whether the right ones follow the left ones everywhere, so that both are found at once.
    neighbours: bool,
    /// Whether the fourth channel counts.
    alpha: bool,
}

/// What is read of the two texels of each point.
type Pair<'w> = [&'w mut TexelWords; 2];

impl Row<'_> {
    /// Texels of 8 bits.
    fn fetch_codes(&self, texels: &[[u8; 4]], pair: Pair<'_>, span: Range<usize>) {
        let mask = if self.alpha { u32::MAX } else { 0x00ff_ffff };
        self.fetch(texels, pair, span, |texel| [u32::from_le_bytes(texel) & mask]);
    }

    /// Texels of 8 bits among others of 16.
    fn fetch_mixed(&self, texels: &[[u8; 4]], pair: Pair<'_>, span: Range<usize>) {
        let mask = if self.alpha { u32::MAX } else { 0xffff };
        self.fetch(texels, pair, span, |[r, g, b, a]| {
            [u32::from(r) | u32::from(g) << 16, (u32::from(b) | u32::from(a) << 16) & mask]
        });
    }

    fn fetch_wide(&self, texels: &[[u16; 4]], pair: Pair<'_>, span: Range<usize>) {
        let mask = if self.alpha { u32::MAX } else { 0xffff };
        self.fetch(texels, pair, span, |[r, g, b, a]| {
            [u32::from(r) | u32::from(g) << 16, (u32::from(b) | u32::from(a) << 16) & mask]
        });
    }

    fn fetch_floats(&self, texels: &[[f32; 4]], pair: Pair<'_>, span: Range<usize>) {
        self.fetch(texels, pair, span, |[r, g, b, a]| {
            [r, g, b, if self.alpha { a } else { 0.0 }].map(f32::to_bits)
        });
    }

    /// Writes the words of each point's texels; what is not there is zero.
    #[inline(always)]
    fn fetch<T: Copy + Default, const N: usize>(
        &self,
        texels: &[T],
        [left, right]: Pair<'_>,
        span: Range<usize>,
        words: impl Fn(T) -> [u32; N],
    ) {
        let ([left_places, right_places], count) = (self.places, span.len());
        let (left, right) = (columns::<N>(left, &span), columns::<N>(right, &span));
        // As long as that, which the compiler cannot know.
        let (left_places, right_places) = (&left_places[..count], &right_places[..count]);
        for i in 0..count {
            let place = left_places[i] as usize;
            let [a, b] = match self.neighbours {
                true => texels.get(place + 1).map_or_else(Default::default, |b| [texels[place], *b]),
                false => {
                    [place, right_places[i] as usize].map(|p| texels.get(p).copied().unwrap_or_default())
                }
            };
            let (a, b) = (words(a), words(b));
            for n in 0..N {
                left[n][i] = a[n];
                right[n][i] = b[n];
            }
        }
    }
}

/// A part of the first columns of words.
fn columns<'w, const N: usize>(texel: &'w mut TexelWords, span: &Range<usize>) -> [&'w mut [u32]; N] {
    let mut words = texel.iter_mut();
    std::array::from_fn(|_| words.next().map_or(&mut [][..], |words| &mut words[span.clone()]))
}

/// What was read, to be filtered within its level.
struct Filter<'w> {
    words: &'w Texel4,
    format: Format,
    len: usize,
}

impl Filter<'_> {
    /// Writes the channels at all points.
    #[inline(always)]
    fn fill<P: Pack>(&self, token: P::Token, taps: &Taps, out: &mut [&mut Column]) {
        match self.format {
            Format::Codes => self.each::<P, Code, Fill>(token, (taps, &taps.across), out),
            Format::Srgb => self.each::<P, SrgbCode, Fill>(token, (taps, &taps.across), out),
            Format::Wide => self.each::<P, WideCode, Fill>(token, (taps, &taps.across), out),
            Format::Floats => self.each::<P, Float, Fill>(token, (taps, &taps.across), out),
        }
    }

    /// Goes by `share` from what `out` holds to this level's.
    #[inline(always)]
    fn blend<P: Pack>(&self, token: P::Token, taps: (&Taps, &Column), out: &mut [&mut Column]) {
        match self.format {
            Format::Codes => self.each::<P, Code, Blend>(token, taps, out),
            Format::Srgb => self.each::<P, SrgbCode, Blend>(token, taps, out),
            Format::Wide => self.each::<P, WideCode, Blend>(token, taps, out),
            Format::Floats => self.each::<P, Float, Blend>(token, taps, out),
        }
    }

    #[inline(always)]
    fn each<P: Pack, T: Stored, W: Way>(
        &self,
        token: P::Token,
        (taps, share): (&Taps, &Column),
        out: &mut [&mut Column],
    ) {
        let [top_left, top_right, bottom_left, bottom_right] = self.words;
        for (channel, out) in out.iter_mut().enumerate() {
            for i in (0..self.len).step_by(P::LANES) {
                let (across, down) = (P::load(token, &taps.across[i..]), P::load(token, &taps.down[i..]));
                let left: P = T::load(token, top_left, channel, i);
                let top = mix(left, T::load(token, top_right, channel, i), across);
                let left: P = T::load(token, bottom_left, channel, i);
                let bottom = mix(left, T::load(token, bottom_right, channel, i), across);
                let mean = mix(top, bottom, down) * T::scale(token, taps, channel, i);
                W::lay(token, mean, share, out, i).store(&mut out[i..]);
            }
        }
    }
}

/// What becomes of filtered values.
trait Way {
    fn lay<P: Pack>(token: P::Token, mean: P, share: &Column, out: &Column, i: usize) -> P;
}

struct Fill;

impl Way for Fill {
    #[inline(always)]
    fn lay<P: Pack>(_: P::Token, mean: P, _: &Column, _: &Column, _: usize) -> P {
        mean
    }
}

struct Blend;

impl Way for Blend {
    #[inline(always)]
    fn lay<P: Pack>(token: P::Token, mean: P, share: &Column, out: &Column, i: usize) -> P {
        mix(P::load(token, &out[i..]), mean, P::load(token, &share[i..]))
    }
}

/// A way of storing channels.
trait Stored {
    /// What loaded numbers are multiplied by.
    fn scale<P: Pack>(token: P::Token, taps: &Taps, channel: usize, i: usize) -> P;
    /// A channel of the points from `i` on.
    fn load<P: Pack>(token: P::Token, words: &[Words; MOST_WORDS], channel: usize, i: usize) -> P;
}

struct Code;

impl Stored for Code {
    #[inline(always)]
    fn scale<P: Pack>(token: P::Token, _: &Taps, _: usize, _: usize) -> P {
        P::splat(token, 1.0 / 255.0)
    }
    #[inline(always)]
    fn load<P: Pack>(token: P::Token, words: &[Words; MOST_WORDS], channel: usize, i: usize) -> P {
        P::load_byte(token, &words[0][i..], channel as u32)
    }
}

struct SrgbCode;

impl Stored for SrgbCode {
    #[inline(always)]
    fn scale<P: Pack>(token: P::Token, _: &Taps, channel: usize, _: usize) -> P {
        P::splat(token, if channel == 3 { 1.0 / 255.0 } else { 1.0 })
    }
    #[inline(always)]
    fn load<P: Pack>(token: P::Token, words: &[Words; MOST_WORDS], channel: usize, i: usize) -> P {
        let code = P::load_byte(token, &words[0][i..], channel as u32);
        if channel == 3 { code } else { linear_from_code(code) }
    }
}

struct WideCode;

impl Stored for WideCode {
    #[inline(always)]
    fn scale<P: Pack>(token: P::Token, taps: &Taps, _: usize, i: usize) -> P {
        P::load(token, &taps.scale[i..])
    }
    #[inline(always)]
    fn load<P: Pack>(token: P::Token, words: &[Words; MOST_WORDS], channel: usize, i: usize) -> P {
        P::load_half(token, &words[channel / 2][i..], channel as u32 % 2)
    }
}

struct Float;

impl Stored for Float {
    #[inline(always)]
    fn scale<P: Pack>(token: P::Token, _: &Taps, _: usize, _: usize) -> P {
        P::splat(token, 1.0)
    }
    #[inline(always)]
    fn load<P: Pack>(token: P::Token, words: &[Words; MOST_WORDS], channel: usize, i: usize) -> P {
        P::load_bits(token, &words[channel][i..])
    }
}

/// The two texels around the coordinate `u` on an axis of `size` texels, and how far it is from the first to the
/// second; where `smooth` is 0, the one it lies in.
#[inline(always)]
fn around<L: Lane>(wrap: Wrap, u: L, size: L, smooth: L) -> [L; 3] {
    let reduced = match wrap {
        Wrap::Repeat => u - u.floor(),
        Wrap::Mirror => u - u.lit(2.0) * (u * u.lit(0.5)).floor(),
        Wrap::Clamp => u.clamp(-1.0, 2.0),
    };
    let x = reduced * size - u.lit(0.5) * smooth;
    let first = x.floor();
    let second = first + u.lit(1.0);
    let share = L::select(smooth.lt(u.lit(0.5)), u.lit(0.0), x - first);
    [wrapped(wrap, first, size), wrapped(wrap, second, size), share]
}

/// The texel, [0, size), that the integral coordinate `i` stands for; 0 for what is no number.
#[inline(always)]
fn wrapped<L: Lane>(wrap: Wrap, i: L, size: L) -> L {
    let (zero, one) = (i.lit(0.0), i.lit(1.0));
    let index = match wrap {
        Wrap::Clamp => i,
        Wrap::Repeat => within(i, size),
        Wrap::Mirror => {
            let double = size + size;
            let j = within(i, double);
            L::select(j.lt(size), j, double - one - j)
        }
    };
    index.max(zero).min(size - one)
}

/// `i` in [−period, 2 · period) brought into [0, period).
#[inline(always)]
fn within<L: Lane>(i: L, period: L) -> L {
    let above = L::select(period.le(i), i - period, i);
    L::select(i.lt(i.lit(0.0)), i + period, above)
}

#[inline(always)]
fn mix<L: Lane>(a: L, b: L, t: L) -> L {
    a + (b - a) * t
}

/// Whether the fourth channel may be anything but 1.
fn has_alpha(texture: &Texture) -> bool {
    texture.encoding() == Encoding::Normal || matches!(texture.bitmap().channels(), 2 | 4)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Bitmap;
    use crate::math::{SimdLevel, Vec2};

    const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
    const FILTERS: [TexelFilter; 2] = [TexelFilter::Nearest, TexelFilter::Linear];
    const MIPS: [MipFilter; 3] = [MipFilter::None, MipFilter::Nearest, MipFilter::Linear];

    /// Textures of every way of storing, of sizes that do not halve evenly.
    fn textures() -> Vec<Texture> {
        let noise = |i: usize| (i as u32).wrapping_mul(0x9e37_79b9) ^ 0x5bd1_e995;
        let count = 13 * 10;
        let bytes: Vec<[u8; 4]> = (0..count).map(|i| noise(i).to_le_bytes()).collect();
        let wide = bytes.iter().map(|t| t.map(|v| u16::from(v) * 199)).collect();
        let floats = bytes.iter().map(|t| t.map(|v| f32::from(v) * 0.03)).collect();
        let bitmap = |texels| Bitmap::new(13, 10, 4, texels).unwrap();
        let opaque = bytes.iter().map(|[r, g, b, _]| [*r, *g, *b, 255]).collect();
        let opaque = Bitmap::new(13, 10, 3, Texels::U8(opaque)).unwrap();
        vec![
            Texture::new(opaque.clone(), Encoding::Srgb),
            Texture::new(opaque, Encoding::Normal),
            Texture::new(bitmap(Texels::U8(bytes.clone())), Encoding::Srgb),
            Texture::new(bitmap(Texels::U8(bytes.clone())), Encoding::Linear),
            Texture::new(bitmap(Texels::U8(bytes)), Encoding::Normal),
            Texture::new(bitmap(Texels::U16(wide)), Encoding::Normal),
            Texture::new(bitmap(Texels::F32(floats)), Encoding::Linear),
        ]
    }

    fn samplers() -> Vec<Sampler> {
        let mut samplers = Vec::new();
        for wrap_u in WRAPS {
            for (wrap_v, magnify) in WRAPS.into_iter().zip([FILTERS[0], FILTERS[1], FILTERS[1]]) {
                for minify in FILTERS {
                    samplers.extend(MIPS.map(|mip| Sampler { wrap_u, wrap_v, magnify, minify, mip }));
                }
            }
        }
        samplers
    }

    #[test]
    fn many_points_get_what_each_gets_alone() {
        let (mut u, mut v, mut lod) = (Column::ZERO, Column::ZERO, Column::ZERO);
        for i in 0..BATCH {
            let t = i as f32 * 0.618_034;
            u[i] = (t - t.floor()) * 6.0 - 3.0;
            v[i] = (i % 23) as f32 / 11.0 - 0.5;
            lod[i] = (i % 37) as f32 / 6.0 - 1.0;
        }
        (u[3], v[4], lod[5], u[6], lod[7]) = (f32::NAN, f32::INFINITY, f32::NAN, 1e30, f32::INFINITY);
        for level in SimdLevel::available() {
            let level = level.dispatch().unwrap();
            let (mut lookup, mut out) = (Lookup::default(), [Column::ZERO; 4]);
            for texture in textures() {
                for sampler in samplers() {
                    for len in [BATCH, 37] {
                        lookup.place(level, (&texture, &sampler), [&u, &v], &lod, len);
                        lookup.read(level, &texture, out.each_mut());
                        for i in 0..len {
                            let alone = sampler.sample(&texture, Vec2::new(u[i], v[i]), lod[i]);
                            let found = [0, 1, 2, 3].map(|c| out[c][i]);
                            let finite = alone.iter().all(|v| v.is_finite());
                            assert!(!finite || alone == found, "{sampler:?} {i}: {found:?} for {alone:?}");
                        }
                    }
                }
            }
        }
    }
}
