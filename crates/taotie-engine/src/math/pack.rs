//! Packs of numbers that load from and store to slices, and columns: one number for each of many points, so that
//! neighbours load as one pack.

use super::Lane;
use fearless_simd::{Simd, f32x4, f32x8, f32x16, i32x8, i32x16, prelude::*, u32x8, u32x16};
use std::ops::{Deref, DerefMut};

/// The maximum number of lanes in a pack.
pub const MOST_LANES: usize = 16;

/// A [`Lane`] that loads from and stores to contiguous memory: one `f32`, or eight, or sixteen.
pub trait Pack: Lane {
    /// The proof that the CPU supports the pack's instructions.
    type Token: Copy;
    /// The number of lanes.
    const LANES: usize;
    /// All lanes equal to `value`.
    fn splat(token: Self::Token, value: f32) -> Self;
    /// The first [`Self::LANES`] numbers of `from`.
    fn load(token: Self::Token, from: &[f32]) -> Self;
    /// Writes the first [`Self::LANES`] numbers of `to`.
    fn store(self, to: &mut [f32]);
    /// The first [`Self::LANES`] pixels of `from`, channel by channel.
    fn load_pixels(token: Self::Token, from: &[[f32; 4]]) -> [Self; 4];
    /// Bit i is set if lane i of `mask` is true.
    fn bits(mask: Self::Mask) -> u64;
    /// Writes the first [`Self::LANES`] pixels of `to`.
    fn store_pixels(channels: [Self; 4], to: &mut [[f32; 4]]);
    /// The bits of each lane shifted right by `shift` and masked with `mask`, as a number.
    fn field(self, shift: u32, mask: u32) -> Self;
    /// The lower or, if `n` is 1, the upper half of the bits of each lane as a positive half float, up to a factor of
    /// 2^112: its exponent and mantissa, moved to their positions in a float.
    fn half_float(self, n: u32) -> Self;
    /// Writes integral lanes of a magnitude below 2^31, modulo 2^32, to the first [`Self::LANES`] words of `to`.
    fn store_words(self, to: &mut [u32]);
    /// Writes `row` · `width` + `self` to the first [`Self::LANES`] words of `to`, for integral lanes below 2^24; the
    /// results are below 2^32.
    fn store_place(self, row: Self, width: Self, to: &mut [u32]);
}

impl Pack for f32 {
    type Token = ();
    const LANES: usize = 1;
    #[inline(always)]
    fn splat((): (), value: f32) -> Self {
        value
    }
    #[inline(always)]
    fn load((): (), from: &[f32]) -> Self {
        from[0]
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        to[0] = self;
    }
    #[inline(always)]
    fn load_pixels((): (), from: &[[f32; 4]]) -> [Self; 4] {
        from[0]
    }
    #[inline(always)]
    fn bits(mask: bool) -> u64 {
        u64::from(mask)
    }
    #[inline(always)]
    fn store_pixels(channels: [Self; 4], to: &mut [[f32; 4]]) {
        to[0] = channels;
    }
    #[inline(always)]
    fn field(self, shift: u32, mask: u32) -> Self {
        ((self.to_bits() >> shift) & mask) as f32
    }
    #[inline(always)]
    fn half_float(self, n: u32) -> Self {
        f32::from_bits(((self.to_bits() >> (16 * n)) & 0xffff) << 13)
    }
    #[inline(always)]
    fn store_words(self, to: &mut [u32]) {
        to[0] = self as i32 as u32;
    }
    #[inline(always)]
    fn store_place(self, row: Self, width: Self, to: &mut [u32]) {
        to[0] = (row as i32).wrapping_mul(width as i32).wrapping_add(self as i32) as u32;
    }
}

