//! Views for renderers to show.
use super::scenes;
use std::path::Path;
use std::sync::Arc;
use taotie_engine::Progress;
use taotie_engine::film::{Development, develop8};
use taotie_engine::image::{Encoding, Image};
use taotie_engine::math::Vec3;
use taotie_engine::render::{
    EnvironmentLight, Frame, Lighting, Prepared, ReferenceSettings, RenderSettings, Shot, reference,
};
use taotie_engine::scene::{Camera, Scene};
use taotie_engine::shade::environment::Environment;
use taotie_io::{PngColor, PngImage, PngSamples, write_png};

/// A scene with the settings to render it, for both renderers.
pub struct View {
    pub scene: Scene,
    pub camera: Camera,
    pub lighting: Lighting,
    pub settings: RenderSettings,
}

impl View {
    /// Returns a small picture under raking light with shadows.
    pub fn of(scene: Scene, camera: Camera) -> Self {
        let lights = vec![scenes::directional(Vec3::new(0.9, -0.5, -0.6), 3.0)];
        let lighting = Lighting { lights, ambient: Vec3::splat(0.08), environment: None };
        let settings = RenderSettings {
            width: 160,
            height: 120,
            samples: 16,
            shadows: true,
            specular_aa: false,
            ..RenderSettings::default()
        };
        Self { scene, camera, lighting, settings }
    }

    pub fn traced(&self, tracing: &ReferenceSettings) -> Frame {
        let prepared = Prepared::new(self.scene.clone(), &self.settings.surface).unwrap();
        reference(&prepared, &self.shot(), tracing, Progress::SILENT).unwrap()
    }

    pub fn shot(&self) -> Shot<'_> {
        Shot { camera: &self.camera, lighting: &self.lighting, settings: &self.settings }
    }
}

impl View {
    /// Returns a small picture lit only by an environment.
    pub fn under(sky: EnvironmentLight, scene: Scene, camera: Camera) -> Self {
        let mut view = Self::of(scene, camera);
        view.lighting = Lighting { environment: Some(sky), ..Lighting::default() };
        view
    }
}

/// Returns a visible environment from its picture. It takes a while to create; clones share it.
pub fn environment_of(sky: Image) -> EnvironmentLight {
    let environment = Arc::new(Environment::new(sky).unwrap());
    EnvironmentLight { environment, rotation: 0.0, intensity: 1.0, visible: true }
}

fn developed(image: &Image) -> Vec<[u8; 4]> {
    let development = Development { background: Some(Vec3::splat(0.03)), ..Development::default() };
    develop8(image, &development).unwrap()
}

/// Returns the mean absolute difference of developed pictures, in codes of 255.
pub fn difference(a: &Image, b: &Image) -> f64 {
    let (a, b) = (developed(a), developed(b));
    let sum: u64 = a
        .iter()
        .zip(&b)
        .flat_map(|(a, b)| (0..3).map(|c| u64::from(a[c].abs_diff(b[c]))).collect::<Vec<_>>())
        .sum();
    sum as f64 / (3 * a.len()) as f64
}

/// Writes a picture to the folder that `TAOTIE_LOOK` names, if it does.
pub fn keep_to_look_at(name: &str, image: &Image) {
    let Some(folder) = std::env::var_os("TAOTIE_LOOK") else { return };
    let pixels: Vec<u8> = developed(image).iter().flat_map(|p| p[..3].to_vec()).collect();
    let (width, height, samples) = (image.width(), image.height(), PngSamples::U8(&pixels));
    let png = PngImage { width, height, color: PngColor::Rgb, samples, encoding: Encoding::Srgb };
    write_png(&Path::new(&folder).join(format!("{name}.png")), &png).unwrap();
}

/// Returns the means of squares of `side` × `side` pixels.
pub fn coarse(image: &Image, side: u32) -> Image {
    let (width, height) = (image.width() / side, image.height() / side);
    let mut means = Image::new(width, height, [0.0; 4]).unwrap();
    for (i, mean) in means.pixels_mut().iter_mut().enumerate() {
        let (x, y) = (i as u32 % width * side, i as u32 / width * side);
        for pixel in (0..side * side).map(|k| image.pixel(x + k % side, y + k / side)) {
            for (mean, value) in mean.iter_mut().zip(pixel) {
                *mean += value / (side * side) as f32;
            }
        }
    }
    means
}
