//! How far long work has come, and whether it is to go on.

use crate::error::{Error, Result};

/// A caller's function: takes the stage and the fraction of it that is done, in [0, 1], and returns whether to go on.
///
/// It is called from any thread, several at once.
pub type Listener<'a> = dyn Fn(&'static str, f64) -> bool + Sync + 'a;

/// A line to the caller of long work: it tells how far the work has come and carries the wish to stop back.
///
/// ```
/// use taotie::{Error, progress::Progress};
///
/// let listener = |stage: &'static str, done: f64| {
///     println!("{stage}: {:.0} %", done * 100.0);
///     done < 0.5
/// };
/// let progress = Progress::new(&listener).stage("simplify");
/// assert!(progress.at(0.25).is_ok());
/// assert!(matches!(progress.at(0.5), Err(Error::Cancelled)));
/// ```
#[derive(Clone, Copy)]
pub struct Progress<'a> {
    listener: Option<&'a Listener<'a>>,
    stage: &'static str,
    /// The fractions of the stage at which this work begins and ends.
    range: [f64; 2],
}

impl<'a> Progress<'a> {
    /// Tells nobody and never stops.
    pub const SILENT: Progress<'static> = Progress { listener: None, stage: "", range: [0.0, 1.0] };

    /// Tells `listener`.
    pub fn new(listener: &'a Listener<'a>) -> Self {
        Self { listener: Some(listener), ..Progress::SILENT }
    }

    /// Returns the same line for a stage of its own, from 0 to 1.
    pub fn stage(self, stage: &'static str) -> Self {
        Self { stage, range: [0.0, 1.0], ..self }
    }

    /// Returns the same line for work that takes this stage from the fraction `from` to the fraction `to`.
    pub fn part(self, from: f64, to: f64) -> Self {
        Self { range: [from, to].map(|fraction| self.overall(fraction)), ..self }
    }

    /// Tells that the fraction `done` of the work, in [0, 1], is behind.
    ///
    /// # Errors
    /// [`Error::Cancelled`] where the listener wants the work to stop.
    pub fn at(&self, done: f64) -> Result<()> {
        match self.listener {
            Some(listener) if !listener(self.stage, self.overall(done)) => Err(Error::Cancelled),
            _ => Ok(()),
        }
    }

    fn overall(&self, done: f64) -> f64 {
        let [from, to] = self.range;
        from + done.clamp(0.0, 1.0) * (to - from)
    }
}

impl std::fmt::Debug for Progress<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Progress").field("stage", &self.stage).field("range", &self.range).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn parts_of_parts_lie_within_their_stage() {
        let told = Mutex::new(Vec::new());
        let listener = |stage: &'static str, done: f64| {
            told.lock().unwrap().push((stage, done));
            true
        };
        let second_half = Progress::new(&listener).stage("bake").part(0.5, 1.0);
        second_half.at(0.5).unwrap();
        second_half.part(0.0, 0.5).at(1.0).unwrap();
        second_half.at(7.0).unwrap();
        second_half.stage("store").at(0.25).unwrap();
        assert_eq!(*told.lock().unwrap(), [("bake", 0.75), ("bake", 0.75), ("bake", 1.0), ("store", 0.25)]);
    }

    #[test]
    fn who_is_told_nothing_never_stops_the_work() {
        assert!(Progress::SILENT.part(0.2, 0.3).stage("any").at(0.5).is_ok());
    }
}
