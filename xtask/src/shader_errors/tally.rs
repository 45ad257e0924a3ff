//! Statistics of relative differences in radiance.

use std::fmt;

/// The minimum radiance for which differences count.
const LEAST: f64 = 1e-3;

/// The relative differences of radiances above 1e-3, by channel.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    /// The number of channels that count.
    pub count: usize,
    pub largest: f64,
    sum: f64,
    /// The index of the point with the largest difference.
    pub worst: usize,
    /// The number of channels that differ by more than 1e-3.
    pub beyond: usize,
}

impl Tally {
    /// Collects the differences between `found` and `truth`.
    pub fn new(truth: &[[f64; 3]], found: impl Iterator<Item = [f64; 3]>) -> Self {
        let mut tally = Self::default();
        let mut points = 0;
        for (at, (truth, found)) in truth.iter().zip(found).enumerate() {
            (0..3).for_each(|channel| tally.add(at, truth[channel], found[channel]));
            points += 1;
        }
        // Missing points count as infinitely wrong.
        if points < truth.len() {
            tally.largest = f64::INFINITY;
        }
        tally
    }

    fn add(&mut self, at: usize, truth: f64, found: f64) {
        if truth <= LEAST {
            return;
        }
        let difference = (found - truth).abs() / truth;
        let difference = if difference.is_nan() { f64::INFINITY } else { difference };
        self.count += 1;
        self.sum += difference;
        self.beyond += usize::from(difference > 1e-3);
        if difference > self.largest {
            (self.largest, self.worst) = (difference, at);
        }
    }

    /// Returns the mean difference.
    pub fn mean(&self) -> f64 {
        self.sum / self.count.max(1) as f64
    }
}

/// Writes two cells of the table.
impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1e} | {:.1e}", self.largest, self.mean())
    }
}
