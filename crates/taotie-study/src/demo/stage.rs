//! Camera, lights and film for the demo's pictures.

use std::path::Path;
use taotie_engine::film::{Development, develop8};
use taotie_engine::image::{Bitmap, Encoding, Image, Texels};
use taotie_engine::math::Vec3;
use taotie_engine::render::{Lighting, RenderSettings, Shot, render};
use taotie_engine::scene::{Camera, Falloff, Light, LightKind, Orbit, Scene, fitting_distance, from_view};
use taotie_engine::{Error, Result};
use taotie_io::FileSet;

/// The background.
const GROUND: f32 = 0.055;

/// Camera and lights for all pictures.
pub struct Stage {
    /// The camera.
    pub camera: Camera,
    /// The lights and the ambient light.
    pub lighting: Lighting,
}

impl Stage {
    /// Creates a stage with a view of the whole vessel.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the scene has no triangles.
    pub fn whole(scene: &Scene) -> Result<Self> {
        Self::whole_in(&[scene])
    }

    /// Creates a stage with a view of the whole vessel in all its poses.
    ///
    /// # Errors
    /// [`Error::Invalid`] if no pose has triangles.
    pub fn whole_in(poses: &[&Scene]) -> Result<Self> {
        let bounds = poses.iter().filter_map(|pose| pose.bounds()).reduce(|a, b| a.united(&b));
        let bounds = bounds.ok_or_else(nothing_to_see)?;
        let mut orbit = orbit([24.0, 15.0], bounds.center());
        orbit.distance = fitting_distance(&orbit, 1.0, 0.92, poses.iter().flat_map(|pose| pose.corners()));
        Ok(Self::new(orbit, bounds.diagonal()))
    }

    /// Creates a stage with a view of the mask on the cup, close enough to distinguish the methods.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the scene has no triangles.
    pub fn cup(scene: &Scene) -> Result<Self> {
        let bounds = scene.bounds().ok_or_else(nothing_to_see)?;
        let low = bounds.min + (bounds.max - bounds.min) * 0.36;
        let high = bounds.min + (bounds.max - bounds.min) * 0.72;
        let middle = Vec3::new(0.0, (low.y + high.y) / 2.0, 0.0);
        let mut orbit = orbit([14.0, 12.0], middle);
        let within = move |p: &Vec3<f64>| (low.y..high.y).contains(&p.y) && p.x.abs() < 0.05;
        orbit.distance = fitting_distance(&orbit, 1.0, 0.96, scene.corners().filter(within));
        Ok(Self::new(orbit, bounds.diagonal()))
    }

    fn new(orbit: Orbit, size: f64) -> Self {
        let camera = orbit.camera(size / 2.0);
        let lighting =
            Lighting { lights: lights(&camera), ambient: Vec3::new(0.20, 0.205, 0.22), environment: None };
        Self { camera, lighting }
    }

    /// Renders a picture of the scene.
    ///
    /// # Errors
    /// Those of [`render`].
    pub fn take(&self, scene: &Scene, settings: &RenderSettings) -> Result<Image> {
        let shot = Shot { camera: &self.camera, lighting: &self.lighting, settings };
        Ok(render(scene, &shot)?.color)
    }

    /// Returns the common settings of all square pictures.
    pub fn settings(side: u32, samples: u32) -> RenderSettings {
        RenderSettings { width: side, height: side, samples, shadows: true, ..RenderSettings::default() }
    }
}

fn nothing_to_see() -> Error {
    Error::invalid("the stage", "the scene has no triangles")
}

/// Returns an orbit that looks at `target` from an azimuth and elevation in degrees.
fn orbit([azimuth, elevation]: [f64; 2], target: Vec3<f64>) -> Orbit {
    let [azimuth, elevation, fov_y] = [azimuth, elevation, 26.0].map(f64::to_radians);
    Orbit { azimuth, elevation, distance: 0.0, target, fov_y }
}

/// Returns a raking key light, a row of softboxes for reflections in the metal, and a rim light.
fn lights(camera: &Camera) -> Vec<Light> {
    let lamps: [([f64; 2], [f32; 3]); 6] = [
        ([-56.0, 36.0], [6.4, 6.0, 5.4]),
        ([-16.0, 64.0], [1.8, 1.8, 1.8]),
        ([30.0, 25.0], [1.1, 1.15, 1.25]),
        ([70.0, 8.0], [1.5, 1.6, 1.8]),
        ([150.0, 38.0], [4.2, 4.2, 4.4]),
        ([-140.0, 20.0], [2.2, 2.1, 1.9]),
    ];
    let light = |([azimuth, elevation], color): ([f64; 2], [f32; 3])| Light {
        name: String::new(),
        kind: LightKind::Directional {
            direction: -from_view(camera, azimuth.to_radians(), elevation.to_radians()),
        },
        color: Vec3::from_array(color),
        falloff: Falloff::None,
    };
    lamps.map(light).into()
}

/// Returns the development settings of all pictures.
pub fn development() -> Development {
    Development { background: Some(Vec3::splat(GROUND)), ..Development::default() }
}

/// Develops a picture to sRGB pixels, row by row from the top.
///
/// # Errors
/// Those of [`develop8`].
pub fn pixels(image: &Image) -> Result<Vec<[u8; 3]>> {
    let pixels = develop8(image, &development())?;
    Ok(pixels.into_iter().map(|[r, g, b, _]| [r, g, b]).collect())
}

/// Develops a picture and writes it as PNG, a file of a set.
///
/// # Errors
/// [`Error::Io`] if it cannot be written.
pub fn write_picture(files: &FileSet, path: &Path, image: &Image) -> Result<()> {
    let texels = Texels::U8(develop8(image, &development())?);
    let bitmap = Bitmap::new(image.width(), image.height(), 3, texels)?;
    files.write_png_bitmap(path, &bitmap, Encoding::Srgb)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_without_triangles_is_an_error() {
        let empty = Scene::default();
        for stage in [Stage::whole(&empty), Stage::cup(&empty), Stage::whole_in(&[])] {
            let message = stage.map(|_| ()).unwrap_err().to_string();
            assert!(message.contains("no triangles"), "{message}");
        }
    }
}
