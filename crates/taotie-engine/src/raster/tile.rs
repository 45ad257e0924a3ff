//! The image to draw into: the positions of the samples in a pixel, its division into tiles, what is visible in them,
//! and the receivers of covered pixels.

use crate::error::{Error, Result};
use fearless_simd::{Simd, f32x8, mask32x8, prelude::*, u32x8};

/// The side length of a tile in pixels.
pub const TILE_SIZE: u32 = 64;

/// The number of pixels in a tile.
pub const TILE_PIXELS: usize = (TILE_SIZE * TILE_SIZE) as usize;

/// The image to draw into.
#[derive(Debug, Clone, Copy)]
pub struct Viewport {
    /// Width in pixels, 1 to 16384.
    pub width: u32,
    /// Height in pixels, 1 to 16384.
    pub height: u32,
    /// The sample positions in a pixel.
    pub pattern: SamplePattern,
}

impl Viewport {
    /// The number of tiles across and down.
    pub fn tiles(&self) -> (u32, u32) {
        (self.width.div_ceil(TILE_SIZE), self.height.div_ceil(TILE_SIZE))
    }
}

/// The faces to draw.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Faces {
    /// Triangles that are counter-clockwise as seen.
    CounterClockwise,
    /// Triangles that are clockwise as seen: the front of a mirrored mesh.
    Clockwise,
    /// All triangles.
    Both,
}

impl Faces {
    /// Returns whether clockwise and counter-clockwise triangles are drawn.
    pub(super) fn turns(self) -> [bool; 2] {
        [self != Self::CounterClockwise, self != Self::Clockwise]
    }
}

/// Sample positions of a pixel in 1/256 pixel, from its top left corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SamplePattern {
    offsets: &'static [[i32; 2]],
}

/// The centre.
const ONE: [[i32; 2]; 1] = [[128, 128]];

/// A rotated grid: no two samples share a row or a column.
const FOUR: [[i32; 2]; 4] = [[96, 32], [224, 96], [32, 160], [160, 224]];

/// The Hammersley points of base 2: one sample in each of 16 rows and 16 columns.
const SIXTEEN: [[i32; 2]; 16] = hammersley();

const fn hammersley() -> [[i32; 2]; 16] {
    let mut points = [[0; 2]; 16];
    let mut i = 0;
    while i < 16 {
        let reversed = ((i & 1) << 3) | ((i & 2) << 1) | ((i & 4) >> 1) | ((i & 8) >> 3);
        points[i as usize] = [i * 16 + 8, reversed * 16 + 8];
        i += 1;
    }
    points
}

impl SamplePattern {
    /// The pattern of 1, 4 or 16 samples.
    ///
    /// # Errors
    /// [`Error::Invalid`] for any other number.
    pub fn new(samples: u32) -> Result<Self> {
        let offsets: &'static [[i32; 2]] = match samples {
            1 => &ONE,
            4 => &FOUR,
            16 => &SIXTEEN,
            other => return Err(Error::invalid(format!("{other} samples per pixel"), "expected 1, 4 or 16")),
        };
        Ok(Self { offsets })
    }

    /// The samples in 1/256 pixel.
    pub fn offsets(self) -> &'static [[i32; 2]] {
        self.offsets
    }

    /// The distance between samples along an axis, in pixels: 1, 1/2 or 1/4.
    pub fn spacing(self) -> f32 {
        match self.offsets.len() {
            1 => 1.0,
            4 => 0.5,
            _ => 0.25,
        }
    }
}

/// The id that means "nothing here".
pub const NO_TRIANGLE: u32 = u32::MAX;

/// A tile by its position in the image.
#[derive(Debug, Clone, Copy)]
pub struct Tile {
    /// Index, row by row.
    pub index: usize,
    /// The left column of pixels.
    pub x: u32,
    /// The top row of pixels.
    pub y: u32,
    /// Columns inside the image, 1 to 64.
    pub width: u32,
    /// Rows inside the image.
    pub height: u32,
}

impl Tile {
    /// The tile of `viewport` with this index.
    pub fn new(viewport: &Viewport, index: usize) -> Self {
        let (across, _) = viewport.tiles();
        let x = (index as u32 % across) * TILE_SIZE;
        let y = (index as u32 / across) * TILE_SIZE;
        let width = TILE_SIZE.min(viewport.width - x);
        let height = TILE_SIZE.min(viewport.height - y);
        Self { index, x, y, width, height }
    }
}

/// One sample of each pixel of a tile.
#[derive(Debug, Clone, Copy)]
pub struct TileSample<'t> {
    /// The tile.
    pub tile: &'t Tile,
    /// The position in the pixel, in 1/256 pixel right and down from its corner.
    pub offset: [i32; 2],
}

/// The nearest triangle at one sample of each pixel of a tile. Pixel (x, y) is at `y · 64 + x`.
#[derive(Debug, Clone)]
pub struct TilePlane {
    /// Triangle ids, or `u32::MAX` where there is no triangle.
    pub ids: Vec<u32>,
    /// Reversed depth: 1 near, 0 far or nothing.
    pub depths: Vec<f32>,
}

impl Default for TilePlane {
    fn default() -> Self {
        Self { ids: vec![NO_TRIANGLE; TILE_PIXELS], depths: vec![0.0; TILE_PIXELS] }
    }
}

impl TilePlane {
    pub(super) fn clear(&mut self) {
        self.ids.resize(TILE_PIXELS, NO_TRIANGLE);
        self.ids.fill(NO_TRIANGLE);
        self.depths.resize(TILE_PIXELS, 0.0);
        self.depths.fill(0.0);
    }
}

/// A triangle visible at a sample, in front of the opaque surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// `y · 64 + x` in the tile.
    pub pixel: u32,
    /// Triangle id.
    pub id: u32,
    /// Reversed depth.
    pub depth: f32,
}

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
