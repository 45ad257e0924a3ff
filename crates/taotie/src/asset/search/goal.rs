//! The goal that a candidate must reach.

use super::trial::Trial;
use crate::asset::figure::Figure;
use crate::asset::requirement::Requirement;
use crate::image::Encoding;
use crate::proof::PixelDifferences;

/// The ratio of a candidate's angles to their limits from which it is close enough to the goal from below.
const CLOSE: f64 = 0.97;
/// The worst fraction of the surface used in patch figures.
const PATCH: f64 = 0.01;
/// The approximate ratios of p95, and of the mean of the worst patch, to the mean angle.
const P95_OF_MEAN: f64 = 2.5;
const PATCH_OF_MEAN: f64 = 6.0;

/// The lower bound of limits, so that they can be divisors.
const LEAST: f64 = 1e-6;
/// The figures that limit angles, and those that limit colours.
const ANGLES: [Figure; 4] = [Figure::MeanAngle, Figure::P95Angle, Figure::PatchAngle, Figure::WithinAngle];
const COLORS: [Figure; 4] = [Figure::MeanColor, Figure::P95Color, Figure::PatchColor, Figure::WithinColor];
/// The maximum factors on the visually lossless limits of colours, and of other numbers, if none are requested.
const MOST_FACTORS: [f64; 2] = [2.0, 4.0];
/// Limits of roughness, metallic and the like, as fractions of the largest number.
const NUMBERS: [Limit; 2] = [
    Limit { statistic: Statistic::Mean, most: 0.02 },
    Limit { statistic: Statistic::Worst(PATCH), most: 0.12 },
];

/// The maximum differences of a candidate.
#[derive(Debug, Clone)]
pub(super) struct Goal {
    angles: Vec<Limit>,
    colors: Vec<Limit>,
    /// Of roughness, metallic and the like.
    numbers: Vec<Limit>,
}

/// A limit of a statistic of differences.
#[derive(Debug, Clone, Copy)]
struct Limit {
    statistic: Statistic,
    most: f64,
}

/// Returns limits multiplied by `factor`.
fn times(limits: &[Limit], factor: f64) -> Vec<Limit> {
    limits.iter().map(|limit| Limit { most: limit.most * factor, ..*limit }).collect()
}

/// Returns the largest ratio of differences, in ascending order, to their limits.
fn worst(limits: &[Limit], differences: &[f32]) -> f64 {
    limits.iter().map(|limit| limit.ratio(differences)).fold(0.0, f64::max)
}

/// Returns the approximate mean difference at which one of the limits is reached.
fn least_mean(limits: &[Limit]) -> f64 {
    limits.iter().map(Limit::mean).fold(f64::INFINITY, f64::min)
}

/// A statistic of differences.
#[derive(Debug, Clone, Copy)]
pub(super) enum Statistic {
    Mean,
    /// The difference that this fraction of the pixels stays within.
    Quantile(f64),
    /// The mean of the worst pixels, by this fraction. No patch of the same area has a larger mean.
    Worst(f64),
}

impl Goal {
    /// Creates the goal from the requirements that pixels decide. If there are none for angles, those of
    /// [`Requirement::visually_lossless`] apply. The same holds for colours, but if normals may be further off, so
    /// may colours: up to twice. Requirements for only the level with this number override those for all.
    pub fn of(requirements: &[Requirement], level: usize) -> Self {
        let lossless = Requirement::visually_lossless();
        let of = |from: &[Requirement], figures: &[Figure]| -> Vec<Limit> {
            let those = from.iter().filter(|required| figures.contains(&required.figure));
            let limits = |level: Option<usize>| -> Vec<Limit> {
                those.clone().filter(|required| required.level == level).filter_map(Limit::of).collect()
            };
            match (limits(Some(level)), limits(None)) {
                (own, of_all) if own.is_empty() => of_all,
                // The finest must meet both.
                (own, of_all) if level == 0 => [own, of_all].concat(),
                (own, _) => own,
            }
        };
        let required = |figures: &[Figure], factor: f64| {
            let required = of(requirements, figures);
            if required.is_empty() { times(&of(&lossless, figures), factor) } else { required }
        };
        let angles = required(&ANGLES, 1.0);
        let factor = (least_mean(&angles) / least_mean(&of(&lossless, &ANGLES))).max(1.0);
        let [colors, numbers] = MOST_FACTORS.map(|most| factor.min(most));
        Self { angles, colors: required(&COLORS, colors), numbers: times(&NUMBERS, numbers) }
    }

    /// Returns the requirements that pixels decide; those of [`Requirement::visually_lossless`] if there are none.
    pub fn decided(requirements: &[Requirement]) -> Vec<Requirement> {
        let decided = requirements.iter().filter(|required| Limit::of(required).is_some());
        let decided: Vec<Requirement> = decided.copied().collect();
        if decided.is_empty() { Requirement::visually_lossless() } else { decided }
    }

    /// Returns the goal with all limits multiplied by `factor`.
    pub fn times(&self, factor: f64) -> Self {
        let Self { angles, colors, numbers } = self;
        Self { angles: times(angles, factor), colors: times(colors, factor), numbers: times(numbers, factor) }
    }

    /// Returns the largest ratios of differences, in ascending order, to the limits of angles and of colours; `None`
    /// for colours that are not compared. Without angles to compare, the first is infinite.
    pub fn ratios(&self, seen: &PixelDifferences) -> (f64, Option<f64>) {
        let color = (!seen.colors.is_empty()).then(|| worst(&self.colors, &seen.colors));
        (worst(&self.angles, &seen.angles), color)
    }

