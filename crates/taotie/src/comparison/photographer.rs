//! Renders images one after the other, from one camera in one light.

use super::look::{self, Look};
use super::method::Method;
use super::options::ComparisonOptions;
use super::parameters::Parameters;
use super::relief::Relief;
use super::subject::Subject;
use super::surfaces::{Difference, ModelDifference, PictureDifference, RenderedSurface, SkippedMethod};
use crate::compare::{self, DisplayImage};
use crate::error::{Error, Result, Warnings};
use crate::image::Image;
use crate::io::Stopwatch;
use crate::progress::Progress;
use crate::render::{Lighting, RenderSettings, Renderer, Shot, SurfaceSettings, render};
use crate::scene::{Camera, Scene};
use crate::surface::SurfaceMethod;

/// The normals with which surfaces are compared, and the pixels away from silhouettes.
pub(super) struct Expected<'a> {
    pub(super) normals: &'a Image,
    pub(super) inner: &'a [bool],
}

/// Renders one image after the other.
pub(super) struct Photographer<'a> {
    pub(super) options: &'a ComparisonOptions,
    camera: Camera,
    lighting: Lighting,
    /// The model's.
    pub(super) diagonal: f64,
    progress: Progress<'a>,
    steps: usize,
    done: usize,
    pub(super) warnings: Warnings,
}

impl<'a> Photographer<'a> {
    pub(super) fn new(
        subject: &Subject<'_>,
        options: &'a ComparisonOptions,
        progress: Progress<'a>,
    ) -> Result<Self> {
        let model = subject.model.scene;
        let camera = options.camera_for(model)?;
        let surfaces = options.methods.len() + usize::from(subject.reference.is_some());
        Ok(Self {
            options,
            lighting: options.lighting_for(model, &camera),
            camera,
            diagonal: model.bounds().map_or(0.0, |bounds| bounds.diagonal()),
            progress,
            // A look and a picture for each shading, then measuring each picture, and again with a baseline.
            steps: surfaces * (1 + (2 + usize::from(options.baseline.is_some())) * options.shadings.len()),
            done: 0,
            warnings: Warnings::default(),
        })
    }

    pub(super) fn parameters(&self) -> Parameters {
        Parameters::new(self.options, &self.camera, &self.lighting)
    }

