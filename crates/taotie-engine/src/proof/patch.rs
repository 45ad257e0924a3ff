//! The parts of an asset that differ most from its scan: the worst patch, a window that covers one per cent of the
//! surface, with the view of it from the direction in which it is seen; and the worst regions, such as UV islands or
//! materials.

use super::close_up::{CloseUp, Footprint, OUTLINE, SurfaceSample, Viewer};
use super::statistics::{Detail, Estimate};
use super::{Difference, Look, NOTHING_DEG, Pair, Properties, Sample};
use crate::bake::{LookupPoint, Scan};
use crate::compare::Field;
use crate::error::Result;
use crate::math::{Mat4, Vec3};
use crate::mesh::{Mesh, Point, Triangles, sample_triangles};
use crate::parallel;
use crate::scene::{Camera, Projection};
use crate::trace::Ray;
use std::collections::BTreeMap;

/// The share of a surface's samples that a window contains.
pub const PATCH_SHARE: f64 = 0.01;
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
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Patch {
    /// The mean difference within it, in degrees, CIEDE2000, or as a fraction of the largest number; or the detail lost, 0 to
    /// about 1.
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

/// Finds the window of one per cent of the samples with the largest mean difference, and measures it at new points, so
/// that it is not the worst by chance: the more `points` the whole surface has, the more are used. Where something emits
/// light, its emission is also compared without the dark surface around it: a lit display is often much smaller than one per
/// cent. `None` if there is nothing to compare.
///
/// # Errors
/// As [`Estimate::of`].
pub fn worst_patch(
    pair: &Pair<'_>,
    (close_up, points): (&CloseUp, usize),
    of: PatchQuantity,
) -> Result<Option<Patch>> {
    let reach = pair.diagonal * OUTLINE;
    let poolings: &[Pooling] = match of {
        PatchQuantity::Angle => &[Pooling::Mean(|sample| sample.angle_deg)],
        PatchQuantity::Color => {
            &[Pooling::Mean(|sample| sample.color), Pooling::Mean(|sample| sample.emission)]
        }
        PatchQuantity::Material => &[Pooling::Mean(|sample| sample.material)],
        PatchQuantity::Detail => {
            &[Pooling::Lost(Detail::Relief, reach), Pooling::Lost(Detail::Colors, reach)]
        }
    };
    let mut worst: Option<Patch> = None;
    for pooling in poolings {
        let patch = patch_of(pair, (close_up, points), *pooling)?;
        worst = Patch::worse([worst, patch]);
    }
    Ok(worst)
}

/// How the samples of a window become one number.
#[derive(Clone, Copy)]
pub(super) enum Pooling {
    /// The mean of a difference.
    Mean(fn(&SurfaceSample) -> f32),
    /// The detail of one of the two that the other one lacks within this distance.
    Lost(Detail, f32),
}

impl Pooling {
    /// Returns the difference of a sample; NaN if nothing is compared.
    fn difference(self, sample: &SurfaceSample) -> f32 {
        match self {
            Self::Mean(difference) => difference(sample),
            Self::Lost(..) if sample.is_missing => f32::NAN,
            Self::Lost(Detail::Relief, _) => sample.angle_deg,
            Self::Lost(Detail::Colors, _) => sample.color,
        }
    }

    /// Returns the figure of a window that holds `all` samples, from those that have a difference.
    fn pooled(self, samples: &[&SurfaceSample], window: &Ball, all: usize) -> f64 {
        /// Mean distances between samples within which an edge may be moved.
        const FEW: f32 = 2.0;
        match self {
            Self::Mean(difference) => {
                samples.iter().map(|sample| f64::from(difference(sample))).sum::<f64>() / all as f64
            }
            Self::Lost(detail, reach) => {
                let side = facing(samples.iter().copied(), window.toward);
                if LEAST_SIDE * side.len() < all {
                    return 0.0;
                }
                let apart = window.radius * (std::f32::consts::PI / all as f32).sqrt();
                let [lost, _] = detail.unequal(&side, reach.max(FEW * apart));
                lost
            }
        }
    }

    /// Returns the figure of a window seen from the direction `toward`, and its 99 % interval, from new samples; `None` if
    /// nothing is compared.
    fn measured(self, samples: &[SurfaceSample], toward: Vec3) -> Result<Option<(f64, [f64; 2])>> {
        /// Standard errors on either side of the number that contain 99 % of Student's distribution of eight groups.
        const T: f64 = 3.5;
        /// The fewest samples whose detail is judged.
        const FEWEST: usize = 64;
        match self {
            Self::Mean(difference) => {
                let values: Vec<f32> = samples.iter().map(difference).collect();
                let estimate = Estimate::of(&values)?;
                Ok(estimate.map(|estimate| (estimate.summary.mean, estimate.mean_interval)))
            }
            Self::Lost(detail, reach) => {
                let known = samples.iter().filter(|sample| !self.difference(sample).is_nan());
                let known = facing(known, toward);
                let [lost, error] = detail.unequal(&known, reach);
                Ok((known.len() >= FEWEST).then_some((lost, [lost - T * error, lost + T * error])))
            }
        }
    }
}

/// One in this many samples of a window must be on its side of the object for their detail to be judged.
const LEAST_SIDE: usize = 4;

/// Returns the samples that are seen from about this direction: a window on a thin part also holds its other side.
fn facing<'a>(samples: impl Iterator<Item = &'a SurfaceSample>, toward: Vec3) -> Vec<&'a SurfaceSample> {
    /// The cosine to the direction.
    const LEAST: f32 = 0.25;
    samples.filter(|sample| sample.toward.dot(toward) > LEAST).collect()
}

