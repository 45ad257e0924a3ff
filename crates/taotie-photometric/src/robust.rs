//! The robust estimator: order statistics reject shadows and highlights, L1 by iterative reweighting starts, and a
//! redescending estimator refines.
//!
//! 1. The darkest 35 % and the brightest 15 % of a pixel's samples are left out, and so are saturated and black ones: the
//!    fractions of the project's design, not tuned here.
//! 2. L1 on the rest, by reweighted least squares (Schlossmacher 1973).
//! 3. The scale of the residuals is their median absolute deviation, corrected for the number of photographs
//!    ([`Robust::spread`]).
//! 4. Tukey's biweight at three scales brings back all samples that agree with the fit (an MM-estimate: Yohai 1987).
//! 5. If the residuals of least squares over all samples are no larger than noise would make them, nothing is rejected,
//!    since rejecting good samples only adds noise.

use crate::block::{LANES, LightTerms, Pack, Sums, packs, shaded, vector, weight};
use crate::photograph::Sample;
use crate::samples::Samples;
use crate::symmetric::Sym3;
use taotie_engine::math::Vec3;

/// Fraction of the darkest samples that the start leaves out.
const DARKEST: f64 = 0.35;
/// Fraction of the brightest samples that the start leaves out.
const BRIGHTEST: f64 = 0.15;
/// Steps of L1.
const L1_STEPS: usize = 7;
/// Steps of the biweight.
const REFINEMENTS: usize = 5;
/// Residuals in scales from which a sample has no weight.
const CUT: f64 = 3.0;
/// Sum of weights below which a pixel keeps its start.
const LEAST_WEIGHT: f32 = 5.0;
/// The smallest scale, relative to the albedo: rounding of an 8-bit photograph.
const LEAST_SCALE: f64 = 1e-3;
/// The median absolute deviation of normally distributed numbers, as a multiple of their standard deviation, inverted.
const NORMAL_MAD: f64 = 1.4826;
/// Least squares is kept if its residuals are at most this multiple of the scale.
const CLEAN: f64 = 1.5;

/// The fewest photographs for the robust estimator; with fewer, its estimate is that of least squares.
pub const FEWEST: usize = 8;

/// The fits of one pixel.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Fit {
    /// Normal times albedo by least squares over all samples.
    pub least_squares: Vec3<f64>,
    /// Standard deviation of its residuals.
    pub deviation: f64,
    /// Normal times albedo by the robust estimator.
    pub robust: Vec3<f64>,
    /// Scale of its residuals; infinite if no sample is rejected.
    pub scale: f64,
}

impl Fit {
    /// Returns the inverse of the residual from which a sample has no weight; 0 if all have full weight.
    #[inline(always)]
    pub fn inverse_reach(&self) -> f64 {
        1.0 / (CUT * self.scale)
    }
}

/// Fits blocks of pixels.
#[derive(Debug, Clone)]
pub struct Robust<'a> {
    samples: &'a Samples,
    /// Inverse of Σ l lᵀ.
    inverse: Sym3,
}

/// Memory of a block, reused.
#[derive(Debug, Default)]
pub struct Scratch {
    lights: Vec<LightTerms>,
    samples: Vec<Pack>,
    /// 1 for samples that are neither saturated nor missing, else 0.
    usable: Vec<Pack>,
    kept: Vec<Pack>,
    residuals: Vec<Pack>,
    sorted: Vec<f32>,
}

/// The samples of a pixel, those of a lane of a block.
struct PixelSamples<'a> {
    pixel: usize,
    lane: usize,
    scratch: &'a Scratch,
}

impl<'a> Robust<'a> {
    /// Prepares the lights.
    pub fn new(samples: &'a Samples) -> Self {
        let mut sum = Sym3::default();
        samples.lights.iter().for_each(|light| sum.add(*light, 1.0));
        // Opening a set checks that its lights determine a normal.
        Self { samples, inverse: sum.inverse().unwrap_or_default() }
    }

