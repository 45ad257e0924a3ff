//! Square PNG files for the tests.

use std::path::Path;
use taotie_engine::image::Encoding;
use taotie_io::{PngColor, PngImage, PngSamples, write_png};

/// Writes a square of these samples: grey, or RGB if there are three for each pixel.
pub fn write_square(path: &Path, samples: PngSamples<'_>, encoding: Encoding) {
    let count = match samples {
        PngSamples::U8(samples) => samples.len(),
        PngSamples::U16(samples) => samples.len(),
    };
    // Three times a square number is not a square number.
    let (color, pixels) = match count.isqrt().pow(2) == count {
        true => (PngColor::Grey, count),
        false => (PngColor::Rgb, count / 3),
    };
    let side = pixels.isqrt() as u32;
    let image = PngImage { width: side, height: side, color, samples, encoding };
    write_png(path, &image).expect("the folder can be written to");
}
