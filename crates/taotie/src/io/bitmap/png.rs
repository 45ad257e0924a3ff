//! Decodes PNG row by row into texels, without an intermediate copy of the whole image.

use super::super::reading::Reading;
use super::limits::{Failure, TexelRoom, check_room, check_size, credible};
use super::widen::widen;
use crate::image::{Bitmap, Texels};
use png::{BitDepth, ColorType, Decoder, DecodingError, Reader, Transformations};
use std::io::Cursor;

type Rows<'a> = Reader<Cursor<&'a [u8]>>;

/// Decodes a PNG; palettes, sub-byte samples and transparent colours become samples of 8 or 16 bits. Returns `None`
/// for an interlaced one.
pub(super) fn decode(bytes: &[u8], reading: &Reading) -> std::result::Result<Option<Bitmap>, Failure> {
    let mut decoder = Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let mut rows = decoder.read_info().map_err(failure)?;
    if rows.info().interlaced {
        return Ok(None);
    }
    let (width, height) = rows.info().size();
    check_size(u64::from(width), u64::from(height), credible(bytes))?;
    let (color, depth) = rows.output_color_type();
    let bytes_of_channel = if depth == BitDepth::Sixteen { 2 } else { 1 };
    check_room(reading, [width, height], TexelRoom { depth: bytes_of_channel, scratch: 0 })?;
    let channels = match color {
        ColorType::Grayscale => 1,
        ColorType::GrayscaleAlpha => 2,
        ColorType::Rgb => 3,
        ColorType::Rgba => 4,
        ColorType::Indexed => return Err(Failure::Unsupported("an unexpanded palette".into())),
    };
    let texels = match depth {
        BitDepth::Eight => {
            Texels::U8(texels(&mut rows, channels, u8::MAX, |line, samples: &mut Vec<u8>| {
                samples.extend_from_slice(line);
            })?)
        }
        BitDepth::Sixteen => Texels::U16(texels(&mut rows, channels, u16::MAX, |line, samples| {
            samples.extend(line.as_chunks().0.iter().map(|bytes| u16::from_be_bytes(*bytes)));
        })?),
        other => return Err(Failure::Unsupported(format!("unexpanded bit depth {other:?}"))),
    };
    Bitmap::new(width, height, channels, texels).map(Some).map_err(|e| Failure::Damaged(e.to_string()))
}

/// Returns all texels; `read` appends the samples of a row of bytes.
fn texels<T: Copy + Default>(
    rows: &mut Rows<'_>,
    channels: u8,
    one: T,
    read: impl Fn(&[u8], &mut Vec<T>),
) -> std::result::Result<Vec<[T; 4]>, Failure> {
    let (width, height) = rows.info().size();
    let mut texels = Vec::with_capacity(width as usize * height as usize);
    let mut row = vec![[T::default(); 4]; width as usize];
    let mut samples = Vec::new();
    while let Some(line) = rows.next_row().map_err(failure)? {
        samples.clear();
        read(line.data(), &mut samples);
        widen(&samples, channels, one, &mut row);
        texels.extend_from_slice(&row);
    }
    Ok(texels)
}

fn failure(error: DecodingError) -> Failure {
    match error {
        DecodingError::LimitsExceeded => Failure::TooLarge(error.to_string()),
        other => Failure::Damaged(other.to_string()),
    }
}
