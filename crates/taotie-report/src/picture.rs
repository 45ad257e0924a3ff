//! The pictures of a page: views of pictures to compare, each a PNG or JPEG file, and their colour scales.

use crate::sheet::Sheet;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};
use taotie_engine::compare::ColorMap;
use taotie_engine::image::{Bitmap, Texels};

/// The number of colours in a legend.
const STOPS: u32 = 32;

/// Pictures of equal size that can be overlaid.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct View {
    /// The tab label, unique within a page: "ggx", "normals", "angular error".
    pub name: String,
    /// A line describing what is shown.
    pub note: String,
    /// The pictures. Initially the first is left of the handle and the last is right of it.
    pub pictures: Vec<Picture>,
    /// The meaning of the colours.
    pub legend: Option<Legend>,
}

/// A picture.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Picture {
    /// Its subject, such as a method; unique within a view. The same label in other views means the same thing: it
    /// stays selected when the view changes.
    pub label: String,
    /// Below the label.
    pub note: String,
    /// The PNG or JPEG file.
    pub file: Vec<u8>,
}

impl Picture {
    /// Encodes a sheet as a picture for a page.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Invalid`] if the sheet has no pixels.
    pub fn new(
        label: impl Into<String>,
        note: impl Into<String>,
        sheet: &Sheet,
    ) -> taotie_engine::Result<Self> {
        Ok(Self { label: label.into(), note: note.into(), file: taotie_io::encode_png(&sheet.png())? })
    }

    /// Encodes a sheet as JPEG, for viewing rather than measuring: about a fifth of the bytes.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Invalid`] if the sheet has no pixels.
    pub fn to_look_at(
        label: impl Into<String>,
        note: impl Into<String>,
        sheet: &Sheet,
    ) -> taotie_engine::Result<Self> {
        const QUALITY: u8 = 90;
        let texels = sheet.pixels.iter().map(|[r, g, b]| [*r, *g, *b, u8::MAX]).collect();
        let bitmap = Bitmap::new(sheet.width as u32, sheet.height as u32, 3, Texels::U8(texels))?;
        let file = taotie_io::encode_jpeg_bitmap(&bitmap, QUALITY)?;
        Ok(Self { label: label.into(), note: note.into(), file })
    }

    /// Returns the width and height in pixels from the file header; zeros if it is neither PNG nor JPEG.
    pub fn size(&self) -> [u32; 2] {
        if self.is_jpeg() {
            return jpeg_size(&self.file).unwrap_or_default();
        }
        let word = |at: usize| self.file.get(at..at + 4)?.try_into().ok().map(u32::from_be_bytes);
        match (self.file.starts_with(b"\x89PNG\r\n\x1a\n"), word(16), word(20)) {
            (true, Some(width), Some(height)) => [width, height],
            _ => [0, 0],
        }
    }

    fn is_jpeg(&self) -> bool {
        self.file.starts_with(b"\xff\xd8\xff")
    }
}

/// Returns the size that the frame header of a JPEG states.
fn jpeg_size(file: &[u8]) -> Option<[u32; 2]> {
    let word = |at: usize| file.get(at..at + 2)?.try_into().ok().map(u16::from_be_bytes);
    let mut at = 2;
    while let Some(marker) = word(at) {
        // SOF0 to SOF2: baseline, extended and progressive.
        if (0xffc0..=0xffc2).contains(&marker) {
            return Some([word(at + 7)?.into(), word(at + 5)?.into()]);
        }
        at += 2 + usize::from(word(at + 2)?);
    }
    None
}

/// Writes the file as a `data:` URI, and the size, which the page needs before the picture is decoded.
impl Serialize for Picture {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let [width, height] = self.size();
        let mut fields = serializer.serialize_struct("Picture", 5)?;
        fields.serialize_field("label", &self.label)?;
        fields.serialize_field("note", &self.note)?;
        let format = if self.is_jpeg() { "jpeg" } else { "png" };
        let uri = format!("data:image/{format};base64,{}", STANDARD.encode(&self.file));
        fields.serialize_field("uri", &uri)?;
        fields.serialize_field("width", &width)?;
        fields.serialize_field("height", &height)?;
        fields.end()
    }
}

/// A colour scale.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Legend {
    /// The quantity.
    pub title: String,
    /// Its unit, such as "°".
    pub unit: String,
    /// The value of the last colour; the first is for 0.
    pub top: f64,
    /// sRGB colours at equal steps from 0 to `top`.
    pub stops: Vec<[u8; 3]>,
}

impl Legend {
    /// Creates a colour scale from 0 to `top`.
    pub fn new(title: &str, unit: &str, top: f64, map: ColorMap) -> Self {
        let stops = (0..STOPS).map(|i| map.color(f64::from(i) / f64::from(STOPS - 1))).collect();
        Self { title: title.into(), unit: unit.into(), top, stops }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_keeps_its_size_and_one_without_pixels_is_an_error() {
        let picture = Picture::new("a", "b", &Sheet::blank(5, 3)).unwrap();
        assert_eq!((picture.size(), picture.label.as_str(), picture.note.as_str()), ([5, 3], "a", "b"));
        assert!(Picture::new("a", "b", &Sheet::blank(0, 3)).is_err());
        let small = Picture::to_look_at("a", "b", &Sheet::blank(50, 30)).unwrap();
        assert_eq!((small.size(), &small.file[..2]), ([50, 30], &b"\xff\xd8"[..]));
        assert!(Picture::to_look_at("a", "b", &Sheet::blank(0, 3)).is_err());
    }

    #[test]
    fn a_legend_runs_from_the_first_colour_to_the_last() {
        let stops = Legend::new("error", "°", 10.0, ColorMap::Gray).stops;
        assert_eq!((stops.len(), stops[0], stops[31]), (32, [0; 3], [255; 3]));
    }

    #[test]
    fn a_file_that_is_not_png_has_no_size() {
        let png = |bytes: &[u8]| Picture { file: bytes.to_vec(), ..Picture::default() }.size();
        assert_eq!(png(b""), [0, 0]);
        assert_eq!(png(&[9; 40]), [0, 0]);
        assert_eq!(png(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x02\0\0\x01"), [0, 0]);
        assert_eq!(png(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x02\0\0\x01\x03"), [2, 259]);
    }
}
