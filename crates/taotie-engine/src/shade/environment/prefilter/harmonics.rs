//! The smooth part of an image of the sphere as spherical harmonics.

use super::lobe::Coefficients;
use super::rings::{Pixel, Rings, polar};
use crate::math::{MOST_LANES, Pack, dispatch_pack, dispatch_registers, scalar};
use crate::parallel;
use fearless_simd::{Level, Simd, f64x4, f64x8, prelude::*};
use std::f64::consts::{PI, SQRT_2, TAU};

/// The light of an image up to a degree: for each order m its coefficients for l ≥ m, with cos mφ and sin mφ.
///
/// Source: Green 2003, "Spherical Harmonic Lighting", for real harmonics; Holmes and Featherstone 2002, eq. 11 and
/// 12, for the recurrence.
pub(super) struct Harmonics {
    level: Level,
    orders: Vec<Vec<Pair>>,
}

/// Three channels with cos mφ and three with sin mφ; two more are padding for speed.
type Pair = [f64; 8];

impl Harmonics {
    /// Computes the harmonics of an image that contains no degree above its number of rings minus that of `grid`.
    /// `areas` are the weights of its pixels in each row.
    pub(super) fn new(rings: &Rings, areas: &[f64], grid: &Grid) -> Self {
        let scale = 2.0 / rings.height as f64 * TAU / rings.width as f64;
        let level = rings.level;
        let rows: Vec<Vec<Pair>> = parallel::tasks(
            rings.height,
            &|y| dispatch_registers!(level, simd => grid.analysed(simd, rings.row(y), areas[y] * scale)),
        );
        let order = |m: usize| {
            let mut sums = vec![[0.0; 8]; grid.degree + 1 - m];
            for (y, row) in rows.iter().enumerate() {
                for (sum, p) in sums.iter_mut().zip(grid.legendre(y, m)) {
                    sum.iter_mut().zip(row[m]).for_each(|(sum, light)| *sum += p * light);
                }
            }
            sums
        };
        Self { level, orders: parallel::tasks(grid.degree + 1, &order) }
    }

    /// The image on the rings of `grid`, each degree multiplied by its coefficient.
    pub(super) fn rings(&self, coefficients: &Coefficients, grid: &Grid) -> Rings {
        let level = self.level;
        let mut output = Rings::black(level, grid.width);
        parallel::pieces(&mut output.pixels, grid.width, &|y, row| {
            let waves: Vec<[f32; 8]> =
                dispatch_registers!(level, simd => self.waves(simd, coefficients, grid, y));
            dispatch_pack!(level, P, token => grid.shine::<P>(token, &waves, row));
        });
        output
    }

    /// Returns the light of a ring with the waves of each order.
    #[inline(always)]
    fn waves<S: Simd>(&self, simd: S, coefficients: &Coefficients, grid: &Grid, y: usize) -> Vec<[f32; 8]> {
        let mut waves = vec![[0.0; 8]; self.orders.len()];
        for (m, (wave, lights)) in waves.iter_mut().zip(&self.orders).enumerate() {
            let mut sum = f64x8::splat(simd, 0.0);
            for ((p, c), light) in grid.legendre(y, m).iter().zip(&coefficients[m..]).zip(lights) {
                sum += f64x8::splat(simd, p * c) * f64x8::simd_from(simd, *light);
            }
            for (wave, sum) in wave.iter_mut().zip(<[f64; 8]>::from(sum)) {
                *wave = sum as f32;
            }
        }
        waves
    }
}

/// The values of harmonics up to a degree at the pixels of rings.
pub(super) struct Grid {
    degree: usize,
    width: usize,
    /// The factor from one order's waves to the next.
    room: usize,
    /// The cosine and the sine of m times the azimuth at the centre of each pixel.
    waves: [Vec<f32>; 2],
    /// Associated Legendre functions at each ring, by order and degree; normalised so that harmonics are orthonormal.
    legendre: Vec<Vec<f64>>,
    /// The start of those of each order.
    starts: Vec<usize>,
}

impl Grid {
    /// Computes the values for rings of `width` pixels, half as many rings.
    pub(super) fn new(width: usize, degree: usize) -> Self {
        let half = |x: usize| x as f64 * PI / width as f64;
        let room = width.next_multiple_of(MOST_LANES);
        let waves = |wave: fn(f64) -> f64| {
            let once: Vec<f32> = (0..2 * width).map(|x| wave(half(x)) as f32).collect();
            let place = |i: usize| i / room * (2 * (i % room) + 1) % (2 * width);
            (0..(degree + 1) * room).map(|i| once[place(i)]).collect()
        };
        let factors = Factors::new(degree);
        let legendre = |y: usize| factors.legendre(polar(width / 2, y));
        Self {
            degree,
            width,
            room,
            waves: [waves(scalar::cos), waves(scalar::sin)],
            legendre: parallel::tasks(width / 2, &legendre),
            starts: (0..=degree)
                .scan(0, |end, m| Some(std::mem::replace(end, *end + degree + 1 - m)))
                .collect(),
        }
    }