    /// Returns the fraction of the progress that the next step makes.
    fn next_step(&self) -> Progress<'a> {
        self.progress.part(self.fraction(self.done), self.fraction(self.done + 1))
    }

    fn fraction(&self, steps: usize) -> f64 {
        steps as f64 / self.steps as f64
    }

    fn step(&mut self) -> Result<()> {
        self.done += 1;
        self.progress.at(self.fraction(self.done))
    }

    /// Renders all images by every method that the model's relief supports, and lists those that it does not.
    pub(super) fn by_all_methods(
        &mut self,
        scene: &mut Scene,
        relief: &mut Relief,
    ) -> Result<(Vec<RenderedSurface>, Vec<SkippedMethod>)> {
        let (mut surfaces, mut skipped) = (Vec::new(), Vec::new());
        for method in &self.options.methods {
            match relief.apply(scene, *method)? {
                None => surfaces.push(self.surface(scene, Some(*method))?),
                Some(why) => skipped.push(SkippedMethod { method: method.id(), reason: why.into() }),
            }
        }
        if surfaces.is_empty() {
            let reasons: Vec<String> =
                skipped.iter().map(|s| format!("{}: {}", s.method, s.reason)).collect();
            return Err(Error::invalid("none of the methods can be rendered", reasons.join("; ")));
        }
        Ok((surfaces, skipped))
    }

    /// Renders all images of a scene by `method`, or by the best that its materials provide.
    pub(super) fn surface(&mut self, scene: &Scene, method: Option<Method>) -> Result<RenderedSurface> {
        let watch = Stopwatch::start();
        let surface = self.surface_settings(method);
        let mut renderer = Renderer::new(scene.clone(), &surface)?;
        self.warnings.absorb(renderer.prepared().warnings().clone());
        let settings = RenderSettings { surface, ..self.options.settings.clone() };
        let look = look::look(&self.camera, &settings, |shot| renderer.render(shot, self.next_step()))?;
        let normals = look.mean_normals(&look.normals)?;
        self.step()?;
        let (mut pictures, mut codes) = (Vec::new(), Vec::new());
        for shading in &self.options.shadings {
            let settings = RenderSettings { shading: *shading, ..settings.clone() };
            let shot = Shot { camera: &self.camera, lighting: &self.lighting, settings: &settings };
            renderer.develop(&shot, &self.options.development, &mut codes, self.next_step())?;
            pictures.push((*shading, DisplayImage::from_developed(settings.width, settings.height, &codes)?));
            self.step()?;
        }
        Ok(RenderedSurface {
            method,
            normals,
            pictures,
            milliseconds: watch.milliseconds(),
            difference: None,
            model_differences: Vec::new(),
        })
    }

    /// Makes a look of a scene by a method that needs no map, or by the best that its materials provide.
    pub(super) fn look(&self, scene: &Scene, method: Option<SurfaceMethod>) -> Result<Look> {
        let surface = SurfaceSettings { method, ..self.options.settings.surface };
        let settings = RenderSettings { surface, ..self.options.settings.clone() };
        self.progress.at(self.fraction(self.done))?;
        look::look(&self.camera, &settings, |shot| render(scene, shot))
    }

    fn surface_settings(&self, method: Option<Method>) -> SurfaceSettings {
        let asked = &self.options.settings.surface;
        let bump_scale = method.and_then(|method| match (method.surface, method.factor) {
            (SurfaceMethod::BumpPrinted, factor) => factor,
            // The factor is already in the materials.
            (_, Some(_)) => None,
            (_, None) => asked.bump_scale,
        });
        SurfaceSettings { method: method.map(|m| m.surface), bump_scale, ..*asked }
    }

    /// Compares all normals with the expected ones, and all images with those of `surfaces[against]`.
    pub(super) fn measure(
        &mut self,
        surfaces: &mut [RenderedSurface],
        against: usize,
        expected: &Expected<'_>,
    ) -> Result<()> {
        for i in (0..surfaces.len()).filter(|i| *i != against) {
            let difference = self.difference(&surfaces[i], &surfaces[against], expected)?;
            surfaces[i].difference = Some(difference);
        }
        surfaces.iter_mut().try_for_each(|surface| self.measure_models(surface))
    }

    /// Compares the images of a surface under all reflectance models with its own under the baseline.
    fn measure_models(&mut self, surface: &mut RenderedSurface) -> Result<()> {
        let Some(baseline) = self.options.baseline else { return Ok(()) };
        let expected = surface.pictures.iter().find(|(shading, _)| *shading == baseline);
        let Some((_, expected)) = expected else { return Ok(()) };
        let mut differences = Vec::new();
        for (shading, picture) in surface.pictures.iter().filter(|(shading, _)| *shading != baseline) {
            let picture = PictureDifference::of(expected, picture)?;
            differences.push(ModelDifference { shading: *shading, baseline, picture });
            self.step()?;
        }
        surface.model_differences = differences;
        Ok(())
    }

    fn difference(
        &mut self,
        surface: &RenderedSurface,
        against: &RenderedSurface,
        expected: &Expected<'_>,
    ) -> Result<Difference> {
        let angles = compare::angular_error(expected.normals, &surface.normals)?;
        let mut pictures = Vec::new();
        for ((_, expected), (_, picture)) in against.pictures.iter().zip(&surface.pictures) {
            pictures.push(PictureDifference::of(expected, picture)?);
            self.step()?;
        }
        Ok(Difference { inner_angles: angles.within(expected.inner)?, angles, pictures })
    }
}