    /// The number of lights.
    fn count(&self) -> usize {
        self.samples.lights.len()
    }

    /// The ratio of the standard deviation of normally distributed residuals to their scale by median, for the
    /// samples that the start keeps: a fit to n points leaves their median too small. From a simulation of 4,000
    /// pixels with 12, 16, 24, 48 and 96 lights (2.28, 1.86, 1.43, 1.17 and 1.07).
    fn spread(&self) -> f64 {
        1.0 + 7.0 / (self.count() as f64 - 6.0)
    }

    /// Returns the first fits of the pixels from `first` on, at most [`LANES`]: least squares, the start, and the
    /// scale.
    pub fn start(&self, first: usize, scratch: &mut Scratch) -> [Fit; LANES] {
        self.load(first, scratch);
        let least_squares = self.least_squares(first, scratch);
        self.subtract(scratch, &packs(least_squares));
        let deviations = self.deviations(scratch);
        let fit = |lane: usize, robust: Vec3<f64>, scale: f64| Fit {
            least_squares: least_squares[lane],
            deviation: deviations[lane],
            robust,
            scale,
        };
        if self.count() < FEWEST {
            return std::array::from_fn(|lane| fit(lane, least_squares[lane], f64::INFINITY));
        }
        let start = self.l1(scratch, &packs(least_squares));
        self.subtract(scratch, &start);
        std::array::from_fn(|lane| {
            let b = vector(&start, lane);
            fit(lane, b, self.scale(b.length(), lane, scratch))
        })
    }

    /// Returns the fits by least squares over all usable samples.
    fn least_squares(&self, first: usize, scratch: &Scratch) -> [Vec3<f64>; LANES] {
        let mut sums = [[0.0; LANES]; 3];
        for (light, samples) in self.samples.lights.iter().zip(&scratch.samples) {
            for (sum, l) in sums.iter_mut().zip(light.to_array()) {
                (0..LANES).for_each(|lane| sum[lane] += f64::from(samples[lane]) * l);
            }
        }
        std::array::from_fn(|lane| {
            let is_whole = scratch.usable.iter().all(|usable| usable[lane] == 1.0);
            if is_whole && !self.samples.is_near() {
                return self.inverse.times(Vec3::from_array(sums.map(|sum| sum[lane])));
            }
            let pixel = PixelSamples { pixel: self.pixel(first, lane), lane, scratch };
            self.solved(&pixel, |_| 1.0).map_or(Vec3::splat(0.0), |(b, _)| b)
        })
    }

    /// Refines first fits. `typical` is the median scale of all pixels.
    pub fn refine(
        &self,
        first: usize,
        fits: [Fit; LANES],
        typical: f64,
        scratch: &mut Scratch,
    ) -> [Fit; LANES] {
        let is_clean = |fit: &Fit| fit.deviation <= CLEAN * fit.scale.max(typical);
        let as_all = |fit: Fit| Fit { robust: fit.least_squares, scale: f64::INFINITY, ..fit };
        if fits.iter().all(is_clean) {
            return fits.map(as_all);
        }
        self.load(first, scratch);
        let start = packs(fits.map(|fit| fit.robust));
        let inverses = fits.map(|fit| fit.inverse_reach() as f32);
        let mut b = start;
        for _ in 1..REFINEMENTS {
            let (mut sums, mut total) = (Sums::default(), [0.0; LANES]);
            let all = scratch.lights.iter().zip(&scratch.samples).zip(&scratch.usable);
            for ((light, samples), usable) in all {
                let mut weights = weights(samples, &shaded(&b, light), &inverses);
                (0..LANES).for_each(|lane| weights[lane] *= usable[lane]);
                (0..LANES).for_each(|lane| total[lane] += weights[lane]);
                sums.add(light, samples, &weights);
            }
            let solved = sums.solve(&b);
            for lane in 0..LANES {
                let source = if total[lane] < LEAST_WEIGHT { &start } else { &solved };
                (0..3).for_each(|c| b[c][lane] = source[c][lane]);
            }
        }
        std::array::from_fn(|lane| {
            let fit = fits[lane];
            match is_clean(&fit) {
                true => as_all(fit),
                false => self.exact(
                    fit,
                    vector(&b, lane),
                    &PixelSamples { pixel: self.pixel(first, lane), lane, scratch },
                ),
            }
        })
    }

