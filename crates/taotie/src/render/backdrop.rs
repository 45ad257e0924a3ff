//! The environment where nothing stands before it.

use super::rays::CameraRays;
use super::settings::EnvironmentLight;
use crate::raster::{TILE_SIZE, Tile};

/// An environment that is seen, from a camera.
pub(super) struct Backdrop {
    light: EnvironmentLight,
    rays: CameraRays,
}

impl Backdrop {
    /// Makes the backdrop; `None` where there is nothing to be seen.
    pub(super) fn new(light: Option<&EnvironmentLight>, rays: CameraRays) -> Option<Self> {
        light.filter(|light| light.visible).map(|light| Self { light: light.clone(), rays })
    }

    /// Lays the environment under the premultiplied pixels of a tile, as the middle of each pixel sees it.
    pub(super) fn fill(&self, tile: &Tile, color: &mut [[f32; 4]]) {
        let turn = self.light.turn();
        for y in 0..tile.height {
            for x in 0..tile.width {
                let pixel = &mut color[(y * TILE_SIZE + x) as usize];
                let uncovered = (1.0 - pixel[3]).max(0.0);
                if uncovered == 0.0 {
                    continue;
                }
                let at = [tile.x + x, tile.y + y].map(|i| f64::from(i) + 0.5);
                let direction = turn.to_environment(self.rays.through(at).direction);
                let radiance =
                    self.light.environment.radiance(direction) * (self.light.intensity * uncovered);
                let [r, g, b] = radiance.to_array();
                *pixel = [pixel[0] + r, pixel[1] + g, pixel[2] + b, 1.0];
            }
        }
    }
}
