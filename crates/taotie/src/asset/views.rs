//! Scan and asset seen from all sides in the same light.

use super::look;
use crate::compare::{self, DisplayImage, Field, PIXELS_PER_DEGREE};
use crate::error::Result;
use crate::film::Development;
use crate::math::Vec3;
use crate::progress::Progress;
use crate::render::{EnvironmentLight, RenderSettings, Renderer, Shot};
use crate::scene::{Camera, Orbit, Outline, Scene};

/// From how many sides.
const COUNT: usize = 8;
/// Degrees above and below the horizon, by turns.
const ELEVATIONS: [f64; 2] = [20.0, -12.0];

/// Images of scan and asset and their differences, view by view.
///
/// ```
/// use taotie::asset::{ViewFigures, Views};
///
/// /// Returns the view from which asset and scan differ most.
/// fn worst(views: &Views) -> Option<&ViewFigures> {
///     views.figures.iter().max_by(|a, b| a.flip.total_cmp(&b.flip))
/// }
/// ```
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Views {
    /// Of the scan.
    pub scan: Vec<DisplayImage>,
    /// Of the asset.
    pub asset: Vec<DisplayImage>,
    /// The difference as an observer sees it.
    pub flip: Vec<Field>,
    /// The same in numbers.
    pub figures: Vec<ViewFigures>,
}

/// The difference of an image of an asset from that of its scan.
///
/// ```
/// use taotie::asset::ViewFigures;
///
/// /// Returns a row of a table.
/// fn row(view: &ViewFigures) -> String {
///     format!("{:>4}° {:>4}° {:.3} {:.3}", view.azimuth_deg, view.elevation_deg, view.flip, view.ssim)
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ViewFigures {
    /// The azimuth of the view, degrees.
    pub azimuth_deg: f64,
    /// Degrees above the horizon.
    pub elevation_deg: f64,
    /// The mean of FLIP, [0, 1]; 0 where equal.
    pub flip: f64,
    /// SSIM; 1 where equal.
    pub ssim: f64,
}

/// Views of each level of the asset, the finest first, in each look.
pub(super) struct Looks {
    /// In one grey material, so that nothing but shape and normals differs.
    pub grey: Vec<Views>,
    /// In their own materials; empty where the scan says nothing of its material.
    pub full: Vec<Views>,
}

/// Takes the images of the scan and of each level of the asset, in each look.
///
/// # Errors
/// [`crate::Error::Cancelled`]; those of rendering, which a scene that was read does not cause.
pub(super) fn take(scan: Scene, levels: Vec<Scene>, side: u32, progress: Progress<'_>) -> Result<Looks> {
    let mut setting = Setting { cameras: cameras(&scan), side, environment: None };
    let (mut full, mut rest) = (Vec::new(), progress);
    if !look::is_plain(&scan) {
        setting.environment = look::environment(std::iter::once(&scan).chain(&levels))?;
        let own = levels.iter().cloned().map(look::full).collect::<Result<Vec<_>>>()?;
        full = setting.views(look::full(scan.clone())?, own, progress.part(0.0, 0.5))?;
        (setting.environment, rest) = (None, progress.part(0.5, 1.0));
    }
    let levels = levels.into_iter().map(look::grey).collect::<Result<Vec<_>>>()?;
    let grey = setting.views(look::grey(scan)?, levels, rest)?;
    Ok(Looks { grey, full })
}

/// How images are taken.
struct Setting {
    cameras: Vec<Camera>,
    /// Pixels along a side.
    side: u32,
    /// Light from all around, in place of lights.
    environment: Option<EnvironmentLight>,
}

impl Setting {
    /// Takes images of the scan and of each level, and compares them.
    fn views(&self, scan: Scene, levels: Vec<Scene>, progress: Progress<'_>) -> Result<Vec<Views>> {
        let scan = self.pictures(scan, progress.part(0.0, 0.5))?;
        let share = 0.5 / levels.len().max(1) as f64;
        let take = |(i, level): (usize, Scene)| {
            let from = 0.5 + i as f64 * share;
            let asset = self.pictures(level, progress.part(from, from + 0.8 * share))?;
            compared(scan.clone(), asset, progress.part(from + 0.8 * share, from + share))
        };
        levels.into_iter().enumerate().map(take).collect()
    }

    fn pictures(&self, scene: Scene, progress: Progress<'_>) -> Result<Vec<DisplayImage>> {
        let side = self.side;
        let settings = RenderSettings { width: side, height: side, samples: 4, ..RenderSettings::default() };
        let development = Development { background: Some(Vec3::splat(0.03)), ..Development::default() };
        let mut renderer = Renderer::new(scene, &settings.surface)?;
        let (mut pictures, mut codes) = (Vec::new(), Vec::new());
        for (i, camera) in self.cameras.iter().enumerate() {
            let [from, to] = [i, i + 1].map(|views| views as f64 / self.cameras.len() as f64);
            let lighting = look::lighting(camera, self.environment.as_ref());
            let shot = Shot { camera, lighting: &lighting, settings: &settings };
            renderer.develop(&shot, &development, &mut codes, progress.part(from, to))?;
            pictures.push(DisplayImage::from_developed(side, side, &codes)?);
        }
        Ok(pictures)
    }
}

/// Compares the images view by view.
fn compared(scan: Vec<DisplayImage>, asset: Vec<DisplayImage>, progress: Progress<'_>) -> Result<Views> {
    let mut views = Views { scan, asset, ..Views::default() };
    for (i, (a, b)) in views.scan.iter().zip(&views.asset).enumerate() {
        progress.at(i as f64 / COUNT as f64)?;
        let flip = compare::flip(a, b, PIXELS_PER_DEGREE)?;
        views.figures.push(ViewFigures {
            azimuth_deg: azimuth(i),
            elevation_deg: ELEVATIONS[i % 2],
            flip: flip.summary().map_or(0.0, |summary| summary.mean),
            ssim: compare::ssim(a, b)?,
        });
        views.flip.push(flip);
    }
    Ok(views)
}

fn azimuth(view: usize) -> f64 {
    view as f64 * 360.0 / COUNT as f64
}

fn cameras(scene: &Scene) -> Vec<Camera> {
    let outline = Outline::new(scene);
    let Some(bounds) = outline.bounds() else { return Vec::new() };
    let camera = |i: usize| {
        let [azimuth, elevation, fov_y] = [azimuth(i), ELEVATIONS[i % 2], 30.0].map(f64::to_radians);
        let mut orbit = Orbit { azimuth, elevation, distance: 0.0, target: bounds.center(), fov_y };
        orbit.distance = outline.fitting_distance(&orbit, 1.0, 0.92);
        orbit.camera(bounds.diagonal() / 2.0)
    };
    (0..COUNT).map(camera).collect()
}
