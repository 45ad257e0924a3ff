//! The size and format of an image, read from its header.

use imagesize::{Compression, ImageError, ImageSize, ImageType};
use std::io::{BufRead, Seek};

/// The size and format of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::io) struct ImageHeader {
    /// Texels across and down.
    pub size: [u32; 2],
    /// Its media type, such as `image/png`.
    pub media_type: &'static str,
}

/// The media type of KTX2.
pub(in crate::io) const KTX2_TYPE: &str = "image/ktx2";

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
    use image::ImageFormat;
    use std::io::Cursor;

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
