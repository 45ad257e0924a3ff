//! Images of the sphere on rings of latitude: the size at which an image is filtered, and smooth lookup in it.

use crate::math::{Lane, MOST_LANES, Pack, dispatch_registers, scalar};
use crate::parallel;
use crate::shade::environment::equirect::Equirect;
use fearless_simd::{Level, Simd, f32x4, f32x16, prelude::*};
use std::f64::consts::PI;

/// A pixel: linear RGB, and a fourth number as padding for speed.
pub(super) type Pixel = [f32; 4];

/// An equirectangular image during filtering.
#[derive(Debug, Clone)]
pub(super) struct Rings {
    /// The SIMD level for its pixels; all levels give the same bits.
    pub(super) level: Level,
    /// Pixels per ring, even.
    pub(super) width: usize,
    /// Rings; that of row y is at the polar angle (y + ½)π/height.
    pub(super) height: usize,
    /// Row by row from the top.
    pub(super) pixels: Vec<Pixel>,
}

/// The weight of each pixel of a row in an integral over the sphere, up to scale.
pub(super) enum Areas {
    /// Its solid angle: light is constant within each texel.
    Solid,
    /// The weight that integrates exactly everything that this number of rings can represent.
    Smooth,
}

/// The polar angle of ring `y` of `height`.
pub(super) fn polar(height: usize, y: usize) -> f64 {
    (y as f64 + 0.5) * (PI / height as f64)
}

/// The weight of a pixel in each of `height` rows. Source of the smooth ones: Fejér's first rule, as in Waldvogel 2006,
/// eq. 2.3.
pub(super) fn areas(height: usize, kind: &Areas) -> Vec<f64> {
    let smooth = |polar: f64| {
        let term = |k: usize| scalar::cos(2.0 * k as f64 * polar) / (4 * k * k - 1) as f64;
        1.0 - 2.0 * (1..=height / 2).map(term).sum::<f64>()
    };
    let area = |polar| match kind {
        Areas::Solid => scalar::sin(polar),
        Areas::Smooth => smooth(polar),
    };
    parallel::collect(height, |y| area(polar(height, y)))
}

impl Rings {
    /// All black, `width` pixels per ring and half as many rings.
    pub(super) fn black(level: Level, width: usize) -> Self {
        let height = width / 2;
        Self { level, width, height, pixels: vec![[0.0; 4]; width * height] }
    }

    /// The angle between rings.
    pub(super) fn step(&self) -> f64 {
        PI / self.height as f64
    }

    /// The polar angle of a ring.
    pub(super) fn polar(&self, y: usize) -> f64 {
        polar(self.height, y)
    }

    pub(super) fn row(&self, y: usize) -> &[Pixel] {
        &self.pixels[y * self.width..][..self.width]
    }

    /// The image, doubled until its rings have `width` pixels, plus images of that size, each times its weight.
    /// `spare` pixels are overwritten.
    pub(super) fn added(mut self, others: &[(f32, &Self)], width: usize, spare: &mut Vec<Pixel>) -> Self {
        if self.width < width {
            while self.width * 2 < width {
                self = self.doubled(&[], Vec::new());
            }
            return self.doubled(others, std::mem::take(spare));
        }
        let level = self.level;
        parallel::pieces(&mut self.pixels, self.width, &|y, row| {
            dispatch_registers!(level, _simd => add_rows(row, y, others));
        });
        self
    }

    /// The image on twice as many rings of twice as many pixels, by the same cubic as [`Self::cubic`], plus images of
    /// that size, each times its weight. `pixels` are overwritten.
    fn doubled(&self, others: &[(f32, &Self)], mut pixels: Vec<Pixel>) -> Self {
        let (level, width, height) = (self.level, self.width * 2, self.height * 2);
        if pixels.len() != width * height {
            pixels = vec![[0.0; 4]; width * height];
        }
        parallel::pieces(&mut pixels, width, &|y, row| {
            dispatch_registers!(level, simd => {
                widen(simd, &self.between_rings(y), row);
                add_rows(row, y, others);
            });
        });
        Self { level, width, height, pixels }
    }

