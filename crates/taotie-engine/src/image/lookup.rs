//! Filtered lookup of many points at a time: positions in packs, texels one by one, decoding and filtering in packs.

use super::filter::{Filter, Format, Found, Weights};
use super::sampler::{MipFilter, Sampler, TexelFilter, Wrap};
use super::{Encoding, Texels, Texture};
use crate::math::{BATCH, Column, Lane, Mask, Pack, Quads, Words, dispatch_pack};
use fearless_simd::Level;
use std::ops::Range;

/// A lookup of [`BATCH`] points in textures of one size: levels, texels and weights. It is shared by all textures
/// that have this size and are read with the same sampler at the same positions.
#[derive(Debug, Clone)]
pub struct Lookup {
    len: usize,
    /// 1 to interpolate between texels, 0 to take the nearest.
    smooth: Column,
    fine: Taps,
    coarse: Taps,
    /// The weight of the coarse level in the mean.
    share: Column,
    /// `true` if any point needs the coarse level.
    blended: bool,
    /// The texels last read.
    found: Found,
}

/// The four texels around each point, in one level.
#[derive(Debug, Clone)]
struct Taps {
    level: Words,
    /// Runs of points in one level: the level, and the end of the run.
    runs: Vec<(usize, usize)>,
    /// `true` if no point is between the last texel of a row and the texel that follows by wrapping.
    neighbours: bool,
    width: Column,
    height: Column,
    /// Top left and bottom left: indices into the level.
    place: [Words; 2],
    /// The step from the left texels to the right ones, modulo 2³².
    step: Words,
    weights: Weights,
}

impl Default for Lookup {
    fn default() -> Self {
        let taps = Taps {
            level: Words::ZERO,
            runs: Vec::new(),
            neighbours: false,
            width: Column::ZERO,
            height: Column::ZERO,
            place: [Words::ZERO; 2],
            step: Words::ZERO,
            weights: Weights::ZERO,
        };
        Self {
            len: 0,
            smooth: Column::ZERO,
            fine: taps.clone(),
            coarse: taps,
            share: Column::ZERO,
            blended: false,
            found: [Quads::ZERO; 4],
        }
    }
}

/// Points at which a texture is looked up.
#[derive(Clone, Copy)]
pub struct LookupPoints<'a> {
    /// u and v; origin top left.
    pub uv: [&'a Column; 2],
    /// log2 of the number of finest-level texels covered by a pixel.
    pub lod: &'a Column,
    /// The number of points in the columns, at most [`BATCH`].
    pub len: usize,
}

impl Lookup {
    /// Finds the texels for some points. `texture` is any of the textures to be read.
    pub fn place(&mut self, level: Level, texture: &Texture, sampler: &Sampler, points: LookupPoints<'_>) {
        let LookupPoints { uv, lod, len } = points;
        self.len = len.min(BATCH);
        dispatch_pack!(level, P, token => self.choose_levels::<P>(token, texture, sampler, lod));
        self.blended = self.share[..self.len].iter().any(|share| *share > 0.0);
        let wanted = Wanted { sampler, smooth: &self.smooth, uv, len: self.len };
        for taps in [&mut self.fine].into_iter().chain(self.blended.then_some(&mut self.coarse)) {
            taps.find_runs(self.len);
            dispatch_pack!(level, P, token => taps.place::<P>(token, &wanted));
        }
    }

    /// The linear RGBA values of `texture`, column by column; the last column of `out` is 1 if it has no alpha.
    pub fn read(&mut self, level: Level, texture: &Texture, mut out: [&mut Column; 4]) {
        let alpha = has_alpha(texture);
        let format = self.fine.fetch(texture, &mut self.found);
        let filter = Filter { found: &self.found, format, alpha, len: self.len };
        dispatch_pack!(level, P, token => filter.fill::<P>(token, &self.fine.weights, &mut out));
        if self.blended {
            let format = self.coarse.fetch(texture, &mut self.found);
            let filter = Filter { found: &self.found, format, alpha, len: self.len };
            dispatch_pack!(level, P, token => filter.blend::<P>(token, (&self.coarse.weights, &self.share), &mut out));
        }
    }

