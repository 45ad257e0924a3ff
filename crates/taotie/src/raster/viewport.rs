//! The image that is drawn into, and how it is cut into tiles.

use super::SamplePattern;

/// The side of a tile in pixels.
pub const TILE_SIZE: u32 = 64;

/// The pixels of a tile.
pub const TILE_PIXELS: usize = (TILE_SIZE * TILE_SIZE) as usize;

/// The image to draw into.
#[derive(Debug, Clone, Copy)]
pub struct Viewport {
    /// Pixels across, 1 to 16384.
    pub width: u32,
    /// Pixels down, 1 to 16384.
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

/// The faces that are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Faces {
    /// Triangles that turn counter-clockwise as seen.
    CounterClockwise,
    /// Triangles that turn clockwise as seen: the front of a mirrored mesh.
    Clockwise,
    /// All triangles.
    Both,
}

impl Faces {
    /// Says whether clockwise triangles and counter-clockwise ones are drawn.
    pub(super) fn turns(self) -> [bool; 2] {
        [self != Self::CounterClockwise, self != Self::Clockwise]
    }
}
