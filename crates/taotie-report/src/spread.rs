//! Mean, quantiles and maximum of many numbers, for people and for machines.

use serde::Serialize;
use taotie::compare::Summary;

/// Mean, quantiles and maximum of a field, in its unit.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Spread {
    /// The number of pixels that have a number.
    pub count: usize,
    /// The arithmetic mean.
    pub mean: f64,
    /// The quantile 0.5.
    pub median: f64,
    /// The quantiles 0.25 and 0.75.
    pub quartiles: [f64; 2],
    /// The quantile 0.95.
    pub p95: f64,
    /// The largest.
    pub max: f64,
}

impl From<Summary> for Spread {
    fn from(s: Summary) -> Self {
        Self {
            count: s.count,
            mean: s.mean,
            median: s.median,
            quartiles: s.quartiles,
            p95: s.p95,
            max: s.max,
        }
    }
}

impl Spread {
    /// Returns all numbers with so many digits behind the point.
    pub fn text(&self, digits: usize, unit: &str) -> String {
        let number = |value: f64| format!("{value:.digits$}{unit}");
        let Self { mean, median, quartiles: [first, third], p95, max, .. } = *self;
        let [mean, median, first, third, p95, max] = [mean, median, first, third, p95, max].map(number);
        format!("mean {mean}, median {median}, quartiles {first} and {third}, p95 {p95}, max {max}")
    }
}
