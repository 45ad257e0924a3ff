//! The regions of an asset, such as UV islands or materials, that differ most from its scan.

use super::Pair;
use super::close_up::{CloseUp, SurfaceSample, Viewer};
use super::patch::{SHARE, Window, worst_window};
use super::statistics::Estimate;
use crate::error::Result;
use crate::math::Vec3;
use crate::mesh::{Triangles, sample_triangles};
use crate::parallel;
use std::collections::BTreeMap;

/// Minimum number of samples for a region's mean to be compared with others.
const LEAST_SAMPLES: usize = 16;
/// Number of new points at which the worst region is measured.
const POINTS: usize = 2_048;

/// A region of an asset, and its difference from the scan.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Region {
    /// The index of the region, in the order of their first triangles.
    pub number: usize,
    /// The mean difference in it, in degrees or CIEDE2000.
    pub mean: f64,
    /// Its 99 % interval.
    pub interval: [f64; 2],
    /// Its share of the asset's visible area, [0, 1].
    pub share: f64,
    /// A point in its middle, in model units.
    pub center: [f64; 3],
    /// Where it differs most: one per cent of the visible surface, or all of the region if that is less.
    #[serde(default)]
    pub worst: Window,
}

/// The worst of the regions that an asset is divided into, seen in close-up.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct WorstRegions {
    /// The number of regions.
    pub count: usize,
    /// The number of regions with too few samples to compare.
    pub skipped: usize,
    /// The region with the largest mean angle between normals, in degrees.
    pub angle: Option<Region>,
    /// The region with the largest mean difference of base colours, CIEDE2000; `None` if colours are not compared.
    pub color: Option<Region>,
}

impl WorstRegions {
    /// Finds the worst regions of an asset whose triangles have these `labels`, one label per region. The worst ones
    /// are then measured at new points, so that none is the worst by chance.
    ///
    /// # Errors
    /// As [`Estimate::of`].
    pub fn of(pair: &Pair<'_>, of_asset: &CloseUp, labels: &[u32]) -> Result<Self> {
        let regions = Regions::of(of_asset, labels);
        let [angle, color]: [fn(&SurfaceSample) -> f32; 2] =
            [|sample| sample.angle_deg, |sample| sample.color];
        let measured = |difference| {
            regions.worst(difference).map(|label| regions.measured(pair, label, difference)).transpose()
        };
        let large = regions.samples.values().filter(|samples| samples.len() >= LEAST_SAMPLES).count();
        Ok(Self {
            count: regions.numbers.len(),
            skipped: regions.numbers.len() - large,
            angle: measured(angle)?.flatten(),
            color: measured(color)?.flatten(),
        })
    }
}

/// The samples of each region.
struct Regions<'a> {
    labels: &'a [u32],
    all: usize,
    /// The index of each label, in the order of first triangles.
    numbers: BTreeMap<u32, usize>,
    samples: BTreeMap<u32, Vec<&'a SurfaceSample>>,
}

impl<'a> Regions<'a> {
    fn of(close_up: &'a CloseUp, labels: &'a [u32]) -> Self {
        let mut numbers = BTreeMap::new();
        for label in labels {
            let next = numbers.len();
            numbers.entry(*label).or_insert(next);
        }
        let mut samples: BTreeMap<u32, Vec<&SurfaceSample>> = BTreeMap::new();
        for sample in &close_up.samples {
            samples.entry(labels[sample.triangle as usize]).or_default().push(sample);
        }
        Self { labels, all: close_up.samples.len(), numbers, samples }
    }

    /// Returns the label of the region with the largest mean; `None` if none has enough samples.
    fn worst(&self, difference: fn(&SurfaceSample) -> f32) -> Option<u32> {
        let mean = |samples: &[&SurfaceSample]| {
            let values: Vec<f32> = samples.iter().map(|s| difference(s)).filter(|v| !v.is_nan()).collect();
            let sum: f64 = values.iter().map(|v| f64::from(*v)).sum();
            (values.len() >= LEAST_SAMPLES).then(|| sum / values.len() as f64)
        };
        let means = self.samples.iter().filter_map(|(label, samples)| Some((*label, mean(samples)?)));
        means.reduce(|worst, next| if next.1 > worst.1 { next } else { worst }).map(|(label, _)| label)
    }

    /// Measures a region at new points; `None` if none of them is visible.
    fn measured(
        &self,
        pair: &Pair<'_>,
        label: u32,
        difference: fn(&SurfaceSample) -> f32,
    ) -> Result<Option<Region>> {
        let viewer = Viewer::of_asset(pair);
        let triangles: Vec<u32> =
            (0..self.labels.len() as u32).filter(|t| self.labels[*t as usize] == label).collect();
        let mesh = viewer.own().surface.mesh();
        let point = sample_triangles(mesh, Triangles::These(&triangles), POINTS)?;
        let found: Vec<Option<SurfaceSample>> = parallel::collect(POINTS, |i| viewer.sample(point(i)));
        let found: Vec<SurfaceSample> = found.into_iter().flatten().collect();
        let values: Vec<f32> = found.iter().map(difference).collect();
        let Some(estimate) = Estimate::of(&values)? else { return Ok(None) };
        let share = self.samples.get(&label).map_or(0.0, |samples| samples.len() as f64 / self.all as f64);
        let worst = worst_window(&found, (SHARE / share).min(1.0), difference);
        Ok(Some(Region {
            number: self.numbers.get(&label).copied().unwrap_or_default(),
            mean: estimate.summary.mean,
            interval: estimate.mean_interval,
            share,
            center: middle(&found).to_f64().to_array(),
            worst: worst.map(|ball| ball.shown()).unwrap_or_default(),
        }))
    }
}

/// Returns the sample closest to the mean of all.
fn middle(samples: &[SurfaceSample]) -> Vec3 {
    let sum = samples.iter().fold(Vec3::splat(0.0), |sum, sample| sum + sample.position);
    let mean = sum * (1.0 / samples.len().max(1) as f32);
    let away = |sample: &SurfaceSample| (sample.position - mean).length();
    let closest = samples.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
    closest.map_or(mean, |sample| sample.position)
}
