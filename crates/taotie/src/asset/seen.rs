//! A level of detail as a viewer sees it, sampled at the requested number of points.

use super::figure::Sampling;
use super::met::RequirementOutcome;
use crate::error::Result;
use crate::proof::{
    CloseUp, DistanceBounds, Overview, Pair, Patch, Picture, SilhouetteFigures, SurfaceSample, hausdorff,
    overview, silhouettes, worst_patch,
};

/// The maximum number of points when samples are added to decide a requirement.
const MOST_POINTS: usize = 4_000_000;
/// The number of points of each surface from which the worst patch is selected. It does not grow with the others, so
/// that more points measure the same patch.
const SOUGHT: usize = 20_000;
/// The safety factor on the points expected to decide a requirement, since estimates of intervals vary.
const MARGIN: f64 = 1.5;

/// A level of detail as a viewer sees it.
pub(super) struct Seen {
    counts: Counts,
    pub overview: Overview,
    pub silhouette: SilhouetteFigures,
    /// Of the scan and the asset.
    pub close_ups: [CloseUp; 2],
    /// The same at the points from which the worst patches are selected; `None` if they are those of `close_ups`.
    sought: Option<[CloseUp; 2]>,
    pub hausdorff: DistanceBounds,
}

/// The numbers of points at which the figures of a level are sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Counts {
    /// On the surface.
    pub surface: usize,
    /// Pixels of the overview.
    overview: usize,
    /// Of each surface, from which the worst patch is selected.
    sought: usize,
    /// Of each surface, seen close up.
    close_up: usize,
    /// Controls the bounds of distances, which tighten in proportion.
    distance: usize,
}

impl Seen {
    /// Samples a level whose overview has `across` pixels across.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if a surface has no area.
    pub fn of(pair: &Pair<'_>, (across, counts): (f32, Counts)) -> Result<Self> {
        let close_ups = close_ups(pair, counts.close_up)?;
        Ok(Self {
            counts,
            sought: sought(pair, counts)?,
            overview: overview(pair, Picture::of(across, counts.overview))?,
            silhouette: silhouettes(pair),
            hausdorff: hausdorff(pair, [&close_ups[0], &close_ups[1]], counts.distance),
            close_ups,
        })
    }

    /// Returns the worse of the worst windows of scan and asset.
    ///
    /// # Errors
    /// Those of [`worst_patch`].
    pub fn worse_patch(
        &self,
        pair: &Pair<'_>,
        difference: fn(&SurfaceSample) -> f32,
    ) -> Result<Option<Patch>> {
        let worst = |close_up| worst_patch(pair, (close_up, self.counts.close_up), difference);
        let [of_scan, of_asset] = self.sought.as_ref().unwrap_or(&self.close_ups);
        Ok(match (worst(of_scan)?, worst(of_asset)?) {
            (Some(a), Some(b)) if b.mean > a.mean => Some(b),
            (None, b) => b,
            (a, _) => a,
        })
    }

    /// Returns the numbers of sampled points.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Measures the figures whose number of points has changed again.
    ///
    /// # Errors
    /// Those of [`Seen::of`].
    pub fn refine(&mut self, pair: &Pair<'_>, counts: Counts) -> Result<()> {
        let before = std::mem::replace(&mut self.counts, counts);
        if counts.overview != before.overview {
            self.overview = overview(pair, Picture::of(self.overview.across, counts.overview))?;
        }
        if counts.close_up != before.close_up {
            let few = std::mem::replace(&mut self.close_ups, close_ups(pair, counts.close_up)?);
            self.sought.get_or_insert(few);
        }
        if counts.distance != before.distance {
            let [of_scan, of_asset] = &self.close_ups;
            self.hausdorff = hausdorff(pair, [of_scan, of_asset], counts.distance);
        }
        Ok(())
    }
}

fn close_ups(pair: &Pair<'_>, points: usize) -> Result<[CloseUp; 2]> {
    Ok([CloseUp::of_scan(pair, points)?, CloseUp::of_asset(pair, points)?])
}

fn sought(pair: &Pair<'_>, counts: Counts) -> Result<Option<[CloseUp; 2]>> {
    (counts.sought != counts.close_up).then(|| close_ups(pair, counts.sought)).transpose()
}

impl Counts {
    /// The same number for all figures of the finest level; a quarter for a coarser one.
    pub fn of(points: usize, is_finest: bool) -> Self {
        let part = |points: usize| if is_finest { points } else { (points / 4).max(10) };
        let all = part(points);
        Self { surface: all, overview: all, sought: part(SOUGHT), close_up: all, distance: all }
    }

    /// Returns the numbers that are likely to decide the undecided requirements.
    pub fn to_decide<'m>(self, met: impl Iterator<Item = &'m RequirementOutcome>) -> Self {
        let mut next = self;
        for met in met {
            let times = met.samples_to_decide();
            let (now, next) = match met.figure.sampling() {
                Some(Sampling::Overview) => (self.overview, &mut next.overview),
                Some(Sampling::CloseUp) => (self.close_up, &mut next.close_up),
                Some(Sampling::Distance) => (self.distance, &mut next.distance),
                None => continue,
            };
            *next = (*next).max(enough(now, times));
        }
        next
    }
}

/// Returns enough points to decide a requirement that needs `times` as many; the same number if even the maximum
/// would not decide it.
fn enough(points: usize, times: f64) -> usize {
    let (now, most) = (points as f64, MOST_POINTS as f64);
    if times <= 1.0 || now >= most || now * times > most * 4.0 {
        return points;
    }
    (now * times * MARGIN).min(most) as usize
}
