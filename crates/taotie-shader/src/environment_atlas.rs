//! The levels of an environment packed into one image, as shaders read them.

use crate::frame::MOST_LEVELS;
use taotie_engine::shade::environment::{EnvironmentMaps, HalfPicture};

/// Alpha as a half float.
const ONE: u16 = 0x3c00;

/// The levels of an environment packed into one image: `environment_maps` and `environment_levels` of a shader.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvironmentAtlas {
    /// Width and height in texels.
    pub size: [usize; 2],
    /// Half floats, linear RGB and 1, row by row from the top.
    pub texels: Vec<[u16; 4]>,
    /// Column and row of each level's first texel, its side length without the border, and its factor. The last row
    /// ends with the factor of the environment's image.
    pub table: [[f32; 4]; MOST_LEVELS],
}

impl EnvironmentAtlas {
    /// Packs the levels into shelves, roughly square overall. Levels beyond the first [`MOST_LEVELS`] − 1 are
    /// dropped: no environment has that many.
    pub fn new(maps: &EnvironmentMaps<'_>) -> Self {
        let levels = &maps.levels[..maps.levels.len().min(MOST_LEVELS - 1)];
        let (size, places) = shelves(levels);
        let mut atlas =
            Self { size, texels: vec![[0, 0, 0, ONE]; size[0] * size[1]], table: [[0.0; 4]; MOST_LEVELS] };
        for (number, (level, place)) in levels.iter().zip(places).enumerate() {
            atlas.put(level, place);
            let [x, y] = place.map(|texels| texels as f32);
            atlas.table[number] = [x, y, level.width.saturating_sub(2) as f32, level.factor];
        }
        atlas.table[MOST_LEVELS - 1][3] = maps.picture.factor;
        atlas
    }

    fn put(&mut self, level: &HalfPicture<'_>, [left, top]: [usize; 2]) {
        let rows = self.texels.chunks_exact_mut(self.size[0]).skip(top);
        for (row, from) in rows.zip(level.texels.chunks_exact(level.width)) {
            row[left..].iter_mut().zip(from).for_each(|(to, from)| *to = opaque(from));
        }
    }
}

/// A texel of half floats with alpha 1.
pub fn opaque([r, g, b]: &[u16; 3]) -> [u16; 4] {
    [*r, *g, *b, ONE]
}

/// The size that holds all levels (at least one texel), and the column and row where each begins.
fn shelves(levels: &[HalfPicture<'_>]) -> ([usize; 2], Vec<[usize; 2]>) {
    let area: usize = levels.iter().map(|level| level.width * level.height).sum();
    let widest = levels.iter().map(|level| level.width).max().unwrap_or(1);
    let width = widest.max(area.isqrt());
    let (mut left, mut top, mut below) = (0, 0, 0);
    let mut places = Vec::with_capacity(levels.len());
    for level in levels {
        if left + level.width > width {
            (left, top) = (0, below);
        }
        places.push([left, top]);
        left += level.width;
        below = below.max(top + level.height);
    }
    ([width, below.max(1)], places)
}

#[cfg(test)]
mod tests {
    use super::*;
    use half::f16;
    use taotie_engine::image::Image;
    use taotie_engine::shade::environment::Environment;

    #[test]
    fn every_level_is_found_by_the_table() {
        let environment = Environment::new(Image::new(16, 8, [0.5, 0.25, 2.0, 1.0]).unwrap()).unwrap();
        let maps = environment.maps();
        assert!(maps.levels.len() < MOST_LEVELS, "{} levels", maps.levels.len());
        let atlas = EnvironmentAtlas::new(&maps);
        assert_eq!(atlas.texels.len(), atlas.size[0] * atlas.size[1]);
        assert_eq!(atlas.table[MOST_LEVELS - 1], [0.0, 0.0, 0.0, maps.picture.factor]);
        let mut taken = vec![false; atlas.texels.len()];
        for (level, [x, y, side, factor]) in maps.levels.iter().zip(atlas.table) {
            assert_eq!((side as usize + 2, factor), (level.width, level.factor));
            let [_, green, blue] = level.texels[0].map(|half| f16::from_bits(half).to_f32() * factor);
            assert!((green - 0.25).abs() < 1e-3 && (blue - 2.0).abs() < 1e-2, "{green} {blue}");
            for (i, texel) in level.texels.iter().enumerate() {
                let at = (y as usize + i / level.width) * atlas.size[0] + x as usize + i % level.width;
                assert_eq!(atlas.texels[at], opaque(texel));
                assert!(!std::mem::replace(&mut taken[at], true), "levels overlap");
            }
        }
    }

    #[test]
    fn levels_lie_apart_and_inside() {
        let sides = [514, 514, 258, 258, 130, 66, 66, 34, 18, 300];
        let level = |side| HalfPicture { width: side, height: side, texels: &[], factor: 1.0 };
        let (size, places) = shelves(&sides.map(level));
        assert!(size[0] >= 514 && size[0] < 1200 && size[1] < 1700, "{size:?}");
        for (i, ([x, y], side)) in places.iter().zip(sides).enumerate() {
            assert!(x + side <= size[0] && y + side <= size[1], "{i}");
            for ([other_x, other_y], other) in places[..i].iter().zip(sides) {
                let apart = x + side <= *other_x
                    || other_x + other <= *x
                    || y + side <= *other_y
                    || other_y + other <= *y;
                assert!(apart, "{i}");
            }
        }
        assert_eq!(shelves(&[]), ([1, 1], vec![]));
    }
}
