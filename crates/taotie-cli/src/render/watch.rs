//! The time of each stage.

use std::time::Instant;

/// Accumulates the time of each stage.
pub struct Watch {
    last: Instant,
    /// Stage and seconds.
    pub laps: Vec<(&'static str, f64)>,
}

impl Watch {
    /// Starts measuring.
    pub fn new() -> Self {
        Self { last: Instant::now(), laps: Vec::new() }
    }

    /// Adds the time since the last lap to a stage.
    pub fn lap(&mut self, stage: &'static str) {
        let now = Instant::now();
        let seconds = now.duration_since(self.last).as_secs_f64();
        self.last = now;
        match self.laps.iter_mut().find(|(known, _)| *known == stage) {
            Some((_, total)) => *total += seconds,
            None => self.laps.push((stage, seconds)),
        }
    }
}
