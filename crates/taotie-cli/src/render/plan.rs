//! The pictures of a run: one, those of a turntable, or those of an animation.

use crate::options;
use anyhow::{Result, bail};
use clap::Args;
use std::path::Path;
use taotie::studio::{Motion, Sequence};
use taotie_engine::scene::animation::Rig;

/// The motion of the object or camera, and the number of pictures.
#[derive(Args)]
#[command(next_help_heading = "Motion")]
pub struct MotionArgs {
    /// Write N numbered pictures around the object, and OUT as an animation of them
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(Sequence::MOST)))]
    pub turntable: Option<u32>,
    /// An animation of the file by name, or by number from 0 [default: the first]
    #[arg(long, value_name = "NAME|N")]
    pub animation: Option<String>,
    /// Time of the animation to show, seconds
    #[arg(long, value_name = "SECONDS", value_parser = options::number, allow_negative_numbers = true, conflicts_with = "frames")]
    pub time: Option<f64>,
    /// Write N numbered pictures from the beginning of the animation to just before its end, and OUT as an animation
    /// of them
    #[arg(long, value_name = "N", conflicts_with = "turntable", value_parser = clap::value_parser!(u32).range(1..=i64::from(Sequence::MOST)))]
    pub frames: Option<u32>,
    /// Pictures per second; without --frames and --turntable the whole animation is written at this rate
    #[arg(long, value_name = "RATE", value_parser = options::number)]
    pub fps: Option<f64>,
}

impl MotionArgs {
    /// Rejects options that cannot work together, before any work is done.
    pub fn check(&self) -> Result<()> {
        if self.fps.is_some_and(|fps| !(fps > 0.0 && fps <= 1000.0)) {
            bail!("--fps: the rate must be above 0 and at most 1000");
        }
        if self.time.is_some() && self.fps.is_some() && self.turntable.is_none() {
            bail!("--fps: a single picture at --time has no rate; leave one of the two out");
        }
        if self.animation.is_some() && !self.animates() {
            bail!(
                "--animation: choose a moment with --time SECONDS, or all of it with --frames N or --fps RATE"
            );
        }
        Ok(())
    }

    /// Returns true if a moment of an animation is wanted, not the model at rest.
    pub fn animates(&self) -> bool {
        self.time.is_some() || self.frames.is_some() || (self.fps.is_some() && self.turntable.is_none())
    }

    /// Returns true if several pictures are rendered.
    pub fn takes_several(&self) -> bool {
        self.turntable.is_some() || self.frames.is_some() || self.fps.is_some()
    }

    /// Returns the requested animation of `model`, by default the first.
    ///
    /// # Errors
    /// If there is none, or none with that name; the text lists the existing ones.
    pub fn choose(&self, rig: Option<Rig>, model: &Path) -> Result<Motion> {
        if rig.as_ref().is_none_or(|rig| rig.animations().is_empty()) {
            let path = model.display();
            bail!("{path}: the file has no animation; leave out --animation, --time, --frames and --fps");
        }
        let name = self.animation.as_deref();
        let option = format!("--animation {}", name.unwrap_or_default());
        Motion::choose(rig, name).map_err(|error| options::under(option, error))
    }

    /// Returns the pictures; `length` is the length of the animation in seconds, unused without one.
    pub fn plan(&self, length: f64) -> Result<Sequence> {
        if let Some(count) = self.turntable {
            return Ok(Sequence::turntable(count, self.time, self.fps)?);
        }
        if self.frames.is_none() && self.fps.is_none() {
            return Ok(Sequence::still(self.time));
        }
        let option = format!("--fps {}", self.fps.unwrap_or_default());
        Sequence::animation(length, self.frames, self.fps).map_err(|error| options::under(option, error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: MotionArgs =
        MotionArgs { turntable: None, animation: None, time: None, frames: None, fps: None };

    #[test]
    fn one_picture_a_turn_or_an_animation() {
        let still = MotionArgs { time: Some(0.5), ..NONE };
        assert_eq!(still.plan(2.0).unwrap(), Sequence::still(Some(0.5)));
        let turn = MotionArgs { turntable: Some(4), fps: Some(8.0), ..still };
        assert_eq!(turn.plan(2.0).unwrap(), Sequence::turntable(4, Some(0.5), Some(8.0)).unwrap());
        let frames = MotionArgs { frames: Some(4), ..NONE };
        assert_eq!(frames.plan(2.0).unwrap(), Sequence::animation(2.0, Some(4), None).unwrap());
        let many = MotionArgs { fps: Some(1000.0), ..NONE };
        let why = many.plan(11.0).unwrap_err().to_string();
        assert_eq!(
            why,
            "--fps 1000: the animation lasts 11 seconds, which is 11000 pictures; the maximum is 9999"
        );
    }
}
