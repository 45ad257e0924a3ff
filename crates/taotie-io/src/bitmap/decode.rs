//! Decodes PNG, JPEG, WebP, TGA, TIFF and Radiance HDR through the crates `image` and `png`.

use super::super::reading::Reading;
use super::limits::{
    Failure, KEPT_OF_8_BITS, MAX_TEXELS, MAX_TEXELS_OF_PLAIN, TexelRoom, check_room, check_size, credible,
};
use image::metadata::Orientation;
use image::{
    DynamicImage, ImageBuffer, ImageDecoder, ImageError, ImageFormat, ImageReader, Pixel, Primitive, Rgba,
};
use png::{BitDepth, ColorType, Decoder, DecodingError, Transformations};
use std::borrow::Cow;
use std::io::Cursor;
use taotie_engine::image::{Bitmap, Texels};

/// Decodes an image through the `image` crate.
pub(super) fn decode(
    bytes: &[u8],
    format: ImageFormat,
    reading: &Reading,
) -> std::result::Result<Bitmap, Failure> {
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.no_limits();
    let mut decoder = reader.into_decoder().map_err(failure)?;
    let (width, height) = decoder.dimensions();
    let credible = match format {
        ImageFormat::WebP => credible(bytes).max(MAX_TEXELS_OF_PLAIN),
        _ => credible(bytes),
    };
    check_size(u64::from(width), u64::from(height), credible)?;
    let color = decoder.color_type();
    let depth = u64::from(color.bytes_per_pixel() / color.channel_count());
    let (texels, own) = (u64::from(width) * u64::from(height), u64::from(color.bytes_per_pixel()));
    let scratch = match format {
        ImageFormat::Jpeg => {
            let room = jpeg_room(bytes, own).ok_or_else(|| Failure::Damaged("invalid header".into()))?;
            // The file is kept, and copied once, when the decoder's memory is free again.
            room.saturating_sub(KEPT_OF_8_BITS * texels).max(2 * bytes.len() as u64)
        }
        // The decoder's own image exists alongside the texels made from it, and some decoders copy it again.
        _ => 2 * own * texels,
    };
    check_room(reading, [width, height], TexelRoom { depth, scratch })?;
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(MAX_TEXELS * 16);
    decoder.set_limits(limits).map_err(failure)?;
    let picture = DynamicImage::from_decoder(decoder).map_err(failure)?;
    let bitmap = bitmap_from(picture)?;
    let is_opaque = matches!(bitmap.channels(), 1 | 3);
    let file =
        stored_file(bytes, format).filter(|file| is_opaque && file.len() as u64 <= bitmap.texels().bytes());
    Ok(match file {
        Some(file) => bitmap.with_file(file.into()),
        None => bitmap,
    })
}

/// Returns a file that every browser decodes to the same picture, up to rounding: WebP without metadata, or JPEG,
/// from which metadata are removed: orientations and colour profiles are not applied to textures. `None` for others.
fn stored_file(bytes: &[u8], format: ImageFormat) -> Option<Cow<'_, [u8]>> {
    match format {
        ImageFormat::WebP => {
            let length = u32::from_le_bytes(*bytes.get(16..)?.first_chunk()?) as usize;
            let is_whole = bytes.len() == 20 + length.next_multiple_of(2);
            (is_whole && matches!(bytes.get(12..16)?, b"VP8 " | b"VP8L")).then_some(Cow::Borrowed(bytes))
        }
        ImageFormat::Jpeg => jpeg_without_metadata(bytes).map(Cow::Owned),
        _ => None,
    }
}

