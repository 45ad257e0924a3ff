//! KTX2 images of UASTC blocks with all mip levels, as KHR_texture_basisu wants them.
//!
//! The encoder is ours: of the crates that encode UASTC one needs `unsafe` to be called, the others cmake or clang to
//! be built. Source of the container: KTX File Format 2.0, 3 and 5.

mod block;
mod fit;
mod range;

use crate::error::{Error, Result};
use crate::image::{Bitmap, Encoding, Texels, Texture};
use crate::math::Vec3;
use crate::math::srgb::srgb_from_linear;
use crate::parallel;

const SIGNATURE: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";
const HEADER: usize = 80;
const LEVEL: usize = 24;
const DESCRIPTOR: usize = 44;

/// Numbers of the Khronos data format: the model, primaries of BT.709, and transfer functions.
const UASTC: u32 = 166;
const BT709: u32 = 1;
const TRANSFER_LINEAR: u32 = 1;
const TRANSFER_SRGB: u32 = 2;

/// The bytes of a block of 4 × 4 texels; levels begin at multiples of it.
const BLOCK: usize = 16;

/// Returns the file for texels of 8 bits, of which alpha is not read.
///
/// # Errors
/// [`Error::Unsupported`] where a side is no multiple of four, which KHR_texture_basisu demands.
pub(super) fn encode(
    (width, height): (u32, u32),
    texels: Vec<[u8; 4]>,
    encoding: Encoding,
) -> Result<Vec<u8>> {
    if !width.is_multiple_of(4) || !height.is_multiple_of(4) {
        let what = format!("a texture of {width}×{height} in KTX2");
        return Err(Error::unsupported(what, "glTF wants multiples of 4; scale it, or write PNG"));
    }
    let texture = Texture::new(Bitmap::new(width, height, 3, Texels::U8(texels))?, encoding);
    let levels: Vec<Vec<u8>> = (0..texture.levels()).map(|level| blocks(&texture, level)).collect();
    Ok(file((width, height), encoding, &levels))
}

/// Returns the blocks of a level, row by row. Texels beyond the border are those at the border.
fn blocks(texture: &Texture, level: usize) -> Vec<u8> {
    let (width, height) = texture.level_size(level);
    let (across, down) = (width.div_ceil(4) as usize, height.div_ceil(4) as usize);
    let block_at = |i: usize| {
        let (x0, y0) = (i % across * 4, i / across * 4);
        block::encode(&std::array::from_fn(|k| {
            let (x, y) = ((x0 + k % 4).min(width as usize - 1), (y0 + k / 4).min(height as usize - 1));
            texel(texture, level, (x, y))
        }))
    };
    parallel::collect(across * down, block_at).into_flattened()
}

/// Returns a texel as it is stored in 8 bits.
fn texel(texture: &Texture, level: usize, (x, y): (usize, usize)) -> [u8; 3] {
    if let (0, Texels::U8(texels)) = (level, texture.bitmap().texels()) {
        let [r, g, b, _] = texels[y * texture.width() as usize + x];
        return [r, g, b];
    }
    let [r, g, b, _] = texture.texel(level, x, y);
    let code = |v: f64| (v * 255.0 + 0.5) as u8;
    match texture.encoding() {
        Encoding::Srgb => [r, g, b].map(|v| code(srgb_from_linear(v.into()))),
        Encoding::Linear => [r, g, b].map(|v| code(v.into())),
        // Means of unit vectors are shorter than one.
        Encoding::Normal => {
            let mean = Vec3::new(r, g, b).to_f64() * 2.0 - Vec3::splat(1.0);
            mean.normalize_or(Vec3::new(0.0, 0.0, 1.0)).to_array().map(|v| code(v * 0.5 + 0.5))
        }
    }
}

/// Returns the file: header, level index, descriptor, key-value data, and the levels, the smallest first.
fn file((width, height): (u32, u32), encoding: Encoding, levels: &[Vec<u8>]) -> Vec<u8> {
    let descriptor_at = HEADER + LEVEL * levels.len();
    let words = key_values();
    let words_at = descriptor_at + DESCRIPTOR;
    let start = (words_at + words.len()).next_multiple_of(BLOCK);
    let mut bytes = SIGNATURE.to_vec();
    let count = levels.len() as u32;
    let numbers = [0, 1, width, height, 0, 0, 1, count, 0];
    let places = [descriptor_at as u32, DESCRIPTOR as u32, words_at as u32, words.len() as u32];
    bytes.extend(numbers.into_iter().chain(places).flat_map(u32::to_le_bytes));
    bytes.resize(HEADER, 0);
    for i in 0..levels.len() {
        let before: usize = levels[i + 1..].iter().map(Vec::len).sum();
        let length = levels[i].len() as u64;
        bytes.extend([(start + before) as u64, length, length].into_iter().flat_map(u64::to_le_bytes));
    }
    bytes.extend(descriptor(encoding).into_iter().flat_map(u32::to_le_bytes));
    bytes.extend(words);
    bytes.resize(start, 0);
    levels.iter().rev().for_each(|level| bytes.extend_from_slice(level));
    bytes
}

/// Blocks of 4 × 4 texels in 16 bytes, of RGB without alpha. Source: Khronos Data Format 1.3, 5.
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