    /// Levels with their sizes and shares, as OpenGL 4.6, 8.14.
    #[inline(always)]
    fn choose_levels<P: Pack>(
        &mut self,
        token: P::Token,
        texture: &Texture,
        sampler: &Sampler,
        lod: &Column,
    ) {
        let last = (texture.levels() - 1) as f32;
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
            self.fine.set_level(texture, fine, i);
            self.coarse.set_level(texture, (fine + one).min(last), i);
            share.store(&mut self.share[i..]);
        }
    }
}

/// Points whose texels are to be found.
struct Wanted<'a> {
    sampler: &'a Sampler,
    /// 1 for filtered texels, 0 for the nearest.
    smooth: &'a Column,
    uv: [&'a Column; 2],
    len: usize,
}

impl Taps {
    /// Sets the level of the points from `i` onwards, with its size: each level halves the previous one, rounding
    /// down.
    #[inline(always)]
    fn set_level<P: Pack>(&mut self, texture: &Texture, level: P, i: usize) {
        let halved = |side: u32| level.lit(f64::from(side)).ldexp(-level).floor().max(level.lit(1.0));
        level.store_words(&mut self.level[i..]);
        halved(texture.width()).store(&mut self.width[i..]);
        halved(texture.height()).store(&mut self.height[i..]);
    }

    /// Finds runs of consecutive points in one level.
    fn find_runs(&mut self, len: usize) {
        let levels = &self.level[..len];
        let Some(first) = levels.first() else { return self.runs.clear() };
        self.runs.clear();
        // Usually all points are in one level, which is faster to detect than to search for changes.
        if levels.iter().fold(0, |parted, level| parted | (level ^ first)) == 0 {
            self.runs.push((*first as usize, len));
            return;
        }
        let mut end = 0;
        for same in levels.chunk_by(|a, b| a == b) {
            end += same.len();
            self.runs.push((same[0] as usize, end));
        }
    }

    #[inline(always)]
    fn place<P: Pack>(&mut self, token: P::Token, wanted: &Wanted<'_>) {
        let Wanted { sampler, smooth, uv: [u, v], len } = *wanted;
        self.neighbours = true;
        for i in (0..len).step_by(P::LANES) {
            let smooth = P::load(token, &smooth[i..]);
            let (width, height) = (P::load(token, &self.width[i..]), P::load(token, &self.height[i..]));
            let [left, right, across] = around(sampler.wrap_u, P::load(token, &u[i..]), width, smooth);
            let [top, bottom, down] = around(sampler.wrap_v, P::load(token, &v[i..]), height, smooth);
            // Lanes beyond `len` may also report this, which only costs time.
            let parted = (right - left).lt(P::splat(token, 1.0)).or(P::splat(token, 1.0).lt(right - left));
            self.neighbours &= !parted.any();
            left.store_place(top, width, &mut self.place[0][i..]);
            left.store_place(bottom, width, &mut self.place[1][i..]);
            (right - left).store_words(&mut self.step[i..]);
            across.store(&mut self.weights.across[i..]);
            down.store(&mut self.weights.down[i..]);
        }
    }

    /// Reads the texels.
    fn fetch(&mut self, texture: &Texture, found: &mut Found) -> Format {
        let is_coded = |(level, _): &(usize, usize)| matches!(texture.level(*level).texels(), Texels::U8(_));
        // A texel of the finest level of a normal map has no variance, whatever its alpha is.
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
            self.weights.scale[start..end].fill(texture.scale(level)[0]);
            self.weights.alpha[start..end].fill(if alpha { 1.0 / 255.0 } else { 0.0 });
            let points = Points { taps: self, alpha, span: start..end };
            match stored {
                Texels::U8(texels) if format == Format::Wide => {
                    points.fetch_wide(texels, found, |texel| texel.map(u16::from));
                }
                Texels::U8(texels) => points.fetch_codes(texels, found),
                Texels::U16(texels) => points.fetch_wide(texels, found, |texel| texel),
                Texels::F32(texels) => points.fetch_floats(texels, found),
            }
            start = end;
        }
        format
    }
}

/// Points looked up in one level.
struct Points<'t> {
    taps: &'t Taps,
    /// `true` if the fourth channel matters.
    alpha: bool,
    span: Range<usize>,
}

