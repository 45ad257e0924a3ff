//! KTX2 images with Basis Universal data, ETC1S or UASTC, through the `basisu` crate: all that KHR_texture_basisu
//! allows.

use super::super::reading::{Reading, caught};
use super::limits::{Failure, MAX_TEXELS_OF_PLAIN, TexelRoom, check_room, check_size, credible};
use basisu::{DecodeFlags, Error, TargetFormat, Transcoder};
use taotie_engine::image::{Bitmap, Texels};

/// Colour model numbers of ETC1S and UASTC in the data format descriptor.
const MODELS: [u8; 2] = [163, 166];

/// The supercompression scheme number of Zstandard.
const ZSTANDARD: u32 = 2;

/// Decodes the largest level of an image. Smaller ones are regenerated, as for every other format.
///
/// The decoder (`basisu` 0.1) is a port of many thousand lines of array indexing; if damage makes it panic, the panic
/// is caught here and becomes an error.
pub(super) fn decode(bytes: &[u8], reading: &Reading) -> Result<Bitmap, Failure> {
    let (width, height) = check_header(bytes)?;
    // Unpacked blocks, at most one byte per texel, and the decoder's own texels.
    let scratch = 5 * u64::from(width) * u64::from(height);
    check_room(reading, [width, height], TexelRoom { depth: 1, scratch })?;
    let attempt = caught(|| {
        let transcoder = Transcoder::new(bytes)?;
        let texels = transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE)?;
        Ok::<_, Error>((texels, if transcoder.has_alpha() { 4 } else { 3 }))
    });
    let Some(Ok((texels, channels))) = attempt else {
        return Err(Failure::damaged("damaged blocks"));
    };
    let texels = Texels::U8(texels.as_chunks::<4>().0.to_vec());
    Bitmap::new(width, height, channels, texels).map_err(|e| Failure::Damaged(e.to_string()))
}

/// Returns width and height if the header describes one 2D image of a plausible size. The decoder does not check
/// sizes. Source: KTX File Format 2.0, 3.
fn check_header(bytes: &[u8]) -> Result<(u32, u32), Failure> {
    let truncated = || Failure::Damaged("the file ends within the header; download it again".into());
    let number = |at: usize| field::<4>(bytes, at).map(u32::from_le_bytes).ok_or_else(truncated);
    let [format, width, height] = [number(12)?, number(20)?, number(24)?];
    let [depth, layers, faces, scheme] = [number(28)?, number(32)?, number(36)?, number(44)?];
    let model = bytes.get(number(48)? as usize + 12).ok_or_else(truncated)?;
    if format != 0 || !MODELS.contains(model) {
        return Err(Failure::Unsupported("KTX2 other than Basis Universal ETC1S and UASTC".into()));
    }
    if depth > 0 || layers > 1 || faces != 1 {
        return Err(Failure::Unsupported("KTX2 with several layers, faces or slices".into()));
    }
    let plain = credible(bytes).max(MAX_TEXELS_OF_PLAIN);
    check_size(u64::from(width), u64::from(height), plain)?;
    let unpacked = u64::from_le_bytes(field(bytes, 96).ok_or_else(truncated)?);
    let blocks = u64::from(width.div_ceil(4)) * u64::from(height.div_ceil(4));
    if scheme == ZSTANDARD && unpacked > 16 * blocks {
        return Err(Failure::damaged(&format!("{unpacked} bytes for {blocks} blocks")));
    }
    Ok((width, height))
}

/// Returns `N` bytes starting at `at`.
fn field<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..at.checked_add(N)?)?.try_into().ok()
}
