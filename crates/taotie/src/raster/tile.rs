//! Tiles of the image, and what is visible in them.

use super::{TILE_PIXELS, TILE_SIZE, Viewport};

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