/// Returns a JPEG without comments, application data and anything after its end. JFIF's header is kept without its
/// thumbnail, and Adobe's, since they concern the colours. `None` unless it has one or three components.
fn jpeg_without_metadata(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut kept = bytes.get(..2)?.to_vec();
    let mut at = 2;
    loop {
        let [0xff, marker] = *bytes.get(at..)?.first_chunk::<2>()? else { return None };
        if marker == 0xd9 {
            kept.extend([0xff, marker]);
            return Some(kept);
        }
        let length = u16::from_be_bytes(*bytes.get(at + 2..)?.first_chunk()?);
        let segment = bytes.get(at..at + 2 + usize::from(length))?;
        at += segment.len();
        match marker {
            0xc0..=0xc2 if !matches!(segment.get(9)?, 1 | 3) => return None,
            0xc0..=0xc2 | 0xc4 | 0xdb | 0xdd => kept.extend(segment),
            0xe0 if segment.get(4..9) == Some(b"JFIF\0") => {
                kept.extend([0xff, marker, 0, 16]);
                kept.extend(segment.get(4..16)?);
                kept.extend([0, 0]);
            }
            0xee => kept.extend(segment.get(..16).filter(|_| length == 14)?),
            0xda => {
                let scan = entropy_coded(bytes.get(at..)?)?;
                kept.extend(segment);
                kept.extend(scan);
                at += scan.len();
            }
            0xe0..=0xef | 0xfe => (),
            _ => return None,
        }
    }
}

/// Returns the bytes before the next marker that does not belong to a scan's data.
fn entropy_coded(bytes: &[u8]) -> Option<&[u8]> {
    let is_marker = |pair: &[u8]| pair[0] == 0xff && !matches!(pair[1], 0 | 0xd0..=0xd7 | 0xff);
    bytes.get(..bytes.windows(2).position(is_marker)?)
}

/// Returns an image turned as its file's metadata state (EXIF), for photographs: textures are never turned.
pub(super) fn upright(bitmap: Bitmap, bytes: &[u8]) -> Bitmap {
    let stated = || {
        let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().ok()?;
        reader.no_limits();
        reader.into_decoder().ok()?.orientation().ok()
    };
    match stated() {
        None | Some(Orientation::NoTransforms) => bitmap,
        Some(orientation) => turned(&bitmap, orientation).unwrap_or(bitmap),
    }
}

fn turned(bitmap: &Bitmap, orientation: Orientation) -> Option<Bitmap> {
    let mut picture = match bitmap.texels() {
        Texels::U8(texels) => DynamicImage::ImageRgba8(rgba(bitmap, texels)?),
        Texels::U16(texels) => DynamicImage::ImageRgba16(rgba(bitmap, texels)?),
        Texels::F32(texels) => DynamicImage::ImageRgba32F(rgba(bitmap, texels)?),
    };
    picture.apply_orientation(orientation);
    let (width, height) = (picture.width(), picture.height());
    let texels = match &picture {
        DynamicImage::ImageRgba8(p) => Texels::U8(p.as_chunks().0.to_vec()),
        DynamicImage::ImageRgba16(p) => Texels::U16(p.as_chunks().0.to_vec()),
        DynamicImage::ImageRgba32F(p) => Texels::F32(p.as_chunks().0.to_vec()),
        _ => return None,
    };
    Bitmap::new(width, height, bitmap.channels(), texels).ok()
}

fn rgba<T: Primitive>(bitmap: &Bitmap, texels: &[[T; 4]]) -> Option<ImageBuffer<Rgba<T>, Vec<T>>>
where
    Rgba<T>: Pixel<Subpixel = T>,
{
    ImageBuffer::from_raw(bitmap.width(), bitmap.height(), texels.as_flattened().to_vec())
}

fn failure(error: ImageError) -> Failure {
    match error {
        ImageError::Limits(e) => Failure::TooLarge(e.to_string()),
        ImageError::Unsupported(e) => Failure::Unsupported(e.to_string()),
        other => Failure::Damaged(other.to_string()),
    }
}

fn bitmap_from(picture: DynamicImage) -> std::result::Result<Bitmap, Failure> {
    let (width, height) = (picture.width(), picture.height());
    let channels = picture.color().channel_count();
    let texels = match &picture {
        DynamicImage::ImageLuma8(p) => Texels::U8(expand(p, channels, u8::MAX)),
        DynamicImage::ImageLumaA8(p) => Texels::U8(expand(p, channels, u8::MAX)),
        DynamicImage::ImageRgb8(p) => Texels::U8(expand(p, channels, u8::MAX)),
        DynamicImage::ImageRgba8(p) => Texels::U8(expand(p, channels, u8::MAX)),
        DynamicImage::ImageLuma16(p) => Texels::U16(expand(p, channels, u16::MAX)),
        DynamicImage::ImageLumaA16(p) => Texels::U16(expand(p, channels, u16::MAX)),
        DynamicImage::ImageRgb16(p) => Texels::U16(expand(p, channels, u16::MAX)),
        DynamicImage::ImageRgba16(p) => Texels::U16(expand(p, channels, u16::MAX)),
        DynamicImage::ImageRgb32F(p) => Texels::F32(expand(p, channels, 1.0)),
        DynamicImage::ImageRgba32F(p) => Texels::F32(expand(p, channels, 1.0)),
        other => return Err(Failure::Unsupported(format!("pixel type {:?}", other.color()))),
    };
    Bitmap::new(width, height, channels, texels).map_err(|e| Failure::Damaged(e.to_string()))
}

