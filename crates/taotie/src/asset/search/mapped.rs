//! Candidates with a normal map.

use super::forecast::Forecast;
use super::goal::{AIM, is_hit};
use super::winner::{Best, Candidate};
use super::workshop::{Workshop, under_map};
use crate::error::Result;
use crate::progress::Progress;

/// The number of trials that close in on the goal.
const ROUNDS: usize = 5;
/// A candidate is made if its forecast is at most this fraction of the bytes of the smallest one so far.
const WORTH: f64 = 0.99;
/// If no candidate reaches the goal, the search targets those whose ratio is at most this factor above the smallest
/// one.
const NEARLY: f64 = 1.03;

/// Finds the smallest candidate with a normal map that reaches the goal, and replaces `best` if it is smaller. Its
/// maps have at least `least_size` texels along a side.
pub(super) fn smallest(
    workshop: &mut Workshop<'_>,
    least_size: u32,
    best: &mut Best,
    progress: Progress<'_>,
) -> Result<()> {
    let Some(mut forecast) = Forecast::measured(workshop, least_size, best.bytes(), progress)? else {
        return Ok(());
    };
    let is_out_of_reach = best.bytes().is_infinite() && forecast.smallest(AIM).is_none();
    let target = if is_out_of_reach { NEARLY * forecast.least_ratio() } else { AIM };
    let (mut aim, mut tried) = (target, Vec::new());
    for _ in 0..ROUNDS {
        let Some(choice) = forecast.smallest(aim) else { break };
        if choice.bytes > WORTH * best.bytes() || tried.contains(&(choice.shape, choice.normals)) {
            break;
        }
        tried.push((choice.shape, choice.normals));
        let Some(draft) = workshop.draft(choice.shape, progress)? else { break };
        let rounding = workshop.rounding(under_map(choice.shape.size), choice.normals);
        let trial = workshop.trial(&draft, rounding)?;
        best.offer(Candidate::made(draft, rounding), trial);
        if is_hit(&trial) {
            break;
        }
        forecast.correct(trial.bytes as f64 / choice.bytes);
        aim *= target / trial.ratio().max(f64::MIN_POSITIVE);
    }
    Ok(())
}
