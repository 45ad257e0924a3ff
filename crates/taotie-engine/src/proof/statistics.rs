//! Statistics of samples with confidence intervals: means, quantiles, and the shares beyond any limit.

use super::SurfaceSample;
use crate::compare::{Field, Summary};
use crate::error::Result;
use crate::math::Vec3;
use crate::parallel;

/// Standard deviations on either side of the mean that contain 99 % of a normal distribution.
const SIGMAS_99: f64 = 2.5758;

/// A summary of samples of a quantity and the 99 % intervals of its mean and its p95.
///
/// ```
/// use taotie_engine::proof::Estimate;
///
/// /// Returns `true` if samples cannot decide if the mean is below `limit`.
/// fn is_undecided(estimate: &Estimate, limit: f64) -> bool {
///     let [low, high] = estimate.mean_interval;
///     (low..high).contains(&limit)
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Estimate {
    /// The summary of the samples. Its maximum is over samples, not a bound.
    pub summary: Summary,
    /// The 99 % interval of the mean: mean ± 2.58 s/√n, with the sample standard deviation s.
    pub mean_interval: [f64; 2],
    /// The 99 % interval of the quantile 0.95, from order statistics.
    pub p95_interval: [f64; 2],
}

impl Estimate {
    /// Summarises samples, ignoring NaN; `None` if there are none.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] for more than 2^32 − 1 samples.
    pub fn of(samples: &[f32]) -> Result<Option<Self>> {
        let mut sorted: Vec<f32> = samples.iter().copied().filter(|v| !v.is_nan()).collect();
        if sorted.is_empty() {
            return Ok(None);
        }
        let Some(summary) = Field::new(sorted.len() as u32, 1, sorted.clone())?.summary() else {
            return Ok(None);
        };
        sorted.sort_unstable_by(f32::total_cmp);
        let count = sorted.len() as f64;
        let from_mean = |v: &f32| f64::from(*v) - summary.mean;
        let squares: f64 = sorted.iter().map(|v| from_mean(v) * from_mean(v)).sum();
        let half = SIGMAS_99 * (squares / (count - 1.0).max(1.0) / count).sqrt();
        let spread = SIGMAS_99 * (count * 0.95 * 0.05).sqrt();
        let at = |rank: f64| f64::from(sorted[(rank.max(0.0) as usize).min(sorted.len() - 1)]);
        Ok(Some(Self {
            summary,
            mean_interval: [(summary.mean - half).max(0.0), summary.mean + half],
            p95_interval: [at(count * 0.95 - spread), at(count * 0.95 + spread)],
        }))
    }
}

/// Returns the 99 % interval of a share measured with `count` samples, [0, 1]. It includes the share, so it starts at
/// exactly 0 if no sample counts, and ends at exactly 1 if all do.
///
/// Source: Wilson 1927, "Probable inference, the law of succession, and statistical inference".
pub fn share_interval(share: f64, count: usize) -> [f64; 2] {
    let (n, z) = (count.max(1) as f64, SIGMAS_99);
    let middle = share + z * z / (2.0 * n);
    let half = z * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
    let [low, high] = [middle - half, middle + half].map(|bound| (bound / (1.0 + z * z / n)).clamp(0.0, 1.0));
    // Rounding may place the share outside.
    [low.min(share), high.max(share)]
}

/// The digits of the standard limits. Between two limits the share is between theirs.
const DIGITS: [u32; 23] =
    [10, 11, 12, 13, 14, 15, 16, 18, 20, 22, 25, 28, 30, 32, 35, 40, 45, 50, 55, 60, 70, 80, 90];
/// Multipliers and divisors of the digits: limits are 0.0001 to 900, and 0. Division is used where possible, so that
/// 0.5 is exactly the number written like that.
const SCALES: [[f64; 2]; 7] =
    [[1.0, 1e5], [1.0, 1e4], [1.0, 1e3], [1.0, 1e2], [1.0, 10.0], [1.0, 1.0], [10.0, 1.0]];
/// Limits that differ by less than this fraction are the same.
const SAME: f64 = 1e-9;

/// The shares of the visible surface on which a difference exceeds each of many limits, the worse of scan and asset.
///
/// ```
/// use taotie_engine::proof::Exceedance;
///
/// let angles = [0.2, 0.3, 0.6, 7.0];
/// let curve = Exceedance::of([&angles, &[0.1]], &[]).unwrap();
/// assert_eq!(curve.beyond(5.0).value, 0.25);
/// ```
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Exceedance {
    /// Limits in ascending order, from the last that everything exceeds to the first that nothing does.
    pub limits: Vec<f64>,
    /// The share of the surface beyond each, the larger of scan and asset, [0, 1].
    pub shares: Vec<f64>,
    /// The number of samples of the surface with fewer of them.
    pub samples: usize,
}

