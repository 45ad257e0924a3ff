//! KTX2 images of UASTC blocks with all mip levels, each compressed with Zstandard, as KHR_texture_basisu requires.
//!
//! The encoder is our own: of the crates that encode UASTC, one needs `unsafe` to call, the others need cmake or
//! clang to build. Source of the container: KTX File Format 2.0, 3 and 5.

mod block;
mod endpoints;
mod levels;

use levels::MipLevel;
use taotie_engine::error::{Error, Result};
use taotie_engine::image::{Bitmap, Encoding, Texels, Texture};
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
    let texture = Texture::new(Bitmap::new(width, height, 3, Texels::U8(texels))?, encoding);
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
