//! Converts images of the library to sheets.

use crate::sheet::{GROUND, Sheet};
use taotie_engine::compare::DisplayImage;
use taotie_engine::image::{Bitmap, Image};
use taotie_engine::math::{Vec3, srgb};
use taotie_engine::surface::encode_normal;

/// Rounds a value in [0, 1] to an 8-bit code.
fn code(v: f32) -> u8 {
    (v * 255.0 + 0.5) as u8
}

impl Sheet {
    /// Converts a developed picture.
    pub fn developed(picture: &DisplayImage) -> Self {
        let pixels = picture.pixels().iter().map(|rgb| rgb.map(code)).collect();
        Self { width: picture.width() as usize, height: picture.height() as usize, pixels }
    }

    /// Shows world-space unit normals n as the colours (n + 1) / 2, and the background if alpha is not 1.
    pub fn of_normals(normals: &Image) -> Self {
        let color = |[x, y, z, covered]: &[f32; 4]| match *covered == 1.0 {
            true => encode_normal(Vec3::new(*x, *y, *z)).to_array().map(code),
            false => GROUND,
        };
        let pixels = normals.pixels().iter().map(color).collect();
        Self { width: normals.width() as usize, height: normals.height() as usize, pixels }
    }

    /// Shows a map as stored, subsampled so that no side is longer than `side` pixels.
    pub fn preview(bitmap: &Bitmap, side: usize) -> Self {
        let (across, down) = (bitmap.width() as usize, bitmap.height() as usize);
        let step = across.max(down).div_ceil(side.max(1)).max(1);
        let (width, height) = ((across / step).max(1), (down / step).max(1));
        let pixel = |i: usize| {
            let [r, g, b, _] = bitmap.stored(i / width * step * across + i % width * step);
            [r, g, b].map(code)
        };
        Self { width, height, pixels: (0..width * height).map(pixel).collect() }
    }

    /// Averages whole blocks in linear light until no side is longer than `side` pixels.
    pub fn shrunk(&self, side: usize) -> Self {
        let factor = self.width.max(self.height).div_ceil(side.max(1)).max(1);
        let (width, height) = ((self.width / factor).max(1), (self.height / factor).max(1));
        let linear: Vec<f64> =
            (0..=255).map(|code| srgb::linear_from_srgb(f64::from(code) / 255.0)).collect();
        let mean = |i: usize, channel: usize| {
            let values = self.block(i % width * factor, i / width * factor, factor);
            let (sum, count) = values
                .fold((0.0, 0.0), |(sum, n), pixel| (sum + linear[usize::from(pixel[channel])], n + 1.0));
            (srgb::srgb_from_linear(sum / count) * 255.0 + 0.5) as u8
        };
        let pixel = |i: usize| std::array::from_fn(|channel| mean(i, channel));
        Self { width, height, pixels: (0..width * height).map(pixel).collect() }
    }

    /// The pixels of a square, clipped to the sheet, row by row.
    fn block(&self, x: usize, y: usize, side: usize) -> impl Iterator<Item = &[u8; 3]> {
        let rows = self.pixels.chunks(self.width.max(1)).skip(y).take(side);
        rows.flat_map(move |row| row.iter().skip(x).take(side))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::image::Texels;

    #[test]
    fn normals_are_colours_and_uncovered_pixels_are_background() {
        let mut normals = Image::new(2, 1, [0.0; 4]).unwrap();
        normals.pixels_mut()[1] = [0.0, 0.0, 1.0, 1.0];
        assert_eq!(Sheet::of_normals(&normals).pixels, [GROUND, [128, 128, 255]]);
    }

    #[test]
    fn previews_are_subsampled() {
        let texels = (0..8).map(|i| [i * 10, 0, 0, 255]).collect();
        let bitmap = Bitmap::new(8, 1, 3, Texels::U8(texels)).unwrap();
        let sheet = Sheet::preview(&bitmap, 3);
        assert_eq!((sheet.width, sheet.height), (2, 1));
        assert_eq!(sheet.pixels, [[0, 0, 0], [30, 0, 0]]);
    }

    #[test]
    fn shrinking_averages_light_and_keeps_small_sheets() {
        let sheet = Sheet { width: 4, height: 1, pixels: vec![[0; 3], [255; 3], [9; 3], [9; 3]] };
        assert_eq!(sheet.shrunk(4).pixels, sheet.pixels);
        assert_eq!(sheet.shrunk(2).pixels, [[188; 3], [9; 3]]);
    }
}
