//! Limits on image sizes, and the reasons why an image cannot be decoded.

use super::super::limits::Bytes;
use super::super::reading::Reading;
use crate::error::Error;
use crate::image::Bitmap;
use std::path::Path;

/// Maximum number of texels of one image: 16,384 × 16,384.
pub(super) const MAX_TEXELS: u64 = 1 << 28;

/// Maximum number of texels per byte in formats other than WebP and KTX2: deflate reaches 1032 to 1, and a byte holds
/// 8 one-bit texels. A larger declared size is rejected before anything is allocated.
const MAX_TEXELS_PER_BYTE: u64 = 1 << 14;

/// Maximum number of texels of a single-colour image, 4096 × 4096: WebP and KTX2 store it in a few bytes, whatever
/// its size.
pub(super) const MAX_TEXELS_OF_PLAIN: u64 = 1 << 24;

/// The reason why an image cannot be decoded, before it is known which file is at fault.
pub(super) enum Failure {
    /// Its content is invalid.
    Damaged(String),
    /// It has more texels than can be drawn.
    TooLarge(String),
    /// It has unsupported content.
    Unsupported(String),
}

impl Failure {
    /// Returns the failure for invalid content, which re-saving may fix.
    pub fn damaged(why: &str) -> Self {
        Self::Damaged(format!("{why}; re-save it"))
    }

    /// Returns the error for the file `path`, at the place `at` in it.
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

/// Returns the maximum number of texels that `bytes` may hold.
pub(super) fn credible(bytes: &[u8]) -> u64 {
    (bytes.len() as u64).saturating_mul(MAX_TEXELS_PER_BYTE)
}

/// Bytes per 8-bit texel: its four channels, plus the mip levels or, before these exist, the decoder's own pixels.
pub(super) const KEPT_OF_8_BITS: u64 = 7;
/// Bytes per 16-bit texel, with mip levels. sRGB texels become floats, which is counted during that conversion.
const KEPT_OF_16_BITS: u64 = 11;
/// Bytes per float texel, with mip levels.
const KEPT_OF_FLOATS: u64 = 22;

/// The memory of an image's texels.
#[derive(Debug, Clone, Copy)]
pub(super) struct TexelRoom {
    /// Bytes per channel: 1, 2 or 4.
    pub depth: u64,
    /// Bytes needed in addition to the texels during decoding.
    pub scratch: u64,
}

/// Rejects an image, of an already checked size, that needs more pixels or memory than allowed. Its texels, the mip
/// levels that will be made from them, and the decoder's additional needs are counted.
pub(super) fn check_room(
    reading: &Reading,
    [width, height]: [u32; 2],
    room: TexelRoom,
) -> std::result::Result<(), Failure> {
    let texels = u64::from(width) * u64::from(height);
    let most = reading.limits().pixels;
    if texels > most {
        return Err(Failure::TooLarge(format!(
            "{width}×{height}; the maximum is {most} pixels: scale it down"
        )));
    }
    let kept = match room.depth {
        1 => KEPT_OF_8_BITS,
        2 => KEPT_OF_16_BITS,
        _ => KEPT_OF_FLOATS,
    };
    let need = texels * kept + room.scratch;
    match reading.take(need) {
        true => Ok(()),
        false => Err(Failure::TooLarge(format!("{width}×{height} needs about {} of memory", Bytes(need)))),
    }
}

/// Rejects sizes that cannot be rendered, and those of more than `credible` texels, which cannot be true.
pub(super) fn check_size(width: u64, height: u64, credible: u64) -> std::result::Result<(), Failure> {
    let side = u64::from(Bitmap::MAX_SIDE);
    if width > side || height > side || width * height > MAX_TEXELS {
        let why =
            format!("{width}×{height}; at most {side} per side and 16384×16384 in total: scale it down");
        return Err(Failure::TooLarge(why));
    }
    if width * height > credible {
        let why = format!("the file cannot hold {width}×{height} texels");
        return Err(Failure::damaged(&why));
    }
    Ok(())
}
