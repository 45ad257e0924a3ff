//! The sizes of images that are believed, and the reasons why an image cannot be had.

use super::super::limits::Bytes;
use super::super::reading::Reading;
use crate::error::Error;
use crate::image::Bitmap;
use std::path::Path;

/// The most texels of one image: 16,384 × 16,384.
pub(super) const MAX_TEXELS: u64 = 1 << 28;

/// The most texels a byte may pack in formats other than WebP and KTX2: deflate comes to 1032 to 1, and a byte holds
/// 8 one-bit texels. A declared size beyond it is refused before anything is allocated.
const MAX_TEXELS_PER_BYTE: u64 = 1 << 14;

/// The most texels of an image of one colour, 4096 × 4096: WebP and KTX2 hold it in a few bytes, whatever its
/// size.
pub(super) const MAX_TEXELS_OF_PLAIN: u64 = 1 << 24;

/// The reason why an image cannot be had, before it is known which file is to blame.
pub(super) enum Failure {
    /// Its content is wrong.
    Damaged(String),
    /// It has more texels than can be drawn.
    TooLarge(String),
    /// It has content that is not read.
    Unsupported(String),
}

impl Failure {
    /// Returns the failure of wrong content, which saving it again may mend.
    pub fn damaged(why: &str) -> Self {
        Self::Damaged(format!("{why}; save it again"))
    }

    /// Returns the error about the file `path`, at the place `at` in it.
    pub fn into_error(self, path: &Path, at: String) -> Error {
        match self {
            Self::Damaged(what) => Error::parse(path, at, one_line(&what)),
            Self::TooLarge(why) => Error::limit(format!("{}: {at}", path.display()), why),
            Self::Unsupported(what) => Error::unsupported(
                format!("{}: {at}: {}", path.display(), one_line(&what)),
                "convert it to PNG",
            ),
        }
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns the most texels that `bytes` may hold.
pub(super) fn credible(bytes: &[u8]) -> u64 {
    (bytes.len() as u64).saturating_mul(MAX_TEXELS_PER_BYTE)
}

/// The bytes a texel of 8 bits: of four channels, and of their mip levels or of the decoder's own pixels, which go before.
pub(super) const KEPT_OF_8_BITS: u64 = 7;
/// The bytes of one of 16 bits, with mip levels. Where it holds sRGB it becomes float, which is counted as that is done.
const KEPT_OF_16_BITS: u64 = 11;
/// The bytes of one of floats, with mip levels.
const KEPT_OF_FLOATS: u64 = 22;

/// The memory of an image's texels.
#[derive(Debug, Clone, Copy)]
pub(super) struct TexelRoom {
    /// Bytes a channel: 1, 2 or 4.
    pub depth: u64,
    /// Bytes beside the texels while they are decoded.
    pub beside: u64,
}

/// Refuses an image, of a size that was checked, that takes more pixels or memory than there may be. Counted are its
/// texels, the mip levels that will be made of them, and what the decoder needs beside.
pub(super) fn check_room(
    reading: &Reading,
    [width, height]: [u32; 2],
    room: TexelRoom,
) -> std::result::Result<(), Failure> {
    let texels = u64::from(width) * u64::from(height);
    let most = reading.limits().pixels;
    if texels > most {
        return Err(Failure::TooLarge(format!("{width}×{height}; at most {most} pixels: scale it down")));
    }
    let kept = match room.depth {
        1 => KEPT_OF_8_BITS,
        2 => KEPT_OF_16_BITS,
        _ => KEPT_OF_FLOATS,
    };
    let need = texels * kept + room.beside;
    match reading.take(need) {
        true => Ok(()),
        false => Err(Failure::TooLarge(format!("{width}×{height} needs about {} of memory", Bytes(need)))),
    }
}

/// Refuses sizes that cannot be drawn, and those of more than `credible` texels, which cannot be true.
pub(super) fn check_size(width: u64, height: u64, credible: u64) -> std::result::Result<(), Failure> {
    let side = u64::from(Bitmap::MAX_SIDE);
    if width > side || height > side || width * height > MAX_TEXELS {
        let why = format!("{width}×{height}; at most {side} a side and 16384×16384 in all: scale it down");
        return Err(Failure::TooLarge(why));
    }
    if width * height > credible {
        let why = format!("so few bytes cannot hold {width}×{height} texels");
        return Err(Failure::damaged(&why));
    }
    Ok(())
}
