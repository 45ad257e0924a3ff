//! Candidates with a normal map.

use super::forecast::Forecast;
use super::winner::Winner;
use super::workshop::{Workshop, under_map};
use crate::error::Result;
use crate::progress::Progress;

/// Trials that close in on the goal.
const ROUNDS: usize = 5;
/// A candidate is made if its forecast has at most this part of the bytes of the smallest one so far.
const WORTH: f64 = 0.99;

/// Puts the smallest candidate with a normal map that reaches the goal in the place of a larger one. Its maps have at least
/// `least_size` texels along a side.
pub(super) fn smallest(
    workshop: &mut Workshop<'_>,
    least_size: u32,
    best: &mut Option<Winner>,
    progress: Progress<'_>,
) -> Result<()> {
    let goal = workshop.goal;
    let most_bytes = best.as_ref().map_or(f64::INFINITY, |best| best.trial.bytes as f64);
    let Some(mut forecast) = Forecast::measured(workshop, least_size, most_bytes, progress)? else {
        return Ok(());
    };
    let (mut aim, mut tried) = (goal.aim(), Vec::new());
    for _ in 0..ROUNDS {
        let Some(choice) = forecast.smallest(aim) else { break };
        if best.as_ref().is_some_and(|best| choice.bytes > WORTH * best.trial.bytes as f64) {
            break;
        }
        if tried.contains(&(choice.shape, choice.quality)) {
            break;
        }
        tried.push((choice.shape, choice.quality));
        let Some(draft) = workshop.draft(choice.shape, progress)? else { break };
        let rounding = workshop.rounding(under_map(choice.shape.size), choice.quality);
        let trial = workshop.trial(&draft, rounding)?;
        if trial.is_near {
            Winner::replace(best, Winner::made(draft, rounding, trial));
        }
        if goal.is_hit(&trial) {
            break;
        }
        forecast.correct(trial.bytes as f64 / choice.bytes);
        aim *= goal.aim() / trial.mean_angle.max(f64::MIN_POSITIVE);
    }
    Ok(())
}
