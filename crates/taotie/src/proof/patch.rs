//! The worst window that covers one per cent of a surface.

use super::close_up::{CloseUp, SurfaceSample, Viewer};
use super::estimate::Estimate;
use super::pair::Pair;
use super::window::Window;
use crate::bake::{Triangles, sample_triangles};
use crate::error::Result;
use crate::math::Vec3;
use crate::mesh::{Mesh, Point};
use crate::parallel;

/// The share of a surface's samples that a window contains.
pub(super) const SHARE: f64 = 0.01;
/// Number of windows to try, their centres spread over the surface.
const WINDOWS: usize = 512;
/// Maximum number of samples among which a window is searched.
const MOST_SAMPLES: usize = 20_000;
/// Minimum number of new points at which the worst window is measured, and as a fraction of those of the whole
/// surface.
const POINTS: usize = 2_048;
const PART: usize = 8;

/// Maximum number of points spread over the surrounding triangles for each of these.
const MOST_TRIED: usize = 128;

/// The window of one per cent of the visible surface in which an asset differs most from its scan.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Patch {
    /// The mean difference within it, in degrees or CIEDE2000.
    pub mean: f64,
    /// Its 99 % interval.
    pub interval: [f64; 2],
    /// Its centre, in model units.
    pub center: [f64; 3],
    /// Its radius, in model units.
    pub radius: f64,
    /// The direction from which it is seen, unit.
    pub toward: [f64; 3],
    /// `true` if its points are those of the scan, `false` if they are the asset's.
    pub is_of_scan: bool,
}

/// Finds the window of one per cent of the samples with the largest mean of `difference`, and measures it at new
/// points, so that it is not the worst by chance: the more `points` the whole surface has, the more are used. `None`
/// if there is nothing to compare.
///
/// # Errors
/// As [`Estimate::of`].
pub fn worst_patch(
    pair: &Pair<'_>,
    (close_up, points): (&CloseUp, usize),
    difference: fn(&SurfaceSample) -> f32,
) -> Result<Option<Patch>> {
    let viewer = if close_up.is_of_scan { Viewer::of_scan(pair) } else { Viewer::of_asset(pair) };
    let Some(window) = worst_window(&close_up.samples, SHARE, difference) else { return Ok(None) };
    let samples = fresh_samples(viewer, &window, (points / PART).max(POINTS))?;
    let values: Vec<f32> = samples.iter().map(difference).collect();
    let Some(estimate) = Estimate::of(&values)? else { return Ok(None) };
    let Window { center, radius, toward } = window.shown();
    Ok(Some(Patch {
        mean: estimate.summary.mean,
        interval: estimate.mean_interval,
        center,
        radius,
        toward,
        is_of_scan: close_up.is_of_scan,
    }))
}

/// Returns the centre of the window of one per cent of the samples in which most of them are missing, in model units;
/// `None` if none is.
pub fn most_missing(close_up: &CloseUp) -> Option<[f64; 3]> {
    let window = worst_window(&close_up.samples, SHARE, |sample| f32::from(u8::from(sample.is_missing)))?;
    (window.mean > 0.0).then(|| window.center.to_f64().to_array())
}

/// A ball that contains a share of the samples.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Ball {
    center: Vec3,
    radius: f32,
    toward: Vec3,
    mean: f64,
}

impl Patch {
    /// Returns the window without its measurements.
    pub fn window(&self) -> Window {
        let Self { center, radius, toward, .. } = *self;
        Window { center, radius, toward }
    }
}

impl Ball {
    /// Returns it with values of the types used in figures.
    pub fn shown(&self) -> Window {
        Window {
            center: self.center.to_f64().to_array(),
            radius: f64::from(self.radius),
            toward: self.toward.to_f64().to_array(),
        }
    }
}

/// Finds the ball around a sample that contains a `share` of them and has the largest mean of `difference`; `None` if
/// there is nothing to compare.
pub(super) fn worst_window(
    samples: &[SurfaceSample],
    share: f64,
    difference: fn(&SurfaceSample) -> f32,
) -> Option<Ball> {
    let known: Vec<(Vec3, Vec3, f32)> = samples
        .iter()
        .step_by(samples.len().div_ceil(MOST_SAMPLES).max(1))
        .map(|sample| (sample.position, sample.toward, difference(sample)))
        .filter(|(.., value)| !value.is_nan())
        .collect();
    if known.is_empty() {
        return None;
    }
    let (windows, held) = (WINDOWS.min(known.len()), ((known.len() as f64 * share) as usize).max(1));
    let window = |i: usize| {
        // Half of the windows are around the worst samples of as many equal parts, half around their first.
        let part = i / 2 * known.len() / windows.div_ceil(2);
        let end = ((i / 2 + 1) * known.len() / windows.div_ceil(2)).max(part + 1).min(known.len());
        let worst = (part..end).fold(part, |best, k| if known[k].2 > known[best].2 { k } else { best });
        let (center, toward, _) = known[if i.is_multiple_of(2) { worst } else { part }];
        let mut squared: Vec<(f32, f32)> = known
            .iter()
            .map(|(position, _, value)| {
                let away = *position - center;
                (away.dot(away), *value)
            })
            .collect();
        squared.select_nth_unstable_by(held - 1, |a, b| a.0.total_cmp(&b.0));
        let radius = squared[held - 1].0.sqrt();
        let mean = squared[..held].iter().map(|(_, value)| f64::from(*value)).sum::<f64>() / held as f64;
        Ball { center, radius, toward, mean }
    };
    let all = parallel::tasks(windows, &window);
    all.into_iter().reduce(|worst, next| if next.mean > worst.mean { next } else { worst })
}

/// Returns the samples at points spread evenly over the part of a surface inside a window.
fn fresh_samples(viewer: Viewer<'_>, window: &Ball, points: usize) -> Result<Vec<SurfaceSample>> {
    let mesh = viewer.own().surface.mesh();
    let near: Vec<u32> = parallel::filter(mesh.triangles().len(), |t| touches(mesh, t, window))
        .into_iter()
        .map(|t| t as u32)
        .collect();
    if near.is_empty() {
        return Ok(Vec::new());
    }
    let is_inside =
        |position: Vec3| (position - window.center).length() <= window.radius.max(f32::MIN_POSITIVE);
    // Large triangles reach far beyond the window: add points until enough of them are inside.
    let mut count = points * 2;
    let inside = loop {
        let point = sample_triangles(mesh, Triangles::These(&near), count)?;
        let inside = parallel::filter(count, |i| is_inside(point(i).position(mesh)));
        if inside.len() >= points || count >= points * MOST_TRIED {
            break inside.into_iter().map(point).collect::<Vec<Point>>();
        }
        count *= 4;
    };
    let found: Vec<Option<SurfaceSample>> = parallel::collect(inside.len(), |i| viewer.sample(inside[i]));
    Ok(found.into_iter().flatten().collect())
}

/// Returns `true` if the ball around a triangle intersects a window.
fn touches(mesh: &Mesh, triangle: usize, window: &Ball) -> bool {
    let [a, b, c] = mesh.corners(triangle);
    let middle = (a + b + c) * (1.0 / 3.0);
    let radius = [a, b, c].into_iter().map(|corner| (corner - middle).length()).fold(0.0, f32::max);
    (middle - window.center).length() <= window.radius + radius
}