/// A register of `$lanes` floats. Pixels are stored half by half.
macro_rules! register_pack {
    ($float:ident, $int:ident, $word:ident, $lanes:literal, $load_pixels:ident, $store_pixels:ident) => {
        impl<S: Simd> Pack for $float<S> {
            type Token = S;
            const LANES: usize = $lanes;
            #[inline(always)]
            fn splat(token: S, value: f32) -> Self {
                SimdBase::splat(token, value)
            }
            #[inline(always)]
            fn load(token: S, from: &[f32]) -> Self {
                SimdBase::from_slice(token, &from[..$lanes])
            }
            #[inline(always)]
            fn store(self, to: &mut [f32]) {
                self.store_slice(&mut to[..$lanes]);
            }
            #[inline(always)]
            fn load_pixels(token: S, from: &[[f32; 4]]) -> [Self; 4] {
                $load_pixels(token, &from[..$lanes])
            }
            #[inline(always)]
            fn bits(mask: Self::Mask) -> u64 {
                mask.to_bitmask()
            }
            #[inline(always)]
            fn store_pixels([r, g, b, a]: [Self; 4], to: &mut [[f32; 4]]) {
                let (low, high) = to[..$lanes].split_at_mut($lanes / 2);
                let ((r, r2), (g, g2), (b, b2), (a, a2)) = (r.split(), g.split(), b.split(), a.split());
                $store_pixels([r, g, b, a], low);
                $store_pixels([r2, g2, b2, a2], high);
            }
            #[inline(always)]
            fn field(self, shift: u32, mask: u32) -> Self {
                let words = self.bitcast::<$word<S>>();
                let words = if shift == 0 { words } else { words >> shift };
                let words = if mask == u32::MAX >> shift { words } else { words & mask };
                words.bitcast::<$int<S>>().to_float()
            }
            #[inline(always)]
            fn half_float(self, n: u32) -> Self {
                let words = self.bitcast::<$word<S>>();
                let moved = if n == 0 { (words & 0xffff) << 13 } else { (words >> 16) << 13 };
                moved.bitcast::<Self>()
            }
            #[inline(always)]
            fn store_words(self, to: &mut [u32]) {
                self.to_int::<$int<S>>().bitcast::<$word<S>>().store_slice(&mut to[..$lanes]);
            }
            #[inline(always)]
            fn store_place(self, row: Self, width: Self, to: &mut [u32]) {
                let (row, width): ($int<S>, $int<S>) = (row.to_int(), width.to_int());
                let column: $int<S> = self.to_int();
                (row * width + column).bitcast::<$word<S>>().store_slice(&mut to[..$lanes]);
            }
        }
    };
}

register_pack!(f32x8, i32x8, u32x8, 8, load8, store4);
register_pack!(f32x16, i32x16, u32x16, 16, load16, store8);

#[inline(always)]
fn load8<S: Simd>(token: S, from: &[[f32; 4]]) -> [f32x8<S>; 4] {
    let (low, high) = from.as_flattened().split_at(16);
    let [r, g, b, a] = f32x4::load_four_interleaved(token, low);
    let [r2, g2, b2, a2] = f32x4::load_four_interleaved(token, high);
    [r.combine(r2), g.combine(g2), b.combine(b2), a.combine(a2)]
}

#[inline(always)]
fn load16<S: Simd>(token: S, from: &[[f32; 4]]) -> [f32x16<S>; 4] {
    let from = from.as_flattened();
    let a: f32x16<S> = SimdBase::from_slice(token, &from[..16]);
    let b: f32x16<S> = SimdBase::from_slice(token, &from[16..32]);
    let c: f32x16<S> = SimdBase::from_slice(token, &from[32..48]);
    let d: f32x16<S> = SimdBase::from_slice(token, &from[48..64]);
    let ((even, odd), (even2, odd2)) = (a.deinterleave(b), c.deinterleave(d));
    let ((first, third), (second, fourth)) = (even.deinterleave(even2), odd.deinterleave(odd2));
    [first, second, third, fourth]
}

#[inline(always)]
fn store4<S: Simd>(channels: [f32x4<S>; 4], to: &mut [[f32; 4]]) {
    f32x4::store_four_interleaved(channels, to.as_flattened_mut());
}

#[inline(always)]
fn store8<S: Simd>(channels: [f32x8<S>; 4], to: &mut [[f32; 4]]) {
    f32x8::store_pixels(channels, to);
}

/// The number of points that pass through a stage together; small enough to stay in the L1 and L2 caches.
pub const BATCH: usize = 256;

/// The number of entries of a column: a pack may be stored starting at any point.
pub const COLUMN: usize = BATCH + MOST_LANES;

/// A value for each point, in code that loads whole registers.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct Aligned<T>(pub [T; COLUMN]);

/// One number per point.
pub type Column = Aligned<f32>;

/// One word per point.
pub type Words = Aligned<u32>;

/// Four adjacent numbers per point.
pub type Quads = Aligned<[f32; 4]>;

impl Column {
    /// All zero.
    pub const ZERO: Self = Self([0.0; COLUMN]);
    /// All one.
    pub const ONE: Self = Self([1.0; COLUMN]);
}

impl Words {
    /// All zero.
    pub const ZERO: Self = Self([0; COLUMN]);
}

impl Quads {
    /// All zero.
    pub const ZERO: Self = Self([[0.0; 4]; COLUMN]);
}

impl<T> Deref for Aligned<T> {
    type Target = [T; COLUMN];
    #[inline(always)]
    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<T> DerefMut for Aligned<T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}
