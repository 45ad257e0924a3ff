//! Renders a model from all sides: `cargo run --release --example turntable -- model.glb turn 36`.
//!
//! Without a model, a sphere rotates. The images are `turn.000.png`, `turn.001.png` and so on.

use std::path::{Path, PathBuf};
use taotie::studio::{CameraOptions, Framing, LightOptions, Viewpoint};
use taotie_engine::film::Development;
use taotie_engine::mesh::Mesh;
use taotie_engine::render::{RenderSettings, Renderer, Shot};
use taotie_engine::scene::{Material, Scene};
use taotie_engine::{Progress, Result};
use taotie_io::ImageFormat;

/// Renders `count` images, `size` pixels wide and high; returns their files.
pub fn turntable(scene: &Scene, count: u32, size: u32, output: &Path) -> Result<Vec<PathBuf>> {
    let framing = Framing { size: [size; 2], all_around: true };
    let viewpoint = Viewpoint::choose(&CameraOptions::default(), framing, scene)?;
    let settings = RenderSettings { width: size, height: size, ..RenderSettings::default() };
    let mut renderer = Renderer::new(scene.clone(), &settings.surface)?;
    let pictures = viewpoint.turn(count).enumerate().map(|(index, view)| {
        let lighting = LightOptions::default().lighting(None, scene, view);
        let shot = Shot { camera: &view.camera(), lighting: &lighting, settings: &settings };
        let frame = renderer.render(&shot, Progress::SILENT)?;
        let path = output.with_extension(format!("{index:03}.png"));
        taotie_io::write_image(&path, &frame.color, &Development::default(), ImageFormat::Png8)?;
        Ok(path)
    });
    pictures.collect()
}

/// Reads the arguments: a model, the folder of the images, and their number.
pub fn main() -> Result<()> {
    let [model, output, count] = [1, 2, 3].map(|place| std::env::args().nth(place));
    let scene = match model {
        Some(model) => taotie_io::load_model(model.as_ref())?.scene,
        None => Scene::of_mesh(Mesh::sphere(1.0, 96, 48), Material::default())?,
    };
    let count = count.and_then(|count| count.parse().ok()).unwrap_or(12);
    turntable(&scene, count, 512, output.as_deref().unwrap_or("turn").as_ref()).map(drop)
}