impl Points<'_> {
    /// 8-bit texels.
    fn fetch_codes(&self, texels: &[[u8; 4]], found: &mut Found) {
        let quads = &mut found[0][self.span.start..][..self.span.len()];
        self.each(texels, |i, four| quads[i] = four.map(|texel| f32::from_bits(u32::from_le_bytes(texel))));
    }

    fn fetch_wide<T: Copy + Default>(&self, texels: &[T], found: &mut Found, codes: impl Fn(T) -> [u16; 4]) {
        let [top, bottom, ..] = found;
        let (start, count) = (self.span.start, self.span.len());
        let (top, bottom) = (&mut top[start..][..count], &mut bottom[start..][..count]);
        let mask = if self.alpha { u64::MAX } else { u64::MAX >> 16 };
        let words = |texel| {
            let [r, g, b, a] = codes(texel).map(u64::from);
            (r | g << 16 | b << 32 | a << 48) & mask
        };
        // Values that fit a register are moved as one.
        let pair = |a, b| {
            let (a, b) = (words(a), words(b));
            [a as u32, (a >> 32) as u32, b as u32, (b >> 32) as u32].map(f32::from_bits)
        };
        self.each(texels, |i, [a, b, c, d]| (top[i], bottom[i]) = (pair(a, b), pair(c, d)));
    }

    fn fetch_floats(&self, texels: &[[f32; 4]], found: &mut Found) {
        self.each(texels, |i, four| {
            for (quads, [r, g, b, a]) in found.iter_mut().zip(four) {
                quads[self.span.start + i] = [r, g, b, if self.alpha { a } else { 0.0 }];
            }
        });
    }

    /// Calls `write` for each point with its index in the span and the four texels around it: top left, top right,
    /// bottom left, bottom right. Missing texels are zero.
    #[inline(always)]
    fn each<T: Copy + Default>(&self, texels: &[T], mut write: impl FnMut(usize, [T; 4])) {
        let count = self.span.len();
        // As long as the output, which avoids bounds checks.
        let [tops, bottoms] = &self.taps.place;
        let (tops, bottoms) = (&tops[self.span.start..][..count], &bottoms[self.span.start..][..count]);
        let two = |place: u32| match texels.get(place as usize..place as usize + 2) {
            Some(&[left, right]) => [left, right],
            _ => Default::default(),
        };
        if self.taps.neighbours {
            for i in 0..count {
                let ([a, b], [c, d]) = (two(tops[i]), two(bottoms[i]));
                write(i, [a, b, c, d]);
            }
            return;
        }
        let one = |place: u32| texels.get(place as usize).copied().unwrap_or_default();
        for (i, step) in self.taps.step[self.span.clone()].iter().enumerate() {
            let (top, bottom) = (tops[i], bottoms[i]);
            let right = |place: u32| one(place.wrapping_add(*step));
            write(i, [one(top), right(top), one(bottom), right(bottom)]);
        }
    }
}

/// The two texels around the coordinate `u` on an axis of `size` texels, and the fraction of the way from the first
/// to the second; if `smooth` is 0, the texel that contains it.
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

/// The texel, in [0, size), at the integral coordinate `i`; 0 for NaN.
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

/// Wraps `i` from [−period, 2 · period) to [0, period).
#[inline(always)]
fn within<L: Lane>(i: L, period: L) -> L {
    let above = L::select(period.le(i), i - period, i);
    L::select(i.lt(i.lit(0.0)), i + period, above)
}

/// Returns true if the fourth channel may differ from 1.
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

    /// Textures of every storage format, of sizes that do not halve evenly.
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
                        let points = LookupPoints { uv: [&u, &v], lod: &lod, len };
                        lookup.place(level, &texture, &sampler, points);
                        lookup.read(level, &texture, out.each_mut());
                        for i in 0..len {
                            let expected = sampler.sample(&texture, Vec2::new(u[i], v[i]), lod[i]);
                            let found = [0, 1, 2, 3].map(|c| out[c][i]);
                            let finite = expected.iter().all(|v| v.is_finite());
                            assert!(
                                !finite || expected == found,
                                "{sampler:?} {i}: {found:?} for {expected:?}"
                            );
                        }
                    }
                }
            }
        }
    }
}
