//! The course of a search for the smallest file: which candidate is tried next, from what was learnt so far.

/// A mesh and a map that were tried for a wanted error.
///
/// ```
/// use taotie::asset::{Asset, Trial};
///
/// /// Returns the trial that came nearest to the scan.
/// fn nearest(asset: &Asset) -> Option<&Trial> {
///     asset.trials().iter().min_by(|a, b| a.mean_angle.total_cmp(&b.mean_angle))
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Trial {
    /// Triangles.
    pub triangles: usize,
    /// Texels along a side.
    pub size: u32,
    /// The mean angle between its normals and the scan's, degrees.
    pub mean_angle: f64,
    /// Its bytes as a GLB with PNG textures and one level of detail; `None` where it is not near enough.
    pub bytes: Option<u64>,
}

/// A mesh and a map that may be tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Candidate {
    pub triangles: u32,
    /// Texels along a side.
    pub size: u32,
}

/// The bytes of a candidate that was made.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weight {
    /// Of all of it.
    pub all: u64,
    /// Of its mesh alone.
    pub mesh: u64,
}

/// The trials so far, and what they teach about the bytes of others.
#[derive(Debug, Default)]
pub(super) struct Course {
    pub trials: Vec<Trial>,
    rates: Rates,
}

/// Bytes a triangle and a texel.
#[derive(Debug)]
struct Rates {
    triangle: f64,
    texel: f64,
}

impl Default for Rates {
    /// A triangle with half a vertex, and a texel of a PNG normal map, before any was measured.
    fn default() -> Self {
        Self { triangle: 36.0, texel: 2.0 }
    }
}

impl Candidate {
    fn texels(self) -> f64 {
        f64::from(self.size) * f64::from(self.size)
    }
}

impl Rates {
    fn of(candidate: Candidate, weight: Weight) -> Self {
        let maps = weight.all.saturating_sub(weight.mesh) as f64;
        Self {
            triangle: weight.mesh as f64 / f64::from(candidate.triangles),
            texel: maps / candidate.texels(),
        }
    }

    fn bytes(&self, candidate: Candidate) -> f64 {
        f64::from(candidate.triangles) * self.triangle + candidate.texels() * self.texel
    }
}

impl Course {
    /// Returns the candidate that is likely the smallest of those that were not tried; `None` where all of them are likely
    /// larger than one that is near enough.
    pub fn next(&self, candidates: &[Candidate]) -> Option<Candidate> {
        let open = candidates.iter().copied().filter(|candidate| self.is_open(*candidate));
        let smallest = open.min_by(|a, b| self.rates.bytes(*a).total_cmp(&self.rates.bytes(*b)))?;
        let may_win = self.least().is_none_or(|least| self.rates.bytes(smallest) < least as f64);
        may_win.then_some(smallest)
    }

    /// Adds a trial, with its weight where it is near enough; returns `true` where it is the smallest of these.
    pub fn add(&mut self, candidate: Candidate, mean_angle: f64, weight: Option<Weight>) -> bool {
        let is_least = weight.is_some_and(|weight| self.least().is_none_or(|least| weight.all < least));
        let Candidate { triangles, size } = candidate;
        let bytes = weight.map(|weight| weight.all);
        self.trials.push(Trial { triangles: triangles as usize, size, mean_angle, bytes });
        if let Some(weight) = weight {
            self.rates = Rates::of(candidate, weight);
        }
        is_least
    }

    fn is_open(&self, candidate: Candidate) -> bool {
        let Candidate { triangles, size } = candidate;
        self.trials.iter().all(|trial| (trial.triangles, trial.size) != (triangles as usize, size))
    }

    fn least(&self) -> Option<u64> {
        self.trials.iter().filter_map(|trial| trial.bytes).min()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A world in which a texel takes so many bytes, and errors fall with triangles and texels.
    fn course(texel: f64, is_near: fn(Candidate) -> bool) -> Course {
        let all = [1_000, 2_500, 5_000, 10_000, 20_000]
            .map(|triangles| [256, 512, 1024, 2048].map(|size| Candidate { triangles, size }));
        let mut course = Course::default();
        while let Some(candidate) = course.next(all.as_flattened()) {
            let mesh = u64::from(candidate.triangles) * 36;
            let weight = Weight { mesh, all: mesh + (candidate.texels() * texel) as u64 };
            course.add(candidate, 0.0, is_near(candidate).then_some(weight));
        }
        course
    }

    /// Where a mesh of ten times the triangles is as near as a map of four times the texels.
    fn either(Candidate { triangles, size }: Candidate) -> bool {
        triangles >= 10_000 || size >= 512
    }

    #[test]
    fn real_bytes_decide_and_not_the_first_that_is_near() {
        let course = course(1.2, either);
        let near: Vec<&Trial> = course.trials.iter().filter(|trial| trial.bytes.is_some()).collect();
        assert_eq!((near[0].triangles, near[0].size), (10_000, 256), "it was the first by estimate");
        let best = near.iter().min_by_key(|trial| trial.bytes).unwrap();
        assert_eq!((best.triangles, best.size), (1_000, 512));
        assert_eq!(course.least(), Some(36_000 + 314_572));
    }

    #[test]
    fn what_cannot_win_is_not_tried() {
        let course = course(2.0, either);
        let last = course.trials.last().unwrap();
        assert_eq!((last.triangles, last.size), (10_000, 256), "{:?}", course.trials);
        assert!(course.trials.iter().all(|trial| trial.size == 256));
    }

    #[test]
    fn where_none_is_near_all_are_tried_once() {
        let none = course(2.0, |_| false);
        let mut tried: Vec<_> = none.trials.iter().map(|trial| (trial.triangles, trial.size)).collect();
        tried.sort_unstable();
        tried.dedup();
        assert_eq!((tried.len(), none.trials.len(), none.least()), (20, 20, None));
    }
}
