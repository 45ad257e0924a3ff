//! Encodes the mip levels of a texture as blocks, with rate–distortion optimisation: blocks repeat bytes of earlier
//! ones if that costs little, since Zstandard stores repetitions in few bits. The idea is from Basis Universal; the
//! search is our own.

use super::block::{Block, Tile, values};
use super::endpoints::{Texels, squares};
use std::collections::VecDeque;
use taotie_engine::image::{self, Encoding, Texture};
use taotie_engine::math::Vec3;
use taotie_engine::math::srgb::srgb_from_linear;
use taotie_engine::parallel;

/// A mip level of a texture.
#[derive(Clone, Copy)]
pub(super) struct MipLevel<'a> {
    pub texture: &'a Texture,
    pub level: usize,
}

impl MipLevel<'_> {
    /// Returns the blocks, row by row. `rdo` is as in [`ImageCodec::Ktx2`](crate::ImageCodec).
    pub fn blocks(&self, rdo: u8) -> Vec<u8> {
        let count = self.across() * self.texture.level_size(self.level).1.div_ceil(4) as usize;
        let nearest = |i: usize| {
            let tile = self.tile(i);
            Block::nearest(&tile).bytes(&tile)
        };
        if rdo == 0 {
            return parallel::collect(count, nearest).into_flattened();
        }
        let run = |run: usize| {
            let tiles: Vec<Tile> = (run * RUN..((run + 1) * RUN).min(count)).map(|i| self.tile(i)).collect();
            run_blocks(&tiles, rdo)
        };
        parallel::tasks(count.div_ceil(RUN), &run).concat().into_flattened()
    }

    /// Returns the number of blocks per row.
    fn across(&self) -> usize {
        self.texture.level_size(self.level).0.div_ceil(4) as usize
    }

    /// Returns the texels of block `i`. Texels beyond the border repeat those at the border.
    fn tile(&self, i: usize) -> Tile {
        let (width, height) = self.texture.level_size(self.level);
        let (x0, y0) = (i % self.across() * 4, i / self.across() * 4);
        std::array::from_fn(|k| {
            self.texel((x0 + k % 4).min(width as usize - 1), (y0 + k / 4).min(height as usize - 1))
        })
    }

    /// Returns a texel as stored in 8 bits.
    fn texel(&self, x: usize, y: usize) -> [u8; 3] {
        if let (0, image::Texels::U8(texels)) = (self.level, self.texture.bitmap().texels()) {
            let [r, g, b, _] = texels[y * self.texture.width() as usize + x];
            return [r, g, b];
        }
        let [r, g, b, _] = self.texture.texel(self.level, x, y);
        let code = |v: f64| (v * 255.0 + 0.5) as u8;
        match self.texture.encoding() {
            Encoding::Srgb => [r, g, b].map(|v| code(srgb_from_linear(v.into()))),
            Encoding::Linear => [r, g, b].map(|v| code(v.into())),
            // Means of unit vectors are shorter than 1.
            Encoding::Normal => {
                let mean = Vec3::new(r, g, b).to_f64() * 2.0 - Vec3::splat(1.0);
                mean.normalize_or(Vec3::new(0.0, 0.0, 1.0)).to_array().map(|v| code(v * 0.5 + 0.5))
            }
        }
    }
}

/// The number of blocks chosen sequentially. Runs are independent of one another, and hence of the threads.
const RUN: usize = 4096;

/// The number of earlier blocks that may be repeated, and the number of the newest whose weights may be.
const WINDOW: usize = 256;
const NEWEST: usize = 32;

/// The estimated number of bits that Zstandard needs for a block: for a repeated one, for one with repeated weights,
/// which are its second half, and for a new one.
const REPEATED: f32 = 24.0;
const REFITTED: f32 = 88.0;
const NEW: f32 = 128.0;

/// The channels of a block's texels.
const CHANNELS: f32 = 48.0;

/// Returns the blocks of a run. Each is the candidate with the smallest sum of squared error and bits, where a new
/// block's bits are worth `rdo` of root mean square, of 255. Its mean square error therefore exceeds that of the
/// nearest block by at most `rdo`².
fn run_blocks(tiles: &[Tile], rdo: u8) -> Vec<[u8; 16]> {
    let bit = CHANNELS * f32::from(rdo) * f32::from(rdo) / NEW;
    let mut window = VecDeque::with_capacity(WINDOW + 1);
    tiles.iter().map(|tile| chosen(tile, bit, &mut window)).collect()
}