    /// Ring `y` of twice as many, with two more pixels at each end.
    #[inline(always)]
    fn between_rings(&self, y: usize) -> Vec<Pixel> {
        let (first, weights) = halfway(y);
        let mut sums = vec![[0.0; 4]; self.width + 4];
        let (inside, end) = (2..self.width + 2, self.width + 2);
        for (k, weight) in weights.into_iter().enumerate() {
            let (from, turn) = self.through_pole(first + k as isize);
            let (early, late) = self.row(from).split_at(turn as usize);
            let (left, right) = sums[inside.clone()].split_at_mut(late.len());
            add_row(left, weight, late);
            add_row(right, weight, early);
        }
        sums.copy_within(self.width..end, 0);
        sums.copy_within(2..4, end);
        sums
    }

    /// The image at positions (u, v) in [0, 1]² by Catmull and Rom's cubic, smooth across the seam and through the
    /// poles.
    #[inline(always)]
    pub(super) fn cubic<S: Simd>(&self, simd: S, [u, v]: [&[f32]; 2], out: &mut [Pixel; MOST_LANES]) {
        let across = Taps::new::<f32x16<S>>(simd, u, self.width);
        let down = Taps::new::<f32x16<S>>(simd, v, self.height);
        for (i, out) in out.iter_mut().enumerate() {
            let weights = across.weights(simd, i);
            let (left, top) = (across.first[i] as isize - 2, down.first[i] as isize - 2);
            let mut rows = weights;
            for (k, sum) in rows.iter_mut().enumerate() {
                let (row, turn) = self.through_pole(top + k as isize);
                *sum = weighted(weights, four(simd, self.row(row), left + turn));
            }
            *out = weighted(down.weights(simd, i), rows).into();
        }
    }

    /// The row at index `y` when continuing beyond the poles, and its rotation in pixels.
    #[inline(always)]
    fn through_pole(&self, y: isize) -> (usize, isize) {
        let (height, turned) = (self.height as isize, self.width as isize / 2);
        match y {
            y if y < 0 => ((-1 - y) as usize, turned),
            y if y >= height => ((2 * height - 1 - y) as usize, turned),
            y => (y as usize, 0),
        }
    }
}

/// The four pixels along one coordinate around each of some positions.
struct Taps {
    /// The index of the first one, plus two.
    first: [u32; MOST_LANES],
    weights: [[f32; MOST_LANES]; 4],
}

impl Taps {
    /// Finds the pixels around coordinates in [0, 1] of `count` pixels, as many as a pack holds.
    #[inline(always)]
    fn new<P: Pack>(token: P::Token, coordinates: &[f32], count: usize) -> Self {
        let mut taps = Self { first: [0; MOST_LANES], weights: [[0.0; MOST_LANES]; 4] };
        // Shifted by one pixel, so that truncation rounds down.
        let x = P::load(token, coordinates) * P::splat(token, count as f32) + P::splat(token, 0.5);
        let first = x.floor();
        first.store_words(&mut taps.first);
        for (stored, weights) in taps.weights.iter_mut().zip(catmull_rom(x - first)) {
            weights.store(stored);
        }
        taps
    }

    /// The weights of the pixels around position `i`.
    #[inline(always)]
    fn weights<S: Simd>(&self, simd: S, i: usize) -> [f32x4<S>; 4] {
        let [a, b, c, d] = &self.weights;
        splats(simd, [a[i], b[i], c[i], d[i]])
    }
}

