//! Where the picture is taken from.

use super::{CameraArgs, Motion};
use anyhow::{Result, bail};
use std::f64::consts::TAU;
use taotie::math::{Mat4, Vec3};
use taotie::scene::{Bounds, Camera, Orbit, Scene, fitting_distance};

/// Directions from which a turntable's object must fit.
const TURNS: u32 = 24;

/// How much of the picture a framed object fills.
const FILL: f64 = 0.9;

/// Where a model is looked at from if nothing is said, degrees: a little from the side and from above.
const DEFAULT_ORBIT: [f64; 2] = [25.0, 15.0];

/// A camera that can be turned about the vertical through its target.
pub struct Viewpoint {
    camera: Camera,
    pivot: Vec3<f64>,
}

impl Viewpoint {
    /// The camera asked for: one of the file by name, an orbit, else the object framed.
    pub fn choose(args: &CameraArgs, framing: Framing, scene: &Scene) -> Result<Self> {
        let Some(bounds) = scene.bounds() else { bail!("the model has no triangle to look at") };
        let named = args.camera.as_ref().map(|name| named(scene, name)).transpose()?;
        Self::around(args, named, bounds, |orbit| Ok(framing.distance(scene, orbit)))
    }

    /// As [`Viewpoint::choose`], framing all that the object fills in the course of its motion, so that no picture of it
    /// is seen from elsewhere than another. Leaves the scene at the end of the motion.
    pub fn choose_moving(
        args: &CameraArgs,
        framing: Framing,
        scene: &mut Scene,
        motion: &Motion,
    ) -> Result<Self> {
        let mut all: Option<Bounds> = None;
        motion.tour(scene, |posed| all = united(all, posed.bounds()))?;
        let Some(bounds) = all else { bail!("the model has no triangle to look at") };
        let named = args.camera.as_ref().map(|name| named(scene, name)).transpose()?;
        Self::around(args, named, bounds, |orbit| {
            let mut distance = 0.0;
            motion.tour(scene, |posed| distance = framing.distance(posed, orbit).max(distance))?;
            Ok(distance)
        })
    }

    /// The camera `named`, else an orbit about `bounds`, by default at the distance that `fit` finds.
    fn around(
        args: &CameraArgs,
        named: Option<Camera>,
        bounds: Bounds,
        fit: impl FnOnce(&Orbit) -> Result<f64>,
    ) -> Result<Self> {
        let pivot = args.target.unwrap_or(bounds.center());
        if let Some(camera) = named {
            return Ok(Self { camera, pivot });
        }
        let (azimuth, elevation, distance) = match args.orbit.as_deref() {
            None => (DEFAULT_ORBIT[0], DEFAULT_ORBIT[1], None),
            Some([azimuth, elevation]) => (*azimuth, *elevation, None),
            Some([azimuth, elevation, distance]) if *distance > 0.0 => {
                (*azimuth, *elevation, Some(*distance))
            }
            Some(_) => bail!(
                "--orbit: write AZIMUTH,ELEVATION or AZIMUTH,ELEVATION,DISTANCE with a distance above 0"
            ),
        };
        let [azimuth, elevation, fov_y] = [azimuth, elevation, args.fov_deg].map(f64::to_radians);
        let mut orbit = Orbit { azimuth, elevation, distance: 0.0, target: pivot, fov_y };
        orbit.distance = distance.map_or_else(|| fit(&orbit), Ok)?;
        let reach = bounds.diagonal() / 2.0 + (pivot - bounds.center()).length();
        Ok(Self { camera: orbit.camera(reach), pivot })
    }

    /// Goes with a camera of the file that moves, where such a one was asked for.
    pub fn follow(&mut self, args: &CameraArgs, scene: &Scene) -> Result<()> {
        if let Some(name) = &args.camera {
            self.camera = named(scene, name)?;
        }
        Ok(())
    }

    /// The camera after the object has turned by `turn` radians, as if it stood on a turntable.
    pub fn camera(&self, turn: f64) -> Camera {
        let mut camera = self.camera.clone();
        camera.world_from_view = self.turned(turn) * camera.world_from_view;
        camera
    }

    /// What fixes things to the camera while the object turns.
    pub fn turned(&self, turn: f64) -> Mat4 {
        let up = Vec3::new(0.0, 1.0, 0.0);
        Mat4::translation(self.pivot) * Mat4::rotation_about(up, -turn) * Mat4::translation(-self.pivot)
    }
}

/// What of the object has to fit into the picture.
#[derive(Debug, Clone, Copy)]
pub struct Framing {
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    /// Whether the object must fit wherever a turntable has turned it to, so that the picture does not jump.
    pub all_around: bool,
}

impl Framing {
    fn distance(self, scene: &Scene, orbit: &Orbit) -> f64 {
        let aspect = f64::from(self.size[0]) / f64::from(self.size[1]);
        let turns = if self.all_around { TURNS } else { 1 };
        let around = (0..turns).map(|i| TAU * f64::from(i) / f64::from(turns));
        let distances = around.map(|turn| {
            let turned = Orbit { azimuth: orbit.azimuth + turn, ..*orbit };
            fitting_distance(&turned, aspect, FILL, scene.corners())
        });
        distances.fold(0.0, f64::max)
    }
}

fn united(a: Option<Bounds>, b: Option<Bounds>) -> Option<Bounds> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.united(&b)),
        (one, other) => one.or(other),
    }
}

fn named(scene: &Scene, name: &str) -> Result<Camera> {
    if let Some(camera) = scene.cameras().iter().find(|camera| camera.name == name) {
        return Ok(camera.clone());
    }
    // Nameless cameras can be chosen by number.
    if let Some(camera) = name.parse::<usize>().ok().and_then(|index| scene.cameras().get(index)) {
        return Ok(camera.clone());
    }
    let names: Vec<String> = scene
        .cameras()
        .iter()
        .enumerate()
        .map(|(i, c)| if c.name.is_empty() { i.to_string() } else { c.name.clone() })
        .collect();
    match names.is_empty() {
        true => bail!("--camera {name}: the file has no camera; use --orbit"),
        false => bail!("--camera {name}: the file has no such camera; it has: {}", names.join(", ")),
    }
}
