//! Packs of numbers that load from and store to slices, and the choice of one by SIMD level.

use super::Lane;
use fearless_simd::{Simd, f32x4, f32x8, prelude::*};

/// A [`Lane`] that loads from and stores to neighbours in memory: one `f32`, or eight.
pub trait Pack: Lane {
    /// The proof that the processor has the pack's instructions.
    type Token: Copy;
    /// How many numbers it holds.
    const LANES: usize;
    /// All lanes equal to `value`.
    fn splat(token: Self::Token, value: f32) -> Self;
    /// The first [`Self::LANES`] numbers of `from`.
    fn load(token: Self::Token, from: &[f32]) -> Self;
    /// Writes the first [`Self::LANES`] numbers of `to`.
    fn store(self, to: &mut [f32]);
    /// The first [`Self::LANES`] pixels of `from`, channel by channel.
    fn load_pixels(token: Self::Token, from: &[[f32; 4]]) -> [Self; 4];
    /// Bit i is set where lane i of `mask` is true.
    fn bits(mask: Self::Mask) -> u64;
    /// Writes the first [`Self::LANES`] pixels of `to`.
    fn store_pixels(channels: [Self; 4], to: &mut [[f32; 4]]);
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
}

impl<S: Simd> Pack for f32x8<S> {
    type Token = S;
    const LANES: usize = 8;
    #[inline(always)]
    fn splat(token: S, value: f32) -> Self {
        SimdBase::splat(token, value)
    }
    #[inline(always)]
    fn load(token: S, from: &[f32]) -> Self {
        SimdBase::from_slice(token, &from[..8])
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        self.store_slice(&mut to[..8]);
    }
    #[inline(always)]
    fn load_pixels(token: S, from: &[[f32; 4]]) -> [Self; 4] {
        let (low, high) = from[..8].as_flattened().split_at(16);
        let [r, g, b, a] = f32x4::load_four_interleaved(token, low);
        let [r2, g2, b2, a2] = f32x4::load_four_interleaved(token, high);
        [r.combine(r2), g.combine(g2), b.combine(b2), a.combine(a2)]
    }
    #[inline(always)]
    fn bits(mask: Self::Mask) -> u64 {
        mask.to_bitmask()
    }
    #[inline(always)]
    fn store_pixels([r, g, b, a]: [Self; 4], to: &mut [[f32; 4]]) {
        let (low, high) = to[..8].as_flattened_mut().split_at_mut(16);
        let ((r, r2), (g, g2), (b, b2), (a, a2)) = (r.split(), g.split(), b.split(), a.split());
        f32x4::store_four_interleaved([r, g, b, a], low);
        f32x4::store_four_interleaved([r2, g2, b2, a2], high);
    }
}

/// Evaluates `call` once, with `$pack` naming the pack type of `level` and `$token` its proof, compiled for that
/// level. Everything that `call` runs must be `#[inline(always)]`, or it falls out of the level.
///
/// `fearless_simd::dispatch!` would compile five levels, one of them eight scalars wide; this compiles those that
/// differ: one `f32` at a time, and packs of eight on SSE2, AVX2 or NEON.
macro_rules! dispatch_pack {
    ($level:expr, $pack:ident, $token:ident => $call:expr) => {{
        use fearless_simd::{Level, Simd as _};
        match $level {
            #[cfg(target_arch = "x86_64")]
            Level::Avx2($token) => {
                type $pack = fearless_simd::f32x8<fearless_simd::x86::Avx2>;
                $token.vectorize(
                    #[inline(always)]
                    || $call,
                )
            }
            #[cfg(target_arch = "x86_64")]
            Level::Sse2($token) => {
                type $pack = fearless_simd::f32x8<fearless_simd::x86::Sse2>;
                $token.vectorize(
                    #[inline(always)]
                    || $call,
                )
            }
            #[cfg(target_arch = "aarch64")]
            Level::Neon($token) => {
                type $pack = fearless_simd::f32x8<fearless_simd::aarch64::Neon>;
                $token.vectorize(
                    #[inline(always)]
                    || $call,
                )
            }
            _ => {
                type $pack = f32;
                let $token = ();
                $call
            }
        }
    }};
}
pub(crate) use dispatch_pack;
