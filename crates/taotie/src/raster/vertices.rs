//! Snaps vertices from clip space to the screen's grid, once per vertex.

use super::clip::ClipVolume;
use super::{SUBPIXELS, Viewport};
use crate::math::dispatch_registers;
use fearless_simd::{Level, Simd, f32x4, f32x8, f64x4, i32x8, prelude::*};
use rayon::prelude::*;

/// Vertices per task.
const BLOCK: usize = 4096;

/// Vertices processed side by side.
const PACK: usize = 8;

/// Vertices on the screen.
#[derive(Debug, Default)]
pub(super) struct ScreenVertices {
    /// x and y in 1/256 pixel, or, for a vertex outside the clip volume, a pair that is far from all those inside:
    /// only triangles of vertices inside, or all outside the same planes, have corners near one another, and the
    /// latter have no area.
    pub places: Vec<[i32; 2]>,
    /// Reversed depth, z/w; meaningless outside.
    pub depths: Vec<f32>,
}

/// The x of vertices outside; the planes are added to it.
const OUTSIDE: f64 = -1_073_741_824.0;

/// The distance in x between vertices outside different planes.
const OUTSIDE_STEP: f64 = 65536.0;

impl ScreenVertices {
    /// Replaces all vertices, reusing the memory.
    pub fn fill(&mut self, clip: &[[f32; 4]], viewport: &Viewport, level: Level) {
        let volume = ClipVolume::new(viewport);
        let size = [viewport.width, viewport.height].map(f64::from);
        self.places.resize(clip.len(), [0; 2]);
        self.depths.resize(clip.len(), 0.0);
        let places = self.places.par_chunks_mut(BLOCK);
        let depths = self.depths.par_chunks_mut(BLOCK);
        clip.par_chunks(BLOCK).zip(places.zip(depths)).for_each(|(clip, (places, depths))| {
            dispatch_registers!(level, simd => Snap { simd, volume, size }.all(clip, places, depths));
        });
    }
}

/// The inputs for snapping a pack of vertices.
struct Snap<S> {
    simd: S,
    volume: ClipVolume,
    size: [f64; 2],
}

impl<S: Simd> Snap<S> {
    #[inline(always)]
    fn all(&self, clip: &[[f32; 4]], places: &mut [[i32; 2]], depths: &mut [f32]) {
        let whole = clip.len() / PACK * PACK;
        let mut i = 0;
        while i < whole {
            self.pack(&clip[i..i + PACK], &mut places[i..i + PACK], &mut depths[i..i + PACK]);
            i += PACK;
        }
        let rest = clip.len() - whole;
        let mut last = [[0.0; 4]; PACK];
        last[..rest].copy_from_slice(&clip[whole..]);
        let (mut last_places, mut last_depths) = ([[0; 2]; PACK], [0.0; PACK]);
        self.pack(&last, &mut last_places, &mut last_depths);
        places[whole..].copy_from_slice(&last_places[..rest]);
        depths[whole..].copy_from_slice(&last_depths[..rest]);
    }

    #[inline(always)]
    fn pack(&self, clip: &[[f32; 4]], places: &mut [[i32; 2]], depths: &mut [f32]) {
        let (low, high) = clip.as_flattened().split_at(4 * PACK / 2);
        let [x0, y0, z0, w0] = f32x4::load_four_interleaved(self.simd, low);
        let [x1, y1, z1, w1] = f32x4::load_four_interleaved(self.simd, high);
        let (x, y) = (x0.combine(x1).widen(), y0.combine(y1).widen());
        let (z, w) = (z0.combine(z1).widen(), w0.combine(w1).widen());
        let low = self.four([x.0, y.0, z.0, w.0]);
        let high = self.four([x.1, y.1, z.1, w.1]);
        let [x, y, depth] = [low[0].narrow(high[0]), low[1].narrow(high[1]), low[2].narrow(high[2])];
        // Integers of at most 24 bits, or with few bits, are exact as floats.
        let (x, y): (i32x8<S>, i32x8<S>) = (x.to_int_precise(), y.to_int_precise());
        let (first, second) = x.interleave(y);
        let places = places.as_flattened_mut();
        first.store_slice(&mut places[..PACK]);
        second.store_slice(&mut places[PACK..]);
        let depth: f32x8<S> = depth;
        depth.store_slice(depths);
    }

    /// Returns snapped x and y, and depth.
    #[inline(always)]
    fn four(&self, [x, y, z, w]: [f64x4<S>; 4]) -> [f64x4<S>; 3] {
        let planes = self.outside([x, y, z, w]);
        let inside = planes.simd_eq(self.splat(0.0));
        let [width, height] = self.size;
        let column = self.snap((x / w + 1.0) * 0.5 * width);
        let row = self.snap((self.splat(1.0) - y / w) * 0.5 * height);
        let far = planes * OUTSIDE_STEP + OUTSIDE;
        [inside.select(column, far), inside.select(row, self.splat(0.0)), z / w]
    }

    #[inline(always)]
    fn snap(&self, v: f64x4<S>) -> f64x4<S> {
        (v * f64::from(SUBPIXELS) + 0.5).floor()
    }

    /// The sum of the bits of the planes that vertices are outside of, as numbers.
    #[inline(always)]
    fn outside(&self, [x, y, z, w]: [f64x4<S>; 4]) -> f64x4<S> {
        let (guard_x, guard_y) = (w * self.volume.guard_x, w * self.volume.guard_y);
        let zero = self.splat(0.0);
        // A NaN distance counts as outside.
        let depth = (w - z).simd_ge(zero).select(zero, self.splat(1.0))
            + z.simd_ge(zero).select(zero, self.splat(2.0));
        let across = (guard_x + x).simd_ge(zero).select(zero, self.splat(4.0))
            + (guard_x - x).simd_ge(zero).select(zero, self.splat(8.0));
        let down = (guard_y + y).simd_ge(zero).select(zero, self.splat(16.0))
            + (guard_y - y).simd_ge(zero).select(zero, self.splat(32.0));
        depth + across + down
    }

    #[inline(always)]
    fn splat(&self, value: f64) -> f64x4<S> {
        f64x4::splat(self.simd, value)
    }
}
