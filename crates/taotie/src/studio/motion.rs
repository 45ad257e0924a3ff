//! The motion of a model: its animation, and the images to take: one, those of a turntable, or those of the
//! animation.

use std::f64::consts::TAU;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::render::{SurfaceSettings, bind_tangents};
use taotie_engine::scene::Scene;
use taotie_engine::scene::animation::{Animation, Rig};

/// Number of moments of an animation at which the model must fit into the image.
const MOMENTS: u32 = 24;

/// A rig and the animation that moves it.
///
/// ```no_run
/// use taotie::studio::Motion;
///
/// let mut loaded = taotie::load_model("walking.glb")?;
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

/// The default duration of a turn of the turntable, in seconds.
const TURN_SECONDS: f64 = 4.0;

/// Seconds between images of an animation without duration.
const STILL_SECONDS: f64 = 1.0 / 24.0;

/// The images to take, in order.
///
/// ```
/// use taotie::studio::Sequence;
///
/// let turn = Sequence::turntable(36, None, Some(24.0))?;
/// assert_eq!((turn.shots.len(), turn.seconds), (36, 1.5));
/// assert_eq!(Sequence::animation(2.0, Some(4), None)?.times(), [0.0, 0.5, 1.0, 1.5]);
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Sequence {
    /// At least one.
    pub shots: Vec<SequenceFrame>,
    /// The duration as a moving image, seconds.
    pub seconds: f64,
}

/// An image to take.
///
/// ```
/// use std::f64::consts::PI;
/// use taotie::studio::Sequence;
///
/// let turn = Sequence::turntable(4, Some(1.5), None)?;
/// let half = turn.shots[2];
/// assert_eq!((half.turn, half.seconds), (PI, Some(1.5)));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct SequenceFrame {
    /// The rotation of the turntable, radians; see [`super::Viewpoint::at`].
    pub turn: f64,
    /// The time of the animation, seconds; `None` for the model at rest.
    pub seconds: Option<f64>,
}

impl Sequence {
    /// The maximum number of images in a sequence.
    pub const MOST: u32 = 9999;

    /// Makes a single image at a time of the animation in seconds, or of the model at rest.
    pub fn still(time: Option<f64>) -> Self {
        Self { shots: vec![SequenceFrame { turn: 0.0, seconds: time }], seconds: 0.0 }
    }

    /// Makes `count` images around the object at one time of its animation, in seconds, or at rest; at `rate` images
    /// per second, or all of them in four seconds.
    ///
    /// # Errors
    /// [`Error::Invalid`] if `count` is 0 or above [`Sequence::MOST`], or `rate` is not above 0.
    pub fn turntable(count: u32, time: Option<f64>, rate: Option<f64>) -> Result<Self> {
        check(count, rate)?;
        let shots = (0..count).map(|i| SequenceFrame { turn: part_of_turn(i, count), seconds: time });
        let seconds = rate.map_or(TURN_SECONDS, |rate| f64::from(count) / rate);
        Ok(Self { shots: shots.collect(), seconds })
    }

    /// Makes images of an animation that lasts `length` seconds, from its beginning to just before its end: `count`
    /// of them, `rate` per second, or both; one if neither is specified.
    ///
    /// # Errors
    /// [`Error::Invalid`] if `rate` is not above 0, or there are none or more than [`Sequence::MOST`] images.
    pub fn animation(length: f64, count: Option<u32>, rate: Option<f64>) -> Result<Self> {
        let (count, step) = match (count, rate) {
            (None, None) => (1, 0.0),
            (Some(count), Some(rate)) => (count, 1.0 / rate),
            (Some(count), None) if length > 0.0 => (count, length / f64::from(count)),
            (Some(count), None) => (count, STILL_SECONDS),
            (None, Some(rate)) => (needed(length, rate)?, 1.0 / rate),
        };
        check(count, rate)?;
        let shots = (0..count).map(|i| SequenceFrame { turn: 0.0, seconds: Some(f64::from(i) * step) });
        Ok(Self { shots: shots.collect(), seconds: f64::from(count) * step })
    }

    /// Returns the time of the animation in each image, in seconds; none if the model is at rest.
    pub fn times(&self) -> Vec<f64> {
        self.shots.iter().filter_map(|shot| shot.seconds).collect()
    }
}

/// Returns the rotation of a turntable at image `i` of `count`, in radians.
pub(super) fn part_of_turn(i: u32, count: u32) -> f64 {
    TAU * f64::from(i) / f64::from(count)
}

fn check(count: u32, rate: Option<f64>) -> Result<()> {
    if !(1..=Sequence::MOST).contains(&count) {
        return Err(Error::invalid(format!("{count} pictures"), format!("use 1 to {}", Sequence::MOST)));
    }
    match rate.filter(|rate| !(*rate > 0.0 && rate.is_finite())) {
        Some(rate) => Err(Error::invalid(format!("rate {rate}"), "it must be finite and above 0")),
        None => Ok(()),
    }
}

/// Returns the number of images, at a rate, that start before an animation ends.
fn needed(length: f64, rate: f64) -> Result<u32> {
    const MOST: u32 = Sequence::MOST;
    // A length stored in 32 bits may be slightly above a whole number of pictures.
    let count = (length * rate - 1e-4).ceil().max(1.0);
    if count > f64::from(MOST) {
        let why =
            format!("the animation lasts {length} seconds, which is {count} pictures; the maximum is {MOST}");
        return Err(Error::invalid(format!("rate {rate}"), why));
    }
    Ok(count as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(length: f64, count: Option<u32>, rate: Option<f64>) -> Vec<f64> {
        Sequence::animation(length, count, rate).unwrap().times()
    }

    #[test]
    fn turns_are_even_and_last_as_long_as_asked() {
        let turn = Sequence::turntable(4, Some(1.5), None).unwrap();
        assert_eq!(turn.shots[1], SequenceFrame { turn: TAU / 4.0, seconds: Some(1.5) });
        assert_eq!((turn.shots.len(), turn.seconds), (4, TURN_SECONDS));
        assert_eq!(Sequence::turntable(4, None, Some(8.0)).unwrap().seconds, 0.5);
        assert!(Sequence::turntable(0, None, None).is_err());
        assert!(Sequence::turntable(4, None, Some(0.0)).is_err());
    }

    #[test]
    fn animations_begin_at_the_start_and_stop_before_the_end() {
        assert_eq!(times(2.0, Some(4), None), [0.0, 0.5, 1.0, 1.5]);
        assert_eq!(times(1.1, None, Some(4.0)), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(times(f64::from(1.000_000_1f32), None, Some(4.0)).len(), 4);
        assert_eq!(times(9.0, Some(2), Some(4.0)), [0.0, 0.25]);
        assert_eq!(times(0.0, None, Some(4.0)), [0.0]);
        assert_eq!(times(0.0, Some(2), None), [0.0, STILL_SECONDS]);
        assert_eq!(Sequence::animation(2.0, Some(4), None).unwrap().seconds, 2.0);
        assert!(Sequence::animation(11.0, None, Some(1000.0)).is_err());
        assert!(Sequence::animation(1.0, None, Some(f64::NAN)).is_err());
    }
}
