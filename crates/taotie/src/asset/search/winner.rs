//! The smallest candidate that reaches the goal.

use super::trial::Trial;
use super::workshop::{Draft, Rounding};

/// A candidate that reaches the goal.
pub(super) struct Winner {
    pub draft: Draft,
    pub rounding: Rounding,
    pub trial: Trial,
}

impl Winner {
    /// Puts a candidate in the place of a larger one.
    pub fn replace(best: &mut Option<Self>, new: Self) {
        if best.as_ref().is_none_or(|best| new.trial.bytes < best.trial.bytes) {
            *best = Some(new);
        }
    }
}