    /// The pixel of a lane; lanes beyond the last pixel repeat it.
    fn pixel(&self, first: usize, lane: usize) -> usize {
        (first + lane).min(self.samples.pixels.len() - 1)
    }

    /// Returns the weighted fit of a pixel to its usable samples in double precision, and the sum of the weights; `None` if
    /// the weights do not determine it.
    fn solved(
        &self,
        PixelSamples { pixel, lane, scratch }: &PixelSamples<'_>,
        weight: impl Fn((f64, Vec3<f64>)) -> f64,
    ) -> Option<(Vec3<f64>, f64)> {
        let (mut matrix, mut right, mut total) = (Sym3::default(), Vec3::splat(0.0), 0.0);
        for (k, samples) in scratch.samples.iter().enumerate() {
            let (sample, direction) = (f64::from(samples[*lane]), self.samples.direction(k, *pixel));
            let weight = weight((sample, direction)) * f64::from(scratch.usable[k][*lane]);
            matrix.add(direction, weight);
            right += direction * (weight * sample);
            total += weight;
        }
        Some((matrix.inverse()?.times(right), total))
    }

    /// Returns a fit with the weights of the residuals of `b`, in double precision.
    fn exact(&self, fit: Fit, b: Vec3<f64>, pixel: &PixelSamples<'_>) -> Fit {
        let inverse_reach = fit.inverse_reach();
        let weight = |(sample, direction)| weight(sample - b.dot(direction), inverse_reach);
        match self.solved(pixel, weight) {
            Some((robust, total)) if total >= f64::from(LEAST_WEIGHT) => Fit { robust, ..fit },
            _ => fit,
        }
    }

    /// Loads the samples of a block; lanes beyond the last pixel repeat it.
    fn load(&self, first: usize, scratch: &mut Scratch) {
        let pixels: [usize; LANES] = std::array::from_fn(|lane| self.pixel(first, lane));
        if self.samples.is_near() || scratch.lights.is_empty() {
            scratch.lights.clear();
            let directions = |k: usize| pixels.map(|pixel| self.samples.direction(k, pixel));
            scratch.lights.extend((0..self.count()).map(|k| LightTerms::new(directions(k))));
        }
        let Scratch { samples, usable, kept, .. } = scratch;
        [&mut *samples, &mut *usable, &mut *kept].into_iter().for_each(Vec::clear);
        for image in &self.samples.images {
            let all = pixels.map(|pixel| image[pixel]);
            samples.push(all.map(Sample::grey));
            usable.push(all.map(|sample| f32::from(sample.is_usable())));
        }
        kept.resize(self.count(), [0.0; LANES]);
        (0..LANES).for_each(|lane| self.keep(lane, scratch));
    }

    /// Marks the samples of a pixel that the start keeps, by order statistics.
    fn keep(&self, lane: usize, scratch: &mut Scratch) {
        let count = self.count();
        let sorted = &mut scratch.sorted;
        sorted.clear();
        sorted.extend(scratch.samples.iter().map(|samples| samples[lane]));
        let low = (DARKEST * count as f64) as usize;
        let high = count - 1 - (BRIGHTEST * count as f64) as usize;
        let (_, low, above) = sorted.select_nth_unstable_by(low, f32::total_cmp);
        let low = *low;
        let high = match high - (count - above.len()) {
            rest if rest < above.len() => *above.select_nth_unstable_by(rest, f32::total_cmp).1,
            _ => low,
        };
        let all = scratch.kept.iter_mut().zip(&scratch.samples).zip(&scratch.usable);
        for ((kept, samples), usable) in all {
            let is_kept = samples[lane] > 0.0 && (low..=high).contains(&samples[lane]);
            kept[lane] = if is_kept { usable[lane] } else { 0.0 };
        }
    }

