//! An image divided into tiles that can be written in parallel.

use crate::raster::TILE_SIZE;

/// The rows of pixels of a tile in an image.
pub(super) struct TileRows<'p, T>(Vec<&'p mut [T]>);

/// Returns the tiles of an image of this width, row by row.
pub(super) fn tiles_of<T>(pixels: &mut [T], width: usize) -> Vec<TileRows<'_, T>> {
    let (side, across) = (TILE_SIZE as usize, width.div_ceil(TILE_SIZE as usize));
    let mut tiles = Vec::with_capacity(across * pixels.len().div_ceil(width.max(1) * side));
    for band in pixels.chunks_mut(width.max(1) * side) {
        let first = tiles.len();
        tiles.extend((0..across).map(|_| TileRows(Vec::with_capacity(side))));
        for row in band.chunks_mut(width.max(1)) {
            for (tile, part) in tiles[first..].iter_mut().zip(row.chunks_mut(side)) {
                tile.0.push(part);
            }
        }
    }
    tiles
}

impl<T: Copy> TileRows<'_, T> {
    /// Writes a tile whose rows are [`TILE_SIZE`] long, cropped to the available size.
    pub(super) fn write(&mut self, pixels: &[T]) {
        for (to, from) in self.0.iter_mut().zip(pixels.chunks_exact(TILE_SIZE as usize)) {
            to.copy_from_slice(&from[..to.len()]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_belongs_to_the_tile_that_holds_it() {
        let (width, height) = (150, 70);
        let mut pixels = vec![0; width * height];
        let tiles = tiles_of(&mut pixels, width);
        assert_eq!(tiles.len(), 6);
        for (number, mut tile) in tiles.into_iter().enumerate() {
            tile.write(&[number + 1; 64 * 64]);
        }
        for (i, pixel) in pixels.iter().enumerate() {
            let (x, y) = (i % width, i / width);
            assert_eq!(*pixel, y / 64 * 3 + x / 64 + 1, "{x}, {y}");
        }
    }
}
