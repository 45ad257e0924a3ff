//! An animation of a model.

use crate::error::{Error, Result, Warnings};
use crate::render::{SurfaceSettings, bind_tangents};
use crate::scene::Scene;
use crate::scene::animation::{Animation, Rig};

/// Number of moments of an animation at which the model must fit into the image.
const MOMENTS: u32 = 24;

/// A rig and the animation that moves it.
///
/// ```no_run
/// use taotie::studio::Motion;
///
/// let mut loaded = taotie::io::load_model("walking.glb".as_ref())?;
/// let motion = Motion::choose(loaded.rig.take(), Some("Walk"))?;
/// motion.pose(&mut loaded.scene, motion.seconds() / 2.0)?;
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug)]
pub struct Motion {
    rig: Rig,
    animation: usize,
}

impl Motion {
    /// Chooses an animation by name, or by index from 0; the first if `choice` is `None`.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is none, or none of that name; the message lists the existing ones.
    pub fn choose(rig: Option<Rig>, choice: Option<&str>) -> Result<Self> {
        let Some(rig) = rig.filter(|rig| !rig.animations().is_empty()) else {
            return Err(Error::invalid("animation", "the file has none"));
        };
        let animations = rig.animations();
        let animation = match choice {
            None => 0,
            Some(name) => number_of(animations, name).ok_or_else(|| {
                let names = names(animations).join(", ");
                let why = format!("the file has no such animation; it has: {names}");
                Error::invalid(format!("animation {name}"), why)
            })?,
        };
        Ok(Self { rig, animation })
    }

    /// Makes tangents follow the surface; returns the settings for images of it. Resets the scene to rest.
    ///
    /// # Errors
    /// As [`bind_tangents`].
    pub fn bind_tangents(
        self,
        scene: &mut Scene,
        settings: &SurfaceSettings,
        warnings: &mut Warnings,
    ) -> Result<(Self, SurfaceSettings)> {
        let (rig, settings) = bind_tangents(scene, self.rig, settings, warnings)?;
        Ok((Self { rig, ..self }, settings))
    }

    /// Returns its name, or its index if it has none.
    pub fn name(&self) -> String {
        names(self.rig.animations()).swap_remove(self.animation)
    }

    /// Returns its duration in seconds.
    pub fn seconds(&self) -> f64 {
        self.rig.animations()[self.animation].seconds()
    }

    /// Poses the scene at a moment.
    ///
    /// # Errors
    /// As [`Rig::pose`].
    pub fn pose(&self, scene: &mut Scene, seconds: f64) -> Result<()> {
        self.rig.pose(scene, self.animation, seconds)
    }

    /// Calls `see` with the scene at evenly spaced moments from the animation's beginning to its end.
    ///
    /// # Errors
    /// As [`Motion::pose`].
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

/// Returns the names, and indices for those without.
fn names(animations: &[Animation]) -> Vec<String> {
    let name = |(i, a): (usize, &Animation)| if a.name.is_empty() { i.to_string() } else { a.name.clone() };
    animations.iter().enumerate().map(name).collect()
}