type Rows<'a> = png::Reader<Cursor<&'a [u8]>>;

/// Decodes a PNG row by row, without an intermediate copy of the whole image; palettes, sub-byte samples and
/// transparent colours become samples of 8 or 16 bits. Returns `None` for an interlaced one.
pub(super) fn decode_png(bytes: &[u8], reading: &Reading) -> std::result::Result<Option<Bitmap>, Failure> {
    let mut decoder = Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let mut rows = decoder.read_info().map_err(png_failure)?;
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
            Texels::U8(png_texels(&mut rows, channels, u8::MAX, |line, samples: &mut Vec<u8>| {
                samples.extend_from_slice(line);
            })?)
        }
        BitDepth::Sixteen => Texels::U16(png_texels(&mut rows, channels, u16::MAX, |line, samples| {
            samples.extend(line.as_chunks().0.iter().map(|bytes| u16::from_be_bytes(*bytes)));
        })?),
        other => return Err(Failure::Unsupported(format!("unexpanded bit depth {other:?}"))),
    };
    Bitmap::new(width, height, channels, texels).map(Some).map_err(|e| Failure::Damaged(e.to_string()))
}

/// Returns all texels; `read` appends the samples of a row of bytes.
fn png_texels<T: Copy + Default>(
    rows: &mut Rows<'_>,
    channels: u8,
    one: T,
    read: impl Fn(&[u8], &mut Vec<T>),
) -> std::result::Result<Vec<[T; 4]>, Failure> {
    let (width, height) = rows.info().size();
    let mut texels = Vec::with_capacity(width as usize * height as usize);
    let mut row = vec![[T::default(); 4]; width as usize];
    let mut samples = Vec::new();
    while let Some(line) = rows.next_row().map_err(png_failure)? {
        samples.clear();
        read(line.data(), &mut samples);
        widen(&samples, channels, one, &mut row);
        texels.extend_from_slice(&row);
    }
    Ok(texels)
}

fn png_failure(error: DecodingError) -> Failure {
    match error {
        DecodingError::LimitsExceeded => Failure::TooLarge(error.to_string()),
        other => Failure::Damaged(other.to_string()),
    }
}

/// Converts interleaved samples to RGBA texels; grey is repeated, missing alpha is `one`.
fn expand<T: Copy + Default>(samples: &[T], channels: u8, one: T) -> Vec<[T; 4]> {
    let mut texels = vec![[T::default(); 4]; samples.len() / usize::from(channels)];
    widen(samples, channels, one, &mut texels);
    texels
}

/// Like [`expand`], but writes into existing memory.
fn widen<T: Copy>(samples: &[T], channels: u8, one: T, texels: &mut [[T; 4]]) {
    match channels {
        1 => each(samples, texels, |[v]| [v, v, v, one]),
        2 => each(samples, texels, |[v, a]| [v, v, v, a]),
        3 => each(samples, texels, |[r, g, b]| [r, g, b, one]),
        _ => each(samples, texels, |texel| texel),
    }
}

/// Converts samples with a channel count known at compile time.
fn each<T: Copy, const N: usize>(samples: &[T], texels: &mut [[T; 4]], texel: impl Fn([T; N]) -> [T; 4]) {
    for (to, samples) in texels.iter_mut().zip(samples.as_chunks().0) {
        *to = texel(*samples);
    }
}

