//! Pictures of an asset.

use super::context::{Target, Work};
use crate::settings::{Thumbnail, Turntable};
use taotie::asset::Limits;
use taotie::studio::{self, CameraOptions, Framing, LightOptions, MaterialOptions, View, Viewpoint};
use taotie_engine::film::Development;
use taotie_engine::image::{Bitmap, Texels};
use taotie_engine::render::{RenderSettings, Renderer, Shot};
use taotie_engine::scene::Scene;
use taotie_engine::{Progress, Result};
use taotie_io::{AnimatedImage, AnimationFormat, AnimationSpec};

/// A model to be rendered.
struct Sitter {
    renderer: Renderer,
    settings: RenderSettings,
}

/// Writes a picture of a model as lossless WebP.
///
/// # Errors
/// Read and write errors.
pub fn thumbnail(
    model: &std::path::Path,
    (path, files): Target<'_>,
    Thumbnail { size }: Thumbnail,
    work: &Work<'_>,
) -> Result<()> {
    let scene = read(model, work)?;
    let viewpoint = framed(&scene, size, false)?;
    let pixels = Sitter::new(scene, size)?.picture(viewpoint.at(0.0))?;
    let bitmap = Bitmap::new(size, size, 4, Texels::U8(pixels))?;
    files.write_bytes(path, &taotie_io::encode_webp_bitmap(&bitmap)?)
}

/// Writes one turn of a model as an animated PNG.
///
/// # Errors
/// Read and write errors.
pub fn turntable(
    model: &std::path::Path,
    (path, files): Target<'_>,
    Turntable { size, frames }: Turntable,
    work: &Work<'_>,
) -> Result<()> {
    let scene = read(model, work)?;
    let viewpoint = framed(&scene, size, true)?;
    let mut sitter = Sitter::new(scene, size)?;
    let (format, seconds) = (AnimationFormat::Png, 4.0);
    let spec = AnimationSpec { format, width: size, height: size, frames, seconds, alpha: true };
    let mut image = AnimatedImage::create(files, path, &spec)?;
    for view in viewpoint.turn(frames) {
        image.add(&sitter.picture(view)?)?;
    }
    image.finish()
}

fn read(model: &std::path::Path, work: &Work<'_>) -> Result<Scene> {
    let limits = Limits { memory: work.limit(), ..Limits::default() };
    Ok(studio::load_within(model, &MaterialOptions::default(), &limits)?.scene)
}

fn framed(scene: &Scene, size: u32, all_around: bool) -> Result<Viewpoint> {
    Viewpoint::choose(&CameraOptions::default(), Framing { size: [size; 2], all_around }, scene)
}

impl Sitter {
    fn new(scene: Scene, size: u32) -> Result<Self> {
        let settings = RenderSettings { width: size, height: size, ..RenderSettings::default() };
        Ok(Self { renderer: Renderer::new(scene, &settings.surface)?, settings })
    }

    fn picture(&mut self, view: View<'_>) -> Result<Vec<[u8; 4]>> {
        let scene = self.renderer.prepared().scene();
        let lighting = LightOptions::default().lighting(None, scene, view);
        let shot = Shot { camera: &view.camera(), lighting: &lighting, settings: &self.settings };
        let mut pixels = Vec::new();
        self.renderer.develop(&shot, &Development::default(), &mut pixels, Progress::SILENT)?;
        Ok(pixels)
    }
}
