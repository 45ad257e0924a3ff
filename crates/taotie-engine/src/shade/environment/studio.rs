//! A procedural photographer's studio: light for models that have none.

use super::equirect::direction_at;
use crate::image::Image;
use crate::math::{Vec3, scalar};
use crate::parallel;
use std::f64::consts::PI;

/// The version of [`studio`], which is bit-identical as long as this is unchanged.
pub const STUDIO_VERSION: u32 = 1;

/// Width in pixels; the height is half of it.
const WIDTH: u32 = 1024;

/// The factor of all radiance, chosen so that a white matt plane facing +z is about as bright as one under a sky of
/// radiance 0.8.
const EXPOSURE: f64 = 0.502;

/// A lamp: a rectangle facing the centre, soft at its edges.
struct Panel {
    /// The direction of its centre.
    toward: [f64; 3],
    /// The approximate direction of its width.
    right: [f64; 3],
    /// Half its width and height at distance 1.
    half: [f64; 2],
    /// The width of its edges.
    edge: f64,
    /// The radiance at its centre; the edges are dimmer.
    radiance: f64,
}

/// A large key light from the upper left, a fill from the right, a strip overhead and a narrow one from behind; the
/// viewer is at +z.
const PANELS: [Panel; 4] = [
    Panel {
        toward: [-0.66, 0.5, 0.56],
        right: [1.0, 0.0, 1.18],
        half: [0.44, 0.58],
        edge: 0.06,
        radiance: 10.0,
    },
    Panel {
        toward: [0.93, 0.1, 0.36],
        right: [-0.39, 0.0, 1.0],
        half: [0.4, 0.7],
        edge: 0.14,
        radiance: 1.5,
    },
    Panel {
        toward: [0.05, 1.0, -0.28],
        right: [1.0, 0.0, 0.0],
        half: [0.85, 0.13],
        edge: 0.06,
        radiance: 5.0,
    },
    Panel {
        toward: [0.6, 0.34, -0.72],
        right: [-0.72, 0.0, -0.6],
        half: [0.1, 0.6],
        edge: 0.05,
        radiance: 6.0,
    },
];

/// Returns an equirectangular image of the studio, linear and grey, so that lit objects keep their colour.
///
/// Law: its bits are those of [`STUDIO_VERSION`], and its irradiance matches its exposure
/// (`laws::environment::the_studio_*`).
pub fn studio() -> Image {
    let height = WIDTH / 2;
    let mut image = Image::new(WIDTH, height, [1.0; 4]).expect("the size is allowed");
    parallel::pieces(image.pixels_mut(), WIDTH as usize, &|y, row| {
        let cos = scalar::cos((y as f64 + 0.5) / f64::from(height) * PI);
        for (x, pixel) in row.iter_mut().enumerate() {
            let direction = direction_at((x as f64 + 0.5) / f64::from(WIDTH), cos).to_f64();
            let light =
                (room(direction) + PANELS.iter().map(|panel| panel.light(direction)).sum::<f64>()) * EXPOSURE;
            *pixel = [light as f32, light as f32, light as f32, 1.0];
        }
    });
    image
}

/// Grey walls under a lighter ceiling, and a floor that darkens towards the viewer's feet, without visible edges.
fn room(d: Vec3<f64>) -> f64 {
    let wall = 0.2 + 0.14 * smooth(d.y) + 0.04 * d.z;
    let floor = 0.38 - 0.22 * smooth(-1.1 * d.y);
    let t = smooth(0.5 - d.y * 4.0);
    wall + (floor - wall) * t
}

impl Panel {
    fn light(&self, d: Vec3<f64>) -> f64 {
        let toward = Vec3::from_array(self.toward).normalize();
        let up = toward.cross(Vec3::from_array(self.right)).normalize();
        let right = up.cross(toward);
        let along = d.dot(toward);
        if along <= 0.0 {
            return 0.0;
        }
        let [x, y] = [d.dot(right) / along, d.dot(up) / along];
        let [far_x, far_y] = [x / self.half[0], y / self.half[1]];
        let inside = |at: f64, half: f64| smooth((half - at.abs()) / self.edge + 0.5);
        let dimmed = 1.0 - 0.2 * (far_x * far_x + far_y * far_y);
        let mask = inside(x, self.half[0]) * inside(y, self.half[1]);
        if mask > 0.0 { self.radiance * dimmed * mask } else { 0.0 }
    }
}

/// A smooth step from 0 at 0 to 1 at 1.
fn smooth(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