/// Finds the worst window by one pooling, and measures it at new points.
fn patch_of(
    pair: &Pair<'_>,
    (close_up, points): (&CloseUp, usize),
    pooling: Pooling,
) -> Result<Option<Patch>> {
    let viewer = if close_up.is_of_scan { Viewer::of_scan(pair) } else { Viewer::of_asset(pair) };
    let Some(window) = worst_window(&close_up.samples, PATCH_SHARE, pooling) else { return Ok(None) };
    let samples = fresh_samples(viewer, &window, (points / PART).max(POINTS))?;
    let Some((mean, interval)) = pooling.measured(&samples, window.toward)? else { return Ok(None) };
    let Window { center, radius, toward } = window.shown();
    Ok(Some(Patch { mean, interval, center, radius, toward, is_of_scan: close_up.is_of_scan }))
}

/// Returns the centre of the window of one per cent of the samples in which most of them are missing, in model units;
/// `None` if none is.
pub fn most_missing(close_up: &CloseUp) -> Option<[f64; 3]> {
    let is_missing = Pooling::Mean(|sample| f32::from(u8::from(sample.is_missing)));
    let window = worst_window(&close_up.samples, PATCH_SHARE, is_missing)?;
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
    /// Returns the patch with the larger mean difference, the first one if they are equal.
    pub fn worse(patches: [Option<Self>; 2]) -> Option<Self> {
        let worse = |a: Self, b: Self| if b.mean > a.mean { b } else { a };
        patches.into_iter().flatten().reduce(worse)
    }

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

/// Finds the ball around a sample that contains a `share` of them, or all that have a `difference` if they are fewer, and has
/// the largest mean; `None` if there is nothing to compare.
pub(super) fn worst_window(samples: &[SurfaceSample], share: f64, pooling: Pooling) -> Option<Ball> {
    let step = samples.len().div_ceil(MOST_SAMPLES).max(1);
    let known: Vec<(&SurfaceSample, f32)> = samples
        .iter()
        .step_by(step)
        .map(|sample| (sample, pooling.difference(sample)))
        .filter(|(_, value)| !value.is_nan())
        .collect();
    if known.is_empty() {
        return None;
    }
    let positions: Vec<Vec3> = known.iter().map(|(sample, _)| sample.position).collect();
    let windows = WINDOWS.min(known.len());
    let held = ((samples.len().div_ceil(step) as f64 * share) as usize).clamp(1, known.len());
    let window = |i: usize| {
        // Half of the windows are around the worst samples of as many equal parts, half around their first.
        let part = i / 2 * known.len() / windows.div_ceil(2);
        let end = ((i / 2 + 1) * known.len() / windows.div_ceil(2)).max(part + 1).min(known.len());
        let worst = (part..end).fold(part, |best, k| if known[k].1 > known[best].1 { k } else { best });
        let (&SurfaceSample { position: center, toward, .. }, _) =
            known[if i.is_multiple_of(2) { worst } else { part }];
        let near = nearest(&positions, center, held);
        let radius = near.iter().fold(0.0, |most, (squared, _)| squared.max(most)).sqrt();
        let inside: Vec<&SurfaceSample> = near.iter().map(|(_, k)| known[*k].0).collect();
        let ball = Ball { center, radius, toward, mean: 0.0 };
        Ball { mean: pooling.pooled(&inside, &ball, held), ..ball }
    };
    let all = parallel::tasks(windows, &window);
    all.into_iter().reduce(|worst, next| if next.mean > worst.mean { next } else { worst })
}

/// Returns the `count` positions nearest to a centre by their indices, each after its squared distance, in any order.
fn nearest(positions: &[Vec3], center: Vec3, count: usize) -> Vec<(f32, usize)> {
    /// One in this many positions shows roughly how far the nearest reach.
    const STRIDE: usize = 16;
    let squared = |position: &Vec3| (*position - center).dot(*position - center);
    let squared: Vec<f32> = positions.iter().map(squared).collect();
    let within = |limit: f32| -> Vec<(f32, usize)> {
        squared.iter().copied().zip(0..).filter(|(squared, _)| *squared <= limit).collect()
    };
    let mut some: Vec<f32> = squared.iter().step_by(STRIDE).copied().collect();
    let rank = count / STRIDE * 2 + 8;
    let mut near = Vec::new();
    if rank < some.len() {
        near = within(*some.select_nth_unstable_by(rank, f32::total_cmp).1);
    }
    if near.len() < count {
        near = squared.into_iter().zip(0..).collect();
    }
    near.select_nth_unstable_by(count - 1, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    near.truncate(count);
    near
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

/// A ball that contains a part of a surface, and the direction from which it is seen.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Window {
    /// Its centre, in model units.
    pub center: [f64; 3],
    /// Its radius, in model units.
    pub radius: f64,
    /// The direction from which it is seen, unit.
    pub toward: [f64; 3],
}

/// Half the width of the picture in radii of the patch.
const MARGIN: f64 = 1.5;
/// The distance of the viewer in radii of the patch: closer parts of the object are cut away.
const AWAY: f64 = 4.0;

/// The quantity by which a patch is the worst.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PatchQuantity {
    /// The angle between normals, degrees.
    Angle,
    /// The colour difference, CIEDE2000.
    Color,
    /// The difference of metallic, roughness or occlusion, whichever is largest, [0, 1].
    Material,
    /// Relief or colours that are lost, whichever is more, relative to how much they vary on the scan: √(D / (V + m²)), where D
    /// is the mean square of differences, V that of the scan about a linear fit, and m is 4° or ΔE 4.
    Detail,
}

/// A parallel view of a patch, from the direction in which it is seen, with some margin.
#[derive(Debug, Clone, Copy)]
pub struct PatchView {
    center: Vec3<f64>,
    right: Vec3<f64>,
    up: Vec3<f64>,
    toward: Vec3<f64>,
    /// Half the width and height, in model units.
    half: f64,
    /// The distance of the viewer, in model units.
    away: f64,
    /// The distance of the farthest surface from the viewer, in model units.
    far: f64,
}

impl PatchView {
    /// Makes the view of a window on an object with this diagonal, in model units.
    pub fn of(window: Window, diagonal: f64) -> Self {
        let toward = Vec3::from_array(window.toward);
        // Up is that of the world, unless the view is along it.
        let world_up =
            if toward.y.abs() < 0.95 { Vec3::new(0.0, 1.0, 0.0) } else { Vec3::new(0.0, 0.0, -1.0) };
        let right = world_up.cross(toward).normalize();
        let radius = window.radius.max(diagonal * 1e-6);
        let away = radius * AWAY;
        Self {
            center: Vec3::from_array(window.center),
            right,
            up: toward.cross(right),
            toward,
            half: radius * MARGIN,
            away,
            far: away + diagonal,
        }
    }

    /// Returns the camera for a renderer.
    pub fn camera(&self) -> Camera {
        let eye = self.center + self.toward * self.away;
        Camera {
            name: String::new(),
            world_from_view: Mat4::from_axes(self.right, self.up, self.toward, eye),
            projection: Projection::Orthographic {
                half_width: self.half,
                half_height: self.half,
                near: self.away * 1e-3,
                far: self.far,
            },
        }
    }

    /// Compares the two surfaces at each pixel, sampled as finely as the scan has detail, as in a close-up; NaN where
    /// there is nothing to compare. An angle counts as 90° where only one of them shows anything.
    ///
    /// # Errors
    /// As [`Field::new`].
    pub fn differences(&self, [scan, asset]: [&Scan; 2], of: PatchQuantity, side: u32) -> Result<Field> {
        let footprint = Footprint::of(scan);
        let toward = self.toward.to_f32();
        let properties = if of == PatchQuantity::Angle { Properties::None } else { Properties::All };
        let difference = |i: usize| {
            let ray = self.ray(i as u32, side);
            let hits = [scan, asset].map(|surface| surface.first_seen(&ray, self.far as f32));
            let [Some(on_scan), Some(on_asset)] = hits.map(|hit| hit.map(|hit| hit.point())) else {
                let is_lost = of == PatchQuantity::Angle && hits.iter().any(Option::is_some);
                return if is_lost { NOTHING_DEG } else { f32::NAN };
            };
            let width = footprint.pixel(footprint.at(scan, on_scan));
            let [seen, shown] = [(scan, on_scan), (asset, on_asset)].map(|(surface, point)| {
                let sample = Sample { at: LookupPoint { point, width }, toward };
                Look::of(surface, [sample], properties)
            });
            let found = Difference::between(&seen, &shown, properties);
            match of {
                PatchQuantity::Angle | PatchQuantity::Detail => found.angle_deg,
                PatchQuantity::Color => found.color,
                PatchQuantity::Material => found.material,
            }
        };
        Field::new(side, side, parallel::collect((side * side) as usize, difference))
    }

    /// Returns the ray through the centre of a pixel.
    fn ray(&self, pixel: u32, side: u32) -> Ray {
        let from_middle = |k: u32| ((f64::from(k) + 0.5) / f64::from(side) * 2.0 - 1.0) * self.half;
        let [x, y] = [from_middle(pixel % side), -from_middle(pixel / side)];
        let origin = self.center + self.right * x + self.up * y + self.toward * self.away;
        Ray::new(origin.to_f32(), -self.toward.to_f32())
    }
}

/// Minimum number of samples for a region's mean to be compared with others.
const LEAST_SAMPLES: usize = 16;

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
    /// The region with the largest mean colour difference, CIEDE2000; `None` if colours are not compared.
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
        let worst = worst_window(&found, (PATCH_SHARE / share).min(1.0), Pooling::Mean(difference));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar;
    use crate::mesh::MeshData;
    use crate::scene::{Material, Scene};

    /// A square in the plane z = 0 whose right half is tilted by this angle. The halves share no vertices.
    fn bent(degrees: f64) -> Scan {
        let (sin, cos) = (scalar::sin(degrees.to_radians()), scalar::cos(degrees.to_radians()));
        let at = |x: f64, y: f64| Vec3::new(x, y, -sin / cos * x.max(0.0)).to_f32();
        let positions =
            [[-1.0, 0.0], [0.0, 1.0]].as_flattened().iter().flat_map(|x| [at(*x, -1.0), at(*x, 1.0)]);
        let (flat, leaning) = (Vec3::new(0.0, 0.0, 1.0), Vec3::new(sin, 0.0, cos).to_f32());
        let mesh = Mesh::new(MeshData {
            positions: positions.collect(),
            normals: [[flat; 4], [leaning; 4]].concat(),
            triangles: vec![[0, 2, 3], [0, 3, 1], [4, 6, 7], [4, 7, 5]],
            ..MeshData::default()
        });
        Scan::new(Scene::of_mesh(mesh.unwrap(), Material::default()).unwrap()).unwrap()
    }

    #[test]
    fn the_picture_shows_where_the_difference_is() {
        let window = Window { radius: 0.5, toward: [0.0, 0.0, 1.0], ..Window::default() };
        let view = PatchView::of(window, 2.0);
        let field = view.differences([&bent(0.0), &bent(20.0)], PatchQuantity::Angle, 16).unwrap();
        let row = &field.values()[8 * 16..9 * 16];
        assert!(row[..7].iter().all(|angle| *angle < 1e-3), "the left half is the same: {row:?}");
        assert!(
            row[9..].iter().all(|angle| (angle - 20.0).abs() < 0.01),
            "the right half is tilted: {row:?}"
        );
        let Projection::Orthographic { half_width, .. } = view.camera().projection else {
            panic!("parallel")
        };
        assert_eq!(half_width, 0.75);
    }
}
