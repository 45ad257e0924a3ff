//! The viewpoint of a picture; errors name the option that requested it.

use super::CameraArgs;
use crate::options;
use anyhow::{Error, Result, bail};
use taotie::studio::{self, Framing, Motion, View};
use taotie_engine::scene::{Camera, Scene};

/// A camera that can be turned about the vertical through its target.
pub struct Viewpoint(studio::Viewpoint);

impl Viewpoint {
    /// Chooses the requested camera: one of the file by name, an orbit, otherwise one that frames the object.
    pub fn choose(args: &CameraArgs, framing: Framing, scene: &Scene) -> Result<Self> {
        check(args, scene)?;
        let chosen = studio::Viewpoint::choose(&args.options()?, framing, scene);
        chosen.map(Self).map_err(|error| of_option(args, error))
    }

    /// Like [`Viewpoint::choose`], but frames the whole extent of the object's motion.
    pub fn choose_moving(
        args: &CameraArgs,
        framing: Framing,
        scene: &mut Scene,
        motion: &Motion,
    ) -> Result<Self> {
        check(args, scene)?;
        let chosen = studio::Viewpoint::choose_moving(&args.options()?, framing, scene, motion);
        chosen.map(Self).map_err(|error| of_option(args, error))
    }

    /// Follows a moving camera of the file, if one was requested.
    pub fn follow(&mut self, args: &CameraArgs, scene: &Scene) -> Result<()> {
        self.0.follow(&args.options()?, scene).map_err(|error| of_option(args, error))
    }

    /// Returns the view after the object has turned by `turn` radians, as on a turntable.
    pub fn at(&self, turn: f64) -> View<'_> {
        self.0.at(turn)
    }

    /// Returns the camera after the object has turned by `turn` radians.
    pub fn camera(&self, turn: f64) -> Camera {
        self.at(turn).camera()
    }
}

fn check(args: &CameraArgs, scene: &Scene) -> Result<()> {
    if scene.triangle_count() == 0 {
        bail!("the model has no triangles to look at");
    }
    match &args.camera {
        Some(name) if scene.cameras().is_empty() => {
            bail!("--camera {name}: the file has no camera; use --orbit")
        }
        _ => Ok(()),
    }
}

fn of_option(args: &CameraArgs, error: taotie_engine::Error) -> Error {
    match &args.camera {
        Some(name) => options::under(format_args!("--camera {name}"), error),
        None => error.into(),
    }
}
