//! The environment as background.

use super::rays::CameraRays;
use super::settings::{EnvironmentLight, Shot};
use crate::image::Image;
use crate::parallel;
use crate::pixel::Turn;
use crate::raster::{TILE_SIZE, Tile};

/// Composites the shot's environment, if it is visible, below an image with premultiplied alpha, linear RGB: the last
/// step of a renderer that only draws surfaces. `image` has the size of the shot.
pub fn fill_backdrop(image: &mut Image, shot: &Shot<'_>) {
    let (width, height) = (image.width(), image.height());
    let rays = CameraRays::new(shot.camera, [width, height]);
    let Some(backdrop) = Backdrop::new(shot.lighting.environment.as_ref(), rays) else { return };
    parallel::pieces(image.pixels_mut(), width as usize, &|y, row| {
        row.iter_mut().zip(0..).for_each(|(pixel, x)| backdrop.lay_under(pixel, [x, y as u32]));
    });
}

/// A visible environment, seen from a camera.
pub(super) struct Backdrop {
    light: EnvironmentLight,
    turn: Turn<f32>,
    rays: CameraRays,
}

impl Backdrop {
    /// Creates the backdrop; `None` if nothing is visible.
    pub(super) fn new(light: Option<&EnvironmentLight>, rays: CameraRays) -> Option<Self> {
        light.filter(|light| light.visible).map(|light| Self {
            light: light.clone(),
            turn: light.turn(),
            rays,
        })
    }

    /// Composites the environment below the premultiplied pixels of a tile, as seen through the centre of each pixel.
    pub(super) fn fill(&self, tile: &Tile, color: &mut [[f32; 4]]) {
        for y in 0..tile.height {
            for x in 0..tile.width {
                let pixel = &mut color[(y * TILE_SIZE + x) as usize];
                self.lay_under(pixel, [tile.x + x, tile.y + y]);
            }
        }
    }

    /// Composites the environment below the pixel in column and row `at`.
    fn lay_under(&self, pixel: &mut [f32; 4], at: [u32; 2]) {
        let uncovered = (1.0 - pixel[3]).max(0.0);
        if uncovered == 0.0 {
            return;
        }
        let middle = at.map(|i| f64::from(i) + 0.5);
        let direction = self.turn.to_environment(self.rays.through(middle).direction);
        let radiance = self.light.environment.radiance(direction) * (self.light.intensity * uncovered);
        let [r, g, b] = radiance.to_array();
        *pixel = [pixel[0] + r, pixel[1] + g, pixel[2] + b, 1.0];
    }
}
