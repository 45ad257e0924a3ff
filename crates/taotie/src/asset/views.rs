//! Scan and asset seen from all sides in the same light.

use super::close_ups::{CloseUps, TakenCloseUps};
use super::look;
use super::view_figures::ViewFigures;
use crate::compare::{self, DisplayImage, Field, PIXELS_PER_DEGREE};
use crate::error::Result;
use crate::film::Development;
use crate::math::Vec3;
use crate::progress::Progress;
use crate::render::{EnvironmentLight, RenderSettings, Renderer, Shot};
use crate::scene::{Camera, Orbit, Outline, Scene};

/// The number of views.
const COUNT: usize = 8;
/// Alternating elevations, degrees above and below the horizon.
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
    /// The perceived difference.
    pub flip: Vec<Field>,
    /// The same in numbers.
    pub figures: Vec<ViewFigures>,
}

/// Views of each level of the asset, the finest first, in both looks.
pub(super) struct Looks {
    /// In one grey material, so that only shape and normals differ.
    pub grey: Vec<Views>,
    /// In the original materials; empty if the scan specifies no material.
    pub full: Vec<Views>,
    /// The worst patches and parts: in grey for normals, in the original materials for colours.
    pub close_ups: TakenCloseUps,
}

/// The images to take.
pub(super) struct Wanted {
    /// Pixels along a side of the images from all sides.
    pub side: u32,
    /// The worst patches and parts.
    pub close_ups: CloseUps,
}

/// Renders the scan and each level of the asset in each look, and the close-ups of the finest.
///
/// # Errors
/// [`crate::Error::Cancelled`]; those of rendering, which do not occur for scenes read from files.
pub(super) fn take(
    scan: Scene,
    levels: Vec<Scene>,
    Wanted { side, close_ups }: Wanted,
    progress: Progress<'_>,
) -> Result<Looks> {
    let mut setting = Setting { cameras: cameras(&scan), side, environment: None };
    let [of_angle, of_color] = close_ups.by_quantity();
    let (mut full, mut colors, mut rest) = (Vec::new(), TakenCloseUps::default(), progress);
    if !look::is_plain(&scan) {
        setting.environment = look::environment(std::iter::once(&scan).chain(&levels))?;
        let own = levels.iter().cloned().map(look::full).collect::<Result<Vec<_>>>()?;
        let scene = look::full(scan.clone())?;
        (full, colors) = setting.views((scene, own), of_color, progress.part(0.0, 0.5))?;
        (setting.environment, rest) = (None, progress.part(0.5, 1.0));
    }
    let levels = levels.into_iter().map(look::grey).collect::<Result<Vec<_>>>()?;
    let (grey, mut close_ups) = setting.views((look::grey(scan)?, levels), of_angle, rest)?;
    close_ups.extend(colors);
    Ok(Looks { grey, full, close_ups })
}

/// How images are rendered.
struct Setting {
    cameras: Vec<Camera>,
    /// Pixels along a side.
    side: u32,
    /// The environment light, in place of lights.
    environment: Option<EnvironmentLight>,
}

impl Setting {
    /// Renders the scan and each level, and compares them; also renders the close-ups of the finest level.
    fn views(
        &self,
        (scan, levels): (Scene, Vec<Scene>),
        wanted: CloseUps,
        progress: Progress<'_>,
    ) -> Result<(Vec<Views>, TakenCloseUps)> {
        let near = wanted.shots();
        let shots = |scene: Scene, near: &[(Camera, u32)], progress: Progress<'_>| {
            let around = self.cameras.iter().map(|camera| (camera.clone(), self.side));
            let shots: Vec<_> = around.chain(near.iter().cloned()).collect();
            let mut around = self.pictures(scene, &shots, progress)?;
            let close_ups = around.split_off(self.cameras.len());
            Result::Ok((around, close_ups))
        };
        let (scan, close_ups_of_scan) = shots(scan, &near, progress.part(0.0, 0.5))?;
        let share = 0.5 / levels.len().max(1) as f64;
        let (mut views, mut close_ups) = (Vec::with_capacity(levels.len()), Vec::new());
        for (i, level) in levels.into_iter().enumerate() {
            let from = 0.5 + i as f64 * share;
            let own = if i == 0 { &near[..] } else { &[] };
            let (asset, of_level) = shots(level, own, progress.part(from, from + 0.8 * share))?;
            close_ups.extend(of_level);
            views.push(compared(scan.clone(), asset, progress.part(from + 0.8 * share, from + share))?);
        }
        let pairs = close_ups_of_scan.into_iter().zip(close_ups).map(|(scan, asset)| [scan, asset]);
        Ok((views, wanted.with_pictures(pairs.collect())?))
    }

    /// Renders an image for each camera, with the given number of pixels along a side.
    fn pictures(
        &self,
        scene: Scene,
        shots: &[(Camera, u32)],
        progress: Progress<'_>,
    ) -> Result<Vec<DisplayImage>> {
        let development = Development { background: Some(Vec3::splat(0.03)), ..Development::default() };
        let usual = RenderSettings { samples: 4, ..RenderSettings::default() };
        let mut renderer = Renderer::new(scene, &usual.surface)?;
        let (mut pictures, mut codes) = (Vec::new(), Vec::new());
        for (i, (camera, side)) in shots.iter().enumerate() {
            let [from, to] = [i, i + 1].map(|views| views as f64 / shots.len() as f64);
            let settings = RenderSettings { width: *side, height: *side, ..usual.clone() };
            let lighting = look::lighting(camera, self.environment.as_ref());
            let shot = Shot { camera, lighting: &lighting, settings: &settings };
            renderer.develop(&shot, &development, &mut codes, progress.part(from, to))?;
            pictures.push(DisplayImage::from_developed(*side, *side, &codes)?);
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
