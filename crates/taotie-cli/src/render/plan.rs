//! Which pictures a run takes: one, those of a turn, or those of an animation.

use crate::options;
use anyhow::{Result, bail};
use clap::Args;
use std::f64::consts::TAU;

/// The most pictures of a run.
const MOST: u32 = 9999;

/// How long a turn of the turntable lasts where no rate is asked for, seconds.
const TURN_SECONDS: f64 = 4.0;

/// Seconds between pictures of an animation that has no length.
const STILL_SECONDS: f64 = 1.0 / 24.0;

/// What moves, and how many pictures are taken of it.
#[derive(Args)]
#[command(next_help_heading = "Motion")]
pub struct MotionArgs {
    /// Writes N pictures around the object, numbered, and OUT as a moving picture of them
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST)))]
    pub turntable: Option<u32>,
    /// An animation of the file by name, or by number from 0; the first if not given
    #[arg(long, value_name = "NAME|N")]
    pub animation: Option<String>,
    /// The model at this time of its animation, in seconds
    #[arg(long, value_name = "SECONDS", value_parser = options::number, allow_negative_numbers = true, conflicts_with = "frames")]
    pub time: Option<f64>,
    /// Writes N pictures from the beginning of the animation to just before its end, numbered, and OUT as a moving
    /// picture of them
    #[arg(long, value_name = "N", conflicts_with = "turntable", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST)))]
    pub frames: Option<u32>,
    /// Pictures a second; without --frames and --turntable as many as the animation needs
    #[arg(long, value_name = "RATE", value_parser = options::number)]
    pub fps: Option<f64>,
}

/// The pictures of a run, in order.
#[derive(Debug, PartialEq)]
pub struct Plan {
    /// At least one.
    pub shots: Vec<Shot>,
    /// How long they last as a moving picture.
    pub seconds: f64,
}

/// A picture to be taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shot {
    /// How far the turntable has turned, radians.
    pub turn: f64,
    /// The time of the animation; `None` for the model at rest.
    pub seconds: Option<f64>,
}

impl MotionArgs {
    /// What can be refused before any work is done.
    pub fn check(&self) -> Result<()> {
        if self.fps.is_some_and(|fps| !(fps > 0.0 && fps <= 1000.0)) {
            bail!("--fps: the rate must lie above 0 and be 1000 at most");
        }
        if self.time.is_some() && self.fps.is_some() && self.turntable.is_none() {
            bail!("--fps: the picture at one --time has no rate; leave one of the two out");
        }
        if self.animation.is_some() && !self.animates() {
            bail!("--animation: say when, by --time SECONDS, or all of it, by --frames N or --fps RATE");
        }
        Ok(())
    }

    /// Whether a moment of an animation is wanted, and not only the model at rest.
    pub fn animates(&self) -> bool {
        self.time.is_some() || self.frames.is_some() || (self.fps.is_some() && self.turntable.is_none())
    }

    /// Whether a moving picture comes of it.
    pub fn takes_several(&self) -> bool {
        self.turntable.is_some() || self.frames.is_some() || self.fps.is_some()
    }

    /// The pictures, given how many seconds the animation lasts; without one that is not read.
    pub fn plan(&self, length: f64) -> Result<Plan> {
        let still = |turn| Shot { turn, seconds: self.time };
        if let Some(count) = self.turntable {
            let turn = |i| TAU * f64::from(i) / f64::from(count);
            let seconds = self.fps.map_or(TURN_SECONDS, |fps| f64::from(count) / fps);
            return Ok(Plan { shots: (0..count).map(|i| still(turn(i))).collect(), seconds });
        }
        let (count, step) = match (self.frames, self.fps) {
            (None, None) => return Ok(Plan { shots: vec![still(0.0)], seconds: 0.0 }),
            (Some(count), Some(fps)) => (count, 1.0 / fps),
            (Some(count), None) if length > 0.0 => (count, length / f64::from(count)),
            (Some(count), None) => (count, STILL_SECONDS),
            (None, Some(fps)) => (needed(length, fps)?, 1.0 / fps),
        };
        let shots = (0..count).map(|i| Shot { turn: 0.0, seconds: Some(f64::from(i) * step) });
        Ok(Plan { shots: shots.collect(), seconds: f64::from(count) * step })
    }
}

impl Plan {
    /// The time of the animation in each picture, seconds; none where the model is at rest.
    pub fn times(&self) -> Vec<f64> {
        self.shots.iter().filter_map(|shot| shot.seconds).collect()
    }
}

/// How many pictures at a rate begin before an animation ends.
fn needed(length: f64, fps: f64) -> Result<u32> {
    // A length that is stored in 32 bits may lie a hair above a whole number of pictures.
    let count = (length * fps - 1e-4).ceil().max(1.0);
    if count > f64::from(MOST) {
        bail!("--fps {fps}: the animation lasts {length} seconds, which is {count} pictures; {MOST} at most");
    }
    Ok(count as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: MotionArgs =
        MotionArgs { turntable: None, animation: None, time: None, frames: None, fps: None };

    fn times(args: &MotionArgs, length: f64) -> Vec<f64> {
        args.plan(length).unwrap().shots.iter().map(|shot| shot.seconds.unwrap()).collect()
    }

    #[test]
    fn a_picture_at_rest_and_one_at_a_time() {
        let shot = |seconds| Plan { shots: vec![Shot { turn: 0.0, seconds }], seconds: 0.0 };
        assert_eq!(NONE.plan(0.0).unwrap(), shot(None));
        assert_eq!(MotionArgs { time: Some(0.5), ..NONE }.plan(2.0).unwrap(), shot(Some(0.5)));
    }

    #[test]
    fn turns_are_even_and_last_as_long_as_asked() {
        let turn = MotionArgs { turntable: Some(4), time: Some(1.5), ..NONE };
        let plan = turn.plan(2.0).unwrap();
        let quarter = TAU / 4.0;
        assert_eq!(plan.shots[1], Shot { turn: quarter, seconds: Some(1.5) });
        assert_eq!((plan.shots.len(), plan.seconds), (4, TURN_SECONDS));
        assert_eq!(MotionArgs { fps: Some(8.0), ..turn }.plan(2.0).unwrap().seconds, 0.5);
    }

    #[test]
    fn animations_begin_at_the_start_and_stop_before_the_end() {
        assert_eq!(times(&MotionArgs { frames: Some(4), ..NONE }, 2.0), [0.0, 0.5, 1.0, 1.5]);
        assert_eq!(times(&MotionArgs { fps: Some(4.0), ..NONE }, 1.1), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(times(&MotionArgs { fps: Some(4.0), ..NONE }, f64::from(1.000_000_1f32)).len(), 4);
        assert_eq!(times(&MotionArgs { fps: Some(4.0), frames: Some(2), ..NONE }, 9.0), [0.0, 0.25]);
        assert_eq!(times(&MotionArgs { fps: Some(4.0), ..NONE }, 0.0), [0.0]);
        assert_eq!(times(&MotionArgs { frames: Some(2), ..NONE }, 0.0), [0.0, STILL_SECONDS]);
        assert_eq!(MotionArgs { frames: Some(4), ..NONE }.plan(2.0).unwrap().seconds, 2.0);
        assert!(MotionArgs { fps: Some(1000.0), ..NONE }.plan(11.0).is_err());
    }
}