    /// The functions of order `m` at a ring, for each degree from m upwards.
    #[inline(always)]
    fn legendre(&self, y: usize, m: usize) -> &[f64] {
        &self.legendre[y][self.starts[m]..][..self.degree + 1 - m]
    }

    /// A row's light with cos mφ and sin mφ for each m.
    #[inline(always)]
    fn analysed<S: Simd>(&self, simd: S, row: &[Pixel], scale: f64) -> Vec<Pair> {
        let wide = |[r, g, b, _]: &Pixel| [f64::from(*r), f64::from(*g), f64::from(*b), 0.0];
        let row: Vec<[f64; 4]> = row.iter().map(wide).collect();
        let [cosines, sines] = &self.waves;
        let waves = cosines.chunks_exact(self.room).zip(sines.chunks_exact(self.room));
        let mut pairs = vec![[0.0; 8]; self.degree + 1];
        for (pair, (cosines, sines)) in pairs.iter_mut().zip(waves) {
            let mut sums = [f64x4::splat(simd, 0.0); 2];
            for ((pixel, c), s) in row.iter().zip(cosines).zip(sines) {
                let pixel = f64x4::simd_from(simd, *pixel);
                sums[0] += f64x4::splat(simd, f64::from(*c)) * pixel;
                sums[1] += f64x4::splat(simd, f64::from(*s)) * pixel;
            }
            let ([r, g, b, _], [r2, g2, b2, _]) = (<[f64; 4]>::from(sums[0]), <[f64; 4]>::from(sums[1]));
            *pair = [r * scale, g * scale, b * scale, r2 * scale, g2 * scale, b2 * scale, 0.0, 0.0];
        }
        pairs
    }

    /// Writes the radiance of `lights` with the waves of each order to the pixels of a ring.
    #[inline(always)]
    fn shine<P: Pack>(&self, token: P::Token, lights: &[[f32; 8]], row: &mut [Pixel]) {
        let zero = P::splat(token, 0.0);
        let mut shone = [[0.0; 4]; MOST_LANES];
        for (i, pixels) in row.chunks_mut(P::LANES).enumerate() {
            let mut sums = [zero; 3];
            for (m, light) in lights.iter().enumerate() {
                let place = m * self.room + i * P::LANES;
                let [cosines, sines] = &self.waves;
                let (c, s) = (P::load(token, &cosines[place..]), P::load(token, &sines[place..]));
                for (k, sum) in sums.iter_mut().enumerate() {
                    *sum = *sum + c * P::splat(token, light[k]) + s * P::splat(token, light[k + 3]);
                }
            }
            let [r, g, b] = sums;
            P::store_pixels([r, g, b, zero], &mut shone);
            pixels.copy_from_slice(&shone[..pixels.len()]);
        }
    }
}

/// The factors of the recurrence of associated Legendre functions.
struct Factors {
    /// From one order to the next.
    orders: Vec<f64>,
    /// For each order from one degree to the next.
    degrees: Vec<Vec<[f64; 2]>>,
}

impl Factors {
    fn new(degree: usize) -> Self {
        let factor = |l: usize, m: usize| {
            let [l, m] = [l as f64, m as f64];
            let a = (4.0 * l * l - 1.0) / (l * l - m * m);
            let b = ((l - 1.0) * (l - 1.0) - m * m) / (4.0 * (l - 1.0) * (l - 1.0) - 1.0);
            [a.sqrt(), b.max(0.0).sqrt()]
        };
        let order = |m: usize| ((2 * m + 1) as f64 / (2 * m) as f64).sqrt();
        Self {
            orders: (1..=degree).map(order).collect(),
            degrees: (0..=degree).map(|m| (m + 1..=degree).map(|l| factor(l, m)).collect()).collect(),
        }
    }

    /// The functions at a polar angle, by order and degree.
    fn legendre(&self, polar: f64) -> Vec<f64> {
        let (sin, cos) = (scalar::sin(polar), scalar::cos(polar));
        let mut values = Vec::new();
        let mut start = (1.0 / (4.0 * PI)).sqrt();
        for (m, degrees) in self.degrees.iter().enumerate() {
            let mut p = start;
            if m > 0 {
                start *= sin * self.orders[m - 1];
                p = start * SQRT_2;
            }
            let mut below = 0.0;
            values.push(p);
            for [a, b] in degrees {
                (below, p) = (p, a * (cos * p - b * below));
                values.push(p);
            }
        }
        values
    }
}
