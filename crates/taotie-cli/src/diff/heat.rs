//! The picture of where two files differ, with its scale below.

use super::args::{DiffArgs, Metric};
use super::subject::{Content, Subject};
use crate::sheet::{NOTE, Sheet, TITLE};
use anyhow::Result;
use noto_sans_mono_bitmap::RasterHeight;
use std::path::Path;
use taotie::compare::{self, ColorMap, Field, Picture, heat};
use taotie::image::Encoding;
use taotie::io::{self, PngColor, PngImage, PngSamples};

/// Where nothing was compared.
const NOTHING: [u8; 3] = [96, 96, 96];
/// Room for the scale under the picture, pixels.
const FOOT: usize = 64;
/// Room beside the scale.
const GAP: usize = 12;
/// The height of the scale's bar.
const BAR: usize = 14;
/// The size of its labels.
const LETTERS: RasterHeight = RasterHeight::Size16;
/// The least width, so that the scale can be read.
const LEAST: usize = 260;

/// A field with how it is to be shown.
struct Shown {
    field: Field,
    title: &'static str,
    unit: &'static str,
    map: ColorMap,
    top: f32,
}

/// Writes the heat map of the metric asked for, else of FLIP or of the angle.
pub fn write(args: &DiffArgs, path: &Path, subject: &Subject) -> Result<()> {
    let mut shown = match &subject.content {
        Content::Normals([(a, _), (b, _)]) => angle(compare::angular_error(&a.normals, &b.normals)?),
        Content::Pictures([a, b]) => of_pictures(args, a, b)?,
    };
    if let Some(top) = args.heat_top {
        shown.top = top as f32;
    }
    let sheet = drawn(&shown);
    let image = PngImage {
        width: sheet.width as u32,
        height: sheet.height as u32,
        color: PngColor::Rgb,
        samples: PngSamples::U8(sheet.pixels.as_flattened()),
        encoding: Encoding::Srgb,
    };
    Ok(io::write_png(path, &image)?)
}

fn angle(field: Field) -> Shown {
    let top = scale(&field);
    Shown { field, title: "angle between normals", unit: "°", map: ColorMap::Viridis, top }
}

fn of_pictures(args: &DiffArgs, a: &Picture, b: &Picture) -> Result<Shown> {
    let shown = |field, title, map, top| Shown { field, title, unit: "", map, top };
    Ok(match args.metric.unwrap_or(Metric::Flip) {
        Metric::Ssim => {
            let map = compare::ssim_map(a, b)?;
            let unlike = map.values().iter().map(|v| 1.0 - v).collect();
            shown(Field::new(map.width(), map.height(), unlike)?, "1 - SSIM", ColorMap::Viridis, 1.0)
        }
        Metric::Psnr | Metric::Rmse => {
            let field = compare::difference(a, b)?;
            let top = scale(&field);
            shown(field, "mean absolute difference", ColorMap::Viridis, top)
        }
        Metric::Flip | Metric::Angle => {
            let field = compare::flip(a, b, args.pixels_per_degree as f32)?;
            shown(field, "FLIP", ColorMap::Magma, 1.0)
        }
    })
}

/// A scale that a few wild texels do not stretch: the 95 % quantile, else the largest number, else 1.
fn scale(field: &Field) -> f32 {
    let summary = field.summary();
    let tops = summary.map_or([0.0; 2], |summary| [summary.p95, summary.max]);
    tops.into_iter().map(|top| top as f32).find(|top| *top > 0.0).unwrap_or(1.0)
}

fn drawn(shown: &Shown) -> Sheet {
    let (width, height) = (shown.field.width() as usize, shown.field.height() as usize);
    let colors = heat(&shown.field, shown.top, shown.map, NOTHING);
    let mut sheet = Sheet::blank(width.max(LEAST), height + FOOT);
    let left = (sheet.width - width) / 2;
    for (y, row) in colors.chunks(width).enumerate() {
        sheet.paste(row, [left, y]);
    }
    draw_scale(&mut sheet, shown, height);
    sheet
}

fn draw_scale(sheet: &mut Sheet, shown: &Shown, y: usize) {
    let room = sheet.width - 2 * GAP;
    let color = |x: usize| shown.map.color(x as f64 / (room - 1) as f64);
    let row: Vec<[u8; 3]> = (0..room).map(color).collect();
    for line in 0..BAR {
        sheet.paste(&row, [GAP, y + GAP + line]);
    }
    let bottom = format!("0{}", shown.unit);
    let beyond = shown.field.values().iter().any(|value| *value > shown.top);
    let top = format!("{}{}{}", number(shown.top), shown.unit, if beyond { "+" } else { "" });
    let mut label = |text: &str, place: fn(usize, usize) -> usize, color| {
        let taken = Sheet::text_width(text, LETTERS).min(room);
        sheet.write(text, [GAP + place(room, taken), y + GAP + BAR + 6], LETTERS, color, taken);
    };
    label(&bottom, |_, _| 0, NOTE);
    label(shown.title, |room, taken| (room - taken) / 2, TITLE);
    label(&top, |room, taken| room - taken, NOTE);
}

/// A number in as few letters as tell it: three significant digits.
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
    fn the_picture_stands_above_its_scale() {
        let field = Field::new(2, 1, vec![0.0, f32::NAN]).unwrap();
        let sheet = drawn(&Shown { field, title: "FLIP", unit: "", map: ColorMap::Gray, top: 1.0 });
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
