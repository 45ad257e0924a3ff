//! The image to draw into: its division into tiles, and the positions of the samples in a pixel.

use crate::error::{Error, Result};

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