/// A share of a surface and its confidence interval of 99 %.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Share {
    /// The share, [0, 1].
    pub value: f64,
    /// Its 99 % interval.
    pub interval: [f64; 2],
}

impl Exceedance {
    /// Counts samples of scan and asset, ignoring NaN, beyond the standard limits and those in `asked`; `None` if
    /// there are no samples.
    pub fn of(surfaces: [&[f32]; 2], asked: &[f64]) -> Option<Self> {
        let sorted: Vec<Vec<f64>> = surfaces.into_iter().map(sorted).filter(|v| !v.is_empty()).collect();
        let samples = sorted.iter().map(Vec::len).min()?;
        let beyond = |limit: f64| {
            let share = |values: &Vec<f64>| {
                let within = values.partition_point(|v| *v <= limit);
                (values.len() - within) as f64 / values.len() as f64
            };
            sorted.iter().map(share).fold(0.0, f64::max)
        };
        let mut limits: Vec<f64> = usual_limits().chain(asked.iter().copied()).collect();
        limits.sort_unstable_by(f64::total_cmp);
        limits.dedup_by(|a, b| *a - *b <= *b * SAME);
        let all: Vec<(f64, f64)> = limits.into_iter().map(|limit| (limit, beyond(limit))).collect();
        let first = all.partition_point(|(_, share)| *share >= 1.0).saturating_sub(1);
        let end = (all.partition_point(|(_, share)| *share > 0.0) + 1).min(all.len());
        let (limits, shares) = all[first.min(end - 1)..end].iter().copied().unzip();
        Some(Self { limits, shares, samples })
    }

    /// Returns the share of the surface beyond a limit.
    pub fn beyond(&self, limit: f64) -> Share {
        let next = self.limits.partition_point(|l| *l < limit * (1.0 - SAME));
        let at = |i: usize| (self.limits[i], self.shares[i]);
        let before = if next == 0 { (0.0, 1.0) } else { at(next - 1) };
        let after = if next < self.limits.len() { at(next) } else { (limit, before.1.min(self.least())) };
        if (after.0 - limit).abs() <= limit * SAME {
            return Share { value: after.1, interval: share_interval(after.1, self.samples) };
        }
        let part = (limit - before.0) / (after.0 - before.0);
        let [low, _] = share_interval(after.1, self.samples);
        let [_, high] = share_interval(before.1, self.samples);
        Share { value: before.1 + (after.1 - before.1) * part, interval: [low, high] }
    }

    /// Returns the share beyond the largest limit.
    fn least(&self) -> f64 {
        self.shares.last().copied().unwrap_or(0.0)
    }
}

/// Returns the limits common to all curves.
fn usual_limits() -> impl Iterator<Item = f64> {
    let above_zero = SCALES
        .into_iter()
        .flat_map(|[times, parts]| DIGITS.into_iter().map(move |digits| f64::from(digits) * times / parts));
    std::iter::once(0.0).chain(above_zero)
}

fn sorted(values: &[f32]) -> Vec<f64> {
    let mut values: Vec<f64> = values.iter().filter(|v| !v.is_nan()).map(|v| f64::from(*v)).collect();
    values.sort_unstable_by(f64::total_cmp);
    values
}

/// The look of a scan whose variation within a window is its detail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Detail {
    /// Normals.
    Relief,
    /// Base colours.
    Colors,
}

impl Detail {
    /// Degrees, and differences of colours, that are hardly visible.
    const LEAST: [f64; 2] = [4.0, 4.0];
    /// Maximum number of samples that are compared with each other.
    const MOST: usize = 4096;
    /// The difference of colours in proportion to which added detail counts: noise of image formats is below 3.
    const ADDED: f64 = 12.0;

    /// Returns the larger of the detail that the asset lacks and of the colours that only it has, each with its standard error.
    pub(super) fn unequal(self, samples: &[&SurfaceSample], reach: f32) -> [f64; 2] {
        let lost = self.lost(samples, reach);
        let added = if self == Self::Colors { added(samples, reach) } else { [0.0; 2] };
        if added[0] > lost[0] { added } else { lost }
    }

    /// Returns the differences of samples relative to what varies on the scan around them: √(D / (V + m²)), where D is the
    /// mean square of the differences, V that of the scan's normals or colours about a linear fit over the window, and m the
    /// least that is visible. A difference is that between the scan and what the asset shows most like it within `reach`, so
    /// that an edge may be slightly moved, and the largest 3 % are left out. 0 if the asset has all detail, about 1 if it has
    /// none; 0 without samples. Also returns its standard error.
    pub(super) fn lost(self, samples: &[&SurfaceSample], reach: f32) -> [f64; 2] {
        let some = some_of(samples);
        let squares = unlike(&some, reach, (|seen| self.of(seen)[0], |shown| self.of(shown)[1]));
        let least = Self::LEAST[self as usize];
        with_error(some.len(), |first, step| {
            let points: Vec<_> =
                (first..some.len()).step_by(step).map(|i| self.point(some[i], some[0])).collect();
            (mean_square(&squares, first, step) / (variation(&points) + least * least)).sqrt()
        })
    }

