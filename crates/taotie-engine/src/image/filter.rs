//! Decodes and filters the texels of many points in packs, for every storage format.

use super::codec::linear_from_code;
use crate::math::{Column, Lane, Pack, Quads};

/// The four texels read around each point, as the bits of floats; see [`Format`].
pub(super) type Found = [Quads; 4];

/// The storage format of texels, and the order in [`Found`] of those around a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Format {
    /// Four 8-bit codes: all four texels are the first quad.
    Codes,
    /// The same, with colour in sRGB.
    Srgb,
    /// Four 16-bit codes, or 8-bit ones if the point's level has no more: the first quad has the upper two texels,
    /// the second the lower two.
    Wide,
    /// Four floats: a quad each.
    Floats,
}

/// The weights of the texels around points, in one level.
#[derive(Debug, Clone)]
pub(super) struct Weights {
    /// The fraction of the way to the right texels; `down` is the fraction to the lower ones.
    pub across: Column,
    pub down: Column,
    /// The factor of filtered values of [`Format::Wide`], and of the fourth channel of [`Format::Codes`] and
    /// [`Format::Srgb`].
    pub scale: Column,
    pub alpha: Column,
}

impl Weights {
    pub(super) const ZERO: Self =
        Self { across: Column::ZERO, down: Column::ZERO, scale: Column::ZERO, alpha: Column::ZERO };
}

/// The texels read, to be filtered within their level.
pub(super) struct Filter<'w> {
    pub found: &'w Found,
    pub format: Format,
    /// Returns true if the fourth channel may differ from 1.
    pub alpha: bool,
    pub len: usize,
}

impl Filter<'_> {
    /// Writes the channels of all points.
    #[inline(always)]
    pub(super) fn fill<P: Pack>(&self, token: P::Token, weights: &Weights, out: &mut [&mut Column; 4]) {
        match self.format {
            Format::Codes => self.each::<P, Code, Fill>(token, (weights, &weights.across), out),
            Format::Srgb => self.each::<P, SrgbCode, Fill>(token, (weights, &weights.across), out),
            Format::Wide => self.each::<P, WideCode, Fill>(token, (weights, &weights.across), out),
            Format::Floats => self.each::<P, Float, Fill>(token, (weights, &weights.across), out),
        }
    }

    /// Blends by `share` from the content of `out` to this level.
    #[inline(always)]
    pub(super) fn blend<P: Pack>(
        &self,
        token: P::Token,
        weights: (&Weights, &Column),
        out: &mut [&mut Column; 4],
    ) {
        match self.format {
            Format::Codes => self.each::<P, Code, Blend>(token, weights, out),
            Format::Srgb => self.each::<P, SrgbCode, Blend>(token, weights, out),
            Format::Wide => self.each::<P, WideCode, Blend>(token, weights, out),
            Format::Floats => self.each::<P, Float, Blend>(token, weights, out),
        }
    }

    #[inline(always)]
    fn each<P: Pack, T: Stored, W: Way>(
        &self,
        token: P::Token,
        (weights, share): (&Weights, &Column),
        [r, g, b, a]: &mut [&mut Column; 4],
    ) {
        for i in (0..self.len).step_by(P::LANES) {
            let red: P = self.mean::<P, T>(token, weights, 0, i);
            let green: P = self.mean::<P, T>(token, weights, 1, i);
            let blue: P = self.mean::<P, T>(token, weights, 2, i);
            let alpha = match self.alpha {
                true => self.mean::<P, T>(token, weights, 3, i),
                false => P::splat(token, 1.0),
            };
            W::lay(token, red, &share[i..], &r[i..]).store(&mut r[i..]);
            W::lay(token, green, &share[i..], &g[i..]).store(&mut g[i..]);
            W::lay(token, blue, &share[i..], &b[i..]).store(&mut b[i..]);
            W::lay(token, alpha, &share[i..], &a[i..]).store(&mut a[i..]);
        }
    }

    /// The bilinear mean of a channel. Values loaded for one channel serve the others too.
    #[inline(always)]
    fn mean<P: Pack, T: Stored>(&self, token: P::Token, weights: &Weights, channel: usize, i: usize) -> P {
        let (across, down) = (P::load(token, &weights.across[i..]), P::load(token, &weights.down[i..]));
        let [top_left, top_right, bottom_left, bottom_right] = T::load::<P>(token, self.found, channel, i);
        let top = mix(top_left, top_right, across);
        let bottom = mix(bottom_left, bottom_right, across);
        mix(top, bottom, down) * T::scale(token, weights, channel, i)
    }
}

