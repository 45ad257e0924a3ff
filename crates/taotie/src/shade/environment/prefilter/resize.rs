//! The size at which an image is filtered.

use super::rings::{Pixel, Rings, accumulate};
use crate::math::scalar;
use crate::parallel;
use crate::shade::environment::equirect::Equirect;
use fearless_simd::Level;
use std::f64::consts::PI;

/// The minimum and the maximum width of a filtered image.
const WIDTHS: [usize; 2] = [256, 2048];

/// Resamples the image onto rings, half as many as pixels per ring. Their number can be halved down to rings of 256
/// to 511 pixels. An image that already has this form is unchanged.
pub(super) fn rings(level: Level, picture: &Equirect) -> Rings {
    let wanted = picture.width().clamp(WIDTHS[0], WIDTHS[1]);
    let unit = 2 << (wanted / 256).ilog2();
    let width = wanted / unit * unit;
    let mut output = Rings::black(level, width);
    let same = [width, width / 2] == [picture.width(), picture.height()];
    let shrinks = picture.width() >= width && picture.height() >= width / 2;
    let shares = Shares::new(picture, width);
    parallel::pieces(&mut output.pixels, width, &|y, row| {
        if same {
            row.iter_mut().enumerate().for_each(|(x, pixel)| *pixel = texel(picture, x, y));
        } else if shrinks {
            shares.gather(y, row);
        } else {
            interpolate(picture, (2 * y + 1) as f64 / width as f64, row);
        }
    });
    output
}

fn texel(picture: &Equirect, x: usize, y: usize) -> Pixel {
    let light = picture.texel(x, y);
    [light.x, light.y, light.z, 0.0]
}

/// A row between texels.
fn interpolate(picture: &Equirect, v: f64, row: &mut [Pixel]) {
    let width = row.len() as f32;
    for (x, pixel) in row.iter_mut().enumerate() {
        let light = picture.radiance_at([(x as f32 + 0.5) / width, v as f32]);
        *pixel = [light.x, light.y, light.z, 0.0];
    }
}

/// The pixels that receive the light of each texel of a larger image.
struct Shares<'a> {
    picture: &'a Equirect,
    /// The left pixel of the two around each texel of a row, and the fraction of the way to the right one, [0, 1).
    columns: Vec<(usize, f64)>,
    /// The fractional ring of each row.
    rows: Vec<f64>,
}

impl<'a> Shares<'a> {
    fn new(picture: &'a Equirect, width: usize) -> Self {
        let column = |x: usize| {
            let at = (x as f64 + 0.5) * width as f64 / picture.width() as f64 - 0.5;
            (at.floor().rem_euclid(width as f64) as usize, at - at.floor())
        };
        let scale = (width / 2) as f64 / picture.height() as f64;
        let row = |y: usize| ((y as f64 + 0.5) * scale - 0.5).clamp(0.0, (width / 2 - 1) as f64);
        let columns = (0..picture.width()).map(column).collect();
        Self { picture, columns, rows: (0..picture.height()).map(row).collect() }
    }

    /// Computes ring `y`. Each texel is distributed linearly, which keeps the centroid of the light.
    fn gather(&self, y: usize, row: &mut [Pixel]) {
        let height = self.picture.height();
        let mut weights = vec![0.0f32; row.len()];
        let from = self.rows.partition_point(|at| *at <= y as f64 - 1.0);
        let near = self.rows[from..].iter().map(|at| 1.0 - (at - y as f64).abs());
        for (source, near) in (from..).zip(near.take_while(|near| *near > 0.0)) {
            let area = scalar::sin((source as f64 + 0.5) * PI / height as f64) * near;
            for (x, (left, between)) in self.columns.iter().enumerate() {
                let light = texel(self.picture, x, source);
                let (share, right) = (between * area, if left + 1 == row.len() { 0 } else { left + 1 });
                for (column, weight) in [(*left, (area - share) as f32), (right, share as f32)] {
                    accumulate(&mut row[column], weight, &light);
                    weights[column] += weight;
                }
            }
        }
        for (pixel, weight) in row.iter_mut().zip(weights) {
            *pixel = pixel.map(|v| v / weight);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use crate::math::SimdLevel;

    #[test]
    fn sizes_can_be_halved_until_few_pixels_are_left() {
        for (width, expected) in
            [(1, 256), (600, 600), (1000, 1000), (1023, 1020), (1024, 1024), (9000, 2048)]
        {
            let image = Image::new(width, 2, [1.0; 4]).unwrap();
            let rings = rings(SimdLevel::fastest(), &Equirect::new(&image));
            assert_eq!((rings.width, rings.height), (expected, expected / 2));
            assert!(rings.pixels.iter().all(|pixel| (pixel[0] - 1.0).abs() < 1e-6));
        }
    }

    /// An isolated texel's light keeps its amount and centroid, which rounding to the nearest pixel would move.
    #[test]
    fn shrinking_moves_no_light() {
        let mut image = Image::new(4100, 2050, [0.0, 0.0, 0.0, 1.0]).unwrap();
        let (x, y) = (1000, 700);
        image.pixels_mut()[y * 4100 + x][0] = 1000.0;
        let rings = rings(SimdLevel::fastest(), &Equirect::new(&image));
        let (mut light, mut middle) = (0.0, [0.0, 0.0]);
        for (i, pixel) in rings.pixels.iter().enumerate() {
            let area = scalar::sin(rings.polar(i / rings.width)) * f64::from(pixel[0]);
            light += area;
            middle[0] += area * ((i % rings.width) as f64 + 0.5) / rings.width as f64;
            middle[1] += area * ((i / rings.width) as f64 + 0.5) / rings.height as f64;
        }
        let truth = scalar::sin((y as f64 + 0.5) * PI / 2050.0) * 1000.0;
        let scale = (2048.0f64 / 4100.0) * (1024.0 / 2050.0);
        assert!((light / (truth * scale) - 1.0).abs() < 3e-3, "{light} {}", truth * scale);
        let at = [(x as f64 + 0.5) / 4100.0, (y as f64 + 0.5) / 2050.0];
        for (middle, at) in middle.into_iter().zip(at) {
            assert!((middle / light - at).abs() < 0.02 / 2048.0, "{} {at}", middle / light);
        }
    }
}
