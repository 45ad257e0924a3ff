//! The surface that is seen at a sample of a pixel.

/// A triangle seen at a sample of a tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VisibleSample {
    /// The pixel, `y · TILE_SIZE + x` in the tile.
    pub pixel: u32,
    /// The triangle's number over all draws.
    pub triangle: u32,
    /// Reversed depth.
    pub depth: f32,
}
