//! Contact sheets: labelled pictures side by side.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use taotie::image::Encoding;
use taotie::io::{PngColor, PngImage, PngSamples};

/// Room between pictures and at the border, pixels.
const GAP: usize = 16;
/// Room for a label of two lines under a picture.
const LABEL: usize = 52;

/// Behind everything.
pub const GROUND: [u8; 3] = [24, 25, 27];
/// The colour of first lines.
pub const TITLE: [u8; 3] = [236, 230, 216];
/// The colour of second lines.
pub const NOTE: [u8; 3] = [150, 152, 156];

/// A picture with what is said of it.
pub struct Cell {
    /// First line.
    pub title: String,
    /// Second line, smaller.
    pub note: String,
    /// sRGB pixels, row by row from the top.
    pub pixels: Vec<[u8; 3]>,
}

/// An 8-bit sRGB picture.
pub struct Sheet {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Row by row from the top.
    pub pixels: Vec<[u8; 3]>,
}

impl Sheet {
    /// An empty sheet.
    pub fn blank(width: usize, height: usize) -> Self {
        Self { width, height, pixels: vec![GROUND; width * height] }
    }

    /// Lays out pictures of one width and height in rows of `columns`.
    pub fn new(cells: &[Cell], [across, down]: [usize; 2], columns: usize) -> Self {
        let rows = cells.len().div_ceil(columns);
        let width = GAP + columns * (across + GAP);
        let height = GAP + rows * (down + LABEL + GAP);
        let mut sheet = Self::blank(width, height);
        for (i, cell) in cells.iter().enumerate() {
            let x = GAP + (i % columns) * (across + GAP);
            let y = GAP + (i / columns) * (down + LABEL + GAP);
            for (row, pixels) in cell.pixels.chunks(across).enumerate() {
                sheet.paste(pixels, [x, y + row]);
            }
            sheet.write(&cell.title, [x, y + down + 6], RasterHeight::Size20, TITLE, across);
            sheet.write(&cell.note, [x, y + down + 29], RasterHeight::Size16, NOTE, across);
        }
        sheet
    }

    /// As a picture to be written.
    pub fn png(&self) -> PngImage<'_> {
        PngImage {
            width: self.width as u32,
            height: self.height as u32,
            color: PngColor::Rgb,
            samples: PngSamples::U8(self.pixels.as_flattened()),
            encoding: Encoding::Srgb,
        }
    }

    /// Lays a row of pixels from `at` to the right.
    pub fn paste(&mut self, row: &[[u8; 3]], [x, y]: [usize; 2]) {
        let start = y * self.width + x;
        self.pixels[start..start + row.len()].copy_from_slice(row);
    }

    /// How many pixels `text` takes across.
    pub fn text_width(text: &str, height: RasterHeight) -> usize {
        text.chars().count() * get_raster_width(FontWeight::Regular, height)
    }

    /// Writes `text` from the top left corner `at`, cut off after `room` pixels.
    pub fn write(
        &mut self,
        text: &str,
        [x, y]: [usize; 2],
        height: RasterHeight,
        color: [u8; 3],
        room: usize,
    ) {
        let advance = get_raster_width(FontWeight::Regular, height);
        for (i, letter) in text.chars().take(room / advance).enumerate() {
            let Some(glyph) = get_raster(letter, FontWeight::Regular, height) else { continue };
            for (row, line) in glyph.rows().enumerate() {
                for (column, ink) in line.iter().enumerate() {
                    let pixel = &mut self.pixels[(y + row) * self.width + x + i * advance + column];
                    *pixel = std::array::from_fn(|c| mix(pixel[c], color[c], *ink));
                }
            }
        }
    }
}

fn mix(below: u8, above: u8, ink: u8) -> u8 {
    let ink = u32::from(ink);
    ((u32::from(below) * (255 - ink) + u32::from(above) * ink + 127) / 255) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_lie_in_rows_with_their_labels() {
        let cell = |grey| Cell { title: "ab".into(), note: String::new(), pixels: vec![[grey; 3]; 64] };
        let sheet = Sheet::new(&[cell(10), cell(20), cell(30)], [8, 8], 2);
        let at = |x: usize, y: usize| sheet.pixels[y * sheet.width + x];
        assert_eq!((sheet.width, sheet.height), (3 * GAP + 16, 3 * GAP + 2 * (8 + LABEL)));
        assert_eq!([at(GAP, GAP), at(2 * GAP + 8, GAP)], [[10; 3], [20; 3]]);
        assert_eq!(at(GAP, 2 * GAP + 8 + LABEL), [30; 3]);
        assert_eq!(at(0, 0), GROUND);
    }

    #[test]
    fn labels_leave_ink_and_stay_within_their_cell() {
        let cell =
            Cell { title: "tangent-normal".repeat(9), note: "x".into(), pixels: vec![[0; 3]; 64 * 64] };
        let sheet = Sheet::new(&[cell], [64, 64], 1);
        let inked: Vec<usize> = sheet.pixels[(GAP + 64) * sheet.width..]
            .iter()
            .enumerate()
            .filter(|(_, p)| **p != GROUND)
            .map(|(i, _)| i % sheet.width)
            .collect();
        assert!(inked.len() > 50 && inked.iter().all(|x| (GAP..GAP + 64).contains(x)));
    }
}