/// Four neighbours in a row from column `x` onwards, which is at most one row's length outside.
#[inline(always)]
fn four<S: Simd>(simd: S, row: &[Pixel], x: isize) -> [f32x4<S>; 4] {
    let at = |k: isize| row[(x + k).rem_euclid(row.len() as isize) as usize];
    if x >= 0
        && let Some(four) = row.get(x as usize..).and_then(|right| right.first_chunk())
    {
        load(simd, four)
    } else {
        load(simd, &[at(0), at(1), at(2), at(3)])
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, [a, b, c, d]: &[Pixel; 4]) -> [f32x4<S>; 4] {
    [
        f32x4::simd_from(simd, *a),
        f32x4::simd_from(simd, *b),
        f32x4::simd_from(simd, *c),
        f32x4::simd_from(simd, *d),
    ]
}

#[inline(always)]
fn splats<S: Simd>(simd: S, [a, b, c, d]: [f32; 4]) -> [f32x4<S>; 4] {
    [f32x4::splat(simd, a), f32x4::splat(simd, b), f32x4::splat(simd, c), f32x4::splat(simd, d)]
}

#[inline(always)]
fn weighted<S: Simd>([a, b, c, d]: [f32x4<S>; 4], pixels: [f32x4<S>; 4]) -> f32x4<S> {
    a * pixels[0] + b * pixels[1] + c * pixels[2] + d * pixels[3]
}

/// Interpolates a ring that has two more pixels at each end.
#[inline(always)]
fn widen<S: Simd>(simd: S, ring: &[Pixel], row: &mut [Pixel]) {
    let (even, odd) = (splats(simd, halfway(0).1), splats(simd, halfway(1).1));
    for (pair, near) in row.as_chunks_mut::<2>().0.iter_mut().zip(ring.windows(5)) {
        let [a, b, c, d, e] = [near[0], near[1], near[2], near[3], near[4]];
        let (left, right) = (load(simd, &[a, b, c, d]), load(simd, &[b, c, d, e]));
        *pair = [weighted(even, left).into(), weighted(odd, right).into()];
    }
}

/// Adds the rings `y` of other images, each times its weight.
#[inline(always)]
fn add_rows(row: &mut [Pixel], y: usize, others: &[(f32, &Rings)]) {
    others.iter().for_each(|(weight, other)| add_row(row, *weight, other.row(y)));
}

#[inline(always)]
fn add_row(sums: &mut [Pixel], weight: f32, pixels: &[Pixel]) {
    for (sum, value) in sums.as_flattened_mut().iter_mut().zip(pixels.as_flattened()) {
        *sum += weight * value;
    }
}

/// The neighbours of pixel `x` of twice as many: the first of four among the half, and their weights.
fn halfway(x: usize) -> (isize, [f32; 4]) {
    let (half, odd) = ((x / 2) as isize, x % 2);
    if odd == 1 { (half - 1, catmull_rom(0.25)) } else { (half - 2, catmull_rom(0.75)) }
}

/// sum += weight · pixel
#[inline(always)]
pub(super) fn accumulate(sum: &mut Pixel, weight: f32, pixel: &Pixel) {
    let ([a, b, c, d], [r, g, b2, e]) = (*sum, *pixel);
    *sum = [a + weight * r, b + weight * g, c + weight * b2, d + weight * e];
}

/// Weights of four neighbours for a position `t` in [0, 1] between the middle two.
///
/// Source: Catmull and Rom 1974; Keys 1981, eq. 15 with a = −½.
#[inline(always)]
pub(super) fn catmull_rom<L: Lane>(t: L) -> [L; 4] {
    let (half, one, half3, two, half5) = (t.lit(0.5), t.lit(1.0), t.lit(1.5), t.lit(2.0), t.lit(2.5));
    let (t2, t3) = (t * t, t * t * t);
    [
        -half * t3 + t2 - half * t,
        half3 * t3 - half5 * t2 + one,
        -half3 * t3 + two * t2 + half * t,
        half * t3 - half * t2,
    ]
}

/// The minimum and the maximum width of a filtered image.
const WIDTHS: [usize; 2] = [256, 2048];

/// Resamples the image onto rings, half as many as pixels per ring. Their number can be halved down to rings of 256
/// to 511 pixels. An image that already has this form is unchanged.
pub(super) fn on_rings(level: Level, picture: &Equirect) -> Rings {
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
            let rings = on_rings(SimdLevel::fastest(), &Equirect::new(&image));
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
        let rings = on_rings(SimdLevel::fastest(), &Equirect::new(&image));
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
