//! What a candidate has to reach.

use super::trial::Trial;

/// A candidate is near enough to the goal from below if it has at least this part of its angle.
const CLOSE: f64 = 0.97;

/// The largest differences that a candidate may have.
#[derive(Debug, Clone, Copy)]
pub(super) struct Goal {
    /// The mean angle as seen, degrees.
    pub angle: f64,
    /// The mean difference of colours as seen, CIEDE2000.
    pub color: f64,
}

impl Goal {
    /// Returns `true` if a trial is near enough to the scan.
    pub fn is_met(self, trial: &Trial) -> bool {
        trial.mean_angle <= self.angle && trial.mean_color.is_none_or(|color| color <= self.color)
    }

    /// Returns `true` if a trial reaches the goal and another one would hardly be smaller.
    pub fn is_hit(self, trial: &Trial) -> bool {
        self.is_met(trial) && trial.mean_angle >= CLOSE * self.angle
    }

    /// Returns the angle to aim at, in the middle of those that hit the goal.
    pub fn aim(self) -> f64 {
        self.angle * 0.5 * (1.0 + CLOSE)
    }
}

/// Returns what is left of an error without one of its sources; they add up in squares.
pub(super) fn remaining(error: f64, source: f64) -> f64 {
    (error * error - source * source).max(0.0).sqrt()
}