    fn of(self, sample: &SurfaceSample) -> [Vec3; 2] {
        match self {
            Self::Relief => sample.normals.map(|normal| normal * 1.0f32.to_degrees()),
            Self::Colors => sample.labs,
        }
    }

    /// Returns the place of a sample on the plane of the first, and what the scan shows there.
    fn point(self, sample: &SurfaceSample, first: &SurfaceSample) -> ([f64; 2], Vec3<f64>) {
        let right = first.toward.any_perpendicular();
        let off = sample.position - first.position;
        let place = [right, first.toward.cross(right)].map(|axis| f64::from(off.dot(axis)));
        (place, self.of(sample)[0].to_f64())
    }
}

/// Returns at most [`Detail::MOST`] of the samples, evenly spread.
fn some_of<'a>(samples: &[&'a SurfaceSample]) -> Vec<&'a SurfaceSample> {
    samples.iter().step_by(samples.len().div_ceil(Detail::MOST).max(1)).copied().collect()
}

/// Returns for each sample the squared difference between its `own` look and the most similar `other` look within `reach`.
fn unlike(
    samples: &[&SurfaceSample],
    reach: f32,
    (own, other): (impl Fn(&SurfaceSample) -> Vec3 + Sync, impl Fn(&SurfaceSample) -> Vec3 + Sync),
) -> Vec<f32> {
    parallel::collect(samples.len(), |i| {
        let (position, look) = (samples[i].position, own(samples[i]));
        let is_near = |near: &&&SurfaceSample| {
            let off = near.position - position;
            off.dot(off) <= reach * reach
        };
        let square = |near: &&SurfaceSample| {
            let off = other(near) - look;
            off.dot(off)
        };
        samples.iter().filter(is_near).map(square).fold(square(&samples[i]), f32::min)
    })
}

/// Returns the colours of an asset that differ from everything that the scan shows within `reach`: √(D / (D + m²)), where D is
/// their mean square difference from the most similar colour of the scan, of which the mean difference is left out, and m is
/// [`Detail::ADDED`]; and its standard error.
fn added(samples: &[&SurfaceSample], reach: f32) -> [f64; 2] {
    let some = some_of(samples);
    let offset = some.iter().fold(Vec3::default(), |sum, sample| sum + (sample.labs[1] - sample.labs[0]));
    let offset = offset * (1.0 / some.len().max(1) as f32);
    let squares = unlike(&some, reach, (|shown| shown.labs[1] - offset, |seen| seen.labs[0]));
    with_error(some.len(), |first, step| {
        let square = mean_square(&squares, first, step);
        (square / (square + Detail::ADDED * Detail::ADDED)).sqrt()
    })
}

/// Returns the mean of every `step`th square from `first` on, without the largest.
fn mean_square(squares: &[f32], first: usize, step: usize) -> f64 {
    /// The share of the samples, those with the largest differences, that are left out: edges that are moved by more.
    const OUTLIERS: f64 = 0.03;
    let mut off: Vec<f32> = squares.iter().skip(first).step_by(step).copied().collect();
    off.sort_unstable_by(f32::total_cmp);
    off.truncate((off.len() as f64 * (1.0 - OUTLIERS)).ceil() as usize);
    off.iter().map(|v| f64::from(*v)).sum::<f64>() / off.len().max(1) as f64
}

/// Returns the figure of all samples, given by the first and the step between them, and its standard error; 0 without any.
fn with_error(count: usize, figure: impl Fn(usize, usize) -> f64) -> [f64; 2] {
    /// Groups whose spread shows the error.
    const GROUPS: usize = 8;
    if count == 0 {
        return [0.0; 2];
    }
    let all = figure(0, 1);
    let off: f64 = (0..GROUPS).map(|group| figure(group, GROUPS) - all).map(|off| off * off).sum();
    [all, (off / (GROUPS * (GROUPS - 1)) as f64).sqrt()]
}

