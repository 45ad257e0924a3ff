//! Numbers as colours, with a scale below.

use crate::sheet::{Line, NOTE, Sheet, TITLE, TextSize};
use taotie_engine::compare::{ColorMap, Field, heat};

/// The colour of pixels that were not compared.
const NOTHING: [u8; 3] = [96, 96, 96];
/// The height of the area for the scale below the picture, pixels.
const FOOT: usize = 64;
/// The margin around the scale.
const GAP: usize = 12;
/// The height of the scale's bar.
const BAR: usize = 14;
/// The size of its labels.
const LETTERS: TextSize = TextSize::Small;
/// The minimum width, so that the scale is readable.
const LEAST: usize = 260;

/// A field and how to display it.
pub struct HeatMap<'a> {
    /// The numbers.
    pub field: &'a Field,
    /// The quantity.
    pub title: &'a str,
    /// Its unit; may be empty.
    pub unit: &'a str,
    /// The colours.
    pub map: ColorMap,
    /// The value of the last colour; the first is for 0.
    pub top: f32,
}

impl<'a> HeatMap<'a> {
    /// Shows angular errors in degrees, with colours up to `top`.
    pub fn of_angles(field: &'a Field, top: f32) -> Self {
        Self { field, title: "angular error", unit: "°", map: ColorMap::Viridis, top }
    }

    /// Shows FLIP in the colours its authors use.
    pub fn of_flip(field: &'a Field) -> Self {
        Self { field, title: "FLIP", unit: "", map: ColorMap::Magma, top: 1.0 }
    }

    /// Draws the picture without its scale.
    pub fn plain(&self) -> Sheet {
        let (width, height) = (self.field.width() as usize, self.field.height() as usize);
        Sheet { width, height, pixels: heat(self.field, self.top, self.map, NOTHING) }
    }

    /// Draws the picture above its scale.
    pub fn with_scale(&self) -> Sheet {
        self.above_scale(&self.plain())
    }

    /// Places any picture above the scale.
    pub fn above_scale(&self, picture: &Sheet) -> Sheet {
        let mut sheet = Sheet::blank(picture.width.max(LEAST), picture.height + FOOT);
        let left = (sheet.width - picture.width) / 2;
        for (y, row) in picture.pixels.chunks(picture.width.max(1)).enumerate() {
            sheet.paste(row, [left, y]);
        }
        self.draw_scale(&mut sheet, picture.height);
        sheet
    }

    fn draw_scale(&self, sheet: &mut Sheet, y: usize) {
        let room = sheet.width - 2 * GAP;
        let color = |x: usize| self.map.color(x as f64 / (room - 1) as f64);
        let row: Vec<[u8; 3]> = (0..room).map(color).collect();
        for line in 0..BAR {
            sheet.paste(&row, [GAP, y + GAP + line]);
        }
        let bottom = format!("0{}", self.unit);
        let beyond = self.field.values().iter().any(|value| *value > self.top);
        let top = format!("{}{}{}", number(self.top), self.unit, if beyond { "+" } else { "" });
        let mut label = |text: &str, place: fn(usize, usize) -> usize, color| {
            let taken = LETTERS.width(text).min(room);
            let line = Line { text, size: LETTERS, color, room: taken };
            sheet.write(&line, [GAP + place(room, taken), y + GAP + BAR + 6]);
        };
        label(&bottom, |_, _| 0, NOTE);
        label(self.title, |room, taken| (room - taken) / 2, TITLE);
        label(&top, |room, taken| room - taken, NOTE);
    }
}

/// Formats a number with at most three significant digits, without trailing zeros.
fn number(value: f32) -> String {
    let digits = match value.abs() {
        v if v >= 100.0 => 0,
        v if v >= 10.0 => 1,
        v if v >= 1.0 => 2,
        _ => 3,
    };
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sheet::GROUND;

    #[test]
    fn the_picture_is_above_its_scale() {
        let field = Field::new(2, 1, vec![0.0, f32::NAN]).unwrap();
        let shown = HeatMap { field: &field, title: "FLIP", unit: "", map: ColorMap::Gray, top: 1.0 };
        let sheet = shown.with_scale();
        assert_eq!((sheet.width, sheet.height), (LEAST, 1 + FOOT));
        let at = |x: usize, y: usize| sheet.pixels[y * sheet.width + x];
        assert_eq!([at(129, 0), at(130, 0), at(0, 0)], [[0; 3], NOTHING, GROUND]);
        assert_eq!([at(GAP, 1 + GAP), at(LEAST - GAP - 1, 1 + GAP)], [[0; 3], [255; 3]]);
        let inked = sheet.pixels[(1 + GAP + BAR) * LEAST..].iter().filter(|p| **p != GROUND).count();
        assert!(inked > 50, "{inked}");
    }

    #[test]
    fn numbers_are_short() {
        let texts = [1.0, 0.25, 12.345, 0.0314, 180.0, 20.0].map(number);
        assert_eq!(texts, ["1", "0.25", "12.3", "0.031", "180", "20"]);
    }
}