/// Returns the bytes needed for decoding a JPEG, estimated from its header, including the decoder's pixels and its
/// copy of the file; `None` for a file that it rejects.
///
/// The decoder (`zune-jpeg` 0.5) keeps one row of blocks if a single scan has all components. For a progressive file,
/// and for one whose components come in several scans, it keeps all coefficients, two bytes each. Markers are located
/// as the decoder does, so that no file can present a different header to it.
fn jpeg_room(bytes: &[u8], bytes_per_pixel: u64) -> Option<u64> {
    let header = JpegHeader::read(bytes)?;
    let pixels = header.width * header.height * bytes_per_pixel;
    let coefficients = if header.keeps_all { header.coefficients() } else { 0 };
    Some(pixels + coefficients + header.rows() + header.length + bytes.len() as u64)
}

/// The start of a frame and of its first scan.
#[derive(Debug, PartialEq)]
struct JpegHeader {
    width: u64,
    height: u64,
    /// The samples of each component across and down in a block of the file, 1 to 4.
    samplings: Vec<[u64; 2]>,
    /// `true` if all coefficients are kept.
    keeps_all: bool,
    /// The length of the file in bytes, including metadata, of which the decoder makes copies.
    length: u64,
}

impl JpegHeader {
    fn read(bytes: &[u8]) -> Option<Self> {
        let mut reader = JpegReader { bytes: bytes.strip_prefix(b"\xff\xd8")?, last: 0 };
        let mut frame = None;
        loop {
            let marker = reader.marker()?;
            let segment = reader.segment()?;
            match marker {
                0xc0..=0xc2 if frame.is_none() => frame = Some(Self::of_frame(marker, segment)?),
                // Other frames, arithmetic coding, an end without an image, a height that comes later.
                0xc0..=0xc3 | 0xc5..=0xc7 | 0xc9..=0xcd | 0xcf | 0xd9 | 0xdc => return None,
                0xda => {
                    let of_scan = usize::from(*segment.first()?);
                    let length = (bytes.len() - reader.bytes.len()) as u64;
                    return frame.map(|frame| Self {
                        keeps_all: frame.keeps_all || of_scan != frame.samplings.len(),
                        length,
                        ..frame
                    });
                }
                _ => {}
            }
        }
    }

    /// Reads the frame header.
    fn of_frame(marker: u8, segment: &[u8]) -> Option<Self> {
        let [_, h1, h0, w1, w0, count, components @ ..] = segment else { return None };
        let (components, rest) = components.as_chunks::<3>();
        if components.len() != usize::from(*count) || !rest.is_empty() {
            return None;
        }
        let sampling = |[_, factors, _]: &[u8; 3]| [factors >> 4, factors & 15].map(u64::from);
        let samplings: Vec<[u64; 2]> = components.iter().map(sampling).collect();
        let is_known = |sampling: &[u64; 2]| sampling.iter().all(|factor| (1..=4).contains(factor));
        let side = |high: &u8, low: &u8| u64::from(u16::from_be_bytes([*high, *low]));
        let (width, height, keeps_all) = (side(w1, w0), side(h1, h0), marker == 0xc2);
        let is_whole = !samplings.is_empty() && samplings.iter().all(is_known);
        is_whole.then_some(Self { width, height, samplings, keeps_all, length: 0 })
    }

    /// Returns the maximum sampling factors of the components, across and down.
    fn most(&self) -> [u64; 2] {
        [0, 1].map(|axis| self.samplings.iter().map(|sampling| sampling[axis]).max().unwrap_or(1))
    }

    /// Returns the bytes of all coefficients: two for each sample of each component, in whole blocks.
    fn coefficients(&self) -> u64 {
        let [across, down] = self.most();
        let blocks = self.width.div_ceil(8 * across) * self.height.div_ceil(8 * down);
        self.samplings.iter().map(|[h, v]| 2 * 64 * blocks * h * v).sum()
    }

    /// Returns the bytes of one row of blocks: its samples, and the same upsampled to the finest component's
    /// resolution.
    fn rows(&self) -> u64 {
        let [across, down] = self.most();
        let blocks = self.width.div_ceil(8 * across);
        let of_component = |[h, v]: &[u64; 2]| {
            let (stride, finer) = (8 * blocks * h, across.div_ceil(*h) * down.div_ceil(*v));
            // Samples; two rows and one upsampled; eight upsampled, which may be doubled, or all samples twice as wide.
            stride * (16 * v + 4 * v + 2 * v * finer + (32 * finer).max(32 * v))
        };
        self.samplings.iter().map(of_component).sum::<u64>() + 16 * 8 * blocks * across
    }
}

