//! The highlight of a region: roughness and F0 that all its pixels share.
//!
//! A few hundred pixels determine it, each with its own normal and base colour, which are eliminated from the normal
//! equations (Schur's complement). A region has a highlight only if it predicts lights that the fit has not seen:
//! half of the lights judge a fit to the others.

use crate::appearance::{Fitting, Sums, damped, moved};
use crate::program::{ALL, Finish, OWN, Surface};
use crate::symmetric::Sym3;
use taotie_engine::parallel;

/// Pixels that determine a highlight.
const PIXELS: usize = 400;
/// Lights from which highlights are fitted.
pub const FEWEST_LIGHTS: usize = 16;
/// Roughnesses to start from: highlights of one may not reach another's.
const STARTS: [f64; 4] = [0.2, 0.35, 0.5, 0.75];
/// F0 to start from: that of most dielectrics.
const START_F0: f64 = 0.04;
/// Rounds of Gauss-Newton.
const ROUNDS: usize = 20;
/// The range of roughness, and the most by which it changes in a round.
const ROUGHNESS: [f64; 3] = [0.05, 1.0, 0.1];
/// The largest F0.
const MOST_F0: f64 = 0.9;
/// The relative gain below which rounds end.
const ENOUGH: f64 = 1e-3;
/// Damping above which rounds end.
const MOST_DAMPING: f64 = 1e4;
/// The misfit of unseen lights with a highlight, relative to that without one, from which a region is matt.
const NO_BETTER: f64 = 0.85;

/// The surfaces of some pixels, and the sums at these.
struct Fitted {
    surfaces: Vec<Surface>,
    sums: Vec<Sums>,
}

/// Returns the highlight of some pixels, and the misfit of unseen lights; `None` if they are matt.
pub fn finish_of(fitting: &Fitting<'_>, pixels: &[usize]) -> (Option<Finish>, f64) {
    let step = pixels.len().div_ceil(PIXELS).max(1);
    let pixels: Vec<usize> = pixels.iter().step_by(step).copied().collect();
    let matt = judged(fitting, &pixels, None);
    if fitting.lights() < FEWEST_LIGHTS {
        return (None, matt);
    }
    let best = |lights: &(dyn Fn(usize) -> bool + Sync), starts: &[Finish]| {
        let found = starts.iter().map(|start| fitted(fitting, &pixels, *start, lights));
        found.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(finish, _)| finish)
    };
    let starts = STARTS.map(|roughness| Finish { roughness, f0: START_F0 });
    let all = best(&|_| true, &starts);
    let half = all.and_then(|all| best(&is_seen, &[all]));
    let shiny = judged(fitting, &pixels, half);
    if shiny < NO_BETTER * matt { (all, shiny) } else { (None, matt) }
}

/// Returns true for the half of the lights that a fit sees before the others judge it.
fn is_seen(light: usize) -> bool {
    light.is_multiple_of(2)
}

/// Returns the mean misfit under unseen lights of surfaces fitted to the others.
fn judged(fitting: &Fitting<'_>, pixels: &[usize], finish: Option<Finish>) -> f64 {
    let costs = parallel::tasks(pixels.len(), &|p| {
        let start = fitting.start(pixels[p], finish);
        let surface = fitting.surface(pixels[p], start, is_seen).unwrap_or(start);
        fitting.sums::<OWN>(pixels[p], &surface, |light| !is_seen(light)).cost
    });
    costs.iter().sum::<f64>() / costs.len().max(1) as f64
}

/// Fits roughness and F0 to some of the lights, and returns the misfit.
fn fitted(
    fitting: &Fitting<'_>,
    pixels: &[usize],
    start: Finish,
    lights: &(dyn Fn(usize) -> bool + Sync),
) -> (Finish, f64) {
    let surfaces: Vec<Surface> = pixels.iter().map(|pixel| fitting.start(*pixel, Some(start))).collect();
    let at = |surfaces: Vec<Surface>| {
        let sums = parallel::tasks(pixels.len(), &|p| fitting.sums::<ALL>(pixels[p], &surfaces[p], lights));
        Fitted { surfaces, sums }
    };
    let mut here = at(surfaces);
    let (mut finish, mut damping) = (start, 1e-2);
    for _ in 0..ROUNDS {
        let Some(next) = here.stepped(finish, damping) else { break };
        let moved = at(here.moved(finish, next, damping));
        let (before, after) = (here.cost(), moved.cost());
        if after > before {
            damping *= 10.0;
            if damping > MOST_DAMPING {
                break;
            }
            continue;
        }
        (here, finish) = (moved, next);
        damping *= 0.2;
        if before - after < ENOUGH * before {
            break;
        }
    }
    (finish, here.cost())
}

impl Fitted {
    fn cost(&self) -> f64 {
        self.sums.iter().map(|sums| sums.cost).sum()
    }

    fn inverse(sums: &Sums, damping: f64) -> Option<Sym3> {
        damped(&sums.own, damping).inverse()
    }

    /// Returns the finish after a step; `None` if the samples do not determine it.
    fn stepped(&self, finish: Finish, damping: f64) -> Option<Finish> {
        let (mut matrix, mut pull) = ([0.0; 3], [0.0; 2]);
        for sums in &self.sums {
            let Some(inverse) = Self::inverse(sums, damping) else { continue };
            let solved = sums.cross.map(|cross| inverse.times(cross));
            for c in 0..2 {
                matrix[c] += sums.shared[c] - sums.cross[c].dot(solved[c]);
                pull[c] += sums.shared_pull[c] - solved[c].dot(sums.pull);
            }
            matrix[2] += sums.shared[2] - sums.cross[0].dot(solved[1]);
        }
        let [a, d, b] = matrix;
        let [a, d] = [a, d].map(|v| v * (1.0 + damping));
        let determinant = a * d - b * b;
        let step = [pull[0] * d - pull[1] * b, pull[1] * a - pull[0] * b].map(|v| v / determinant);
        let [least, most, longest] = ROUGHNESS;
        // F0 may at most grow or shrink by half in a round.
        let reach = 0.5 * finish.f0 + 0.005;
        step.iter().all(|v| v.is_finite()).then(|| Finish {
            roughness: (finish.roughness + step[0].clamp(-longest, longest)).clamp(least, most),
            f0: (finish.f0 + step[1].clamp(-reach, reach)).clamp(0.0, MOST_F0),
        })
    }

    /// Returns the surfaces after the same step.
    fn moved(&self, from: Finish, to: Finish, damping: f64) -> Vec<Surface> {
        let [roughness, f0] = [to.roughness - from.roughness, to.f0 - from.f0];
        let step = |(surface, sums): (&Surface, &Sums)| {
            let pull = sums.pull - sums.cross[0] * roughness - sums.cross[1] * f0;
            let next = Self::inverse(sums, damping).map(|inverse| moved(surface, inverse.times(pull)));
            Surface { finish: Some(to), ..next.unwrap_or(*surface) }
        };
        self.surfaces.iter().zip(&self.sums).map(step).collect()
    }
}
