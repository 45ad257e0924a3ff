//! The kinds of light under which points are measured, and the sky.

use taotie_engine::image::Image;
use taotie_engine::math::Vec3;
use taotie_engine::pixel::{Cone, Falloff, LightSource, Place, Turn};
use taotie_engine::shade::environment::Environment;
use taotie_shader::FrameFactors;

/// A kind of light.
#[derive(Debug, Clone)]
pub struct Lighting {
    pub lights: Vec<LightSource<f32>>,
    /// Ambient radiance, linear RGB.
    pub ambient: Vec3,
    /// The factor of emission.
    pub emission: f32,
    /// The factor of the environment's radiance.
    pub intensity: f32,
    /// The viewer's position and 1, or the direction to the viewer and 0.
    pub eye: [f32; 4],
}

/// The rotation of the environment.
pub const TURN: Turn<f32> = Turn { sin: 0.6, cos: 0.8 };

/// Returns each kind of light separately, and all together: a sun, a lamp with a limited range, a spot, and the sky
/// with ambient light and emission.
pub fn kinds() -> [Lighting; 5] {
    let dark =
        Lighting { lights: Vec::new(), ambient: Vec3::splat(0.0), emission: 0.0, intensity: 0.0, eye: NEAR };
    let of = |light| Lighting { lights: vec![light], ..dark.clone() };
    let [sun, lamp, spot] = lights();
    let sky =
        Lighting { ambient: Vec3::new(0.02, 0.03, 0.04), emission: 0.3, intensity: 0.8, ..dark.clone() };
    let all = Lighting { lights: vec![sun, lamp, spot], eye: FAR, ..sky.clone() };
    [Lighting { eye: FAR, ..of(sun) }, of(lamp), of(spot), sky, all]
}

const NEAR: [f32; 4] = [0.25, -0.5, 4.0, 1.0];
const FAR: [f32; 4] = [0.0, 0.6, 0.8, 0.0];

fn lights() -> [LightSource<f32>; 3] {
    let at = |x, y, z| Place::At(Vec3::new(x, y, z));
    let color = |r, g, b| Vec3::new(r, g, b);
    let cone = Cone { axis: Vec3::new(0.48, -0.6, -0.64), cos_inner: 0.95, cos_outer: 0.6 };
    [
        LightSource {
            color: color(3.0, 2.9, 2.7),
            place: Place::Towards(Vec3::new(-0.48, 0.64, 0.6)),
            falloff: Falloff::None,
            cone: None,
        },
        LightSource {
            color: color(20.0, 24.0, 22.0),
            place: at(2.0, 1.5, 2.5),
            falloff: Falloff::Windowed(9.0),
            cone: None,
        },
        LightSource {
            color: color(40.0, 36.0, 30.0),
            place: at(-1.5, 2.0, 2.0),
            falloff: Falloff::InverseSquare,
            cone: Some(cone),
        },
    ]
}

impl Lighting {
    /// Returns the uniforms of the frame.
    pub fn frame(&self, sky: &Environment) -> FrameFactors {
        let maps = sky.maps();
        FrameFactors {
            clip_from_world: [[0.0; 4]; 4],
            eye: self.eye,
            ambient: self.ambient,
            spacing: 1.0,
            turn: TURN,
            intensity: self.intensity,
            levels: maps.levels.len(),
            smoothest_alpha: maps.smoothest_alpha,
            lights: self.lights.len(),
        }
    }
}

/// Returns a sky with a soft sun.
pub fn sky() -> Environment {
    let mut image = Image::new(128, 64, [1.0; 4]).expect("the size is valid");
    for (i, pixel) in image.pixels_mut().iter_mut().enumerate() {
        let (u, v) = ((i % 128) as f32 / 128.0, (i / 128) as f32 / 64.0);
        let (across, down) = (u - 0.7, v - 0.3);
        let sun = 6.0 / (1.0 + 80.0 * (across * across + down * down));
        *pixel = [0.3 + sun, 0.4 + 0.3 * (1.0 - v) + sun, 0.5 + 0.5 * (1.0 - v) + sun, 1.0];
    }
    Environment::new(image).expect("the picture is valid")
}
