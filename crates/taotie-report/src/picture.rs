//! Sheets and colour maps on a page.

use crate::data::{Legend, Picture};
use crate::sheet::Sheet;
use taotie_engine::Result;
use taotie_engine::compare::ColorMap;
use taotie_engine::image::{Bitmap, Texels};

/// The number of colours in a legend.
const STOPS: u32 = 32;

impl Picture {
    /// Encodes a sheet as a picture for a page.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Invalid`] if the sheet has no pixels.
    pub fn new(label: impl Into<String>, note: impl Into<String>, sheet: &Sheet) -> Result<Self> {
        Ok(Self { label: label.into(), note: note.into(), file: taotie_io::encode_png(&sheet.png())? })
    }

    /// Encodes a sheet as JPEG, for viewing rather than measuring: about a fifth of the bytes.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Invalid`] if the sheet has no pixels.
    pub fn to_look_at(label: impl Into<String>, note: impl Into<String>, sheet: &Sheet) -> Result<Self> {
        const QUALITY: u8 = 90;
        let texels = sheet.pixels.iter().map(|[r, g, b]| [*r, *g, *b, u8::MAX]).collect();
        let bitmap = Bitmap::new(sheet.width as u32, sheet.height as u32, 3, Texels::U8(texels))?;
        let file = taotie_io::encode_jpeg_bitmap(&bitmap, QUALITY)?;
        Ok(Self { label: label.into(), note: note.into(), file })
    }
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
}
