//! Which triangles are seen in one tile.

use super::scan::scan;
use super::sink::{InFront, Nearest};
use super::{Bins, Viewport};
use crate::error::Result;
use crate::math::SimdLevel;
use fearless_simd::dispatch;

/// The side of a tile in pixels.
pub const TILE_SIZE: u32 = 64;

/// The pixels of a tile.
pub const TILE_PIXELS: usize = (TILE_SIZE * TILE_SIZE) as usize;

/// The id that says "nothing here".
pub const NO_TRIANGLE: u32 = u32::MAX;

/// A tile by its place in the picture.
#[derive(Debug, Clone, Copy)]
pub struct Tile {
    /// Index, row by row.
    pub index: usize,
    /// The left column of pixels.
    pub x: u32,
    /// The top row of pixels.
    pub y: u32,
    /// Columns that are inside the picture, 1 to [`TILE_SIZE`].
    pub width: u32,
    /// Rows that are inside the picture.
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

/// The nearest triangle at one sample of each pixel of a tile. Pixel (x, y) is at `y · TILE_SIZE + x`.
#[derive(Debug, Clone)]
pub struct TilePlane {
    /// Triangle ids, or [`NO_TRIANGLE`].
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
    fn clear(&mut self) {
        self.ids.resize(TILE_PIXELS, NO_TRIANGLE);
        self.ids.fill(NO_TRIANGLE);
        self.depths.resize(TILE_PIXELS, 0.0);
        self.depths.fill(0.0);
    }
}

/// A triangle seen at a sample, in front of what is opaque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// `y · TILE_SIZE + x` in the tile.
    pub pixel: u32,
    /// Triangle id.
    pub id: u32,
    /// Reversed depth.
    pub depth: f32,
}

/// Fills `plane` with the nearest triangle of `bins` at the sample `offset` (1/256 pixel). At equal depth the
/// triangle drawn first stays.
///
/// # Errors
/// Where the SIMD level is not to be had on this machine.
pub fn rasterize_opaque(
    bins: &Bins,
    tile: &Tile,
    offset: [i32; 2],
    simd: SimdLevel,
    plane: &mut TilePlane,
) -> Result<()> {
    let level = simd.dispatch()?;
    plane.clear();
    if let (Some(ids), Some(depths)) = (plane.ids.first_chunk_mut(), plane.depths.first_chunk_mut()) {
        let mut sink = Nearest { ids, depths };
        dispatch!(level, simd => scan(simd, bins, tile, offset, &mut sink));
    }
    Ok(())
}

/// Lists every triangle of `bins` in front of `opaque` at the sample `offset`, in drawing order.
///
/// # Errors
/// Where the SIMD level is not to be had on this machine.
pub fn rasterize_layers(
    bins: &Bins,
    tile: &Tile,
    offset: [i32; 2],
    simd: SimdLevel,
    opaque: &TilePlane,
) -> Result<Vec<Layer>> {
    let level = simd.dispatch()?;
    let mut layers = Vec::new();
    let mut sink = InFront { opaque: &opaque.depths, layers: &mut layers };
    dispatch!(level, simd => scan(simd, bins, tile, offset, &mut sink));
    Ok(layers)
}