    /// Returns the largest ratio of an image's visible differences, in ascending order, to their limit; infinite if
    /// no pixel shows it. Numbers that are neither colours nor normals have separate limits.
    pub fn image_ratio(&self, encoding: Encoding, differences: &[f32]) -> f64 {
        let limits: &[Limit] = match encoding {
            Encoding::Normal => &self.angles,
            Encoding::Srgb => &self.colors,
            Encoding::Linear => &self.numbers,
        };
        worst(limits, differences)
    }

    /// Returns the approximate ratio of a mean angle, degrees.
    pub fn ratio_of_mean(&self, mean: f64) -> f64 {
        mean / least_mean(&self.angles)
    }
}

/// Returns `true` if a trial reaches the goal and another one would hardly be smaller.
pub(super) fn is_hit(trial: &Trial) -> bool {
    trial.is_near && trial.angle_ratio >= CLOSE
}

/// The target ratio of angles, in the middle of those that hit the goal.
pub(super) const AIM: f64 = 0.5 * (1.0 + CLOSE);

/// Returns an error without one of its sources; they add up in squares.
pub(super) fn remaining(error: f64, source: f64) -> f64 {
    (error * error - source * source).max(0.0).sqrt()
}

impl Limit {
    /// Returns the limit that a requirement sets; `None` if pixels do not decide it.
    fn of(required: &Requirement) -> Option<Self> {
        let most = required.most;
        let (statistic, most) = match required.figure {
            Figure::MeanAngle | Figure::MeanColor => (Statistic::Mean, most),
            Figure::P95Angle | Figure::P95Color => (Statistic::Quantile(0.95), most),
            Figure::PatchAngle | Figure::PatchColor => (Statistic::Worst(PATCH), most),
            Figure::WithinAngle | Figure::WithinColor => (Statistic::Quantile(most), required.within?),
            _ => return None,
        };
        Some(Self { statistic, most: most.max(LEAST) })
    }

    /// Returns the ratio of the statistic of some differences, in ascending order, to the limit.
    fn ratio(&self, differences: &[f32]) -> f64 {
        match self.statistic.of(differences) {
            Some(value) if value.is_finite() => value / self.most,
            _ => f64::INFINITY,
        }
    }

    /// Returns the approximate mean difference at which it is reached.
    fn mean(&self) -> f64 {
        match self.statistic {
            Statistic::Mean => self.most,
            Statistic::Quantile(_) => self.most / P95_OF_MEAN,
            Statistic::Worst(_) => self.most / PATCH_OF_MEAN,
        }
    }
}

impl Statistic {
    /// Returns the statistic of differences in ascending order; `None` if there are none.
    pub fn of(self, differences: &[f32]) -> Option<f64> {
        let count = differences.len();
        let at = |part: f64| ((count as f64 * part) as usize).min(count.saturating_sub(1));
        let mean = |of: &[f32]| of.iter().map(|v| f64::from(*v)).sum::<f64>() / of.len() as f64;
        (count > 0).then(|| match self {
            Self::Mean => mean(differences),
            Self::Quantile(part) => f64::from(differences[at(part)]),
            Self::Worst(part) => mean(&differences[at(1.0 - part)..]),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn goal(texts: &[&str]) -> Goal {
        Goal::of(&texts.iter().map(|text| text.parse().unwrap()).collect::<Vec<_>>(), 0)
    }

    /// A hundred pixels, the last of which is far off.
    fn seen() -> PixelDifferences {
        let mut angles: Vec<f32> = (1..100).map(|i| i as f32 * 0.01).collect();
        angles.push(20.0);
        PixelDifferences { colors: angles.iter().map(|v| v * 2.0).collect(), angles }
    }

    #[test]
    fn the_worst_limit_decides() {
        let (angle, color) = goal(&["mean-angle=1", "mean-color=2"]).ratios(&seen());
        assert!((angle - 0.695).abs() < 1e-6 && (color.unwrap() - 0.695).abs() < 1e-6, "{angle} {color:?}");
        assert!((goal(&["mean-angle=1", "p95-angle=0.48"]).ratios(&seen()).0 - 2.0).abs() < 1e-6);
        assert!((goal(&["patch-angle=5"]).ratios(&seen()).0 - 4.0).abs() < 1e-6);
        let (_, color) = goal(&["within-1dE=50%"]).ratios(&seen());
        assert!((color.unwrap() - 1.02).abs() < 1e-6, "{color:?}");
    }

    #[test]
    fn what_is_not_required_stays_visually_lossless() {
        let (lossless, wanted) =
            (Goal::of(&[], 0), goal(&["mean-angle@0=4", "flip=0.1", "mean-angle@1=0.1"]));
        assert_eq!(wanted.ratios(&seen()).1.map(|ratio| ratio * 2.0), lossless.ratios(&seen()).1);
        assert_eq!(goal(&["mean-angle=0.1"]).ratios(&seen()).1, lossless.ratios(&seen()).1);
        assert!((wanted.ratio_of_mean(1.0) - 0.25).abs() < 1e-9, "only of level 0");
    }

    #[test]
    fn nothing_to_compare_is_not_near() {
        assert_eq!(Goal::of(&[], 0).ratios(&PixelDifferences::default()), (f64::INFINITY, None));
    }
}
