//! The smooth part of an image of the sphere as spherical harmonics.

use super::lobe::Coefficients;
use super::rings::{Areas, Pixel, Rings, accumulate};
use crate::math::scalar;
use crate::parallel;
use std::f64::consts::{PI, TAU};

/// The light of an image up to a degree: for each order m its coefficients for l from m on, with cos mφ and sin mφ.
///
/// Source: Green 2003, "Spherical Harmonic Lighting", for real harmonics; Holmes and Featherstone 2002, eq. 11 and
/// 12, for the recurrence.
pub(super) struct Harmonics {
    degree: usize,
    orders: Vec<Vec<Pair>>,
}

/// Three channels with cos mφ and three with sin mφ.
type Pair = [f64; 6];

impl Harmonics {
    /// Makes the harmonics of an image that shows no degree above its number of rings less `degree`.
    pub(super) fn new(rings: &Rings, degree: usize) -> Self {
        let waves = Waves::new(rings.width, degree);
        let areas = rings.areas(&Areas::Smooth);
        let scale = 2.0 / rings.height as f64 * TAU / rings.width as f64;
        let legendre = Legendre::new(rings, degree);
        let row = |y: usize| analysed(rings.row(y), degree, &waves, areas[y] * scale);
        let rows: Vec<Vec<Pair>> = parallel::tasks(rings.height, &row);
        let order = |m: usize| {
            let mut sums = vec![[0.0; 6]; degree + 1 - m];
            for (y, row) in rows.iter().enumerate() {
                legendre.each(m, y, |l, p| {
                    sums[l - m].iter_mut().zip(row[m]).for_each(|(sum, light)| *sum += p * light);
                });
            }
            sums
        };
        Self { degree, orders: parallel::tasks(degree + 1, &order) }
    }

    /// The image on rings of `width` pixels, half as many rings, each degree multiplied by its coefficient.
    pub(super) fn rings(&self, coefficients: &Coefficients, width: usize) -> Rings {
        let mut output = Rings::black(width, width / 2);
        let legendre = Legendre::new(&output, self.degree);
        let waves = Waves::new(width, self.degree);
        parallel::pieces(&mut output.pixels, width, &|y, row| {
            for m in 0..=self.degree {
                let mut sum = [0.0; 6];
                legendre.each(m, y, |l, p| {
                    let (light, p) = (&self.orders[m][l - m], p * coefficients[l]);
                    sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += p * light);
                });
                let [r, g, b, r2, g2, b2] = sum.map(|light| light as f32);
                for (pixel, [c, s]) in row.iter_mut().zip(waves.of(m)) {
                    accumulate(pixel, *c, &[r, g, b, 0.0]);
                    accumulate(pixel, *s, &[r2, g2, b2, 0.0]);
                }
            }
        });
        output
    }
}

/// The cosine and the sine of m times the azimuth in the middle of each pixel.
struct Waves {
    width: usize,
    table: Vec<[f32; 2]>,
}

impl Waves {
    fn new(width: usize, degree: usize) -> Self {
        let half = |x: usize| x as f64 * PI / width as f64;
        let once: Vec<[f32; 2]> =
            (0..2 * width).map(|x| [scalar::cos(half(x)) as f32, scalar::sin(half(x)) as f32]).collect();
        let wave = |m: usize| (0..width).map(move |x| m * (2 * x + 1) % (2 * width));
        Self { width, table: (0..=degree).flat_map(wave).map(|i| once[i]).collect() }
    }

    fn of(&self, m: usize) -> &[[f32; 2]] {
        &self.table[m * self.width..][..self.width]
    }
}

/// A row's light with cos mφ and sin mφ for each m.
fn analysed(row: &[Pixel], degree: usize, waves: &Waves, scale: f64) -> Vec<Pair> {
    let order = |m: usize| {
        let mut sum = [0.0; 6];
        for (pixel, [c, s]) in row.iter().zip(waves.of(m)) {
            for i in 0..3 {
                sum[i] += f64::from(*c) * f64::from(pixel[i]);
                sum[i + 3] += f64::from(*s) * f64::from(pixel[i]);
            }
        }
        sum.map(|sum| sum * scale)
    };
    (0..=degree).map(order).collect()
}

/// Associated Legendre functions at rings, normalised so that harmonics are orthonormal.
struct Legendre {
    degree: usize,
    /// sin θ, cos θ.
    rings: Vec<[f64; 2]>,
    /// The factors of the recurrence, for each order and degree.
    factors: Vec<Vec<[f64; 2]>>,
}

impl Legendre {
    fn new(rings: &Rings, degree: usize) -> Self {
        let ring = |y| [scalar::sin(rings.polar(y)), scalar::cos(rings.polar(y))];
        let factor = |l: usize, m: usize| {
            let [l, m] = [l as f64, m as f64];
            let a = (4.0 * l * l - 1.0) / (l * l - m * m);
            let b = ((l - 1.0) * (l - 1.0) - m * m) / (4.0 * (l - 1.0) * (l - 1.0) - 1.0);
            [a.sqrt(), b.max(0.0).sqrt()]
        };
        let factors = |m: usize| (m + 1..=degree).map(|l| factor(l, m)).collect();
        Self {
            degree,
            rings: (0..rings.height).map(ring).collect(),
            factors: (0..=degree).map(factors).collect(),
        }
    }

    /// Gives the function of order `m` for each degree from m on, at a ring.
    fn each(&self, m: usize, y: usize, mut give: impl FnMut(usize, f64)) {
        let [sin, cos] = self.rings[y];
        let mut p = (1.0 / (4.0 * PI)).sqrt();
        for m in 1..=m {
            p *= sin * ((2 * m + 1) as f64 / (2 * m) as f64).sqrt();
        }
        if m > 0 {
            p *= std::f64::consts::SQRT_2;
        }
        let mut below = 0.0;
        give(m, p);
        for (l, [a, b]) in (m + 1..=self.degree).zip(&self.factors[m]) {
            (below, p) = (p, a * (cos * p - b * below));
            give(l, p);
        }
    }
}