/// The operation on filtered values.
trait Way {
    fn lay<P: Pack>(token: P::Token, mean: P, share: &[f32], out: &[f32]) -> P;
}

struct Fill;

impl Way for Fill {
    #[inline(always)]
    fn lay<P: Pack>(_: P::Token, mean: P, _: &[f32], _: &[f32]) -> P {
        mean
    }
}

struct Blend;

impl Way for Blend {
    #[inline(always)]
    fn lay<P: Pack>(token: P::Token, mean: P, share: &[f32], out: &[f32]) -> P {
        mix(P::load(token, out), mean, P::load(token, share))
    }
}

/// A storage format of channels.
trait Stored {
    /// The factor of the means.
    fn scale<P: Pack>(token: P::Token, weights: &Weights, channel: usize, i: usize) -> P;
    /// A channel of the four texels around the points from `i` onwards.
    fn load<P: Pack>(token: P::Token, found: &Found, channel: usize, i: usize) -> [P; 4];
}

struct Code;

impl Stored for Code {
    #[inline(always)]
    fn scale<P: Pack>(token: P::Token, weights: &Weights, channel: usize, i: usize) -> P {
        if channel == 3 { P::load(token, &weights.alpha[i..]) } else { P::splat(token, 1.0 / 255.0) }
    }
    #[inline(always)]
    fn load<P: Pack>(token: P::Token, found: &Found, channel: usize, i: usize) -> [P; 4] {
        let [a, b, c, d] = P::load_pixels(token, &found[0][i..]);
        let shift = 8 * channel as u32;
        [a.field(shift, 0xff), b.field(shift, 0xff), c.field(shift, 0xff), d.field(shift, 0xff)]
    }
}

struct SrgbCode;

impl Stored for SrgbCode {
    #[inline(always)]
    fn scale<P: Pack>(token: P::Token, weights: &Weights, channel: usize, i: usize) -> P {
        if channel == 3 { P::load(token, &weights.alpha[i..]) } else { P::splat(token, 1.0) }
    }
    #[inline(always)]
    fn load<P: Pack>(token: P::Token, found: &Found, channel: usize, i: usize) -> [P; 4] {
        let codes = Code::load(token, found, channel, i);
        if channel == 3 {
            return codes;
        }
        let [a, b, c, d] = codes;
        [linear_from_code(a), linear_from_code(b), linear_from_code(c), linear_from_code(d)]
    }
}

struct WideCode;

impl Stored for WideCode {
    #[inline(always)]
    fn scale<P: Pack>(token: P::Token, weights: &Weights, _: usize, i: usize) -> P {
        P::load(token, &weights.scale[i..])
    }
    #[inline(always)]
    fn load<P: Pack>(token: P::Token, found: &Found, channel: usize, i: usize) -> [P; 4] {
        let top: [P; 4] = P::load_pixels(token, &found[0][i..]);
        let bottom: [P; 4] = P::load_pixels(token, &found[1][i..]);
        let (left, right, shift) = (channel / 2, channel / 2 + 2, 16 * (channel as u32 % 2));
        let (a, b) = (top[left].field(shift, 0xffff), top[right].field(shift, 0xffff));
        [a, b, bottom[left].field(shift, 0xffff), bottom[right].field(shift, 0xffff)]
    }
}

struct Float;

impl Stored for Float {
    #[inline(always)]
    fn scale<P: Pack>(token: P::Token, _: &Weights, _: usize, _: usize) -> P {
        P::splat(token, 1.0)
    }
    #[inline(always)]
    fn load<P: Pack>(token: P::Token, found: &Found, channel: usize, i: usize) -> [P; 4] {
        let [a, b, c, d] = found;
        let (a, b) = (P::load_pixels(token, &a[i..]), P::load_pixels(token, &b[i..]));
        let (c, d) = (P::load_pixels(token, &c[i..]), P::load_pixels(token, &d[i..]));
        [a[channel], b[channel], c[channel], d[channel]]
    }
}

#[inline(always)]
fn mix<L: Lane>(a: L, b: L, t: L) -> L {
    a + (b - a) * t
}
