//! The level of detail that candidates are for.

use crate::asset::lod::Lod;
use crate::proof::Picture;

/// A level of detail of an asset: its number, 0 the finest, and the size of the object on the screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::asset) struct Level {
    pub number: usize,
    /// Pixels across the object.
    pub across: u32,
}

/// The minimum number of triangles of any candidate.
const LEAST: u32 = 16;

impl Level {
    pub const FINEST: Self = Self { number: 0, across: Lod::FINEST };

    /// Returns `true` for the finest.
    pub fn is_finest(self) -> bool {
        self.number == 0
    }

    /// Returns its number of pixels as a fraction of the finest level's, for the whole object.
    pub fn part(self) -> f64 {
        let part = f64::from(self.across) / f64::from(Lod::FINEST);
        part * part
    }

    /// Returns a number of triangles of the finest level in proportion to the pixels of this one.
    pub fn triangles(self, of_finest: u32) -> u32 {
        ((f64::from(of_finest) * self.part()) as u32).max(LEAST)
    }

    /// Returns the map side of the finest level, texels, in proportion to the pixels of this one, a multiple of 4.
    pub fn side(self, of_finest: u32) -> u32 {
        (of_finest * self.across / Lod::FINEST).next_multiple_of(4).max(16)
    }

    /// Returns the picture at which it is measured, with `count` pixels if it is the finest.
    pub fn picture(self, count: usize) -> Picture {
        Picture::of(self.across as f32, count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_objects_have_fewer_triangles_and_texels() {
        let quarter = Level { number: 1, across: 256 };
        assert_eq!((quarter.triangles(8000), quarter.side(512), quarter.side(20)), (2000, 256, 16));
        assert_eq!((Level::FINEST.triangles(8000), Level::FINEST.side(512)), (8000, 512));
        let smallest = Level { number: 1, across: 32 };
        assert_eq!((smallest.triangles(100), smallest.side(256)), (LEAST, 16));
        assert_eq!(quarter.picture(1000), Picture { across: 256.0, count: 500 });
    }
}
