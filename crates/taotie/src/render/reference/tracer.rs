//! The state shared by all paths of an image.

use super::super::draw::{Draw, Draws};
use super::super::ground::Ground;
use super::super::prepare::Ready;
use super::super::rays::CameraRays;
use super::super::settings::{RenderSettings, Shot};
use super::super::view::View;
use super::environment::WorldEnvironment;
use super::settings::ReferenceSettings;
use super::surfaces::Sight;
use crate::error::Result;
use crate::math::Vec3;
use crate::pixel::LightSource;
use fearless_simd::Level;

/// The state shared by all paths of an image.
pub(super) struct Tracer<'t> {
    pub draws: &'t Draws<'t>,
    pub sight: Sight<'t>,
    pub view: View,
    pub camera: CameraRays,
    pub sources: Vec<LightSource<f32>>,
    pub ambient: Vec3,
    pub ground: Option<Ground>,
    pub environment: Option<WorldEnvironment<'t>>,
    /// The settings effective for the model.
    pub settings: RenderSettings,
    pub reference: ReferenceSettings,
    pub level: Level,
    /// The height above the surface at which rays start, in model units.
    pub ray_offset: f32,
    /// `true` if any surface emits light.
    pub emitters: bool,
}

impl<'t> Tracer<'t> {
    /// Validates and prepares the inputs of paths.
    ///
    /// # Errors
    /// As for [`super::reference`].
    pub(super) fn new(
        ready: Ready<'t>,
        draws: &'t Draws<'t>,
        shot: &Shot<'t>,
        paths: &ReferenceSettings,
    ) -> Result<Self> {
        paths.check()?;
        shot.check()?;
        let (settings, lighting) = (shot.settings.as_taken(), shot.lighting);
        let (width, height) = (settings.width, settings.height);
        crate::image::Image::check_size(width, height)?;
        let camera = CameraRays::new(shot.camera, [width, height]);
        let view = View::new(shot.camera, width, height)?;
        let level = settings.surface.simd.dispatch()?;
        let rays = u64::from(width) * u64::from(height) * u64::from(paths.spp);
        let tree = ready.tree(rays);
        Ok(Self {
            draws,
            sight: Sight { draws, tree },
            view,
            camera,
            sources: lighting.lights.iter().map(LightSource::new).collect(),
            ambient: lighting.ambient,
            ground: Ground::of(ready, shot, camera),
            environment: lighting.environment.as_ref().map(WorldEnvironment::new),
            settings,
            reference: *paths,
            level,
            ray_offset: ready.ray_offset(),
            emitters: draws.all.iter().any(Draw::shines),
        })
    }
}
