//! The size and the format of an image, read from its header.

use super::{KTX2, guess_format};
use image::ImageReader;
use std::io::{BufRead, Seek};

/// The size and the format of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::io) struct ImageHeader {
    /// Texels across and down.
    pub size: [u32; 2],
    /// Its media type, such as `image/png`.
    pub media_type: &'static str,
}

/// The media type of KTX2.
pub(in crate::io) const KTX2_TYPE: &str = "image/ktx2";

/// The fewest bytes that hold the size of KTX2; enough to recognise any format.
const START: usize = 28;

impl ImageHeader {
    /// Reads the header of an image; `None` if the format is unknown or the header is damaged. The format of TGA, which has no
    /// signature, follows from `name`.
    pub fn read(mut image: impl BufRead + Seek, name: &str) -> Option<Self> {
        let mut start = [0; START];
        image.read_exact(&mut start).ok()?;
        image.rewind().ok()?;
        if start.starts_with(KTX2) {
            // KTX 2.0, section 2: pixelWidth and pixelHeight follow vkFormat and typeSize.
            let [.., width, height] = *start.as_chunks::<4>().0 else { return None };
            let size = [width, height].map(u32::from_le_bytes);
            return Some(Self { size, media_type: KTX2_TYPE });
        }
        let format = guess_format(&start, name)?;
        let mut reader = ImageReader::with_format(image, format);
        reader.no_limits();
        let (width, height) = reader.into_dimensions().ok()?;
        Some(Self { size: [width, height], media_type: format.to_mime_type() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn sizes_come_from_headers() {
        let mut png = Vec::new();
        let pixels = image::GrayImage::new(7, 5);
        pixels.write_to(&mut Cursor::new(&mut png), image::ImageFormat::Png).unwrap();
        let header = ImageHeader::read(Cursor::new(&png), "a").unwrap();
        assert_eq!(header, ImageHeader { size: [7, 5], media_type: "image/png" });
        let ktx2 = [KTX2, &[0; 8], &[3, 1, 0, 0], &[9, 0, 0, 0], &[0; 9]].concat();
        let header = ImageHeader::read(Cursor::new(&ktx2), "a").unwrap();
        assert_eq!(header, ImageHeader { size: [259, 9], media_type: KTX2_TYPE });
        assert_eq!(ImageHeader::read(Cursor::new(&png[..20]), "a"), None);
    }
}
