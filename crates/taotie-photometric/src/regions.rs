//! Regions of one material: pixels of similar albedo.
//!
//! Otsu's threshold on the logarithm of the albedo divides the object in two, and each part again. A division counts if
//! its two highlights predict unseen lights better than a common one.

use crate::appearance::Fitting;
use crate::finish::finish_of;
use crate::program::Finish;
use taotie_engine::math::scalar;

/// The most regions are 2 to this power.
const DIVISIONS: usize = 2;
/// Intervals of the histogram.
const INTERVALS: usize = 256;
/// The smallest fraction of the object that is a region.
const LEAST: f64 = 0.05;
/// The misfit of two regions relative to that of one, from which they are one.
const NO_BETTER: f64 = 0.9;

/// A region and its highlight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// Its pixels have less albedo than this, and at least that of the region before.
    pub below: f64,
    /// Its highlight; `None` if it is matt.
    pub finish: Option<Finish>,
    /// Misfit of unseen lights.
    misfit: f64,
}

/// A pixel and the logarithm of its albedo.
type Entry = (usize, f64);

/// Limits of the division of a region.
#[derive(Debug, Clone, Copy)]
struct Limits {
    /// Further divisions.
    divisions: usize,
    /// The fewest pixels of a part.
    least: f64,
}

/// Divides pixels into regions, the darkest first. Each pixel has its albedo, above 0.
pub fn regions(fitting: &Fitting<'_>, pixels: &[(usize, f64)]) -> Vec<Region> {
    let entries: Vec<Entry> = pixels.iter().map(|(i, albedo)| (*i, scalar::ln(*albedo))).collect();
    let whole = region(fitting, &entries, f64::INFINITY);
    divided(fitting, &entries, whole, Limits { divisions: DIVISIONS, least: LEAST * pixels.len() as f64 })
}

fn region(fitting: &Fitting<'_>, entries: &[Entry], below: f64) -> Region {
    let pixels: Vec<usize> = entries.iter().map(|(pixel, _)| *pixel).collect();
    let (finish, misfit) = finish_of(fitting, &pixels);
    Region { below, finish, misfit }
}

fn divided(fitting: &Fitting<'_>, entries: &[Entry], whole: Region, limits: Limits) -> Vec<Region> {
    let Limits { divisions, least } = limits;
    let Some(threshold) = threshold(entries).filter(|_| divisions > 0) else { return vec![whole] };
    let (dark, bright): (Vec<Entry>, Vec<Entry>) = entries.iter().partition(|(_, log)| *log < threshold);
    if (dark.len().min(bright.len()) as f64) < least {
        return vec![whole];
    }
    let below = region(fitting, &dark, scalar::exp(threshold));
    let above = region(fitting, &bright, whole.below);
    let apart = below.misfit * dark.len() as f64 + above.misfit * bright.len() as f64;
    if apart > NO_BETTER * whole.misfit * entries.len() as f64 {
        return vec![whole];
    }
    let rest = Limits { divisions: divisions - 1, least };
    let mut regions = divided(fitting, &dark, below, rest);
    regions.extend(divided(fitting, &bright, above, rest));
    regions
}

/// Returns the threshold that separates two groups of numbers best (Otsu 1979); `None` if all are alike.
fn threshold(values: &[Entry]) -> Option<f64> {
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (_, v)| (low.min(*v), high.max(*v)));
    let width = (high - low) / INTERVALS as f64;
    if !(width > 0.0 && width.is_finite()) {
        return None;
    }
    let mut counts = [0.0; INTERVALS];
    values.iter().for_each(|(_, v)| counts[(((v - low) / width) as usize).min(INTERVALS - 1)] += 1.0);
    let moment = |counts: &[f64]| counts.iter().enumerate().map(|(i, count)| i as f64 * count).sum::<f64>();
    let (all, total) = (values.len() as f64, moment(&counts));
    let between = |at: usize| {
        let below: f64 = counts[..at].iter().sum();
        let difference = moment(&counts[..at]) / below - (total - moment(&counts[..at])) / (all - below);
        if below > 0.0 && below < all { below * (all - below) * difference * difference } else { 0.0 }
    };
    let best = (1..INTERVALS).max_by(|a, b| between(*a).total_cmp(&between(*b)))?;
    Some(low + width * best as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_threshold_is_between_two_groups() {
        let values: Vec<(usize, f64)> =
            (0..300).map(|i| (i, if i % 3 == 0 { -2.0 } else { 0.5 } + 0.001 * i as f64)).collect();
        let threshold = threshold(&values).unwrap();
        assert!((-1.7..0.5).contains(&threshold), "{threshold}");
        assert_eq!(super::threshold(&[(0, 1.0), (1, 1.0)]), None);
        assert_eq!(super::threshold(&[]), None);
    }
}
