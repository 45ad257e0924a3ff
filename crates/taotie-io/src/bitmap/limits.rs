//! Limits on images: their sizes, read from headers, and the memory of their texels and of the textures made from
//! them; and the reasons why an image cannot be decoded.

use super::super::limits::Bytes;
use super::super::reading::Reading;
use imagesize::{Compression, ImageError, ImageSize, ImageType};
use std::io::{BufRead, Seek};
use std::path::Path;
use taotie_engine::error::Error;
use taotie_engine::image::{Bitmap, Encoding, Texels, Texture};

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

/// Makes a texture from an image whose texels and mip levels were counted when it was read; `None` if its additional
/// needs do not fit in memory.
pub(crate) fn texture(reading: &Reading, bitmap: Bitmap, encoding: Encoding) -> Option<Texture> {
    count_first(reading, &bitmap, encoding).then(|| Texture::new(bitmap, encoding))
}

/// Makes a texture from an image combined from others, and counts all of it; `None` if it does not fit in memory.
pub(crate) fn combined(reading: &Reading, bitmap: Bitmap, encoding: Encoding) -> Option<Texture> {
    count_copy(reading, &bitmap, encoding).then(|| Texture::new(bitmap, encoding))
}

/// Counts the needs of an image's first texture beyond those counted when it was read; returns `true` if they fit.
pub(crate) fn count_first(reading: &Reading, bitmap: &Bitmap, encoding: Encoding) -> bool {
    // When it is read, its encoding is unknown.
    let counted = bytes(bitmap.texels(), Encoding::Linear);
    reading.take(bytes(bitmap.texels(), encoding) - counted)
}

/// Counts all of a texture of a copied image; returns `true` if it fits.
pub(crate) fn count_copy(reading: &Reading, bitmap: &Bitmap, encoding: Encoding) -> bool {
    reading.take(bytes(bitmap.texels(), encoding))
}

/// Returns the peak number of bytes for texels and everything that a texture makes from them. Mip levels are a third
/// of the finest; those of 8-bit normals have 16 bits.
fn bytes(texels: &Texels, encoding: Encoding) -> u64 {
    let per_texel = match (texels, encoding) {
        (Texels::U8(_), _) => 4 + 3,
        // It is converted to float before it is freed.
        (Texels::U16(_), Encoding::Srgb) => 8 + 16,
        (Texels::U16(_), _) => 8 + 3,
        (Texels::F32(_), _) => 16 + 6,
    };
    texels.len() as u64 * per_texel
}

/// The size and format of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ImageHeader {
    /// Texels across and down.
    pub size: [u32; 2],
    /// Its media type, such as `image/png`.
    pub media_type: &'static str,
}

/// The media type of KTX2.
pub(crate) const KTX2_TYPE: &str = "image/ktx2";

impl ImageHeader {
    /// Reads only the header of an image; returns `None` if the format is unknown or the header is damaged.
    pub fn read(image: impl BufRead + Seek) -> Option<Self> {
        let found = |mut image| -> Result<(ImageType, ImageSize), ImageError> {
            let kind = imagesize::reader_type(&mut image)?;
            Ok((kind, kind.reader_size(&mut image)?))
        };
        let (kind, ImageSize { width, height }) = found(image).ok()?;
        let media_type = match kind {
            ImageType::Png => "image/png",
            ImageType::Jpeg => "image/jpeg",
            ImageType::Webp => "image/webp",
            ImageType::Heif(Compression::Av1) => "image/avif",
            ImageType::Ktx2 => KTX2_TYPE,
            ImageType::Tga => "image/x-tga",
            ImageType::Hdr => "image/vnd.radiance",
            ImageType::Exr => "image/x-exr",
            _ => return None,
        };
        Some(Self { size: [u32::try_from(width).ok()?, u32::try_from(height).ok()?], media_type })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Limits;
    use image::ImageFormat;
    use std::io::Cursor;

    fn reading(memory: u64) -> Reading {
        Reading::new(Path::new("a.png"), &Limits { memory: Some(Bytes(memory)), ..Limits::default() })
    }

    #[test]
    fn deep_colours_become_float_and_that_counts() {
        let bitmap = Bitmap::new(8, 8, 3, Texels::U16(vec![[1, 2, 3, 4]; 64])).unwrap();
        // 11 of 24 bytes per texel were counted when the image was read.
        assert!(texture(&reading(13 * 64), bitmap.clone(), Encoding::Srgb).is_some());
        assert!(texture(&reading(13 * 64 - 1), bitmap.clone(), Encoding::Srgb).is_none());
        assert!(texture(&reading(1), bitmap.clone(), Encoding::Linear).is_some());
        assert!(combined(&reading(11 * 64 - 1), bitmap.clone(), Encoding::Normal).is_none());
        assert!(combined(&reading(11 * 64), bitmap, Encoding::Normal).is_some());
    }

    #[test]
    fn what_is_counted_holds_all_levels() {
        for texels in [
            Texels::U8(vec![[128, 128, 255, 255]; 4096]),
            Texels::U16(vec![[1, 2, 3, 4]; 4096]),
            Texels::F32(vec![[0.5; 4]; 4096]),
        ] {
            for encoding in [Encoding::Srgb, Encoding::Linear, Encoding::Normal] {
                let counted = bytes(&texels, encoding);
                let texture = Texture::new(Bitmap::new(64, 64, 4, texels.clone()).unwrap(), encoding);
                let held = texture.bytes();
                assert!(held <= counted && 2 * held > counted, "{encoding:?}: {held} of {counted}");
            }
        }
    }

    fn encoded(format: ImageFormat) -> Vec<u8> {
        let mut bytes = Vec::new();
        image::GrayImage::new(7, 5).write_to(&mut Cursor::new(&mut bytes), format).unwrap();
        bytes
    }

    #[test]
    fn sizes_come_from_headers() {
        let read = |bytes: &[u8]| ImageHeader::read(Cursor::new(bytes));
        let png = encoded(ImageFormat::Png);
        assert_eq!(read(&png), Some(ImageHeader { size: [7, 5], media_type: "image/png" }));
        let jpeg = encoded(ImageFormat::Jpeg);
        assert_eq!(read(&jpeg), Some(ImageHeader { size: [7, 5], media_type: "image/jpeg" }));
        let ktx2 = [super::super::KTX2, &[0; 8], &[3, 1, 0, 0], &[9, 0, 0, 0], &[0; 60]].concat();
        assert_eq!(read(&ktx2), Some(ImageHeader { size: [259, 9], media_type: KTX2_TYPE }));
        assert_eq!((read(&png[..20]), read(b"no image at all")), (None, None));
    }
}
