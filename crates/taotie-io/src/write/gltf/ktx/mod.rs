//! KTX2 images of UASTC blocks with all mip levels, each compressed with Zstandard, as KHR_texture_basisu requires.
//!
//! The encoder is our own: of the crates that encode UASTC, one needs `unsafe` to call, the others need cmake or
//! clang to build. Source of the container: KTX File Format 2.0, 3 and 5.

mod block;
mod endpoints;

use block::{Block, Tile, values};
use endpoints::{Texels, squares};
use std::collections::VecDeque;
use taotie_engine::error::{Error, Result};
use taotie_engine::image::{self, Bitmap, Encoding, Texture};
use taotie_engine::math::Vec3;
use taotie_engine::math::srgb::srgb_from_linear;
use taotie_engine::parallel;

const SIGNATURE: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";
const HEADER: usize = 80;
const LEVEL: usize = 24;
const DESCRIPTOR: usize = 44;

/// Constants of the Khronos data format: the model, BT.709 primaries, and transfer functions.
const UASTC: u32 = 166;
const BT709: u32 = 1;
const TRANSFER_LINEAR: u32 = 1;
const TRANSFER_SRGB: u32 = 2;

/// Bytes per block of 4 × 4 texels.
const BLOCK: usize = 16;

/// The supercompression scheme number of Zstandard, and its compression level: the highest that needs no more memory
/// than usual.
const ZSTANDARD: u32 = 2;
const ZSTANDARD_LEVEL: i32 = 19;

/// An image to be encoded.
pub(super) struct KtxImage {
    /// Width and height in texels.
    pub size: [u32; 2],
    /// 8-bit texels; their alpha is ignored.
    pub texels: Vec<[u8; 4]>,
    /// The encoding of the texels.
    pub encoding: Encoding,
    /// As in [`ImageCodec::Ktx2`](crate::ImageCodec).
    pub rdo: u8,
}

/// A mip level as stored.
struct Level {
    /// The Zstandard-compressed blocks.
    packed: Vec<u8>,
    /// The uncompressed size of the blocks in bytes.
    unpacked: usize,
}

/// Encodes the image.
///
/// # Errors
/// [`Error::Unsupported`] if a side is not a multiple of four, which KHR_texture_basisu requires.
pub(super) fn encode(image: KtxImage) -> Result<Vec<u8>> {
    let KtxImage { size: [width, height], texels, encoding, rdo } = image;
    if !width.is_multiple_of(4) || !height.is_multiple_of(4) {
        let what = format!("{width}×{height} KTX2 texture");
        return Err(Error::unsupported(what, "glTF requires multiples of 4; resize it, or write PNG"));
    }
    let texture = Texture::new(Bitmap::new(width, height, 3, image::Texels::U8(texels))?, encoding);
    let pack = |level: usize| Level::new(&MipLevel { texture: &texture, level }.blocks(rdo));
    let levels = parallel::try_tasks(texture.levels(), &pack)?;
    Ok(file([width, height], encoding, &levels))
}

impl Level {
    /// Compresses blocks.
    fn new(blocks: &[u8]) -> Result<Self> {
        let packed = zstd::bulk::compress(blocks, ZSTANDARD_LEVEL)
            .map_err(|e| Error::invalid("Zstandard compression", e.to_string()))?;
        Ok(Self { packed, unpacked: blocks.len() })
    }
}

/// Returns the file: header, level index, descriptor, key-value data, and the levels, the smallest first.
/// Supercompressed levels need no alignment.
fn file([width, height]: [u32; 2], encoding: Encoding, levels: &[Level]) -> Vec<u8> {
    let descriptor_at = HEADER + LEVEL * levels.len();
    let words = key_values();
    let words_at = descriptor_at + DESCRIPTOR;
    let start = words_at + words.len();
    let mut bytes = SIGNATURE.to_vec();
    let count = levels.len() as u32;
    let numbers = [0, 1, width, height, 0, 0, 1, count, ZSTANDARD];
    let places = [descriptor_at as u32, DESCRIPTOR as u32, words_at as u32, words.len() as u32];
    bytes.extend(numbers.into_iter().chain(places).flat_map(u32::to_le_bytes));
    bytes.resize(HEADER, 0);
    for (i, level) in levels.iter().enumerate() {
        let before: usize = levels[i + 1..].iter().map(|level| level.packed.len()).sum();
        let numbers = [start + before, level.packed.len(), level.unpacked];
        bytes.extend(numbers.into_iter().flat_map(|number| (number as u64).to_le_bytes()));
    }
    bytes.extend(descriptor(encoding).into_iter().flat_map(u32::to_le_bytes));
    bytes.extend(words);
    levels.iter().rev().for_each(|level| bytes.extend_from_slice(&level.packed));
    bytes
}

/// Describes 16-byte blocks of 4 × 4 texels, RGB without alpha. Source: Khronos Data Format 1.3, 5.
fn descriptor(encoding: Encoding) -> [u32; DESCRIPTOR / 4] {
    let colors = match encoding {
        Encoding::Srgb => BT709 << 8 | TRANSFER_SRGB << 16,
        Encoding::Linear | Encoding::Normal => TRANSFER_LINEAR << 16,
    };
    let (version, size) = (2, DESCRIPTOR as u32 - 4);
    let last_bit = 127;
    let sides = 3 | 3 << 8;
    [
        DESCRIPTOR as u32,
        0,
        version | size << 16,
        UASTC | colors,
        sides,
        BLOCK as u32,
        0,
        last_bit << 16,
        0,
        0,
        !0,
    ]
}

/// Returns the key-value data: the orientation of the image, and the program that wrote it.
fn key_values() -> Vec<u8> {
    let mut bytes = Vec::new();
    for (key, value) in
        [("KTXorientation", "rd"), ("KTXwriter", concat!("taotie ", env!("CARGO_PKG_VERSION")))]
    {
        let length = key.len() + value.len() + 2;
        bytes.extend((length as u32).to_le_bytes());
        bytes.extend([key, "\0", value, "\0"].concat().bytes());
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    bytes
}

/// A mip level of a texture, encoded as blocks with rate–distortion optimisation: blocks repeat bytes of earlier ones
/// if that costs little, since Zstandard stores repetitions in few bits. The idea is from Basis Universal; the search
/// is our own.
#[derive(Clone, Copy)]
struct MipLevel<'a> {
    texture: &'a Texture,
    level: usize,
}

impl MipLevel<'_> {
    /// Returns the blocks, row by row. `rdo` is as in [`ImageCodec::Ktx2`](crate::ImageCodec).
    fn blocks(&self, rdo: u8) -> Vec<u8> {
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
