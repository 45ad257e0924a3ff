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

use crate::block::{LANES, LightTerms, Pack, Sums, shaded, vector};
use crate::samples::Samples;
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
const LEAST_WEIGHT: f64 = 5.0;
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
    lights: Vec<LightTerms>,
}

/// Memory of a block, reused.
#[derive(Debug, Default)]
pub struct Scratch {
    samples: Vec<Pack>,
    kept: Vec<Pack>,
    residuals: Vec<Pack>,
    sorted: Vec<f64>,
}

impl<'a> Robust<'a> {
    /// Prepares the lights.
    pub fn new(samples: &'a Samples) -> Self {
        Self { samples, lights: samples.lights.iter().map(|light| LightTerms::new(*light)).collect() }
    }

    /// The lights.
    pub fn lights(&self) -> &[LightTerms] {
        &self.lights
    }

    /// The ratio of the standard deviation of normally distributed residuals to their scale by median, for the
    /// samples that the start keeps: a fit to n points leaves their median too small. From a simulation of 4,000
    /// pixels with 12, 16, 24, 48 and 96 lights (2.28, 1.86, 1.43, 1.17 and 1.07).
    fn spread(&self) -> f64 {
        1.0 + 7.0 / (self.lights.len() as f64 - 6.0)
    }

    /// Returns the first fits of the pixels from `first` on, at most [`LANES`]: least squares, the start, and the
    /// scale.
    pub fn start(&self, first: usize, scratch: &mut Scratch) -> [Fit; LANES] {
        self.load(first, scratch);
        let all = vec![[1.0; LANES]; self.lights.len()];
        let least_squares = self.solve(scratch, &all, &[[0.0; LANES]; 3]);
        self.subtract(scratch, &least_squares);
        let deviations = self.deviations(scratch);
        let fit = |lane: usize, start: &[Pack; 3], scale: f64| Fit {
            least_squares: vector(&least_squares, lane),
            deviation: deviations[lane],
            robust: vector(start, lane),
            scale,
        };
        if self.lights.len() < FEWEST {
            return std::array::from_fn(|lane| fit(lane, &least_squares, f64::INFINITY));
        }
        let start = self.l1(scratch, &least_squares);
        self.subtract(scratch, &start);
        std::array::from_fn(|lane| {
            let scale = self.scale(vector(&start, lane).length(), lane, scratch);
            fit(lane, &start, scale)
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
        let start: [Pack; 3] = std::array::from_fn(|c| fits.map(|fit| fit.robust.to_array()[c]));
        let inverses = fits.map(|fit| fit.inverse_reach());
        let mut b = start;
        for _ in 0..REFINEMENTS {
            let (mut sums, mut total) = (Sums::default(), [0.0; LANES]);
            for (light, samples) in self.lights.iter().zip(&scratch.samples) {
                let weights = weights(samples, &shaded(&b, light), &inverses);
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
            if is_clean(&fit) { as_all(fit) } else { Fit { robust: vector(&b, lane), ..fit } }
        })
    }

    /// Loads the samples of a block; lanes beyond the last pixel repeat it.
    fn load(&self, first: usize, scratch: &mut Scratch) {
        let last = self.samples.pixels.len() - 1;
        scratch.samples.clear();
        scratch.samples.extend(
            self.samples
                .images
                .iter()
                .map(|image| std::array::from_fn(|lane| f64::from(image[(first + lane).min(last)].grey()))),
        );
        scratch.kept.clear();
        scratch.kept.resize(self.lights.len(), [0.0; LANES]);
        for lane in 0..LANES {
            self.keep((first + lane).min(last), lane, scratch);
        }
    }

    /// Marks the samples of a pixel that the start keeps, by order statistics.
    fn keep(&self, pixel: usize, lane: usize, scratch: &mut Scratch) {
        let count = self.lights.len();
        let sorted = &mut scratch.sorted;
        sorted.clear();
        sorted.extend(scratch.samples.iter().map(|samples| samples[lane]));
        let low = (DARKEST * count as f64) as usize;
        let high = count - 1 - (BRIGHTEST * count as f64) as usize;
        let (_, low, above) = sorted.select_nth_unstable_by(low, f64::total_cmp);
        let low = *low;
        let high = match high - (count - above.len()) {
            rest if rest < above.len() => *above.select_nth_unstable_by(rest, f64::total_cmp).1,
            _ => low,
        };
        for (k, kept) in scratch.kept.iter_mut().enumerate() {
            let sample = self.samples.images[k][pixel];
            let grey = scratch.samples[k][lane];
            let usable = grey > 0.0 && !sample.is_saturated();
            kept[lane] = if usable && (low..=high).contains(&grey) { 1.0 } else { 0.0 };
        }
    }

    fn solve(&self, scratch: &Scratch, weights: &[Pack], otherwise: &[Pack; 3]) -> [Pack; 3] {
        let mut sums = Sums::default();
        for ((light, samples), weights) in self.lights.iter().zip(&scratch.samples).zip(weights) {
            sums.add(light, samples, weights);
        }
        sums.solve(otherwise)
    }

    fn l1(&self, scratch: &Scratch, otherwise: &[Pack; 3]) -> [Pack; 3] {
        let mut b = self.solve(scratch, &scratch.kept, otherwise);
        for _ in 1..L1_STEPS {
            let mut least = [0.0; LANES];
            for (lane, least) in least.iter_mut().enumerate() {
                *least = 1e-3 * b.iter().map(|v| v[lane].abs()).sum::<f64>() + 1e-9;
            }
            let mut sums = Sums::default();
            for ((light, samples), kept) in self.lights.iter().zip(&scratch.samples).zip(&scratch.kept) {
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
        scratch.residuals.clear();
        for (light, samples) in self.lights.iter().zip(&scratch.samples) {
            let shaded = shaded(b, light);
            scratch.residuals.push(std::array::from_fn(|lane| samples[lane] - shaded[lane]));
        }
    }

    /// Returns the standard deviations of the residuals of all samples.
    fn deviations(&self, scratch: &Scratch) -> Pack {
        let mut squares = [0.0; LANES];
        for residuals in &scratch.residuals {
            (0..LANES).for_each(|lane| squares[lane] += residuals[lane] * residuals[lane]);
        }
        squares.map(|sum| (sum / (self.lights.len() - 3) as f64).sqrt())
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
        let median = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
        (NORMAL_MAD * median).max(least) * self.spread()
    }
}

/// Returns Tukey's biweights of samples, given [`Fit::inverse_reach`].
#[inline(always)]
fn weights(samples: &Pack, shaded: &Pack, inverses: &Pack) -> Pack {
    let mut weights = [0.0; LANES];
    for lane in 0..LANES {
        weights[lane] = weight(samples[lane] - shaded[lane], inverses[lane]);
    }
    weights
}

/// Returns Tukey's biweight of a residual, given [`Fit::inverse_reach`].
#[inline(always)]
pub fn weight(residual: f64, inverse_reach: f64) -> f64 {
    let relative = residual * inverse_reach;
    let inside = 1.0 - relative * relative;
    if inside > 0.0 { inside * inside } else { 0.0 }
}
