//! Finds the best asset within a number of bytes.

use super::goal::Goal;
use super::round::round;
use super::winner::Best;
use super::workshop::Workshop;
use crate::error::Result;
use crate::math::scalar::{exp, ln};
use crate::progress::Progress;

/// The maximum number of searches, each for a goal closer to the budget.
const ROUNDS: usize = 5;
/// The fraction of the budget that is sufficient.
const ENOUGH: f64 = 0.93;
/// The power of the saved bytes with which differences grow, until two rounds measure it, and its range.
const POWER: f64 = 0.8;
const LEAST_POWER: f64 = 0.2;
const MOST_POWER: f64 = 3.0;
/// The range of goals, as factors of the limits.
const RANGE: [f64; 2] = [0.05, 100.0];
/// The bytes of metadata in every asset.
const METADATA: f64 = 1_500.0;

/// Returns the candidate closest to the scan among those with at most `most` bytes. If a goal is requested, a smaller
/// one that meets it is sufficient. If all are larger, returns the smallest found.
pub(super) fn within(
    workshop: &mut Workshop<'_>,
    goal: &Goal,
    most: u64,
    progress: Progress<'_>,
) -> Result<Best> {
    let scan = workshop.scan();
    let xmp = scan.about.xmp.as_ref().map_or(0, |xmp| xmp.to_string().len());
    let most = (most as f64 - METADATA - xmp as f64).max(0.0);
    let aim = 0.5 * (1.0 + ENOUGH) * most.max(1.0);
    let is_goal_enough = workshop.has_goal();
    let (mut found, mut factor): (Option<Best>, f64) = (None, 1.0);
    // The largest factor with too many bytes, and the smallest within the budget.
    let [mut low, mut high] = [0.0, f64::INFINITY];
    let mut rounds = Vec::with_capacity(ROUNDS);
    for _ in 0..ROUNDS {
        workshop.goal = goal.times(factor);
        let before = workshop.trials.len();
        let mut best = round(workshop, progress)?;
        workshop.trials[before..].iter_mut().for_each(|trial| trial.scale(factor));
        best.scale(factor);
        let bytes = best.least_bytes();
        let is_within = bytes <= most;
        if is_within {
            high = factor
        } else {
            low = factor
        }
        if is_within || found.as_ref().is_none_or(|known| bytes < known.least_bytes()) {
            found = Some(best);
        }
        let is_done = is_within && (bytes >= ENOUGH * most || (is_goal_enough && factor == 1.0));
        if is_done || factor == RANGE[usize::from(!is_within)] {
            break;
        }
        let power = rounds.last().map_or(POWER, |[known, of_known]: &[f64; 2]| {
            (ln(factor / known) / ln(of_known / bytes)).clamp(LEAST_POWER, MOST_POWER)
        });
        rounds.push([factor, bytes]);
        let next = (factor * exp(ln(bytes / aim) * power)).clamp(RANGE[0], RANGE[1]);
        factor = match (low > 0.0, high.is_finite()) {
            (true, true) if next <= low || next >= high => (low * high).sqrt(),
            _ => next,
        };
    }
    workshop.goal = goal.clone();
    Ok(found.unwrap_or_default())
}
