//! The environment as seen by paths.

use super::super::settings::EnvironmentLight;
use crate::math::Vec3;
use crate::pixel::Turn;
use crate::shade::environment::EnvironmentSample;

/// The environment in world space.
#[derive(Clone, Copy)]
pub(super) struct WorldEnvironment<'t> {
    light: &'t EnvironmentLight,
    turn: Turn<f32>,
    /// `true` if it is visible wherever no surface is in front of it.
    pub visible: bool,
}

impl<'t> WorldEnvironment<'t> {
    pub(super) fn new(light: &'t EnvironmentLight) -> Self {
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
