//! A picture of a scene in one call.

use crate::studio::{CameraOptions, Framing, LightOptions, View, Viewpoint};
use std::path::Path;
use std::sync::Arc;
use taotie_engine::error::Result;
use taotie_engine::film::Development;
use taotie_engine::image::{Bitmap, Texels};
use taotie_engine::progress::Progress;
use taotie_engine::render::{EnvironmentLight, Frame, RenderSettings, Renderer, Shot};
use taotie_engine::scene::Scene;
use taotie_io::ImageFormat;

/// Settings of a picture: camera, light, renderer and development. The defaults frame the object and light it.
///
/// ```
/// use taotie::{Material, Mesh, Picture, RenderSettings, Scene};
///
/// let ball = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default())?;
/// let settings = RenderSettings { width: 64, height: 64, ..RenderSettings::default() };
/// let picture = Picture { settings, ..Picture::default() };
/// let frame = picture.render(&ball)?;
/// assert!(frame.color.pixel(32, 32)[0] > frame.color.pixel(0, 0)[0]);
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Picture {
    /// The camera; by default one that frames the object.
    pub camera: CameraOptions,
    /// The lights and the ambient light.
    pub lights: LightOptions,
    /// The environment light, from [`EnvironmentOptions::load`](crate::studio::EnvironmentOptions::load).
    pub environment: Option<EnvironmentLight>,
    /// The size, the shading model and the rest of the renderer's settings.
    pub settings: RenderSettings,
    /// The conversion from linear light to sRGB.
    pub development: Development,
}

impl Picture {
    /// Renders a scene; returns it in linear light.
    ///
    /// # Errors
    /// As [`Viewpoint::choose`] and [`render`](taotie_engine::render::render).
    pub fn render(&self, scene: &Scene) -> Result<Frame> {
        let viewpoint = self.viewpoint(scene, false)?;
        let view = viewpoint.at(0.0);
        let lighting = self.lights.lighting(self.environment.as_ref(), scene, view);
        let shot = Shot { camera: &view.camera(), lighting: &lighting, settings: &self.settings };
        taotie_engine::render::render(scene, &shot)
    }

    /// Renders a scene and writes it as a PNG with 8 bits per channel.
    ///
    /// # Errors
    /// As [`Picture::render`] and [`write_image`](taotie_io::write_image).
    pub fn write(&self, scene: &Scene, path: impl AsRef<Path>) -> Result<()> {
        let image = self.render(scene)?.color;
        taotie_io::write_image(path.as_ref(), &image, &self.development, ImageFormat::Png8)
    }

    /// Renders a scene; returns it developed, in 8-bit sRGB with straight alpha.
    ///
    /// # Errors
    /// As [`Picture::render`].
    pub fn take(&self, scene: impl Into<Arc<Scene>>) -> Result<Bitmap> {
        let mut renderer = Renderer::new(scene, &self.settings.surface)?;
        let viewpoint = self.viewpoint(renderer.prepared().scene(), false)?;
        self.develop(&mut renderer, viewpoint.at(0.0))
    }

    /// Takes `count` pictures all around a scene, and passes each on.
    ///
    /// ```
    /// use taotie::{Material, Mesh, Picture, RenderSettings, Scene};
    ///
    /// let ball = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default())?;
    /// let settings = RenderSettings { width: 32, height: 32, ..RenderSettings::default() };
    /// let mut sizes = Vec::new();
    /// Picture { settings, ..Picture::default() }.turntable(ball, 4, |bitmap| {
    ///     sizes.push(bitmap.width());
    ///     Ok(())
    /// })?;
    /// assert_eq!(sizes, [32; 4]);
    /// # Ok::<(), taotie::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Picture::render`], and those of `each`.
    pub fn turntable(
        &self,
        scene: impl Into<Arc<Scene>>,
        count: u32,
        mut each: impl FnMut(Bitmap) -> Result<()>,
    ) -> Result<()> {
        let mut renderer = Renderer::new(scene, &self.settings.surface)?;
        let viewpoint = self.viewpoint(renderer.prepared().scene(), true)?;
        viewpoint.turn(count).try_for_each(|view| each(self.develop(&mut renderer, view)?))
    }

    fn viewpoint(&self, scene: &Scene, all_around: bool) -> Result<Viewpoint> {
        let size = [self.settings.width, self.settings.height];
        Viewpoint::choose(&self.camera, Framing { size, all_around }, scene)
    }

    fn develop(&self, renderer: &mut Renderer, view: View<'_>) -> Result<Bitmap> {
        let lighting = self.lights.lighting(self.environment.as_ref(), renderer.prepared().scene(), view);
        let shot = Shot { camera: &view.camera(), lighting: &lighting, settings: &self.settings };
        let mut pixels = Vec::new();
        renderer.develop(&shot, &self.development, &mut pixels, Progress::SILENT)?;
        Bitmap::new(self.settings.width, self.settings.height, 4, Texels::U8(pixels))
    }
}