/// A block that was written, and its decoded texels.
struct Written {
    block: Block,
    colors: Texels,
    bytes: [u8; 16],
}

/// Returns the bytes of a block, which is added to the front of the window if it is new.
fn chosen(tile: &Tile, bit: f32, window: &mut VecDeque<Written>) -> [u8; 16] {
    let mut search = Search::new(tile, bit);
    window.iter().for_each(|earlier| search.repeat(earlier));
    if search.cost > bit * REFITTED {
        window.iter().take(NEWEST).for_each(|earlier| search.refit(earlier));
    }
    let Search { block, colors, repeated, .. } = search;
    repeated.unwrap_or_else(|| {
        let bytes = block.bytes(tile);
        window.push_front(Written { block, colors, bytes });
        window.truncate(WINDOW);
        bytes
    })
}

/// The search for a block, and the best one so far.
struct Search {
    texels: Texels,
    /// The squared error that one bit is worth.
    bit: f32,
    block: Block,
    colors: Texels,
    cost: f32,
    /// The bytes of the earlier block that is repeated.
    repeated: Option<[u8; 16]>,
}

impl Search {
    /// Starts with the nearest block.
    fn new(tile: &Tile, bit: f32) -> Self {
        let (texels, block) = (values(tile), Block::nearest(tile));
        let colors = block.colors();
        let cost = squares(&colors, &texels) + bit * NEW;
        Self { texels, bit, block, colors, cost, repeated: None }
    }

    /// Tries to repeat an earlier block.
    fn repeat(&mut self, earlier: &Written) {
        let cost = squares(&earlier.colors, &self.texels) + self.bit * REPEATED;
        if cost < self.cost {
            let Written { block, colors, bytes } = *earlier;
            (self.block, self.colors, self.cost, self.repeated) = (block, colors, cost, Some(bytes));
        }
    }

    /// Tries to repeat an earlier block's weights.
    fn refit(&mut self, earlier: &Written) {
        let Some(block) = earlier.block.refitted(&self.texels) else { return };
        let colors = block.colors();
        let cost = squares(&colors, &self.texels) + self.bit * REFITTED;
        if cost < self.cost {
            (self.block, self.colors, self.cost, self.repeated) = (block, colors, cost, None);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tiles of a ramp with some noise.
    fn tiles(count: usize) -> Vec<Tile> {
        let texel = |block: usize, k: usize| {
            let noise = (block * 16 + k).wrapping_mul(2_654_435_761) >> 7 & 3;
            let place = block / 2 + k % 4;
            [place + noise, 2 * (place % 64) + noise, 90 + noise].map(|v| (v % 256) as u8)
        };
        (0..count).map(|block| std::array::from_fn(|k| texel(block, k))).collect()
    }

    /// The error added by repetition stays below the bound, and a larger bound allows more repetition.
    #[test]
    fn repeats_within_the_bound() {
        let tiles = tiles(300);
        let distinct = |rdo: u8| {
            let all: std::collections::BTreeSet<[u8; 16]> = run_blocks(&tiles, rdo).into_iter().collect();
            all.len()
        };
        let counts = [1, 4, 16].map(distinct);
        assert!(counts[0] > counts[1] && counts[1] > counts[2], "{counts:?}");
        for rdo in [1u8, 4, 16] {
            let (bound, mut window) = (f32::from(rdo) * f32::from(rdo), VecDeque::new());
            for tile in &tiles {
                let bytes = chosen(tile, CHANNELS * bound / NEW, &mut window);
                let shown = window.iter().find(|written: &&Written| written.bytes == bytes);
                let shown = shown.expect("new or in the window").colors;
                let error = |colors: &Texels| squares(colors, &values(tile)) / CHANNELS;
                let least = error(&Block::nearest(tile).colors());
                assert!(error(&shown) <= least + bound, "{} {least} {bound}", error(&shown));
            }
        }
    }

    #[test]
    fn one_colour_is_one_block() {
        let blocks = run_blocks(&[[[7, 80, 200]; 16]; 9], 1);
        assert!(blocks.iter().all(|block| *block == blocks[0]));
    }
}
