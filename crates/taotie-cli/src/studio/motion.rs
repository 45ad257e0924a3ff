//! The animation of a model that was asked for.

use anyhow::{Result, bail};
use std::path::Path;
use taotie::Warnings;
use taotie::render::{SurfaceSettings, bind_tangents};
use taotie::scene::Scene;
use taotie::scene::animation::{Animation, Rig};

/// Moments of an animation at which it must fit into the picture.
const MOMENTS: u32 = 24;

/// A rig and which of its animations moves it.
pub struct Motion {
    rig: Rig,
    animation: usize,
}

impl Motion {
    /// The animation of `model` asked for by name, or by number from 0; the first where nothing was said.
    ///
    /// # Errors
    /// That there is none, or none of that name; the text lists those that there are.
    pub fn choose(rig: Option<Rig>, choice: Option<&str>, model: &Path) -> Result<Self> {
        let Some(rig) = rig.filter(|rig| !rig.animations().is_empty()) else {
            let path = model.display();
            bail!("{path}: it has no animation; leave out --animation, --time, --frames and --fps");
        };
        let animations = rig.animations();
        let animation = match choice {
            None => 0,
            Some(name) => match number_of(animations, name) {
                Some(animation) => animation,
                None => {
                    let names = names(animations).join(", ");
                    bail!("--animation {name}: the file has no such animation; it has: {names}");
                }
            },
        };
        Ok(Self { rig, animation })
    }

    /// Makes tangents follow the surface; returns the settings for pictures of it. Brings the scene to rest.
    pub fn bind_tangents(
        self,
        scene: &mut Scene,
        settings: &SurfaceSettings,
        warnings: &mut Warnings,
    ) -> Result<(Self, SurfaceSettings)> {
        let (rig, settings) = bind_tangents(scene, self.rig, settings, warnings)?;
        Ok((Self { rig, ..self }, settings))
    }

    /// Its name, or its number where it has none.
    pub fn name(&self) -> String {
        names(self.rig.animations()).swap_remove(self.animation)
    }

    /// How long it lasts, seconds.
    pub fn seconds(&self) -> f64 {
        self.rig.animations()[self.animation].seconds()
    }

    /// Brings the scene to a moment.
    pub fn pose(&self, scene: &mut Scene, seconds: f64) -> Result<()> {
        Ok(self.rig.pose(scene, self.animation, seconds)?)
    }

    /// Shows `see` the scene at even moments from the animation's beginning to its end.
    pub fn tour(&self, scene: &mut Scene, mut see: impl FnMut(&Scene)) -> Result<()> {
        for moment in 0..MOMENTS {
            self.pose(scene, self.seconds() * f64::from(moment) / f64::from(MOMENTS - 1))?;
            see(scene);
        }
        Ok(())
    }
}

fn number_of(animations: &[Animation], name: &str) -> Option<usize> {
    let named = animations.iter().position(|animation| animation.name == name);
    named.or_else(|| name.parse().ok().filter(|number| *number < animations.len()))
}

/// Names, and numbers for those without.
fn names(animations: &[Animation]) -> Vec<String> {
    let name = |(i, a): (usize, &Animation)| if a.name.is_empty() { i.to_string() } else { a.name.clone() };
    animations.iter().enumerate().map(name).collect()
}
