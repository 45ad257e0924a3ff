//! Receivers of covered pixels.

use super::{Layer, TILE_PIXELS};
use fearless_simd::{Simd, f32x8, mask32x8, prelude::*, u32x8};

const PACK: usize = 8;

/// Receives the coverage of triangles, in drawing order.
pub(super) trait Sink {
    /// Receives eight pixels starting at `pixel`; `covered` marks the covered ones, `depth` is their depth.
    fn pack<S: Simd>(&mut self, pixel: usize, covered: mask32x8<S>, depth: f32x8<S>, id: u32);

    /// Receives one pixel.
    fn one(&mut self, pixel: usize, depth: f32, id: u32);
}

/// Keeps the nearest triangle of each pixel.
pub(super) struct Nearest<'a> {
    pub ids: &'a mut [u32; TILE_PIXELS],
    pub depths: &'a mut [f32; TILE_PIXELS],
}

impl Sink for Nearest<'_> {
    #[inline(always)]
    fn pack<S: Simd>(&mut self, pixel: usize, covered: mask32x8<S>, depth: f32x8<S>, id: u32) {
        let simd = depth.token();
        let depths = &mut self.depths[pixel..pixel + PACK];
        let before = f32x8::from_slice(simd, depths);
        let wins = covered & before.simd_lt(depth);
        if wins.any_true() {
            wins.select(depth, before).store_slice(depths);
            let ids = &mut self.ids[pixel..pixel + PACK];
            let old = u32x8::from_slice(simd, ids);
            wins.select(u32x8::splat(simd, id), old).store_slice(ids);
        }
    }

    #[inline(always)]
    fn one(&mut self, pixel: usize, depth: f32, id: u32) {
        if self.depths[pixel] < depth {
            self.depths[pixel] = depth;
            self.ids[pixel] = id;
        }
    }
}

/// Lists everything in front of the opaque surfaces.
pub(super) struct InFront<'a> {
    /// Their depths.
    pub opaque: &'a [f32],
    pub layers: &'a mut Vec<Layer>,
}

impl Sink for InFront<'_> {
    #[inline(always)]
    fn pack<S: Simd>(&mut self, pixel: usize, covered: mask32x8<S>, depth: f32x8<S>, id: u32) {
        let simd = depth.token();
        let before = f32x8::from_slice(simd, &self.opaque[pixel..pixel + PACK]);
        let seen = covered & before.simd_lt(depth);
        if !seen.any_true() {
            return;
        }
        let mut depths = [0.0; 8];
        depth.store_slice(&mut depths);
        let mut flags = [0.0; 8];
        seen.select(f32x8::splat(simd, 1.0), f32x8::splat(simd, 0.0)).store_slice(&mut flags);
        for i in 0..8 {
            if flags[i] != 0.0 {
                self.layers.push(Layer { pixel: (pixel + i) as u32, id, depth: depths[i] });
            }
        }
    }

    #[inline(always)]
    fn one(&mut self, pixel: usize, depth: f32, id: u32) {
        if self.opaque[pixel] < depth {
            self.layers.push(Layer { pixel: pixel as u32, id, depth });
        }
    }
}
