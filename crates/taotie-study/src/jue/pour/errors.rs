//! The normal errors of a low-poly vessel compared with the ground truth, at rest and poured.

use super::pouring::Pouring;
use super::rig::POURED;
use super::truth::Truth;
use rayon::prelude::*;
use taotie_engine::compare::{Summary, angular_error};
use taotie_engine::image::Image;
use taotie_engine::math::Vec2;
use taotie_engine::render::{Aovs, Lighting, RenderSettings, Shot, render};
use taotie_engine::scene::{Camera, Scene};
use taotie_engine::{Error, Result};

/// The measurement rule in words.
pub const RULE: &str = "angle between the rendered normal and that of the displaced mesh under the same skin at the \
    same uv, with its normal taken from the moved surface; over the pixels of triangles whose corners all move by \
    at least a millimetre, seen by a camera that moves with the cup, so that the same surface is seen at rest and \
    poured";

/// Corners that move less count as stationary, metres.
const MOVED: f32 = 0.001;

/// The camera for looking at normals.
#[derive(Debug, Clone)]
pub struct Eye {
    /// The camera at rest; it moves with the cup.
    pub camera: Camera,
    /// The side of the picture, pixels.
    pub side: u32,
}

/// Returns the angular errors of a vessel with a normal map, at rest and poured, degrees; [`RULE`] states which
/// pixels count. `truths` are those of the two moments.
///
/// # Errors
/// [`Error::Invalid`] if the camera sees nothing that moves.
pub fn angular_errors(vessel: &mut Pouring, truths: &[Truth; 2], eye: &Eye) -> Result<[Summary; 2]> {
    let moved = moved(vessel)?;
    let mut error_at = |seconds: f64, truth: &Truth| {
        let seen = vessel.seen_from(eye, seconds)?;
        let of_interest = |pixel: &[f32; 4]| pixel[3] > 0.0 && moved[pixel[0] as usize];
        let keep: Vec<bool> = seen.triangle.pixels().iter().map(of_interest).collect();
        let error = angular_error(&seen.normals, &normals_of(truth, &seen))?.within(&keep)?.summary();
        error.ok_or_else(nothing_seen)
    };
    Ok([error_at(0.0, &truths[0])?, error_at(POURED, &truths[1])?])
}

fn nothing_seen() -> Error {
    Error::invalid("angular errors", "the camera sees nothing that moves")
}

/// Returns for each triangle of the low mesh whether it moves.
fn moved(vessel: &mut Pouring) -> Result<Vec<bool>> {
    let mesh = |scene: &Scene| scene.meshes()[0].clone();
    let (rest, poured) = (mesh(vessel.at(0.0)?), mesh(vessel.at(POURED)?));
    let moves = |t: usize| {
        let mut pairs = rest.corners(t).into_iter().zip(poured.corners(t));
        pairs.all(|(p, q)| (q - p).length() >= MOVED)
    };
    Ok((0..rest.triangles().len()).map(moves).collect())
}

impl Pouring {
    /// Renders the view of a camera that moves with the cup, at a moment.
    fn seen_from(&mut self, eye: &Eye, seconds: f64) -> Result<Aovs> {
        let mut camera = eye.camera.clone();
        camera.world_from_view = self.motion(seconds)? * camera.world_from_view;
        let (width, height) = (eye.side, eye.side);
        let settings = RenderSettings { width, height, samples: 1, aovs: true, ..RenderSettings::default() };
        let lighting = Lighting::default();
        let shot = Shot { camera: &camera, lighting: &lighting, settings: &settings };
        let frame = render(self.at(seconds)?, &shot)?;
        frame.aovs.ok_or_else(nothing_seen)
    }
}

/// Returns the normals of the ground truth at the visible uvs.
fn normals_of(truth: &Truth, seen: &Aovs) -> Image {
    let mut normals = seen.uv.clone();
    normals.pixels_mut().par_iter_mut().for_each(|pixel| {
        let [u, v, _, covered] = *pixel;
        let found = (covered > 0.0).then(|| truth.normal(Vec2::new(u, v))).flatten();
        *pixel = found.map_or([0.0; 4], |n| [n.x, n.y, n.z, 1.0]);
    });
    normals
}