/// Returns the mean square that a linear fit over two coordinates leaves of vectors.
fn variation(points: &[([f64; 2], Vec3<f64>)]) -> f64 {
    let count = points.len() as f64;
    let mean = points.iter().fold(([0.0; 2], Vec3::splat(0.0)), |([x, y], sum), ([u, v], value)| {
        ([x + u / count, y + v / count], sum + *value / count)
    });
    let ([x, y], middle) = mean;
    let (mut gram, mut sides, mut all) = ([0.0; 3], [Vec3::splat(0.0); 2], 0.0);
    for ([u, v], value) in points {
        let (u, v, value) = (u - x, v - y, *value - middle);
        gram = [gram[0] + u * u, gram[1] + u * v, gram[2] + v * v];
        sides = [sides[0] + value * u, sides[1] + value * v];
        all += value.dot(value);
    }
    let [uu, uv, vv] = gram;
    let determinant = uu * vv - uv * uv;
    let explained = if determinant > 1e-12 * uu * vv {
        let [a, b] = [sides[0] * vv - sides[1] * uv, sides[1] * uu - sides[0] * uv];
        (a.dot(sides[0]) + b.dot(sides[1])) / determinant
    } else {
        0.0
    };
    ((all - explained) / count).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::integration::{hash, unit};

    #[test]
    fn intervals_hold_the_truth_as_often_as_they_claim() {
        // Uniform numbers: mean 0.5, p95 0.95.
        let (mut mean_misses, mut p95_misses, rounds) = (0, 0, 1000);
        for round in 0..rounds {
            let samples: Vec<f32> = (0..400).map(|i| unit(hash(hash(9, round), i))).collect();
            let estimate = Estimate::of(&samples).unwrap().unwrap();
            let holds = |[low, high]: [f64; 2], truth: f64| (low..=high).contains(&truth);
            mean_misses += usize::from(!holds(estimate.mean_interval, 0.5));
            p95_misses += usize::from(!holds(estimate.p95_interval, 0.95));
        }
        assert!((2..=20).contains(&mean_misses), "{mean_misses} of {rounds}");
        assert!((2..=24).contains(&p95_misses), "{p95_misses} of {rounds}");
    }

    #[test]
    fn nothing_has_no_estimate() {
        assert!(Estimate::of(&[f32::NAN]).unwrap().is_none());
        let one = Estimate::of(&[2.0, f32::NAN]).unwrap().unwrap();
        assert_eq!((one.summary.count, one.mean_interval), (1, [2.0, 2.0]));
    }

    #[test]
    fn an_interval_includes_its_share() {
        for count in 1..2000 {
            let [[least, some], [most, all]] = [0.0, 1.0].map(|share| share_interval(share, count));
            assert_eq!((least, all), (0.0, 1.0), "{count}");
            assert!(some > 0.0 && most < 1.0, "{count}");
            let one = 1.0 / count as f64;
            let [low, high] = share_interval(one, count);
            assert!((low..=high).contains(&one), "{count}");
        }
    }

    #[test]
    fn shares_are_exact_at_the_usual_limits_and_bracketed_between_them() {
        // 1,000 angles from 0.01° to 10°.
        let angles: Vec<f32> = (1..=1000).map(|i| i as f32 * 0.01).collect();
        let curve = Exceedance::of([&angles, &[]], &[]).unwrap();
        for (limit, share) in [(0.5, 0.5 / 10.0), (1.0, 0.1), (5.0, 0.5), (9.0, 0.9)] {
            let found = curve.beyond(limit);
            assert!((found.value - (1.0 - share)).abs() < 2e-3, "{limit}: {found:?}");
            assert_eq!(found.interval, share_interval(found.value, 1000), "{limit}");
        }
        let between = curve.beyond(6.5);
        assert!((between.value - 0.35).abs() < 1e-9, "{between:?}");
        assert_eq!(between.interval, [share_interval(0.3, 1000)[0], share_interval(0.4, 1000)[1]]);
        let asked = Exceedance::of([&angles, &[]], &[6.5]).unwrap();
        let exact = asked.beyond(6.5);
        assert!(
            (exact.value - 0.35).abs() < 1e-3 && exact.interval == share_interval(exact.value, 1000),
            "{exact:?}"
        );
        assert_eq!(curve.beyond(100.0).value, 0.0);
        assert!(curve.beyond(100.0).interval[1] < 0.01);
        assert_eq!(curve.beyond(1e-6).value, 1.0);
    }

    #[test]
    fn the_worse_surface_counts_and_only_limits_that_tell_something_are_kept() {
        let curve = Exceedance::of([&[1.0, 3.0], &[f32::NAN, 20.0, 0.001, 0.001, 0.001]], &[]).unwrap();
        assert_eq!([0.5, 2.5, 10.0].map(|limit| curve.beyond(limit).value), [1.0, 0.5, 0.25]);
        assert_eq!(curve.samples, 2);
        assert!(curve.limits.len() < 40 && curve.shares.last() == Some(&0.0), "{curve:?}");
        assert_eq!(Exceedance::of([&[f32::NAN], &[]], &[]), None);
        let infinite = Exceedance::of([&[f32::INFINITY], &[]], &[]).unwrap();
        assert_eq!(infinite.beyond(1e6).value, 1.0);
        let none = Exceedance::of([&[0.0], &[0.0]], &[]).unwrap();
        assert_eq!((none.beyond(1e-9).value, none.beyond(3.0).value), (0.0, 0.0));
    }
}