/// The rest of a file, and the last byte read before it.
struct JpegReader<'a> {
    bytes: &'a [u8],
    last: u8,
}

impl<'a> JpegReader<'a> {
    fn byte(&mut self) -> Option<u8> {
        let (byte, rest) = self.bytes.split_first()?;
        self.bytes = rest;
        Some(*byte)
    }

    /// Returns the next marker: the byte after one or more 255s. Zeros after a 255 are skipped as well.
    fn marker(&mut self) -> Option<u8> {
        loop {
            let mut byte = self.byte()?;
            if self.last == 0xff {
                while byte == 0xff || byte == 0 {
                    self.last = byte;
                    byte = self.byte()?;
                }
            }
            let is_marker = self.last == 0xff;
            self.last = byte;
            if is_marker {
                return Some(byte);
            }
        }
    }

    /// Returns the segment after a marker, whose length is stored in its first two bytes.
    fn segment(&mut self) -> Option<&'a [u8]> {
        let length = usize::from(u16::from_be_bytes([self.byte()?, self.byte()?]));
        let (segment, rest) = self.bytes.split_at_checked(length.checked_sub(2)?)?;
        self.bytes = rest;
        Some(segment)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A header of 64 × 32 pixels, from a frame marker, the components' sampling factors, and the component count of
    /// the first scan.
    fn file(frame: u8, factors: &[u8], scan: u8) -> Vec<u8> {
        let count = factors.len() as u8;
        let mut bytes = b"\xff\xd8\xff\xe0\0\x06ab\xff\xc2".to_vec();
        bytes.extend([0xff, frame, 0, 8 + 3 * count, 8, 0, 32, 0, 64, count]);
        bytes.extend(factors.iter().enumerate().flat_map(|(i, factor)| [i as u8, *factor, 0]));
        bytes.extend([0xff, 0xff, 0xda, 0, 6 + 2 * scan, scan]);
        bytes.extend((0..scan).flat_map(|i| [i, 0]).chain([0, 63, 0]));
        bytes
    }

    fn keeps_all(bytes: &[u8]) -> Option<bool> {
        JpegHeader::read(bytes).map(|header| header.keeps_all)
    }

    #[test]
    fn coefficients_are_kept_where_no_scan_has_all() {
        let fine = [0x11; 3];
        let cases = [(0xc0, 3), (0xc1, 3), (0xc2, 3), (0xc2, 1), (0xc0, 1)];
        let kept = cases.map(|(frame, scan)| keeps_all(&file(frame, &fine, scan)).unwrap());
        assert_eq!(kept, [false, false, true, true, true]);
    }

    #[test]
    fn room_is_of_samples_and_rows() {
        let file = file(0xc2, &[0x22, 0x11, 0x11], 3);
        let header = JpegHeader::read(&file).unwrap();
        assert_eq!((header.width, header.height, header.length), (64, 32, file.len() as u64));
        let samples = 64 * 32 + 2 * 32 * 16;
        assert_eq!(header.coefficients(), 2 * samples);
        let all = jpeg_room(&file, 3).unwrap();
        assert_eq!(all, 64 * 32 * 3 + 2 * samples + header.rows() + 2 * file.len() as u64);
        // The buffered rows are small compared with a tall image.
        assert!((64 * 176..=64 * 320).contains(&header.rows()), "{}", header.rows());
    }

    #[test]
    fn what_the_decoder_refuses_has_no_header() {
        let sound = file(0xc0, &[0x11], 1);
        assert!(keeps_all(&sound).is_some());
        assert!((0..sound.len()).all(|end| keeps_all(&sound[..end]).is_none()));
        let twice = [&sound[..sound.len() - 11], &sound[10..]].concat();
        for wrong in [&file(0xc9, &[0x11], 1), &file(0xc0, &[0x51], 1), &file(0xc0, &[], 0), &twice] {
            assert_eq!(keeps_all(wrong), None);
        }
        // Zeros between a 255 and a marker hide the marker.
        let hidden = [&b"\xff\xd8\xff\0\xc2"[..], &sound[2..]].concat();
        assert_eq!(keeps_all(&hidden), Some(false));
    }
}
