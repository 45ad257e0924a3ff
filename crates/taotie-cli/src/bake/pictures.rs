//! Pictures of maps for people to look at.

use crate::sheet::{GROUND, Sheet};
use taotie::asset::Misses;
use taotie::bake::Texel;
use taotie::image::Bitmap;

/// A picture of a map, no longer than `side` pixels.
pub fn preview(bitmap: &Bitmap, side: usize) -> Sheet {
    let step = (bitmap.width().max(bitmap.height()) as usize).div_ceil(side).max(1);
    let (width, height) = (bitmap.width() as usize / step, bitmap.height() as usize / step);
    let code = |i: usize| {
        let at = i / width * step * bitmap.width() as usize + i % width * step;
        let [r, g, b, _] = bitmap.stored(at);
        [r, g, b].map(|v| (v * 255.0 + 0.5) as u8)
    };
    Sheet { width, height, pixels: (0..width * height).map(code).collect() }
}

/// Where rays missed: amber took the closest point, red found nothing.
pub fn misses(misses: &Misses) -> Sheet {
    const COVERED: [u8; 3] = [70, 90, 80];
    const CLOSEST: [u8; 3] = [240, 170, 40];
    const LOST: [u8; 3] = [230, 50, 40];
    let color = |texel: &Texel| match texel {
        Texel::Free => GROUND,
        Texel::Met => COVERED,
        Texel::Closest => CLOSEST,
        Texel::Lost => LOST,
    };
    let pixels = misses.texels.iter().map(color).collect();
    Sheet { width: misses.width, height: misses.height, pixels }
}
