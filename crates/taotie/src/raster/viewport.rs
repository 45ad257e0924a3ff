//! The image to draw into, and its division into tiles.

use super::SamplePattern;

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
