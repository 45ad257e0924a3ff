//! The state shared by all paths of an image, and what they see: the surface hit by a ray, and the environment.

use super::super::background::Ground;
use super::super::camera::{CameraRays, View};
use super::super::draw::{Draw, Draws};
use super::super::prepare::Ready;
use super::super::settings::{EnvironmentLight, RenderSettings, Shot};
use super::super::tree::{Footprint, SceneTree};
use super::ReferenceSettings;
use crate::error::Result;
use crate::math::Vec3;
use crate::math::integration::{hash, unit};
use crate::pixel::{LightSource, Turn};
use crate::scene::AlphaMode;
use crate::shade::environment::EnvironmentSample;
use crate::trace::{Hit, Ray};
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

/// The point where a ray hit a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Intersection {
    pub draw: u32,
    /// The triangle's index over all draws.
    pub triangle: u32,
    /// The weights of its corners.
    pub weights: [f32; 3],
    /// `true` if it was hit from its front.
    pub front: bool,
}

/// Rays through a scene. A mask exists if its alpha reaches the cutoff; a blended surface exists with the probability
/// alpha, times the share of light that does not pass through it.
pub(super) struct Sight<'t> {
    draws: &'t Draws<'t>,
    tree: &'t SceneTree,
}

/// A blended surface hit by a ray, and a number in [0, 1) that decides whether it exists.
struct Blended {
    hit: Hit,
    chance: f32,
}

impl Sight<'_> {
    /// The nearest surface at a distance below `limit`. A `camera` sees single-sided surfaces only from their front.
    /// `chance` is a number in [0, 1), requested once, that decides which of the blended surfaces on the way exists.
    pub(super) fn nearest(
        &self,
        ray: &Ray,
        limit: f32,
        camera: bool,
        chance: impl FnOnce() -> f32,
    ) -> Option<Intersection> {
        let seen = |hit: &Hit| {
            let draw = self.draw(hit);
            let culled = camera && !draw.material.double_sided && !from_front(draw, hit, ray);
            !culled && self.is_masked_in(draw, hit)
        };
        let mut hit = self.tree.0.nearest_of(ray, limit, seen)?;
        if self.draw(&hit).material.is_blended() {
            hit = self.nearest_by_chance(ray, limit, seen, Blended { hit, chance: chance() })?;
        }
        let draw = self.draws.number_of(hit.triangle);
        let front = from_front(&self.draws.all[draw], &hit, ray);
        Some(Intersection { draw: draw as u32, triangle: hit.triangle, weights: hit.weights, front })
    }

    /// Steps through surfaces, accepting each with probability α. The remainder of the chance is as evenly
    /// distributed as before.
    fn nearest_by_chance(
        &self,
        ray: &Ray,
        limit: f32,
        seen: impl Fn(&Hit) -> bool,
        Blended { mut hit, mut chance }: Blended,
    ) -> Option<Hit> {
        loop {
            let draw = self.draw(&hit);
            if !draw.material.is_blended() {
                return Some(hit);
            }
            let alpha = self.coverage(draw, &hit);
            if chance < alpha {
                return Some(hit);
            }
            chance = (chance - alpha.max(0.0)) / (1.0 - alpha.max(0.0));
            let passed = (hit.distance, hit.triangle);
            hit = self
                .tree
                .0
                .nearest_of(ray, limit, |hit| (hit.distance, hit.triangle) > passed && seen(hit))?;
        }
    }

    /// Returns true if nothing blocks the ray up to `limit` lengths. `chance` is the ray's number: with the
    /// triangle's, it decides whether a blended surface exists.
    pub(super) fn is_free(&self, ray: &Ray, limit: f32, chance: u32) -> bool {
        !self.tree.0.occluded(ray, limit, |hit| {
            let draw = self.draw(hit);
            let is_in = self.is_masked_in(draw, hit);
            is_in
                && (!draw.material.is_blended()
                    || unit(hash(chance, hit.triangle)) < self.coverage(draw, hit))
        })
    }

    fn draw(&self, hit: &Hit) -> &Draw<'_> {
        self.draws.of(hit.triangle)
    }

    /// Returns true if the surface is not cut out by a mask.
    fn is_masked_in(&self, draw: &Draw<'_>, hit: &Hit) -> bool {
        match draw.material.alpha {
            AlphaMode::Mask(cutoff) => self.alpha(draw, hit) >= cutoff,
            _ => true,
        }
    }

    /// Returns the probability that a blended surface exists.
    fn coverage(&self, draw: &Draw<'_>, hit: &Hit) -> f32 {
        let kept = 1.0 - Footprint::of(draw, hit).passed(self.draws.scene, draw);
        if draw.material.alpha == AlphaMode::Blend { self.alpha(draw, hit) * kept } else { kept }
    }

    fn alpha(&self, draw: &Draw<'_>, hit: &Hit) -> f32 {
        Footprint::of(draw, hit).alpha(self.draws.scene, draw)
    }
}

/// Returns true if the ray comes from the triangle's front.
fn from_front(draw: &Draw<'_>, hit: &Hit, ray: &Ray) -> bool {
    let [a, b, c] = draw.vertices(hit.triangle).map(|v| draw.positions[v as usize]);
    let along = (b - a).cross(c - a).dot(ray.direction());
    if draw.mirrored { along > 0.0 } else { along < 0.0 }
}

/// The environment in world space.
#[derive(Clone, Copy)]
pub(super) struct WorldEnvironment<'t> {
    light: &'t EnvironmentLight,
    turn: Turn<f32>,
    /// `true` if it is visible wherever no surface is in front of it.
    pub visible: bool,
}

impl<'t> WorldEnvironment<'t> {
    fn new(light: &'t EnvironmentLight) -> Self {
        Self { light, turn: light.turn(), visible: light.visible }
    }

    /// The radiance from the unit direction `world`.
    pub(super) fn radiance(&self, world: Vec3) -> Vec3 {
        self.light.environment.radiance(self.turn.to_environment(world)) * self.light.intensity
    }

    /// Samples a direction, in world space, proportionally to radiance. `u` in [0, 1)².
    pub(super) fn sample(&self, u: [f32; 2]) -> EnvironmentSample {
        let sample = self.light.environment.sample(u);
        EnvironmentSample {
            direction: self.turn.to_world(sample.direction),
            radiance: sample.radiance * self.light.intensity,
            pdf: sample.pdf,
        }
    }

    /// The density of [`Self::sample`].
    pub(super) fn pdf(&self, world: Vec3) -> f32 {
        self.light.environment.pdf(self.turn.to_environment(world))
    }
}