    fn solve(&self, scratch: &Scratch, weights: &[Pack], otherwise: &[Pack; 3]) -> [Pack; 3] {
        let mut sums = Sums::default();
        for ((light, samples), weights) in scratch.lights.iter().zip(&scratch.samples).zip(weights) {
            sums.add(light, samples, weights);
        }
        sums.solve(otherwise)
    }

    fn l1(&self, scratch: &Scratch, otherwise: &[Pack; 3]) -> [Pack; 3] {
        let mut b = self.solve(scratch, &scratch.kept, otherwise);
        for _ in 1..L1_STEPS {
            let mut least = [0.0; LANES];
            for (lane, least) in least.iter_mut().enumerate() {
                *least = 1e-3 * b.iter().map(|v| v[lane].abs()).sum::<f32>() + 1e-9;
            }
            let mut sums = Sums::default();
            for ((light, samples), kept) in scratch.lights.iter().zip(&scratch.samples).zip(&scratch.kept) {
                let shaded = shaded(&b, light);
                let mut weights = [0.0; LANES];
                for lane in 0..LANES {
                    let residual = (samples[lane] - shaded[lane]).abs();
                    weights[lane] = kept[lane] / if residual > least[lane] { residual } else { least[lane] };
                }
                sums.add(light, samples, &weights);
            }
            b = sums.solve(&b);
        }
        b
    }

    /// Computes the residuals of all samples.
    fn subtract(&self, scratch: &mut Scratch, b: &[Pack; 3]) {
        let Scratch { lights, samples, residuals, .. } = scratch;
        residuals.clear();
        for (light, samples) in lights.iter().zip(samples.iter()) {
            let shaded = shaded(b, light);
            residuals.push(std::array::from_fn(|lane| samples[lane] - shaded[lane]));
        }
    }

    /// Returns the standard deviations of the residuals of all usable samples.
    fn deviations(&self, scratch: &Scratch) -> [f64; LANES] {
        let (mut squares, mut counts) = ([0.0_f32; LANES], [-3.0_f32; LANES]);
        for (residuals, usable) in scratch.residuals.iter().zip(&scratch.usable) {
            (0..LANES).for_each(|lane| squares[lane] += usable[lane] * residuals[lane] * residuals[lane]);
            (0..LANES).for_each(|lane| counts[lane] += usable[lane]);
        }
        std::array::from_fn(|lane| (f64::from(squares[lane]) / f64::from(counts[lane].max(1.0))).sqrt())
    }

    /// Returns the scale of the residuals of the samples that the start keeps.
    fn scale(&self, length: f64, lane: usize, scratch: &mut Scratch) -> f64 {
        let Scratch { kept, residuals, sorted, .. } = scratch;
        let of_kept = residuals.iter().zip(kept.iter()).filter(|(_, kept)| kept[lane] > 0.0);
        sorted.clear();
        sorted.extend(of_kept.map(|(residuals, _)| residuals[lane].abs()));
        let least = (LEAST_SCALE * length).max(f64::MIN_POSITIVE);
        if sorted.is_empty() {
            return least;
        }
        let middle = sorted.len() / 2;
        let median = *sorted.select_nth_unstable_by(middle, f32::total_cmp).1;
        (NORMAL_MAD * f64::from(median)).max(least) * self.spread()
    }
}

/// Returns Tukey's biweights of samples, given [`Fit::inverse_reach`].
#[inline(always)]
fn weights(samples: &Pack, shaded: &Pack, inverses: &Pack) -> Pack {
    let mut weights = [0.0; LANES];
    for lane in 0..LANES {
        let relative = (samples[lane] - shaded[lane]) * inverses[lane];
        let inside = 1.0 - relative * relative;
        weights[lane] = if inside > 0.0 { inside * inside } else { 0.0 };
    }
    weights
}
