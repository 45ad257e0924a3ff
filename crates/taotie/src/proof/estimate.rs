//! Means and quantiles of samples, with confidence intervals.

use crate::compare::{Field, Summary};
use crate::error::Result;

/// Standard deviations on either side of the mean that contain 99 % of a normal distribution.
const SIGMAS_99: f64 = 2.5758;

/// A summary of samples of a quantity and the 99 % intervals of its mean and its p95.
///
/// ```
/// use taotie::proof::Estimate;
///
/// /// Returns `true` if samples cannot decide if the mean is below `limit`.
/// fn is_undecided(estimate: &Estimate, limit: f64) -> bool {
///     let [low, high] = estimate.mean_interval;
///     (low..high).contains(&limit)
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

/// Returns the 99 % interval of a share measured with `count` samples, [0, 1].
///
/// Source: Wilson 1927, "Probable inference, the law of succession, and statistical inference".
pub fn share_interval(share: f64, count: usize) -> [f64; 2] {
    let (n, z) = (count.max(1) as f64, SIGMAS_99);
    let middle = share + z * z / (2.0 * n);
    let half = z * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
    [middle - half, middle + half].map(|bound| (bound / (1.0 + z * z / n)).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sequence::{hash, unit};

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
}
