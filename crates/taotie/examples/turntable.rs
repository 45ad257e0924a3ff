//! Renders a model from all sides: `cargo run --release --example turntable -- model.glb turn 36`.
//!
//! Without a model, a sphere rotates. The images are `turn.000.png`, `turn.001.png` and so on.

use std::path::{Path, PathBuf};
use taotie::{Material, Mesh, Picture, RenderSettings, Result, Scene};
use taotie_engine::image::Encoding;

/// Renders `count` images, `size` pixels wide and high; returns their files.
pub fn turntable(scene: Scene, count: u32, size: u32, output: &Path) -> Result<Vec<PathBuf>> {
    let settings = RenderSettings { width: size, height: size, ..RenderSettings::default() };
    let picture = Picture { settings, ..Picture::default() };
    let mut files = Vec::new();
    picture.turntable(scene, count, |bitmap| {
        let path = output.with_extension(format!("{:03}.png", files.len()));
        taotie_io::write_png_bitmap(&path, &bitmap, Encoding::Srgb)?;
        files.push(path);
        Ok(())
    })?;
    Ok(files)
}

/// Reads the arguments: a model, the folder of the images, and their number.
pub fn main() -> Result<()> {
    let [model, output, count] = [1, 2, 3].map(|place| std::env::args().nth(place));
    let scene = match model {
        Some(model) => taotie::load_model(model)?.scene,
        None => Scene::of_mesh(Mesh::sphere(1.0, 96, 48), Material::default())?,
    };
    let count = count.and_then(|count| count.parse().ok()).unwrap_or(12);
    turntable(scene, count, 512, output.as_deref().unwrap_or("turn").as_ref()).map(drop)
}
