//! The surfaces of a comparison as seen, their differences, and their rendering: one image after the other, from one
//! camera in one light.

use super::look::{self, Look};
use super::options::{ComparisonOptions, Method};
use super::parameters::Parameters;
use super::relief::Relief;
use super::subject::Subject;
use taotie_engine::compare::{self, DisplayImage, Field, PIXELS_PER_DEGREE};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::Image;
use taotie_engine::names::Named;
use taotie_engine::progress::Progress;
use taotie_engine::render::{Lighting, RenderSettings, Renderer, Shot, SurfaceSettings, render};
use taotie_engine::scene::{Camera, Scene};
use taotie_engine::shade::Shading;
use taotie_engine::surface::SurfaceMethod;
use taotie_io::Stopwatch;

/// A surface as seen: the model by one method, or the reference.
///
/// ```
/// use taotie::comparison::Comparison;
///
/// /// Returns the names of the files for the normals of all methods, such as `bump-5.normals.png`.
/// fn files(comparison: &Comparison) -> Vec<String> {
///     comparison.surfaces.iter().map(|surface| surface.file_name("normals")).collect()
/// }
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct RenderedSurface {
    /// The method, or `None` for the reference.
    pub method: Option<Method>,
    /// The mean normal of each pixel, as [`taotie_engine::render::Aovs::normals`].
    pub normals: Image,
    /// The developed image under each shading.
    pub pictures: Vec<(Shading, DisplayImage)>,
    /// The time from scene to all of these.
    pub milliseconds: f64,
    /// The difference from the surface with which it is compared; `None` for that surface itself.
    pub difference: Option<Difference>,
    /// The differences of its images from its own under the baseline, one for each other reflectance model; empty
    /// without a baseline.
    pub model_differences: Vec<ModelDifference>,
}

/// The difference that a reflectance model makes to the image of one surface.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ModelDifference {
    /// The reflectance model.
    pub shading: Shading,
    /// The one with which it is compared.
    pub baseline: Shading,
    /// The difference of their images.
    pub picture: PictureDifference,
}

/// The difference of a surface from the one with which it is compared.
///
/// ```
/// use taotie::comparison::Difference;
///
/// /// Returns the largest angle away from silhouettes, degrees.
/// fn most(difference: &Difference) -> Option<f64> {
///     Some(difference.inner_angles.summary()?.max)
/// }
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Difference {
    /// Degrees, if both are covered.
    pub angles: Field,
    /// The same away from silhouettes.
    pub inner_angles: Field,
    /// The images under each shading, in the same order.
    pub pictures: Vec<PictureDifference>,
}

/// The difference of two developed images, over the pixels that show either surface.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct PictureDifference {
    /// Root mean square error, in [0, 1] of encoded values.
    pub rmse: f64,
    /// Decibels; infinite for equal images.
    pub psnr: f64,
    /// Structural similarity, at most 1.
    pub ssim: f64,
    /// FLIP at each of these pixels, in [0, 1]; NaN at others.
    pub flip: Field,
    /// The number of these pixels.
    pub pixels: usize,
}

/// A method that the model's materials do not support.
///
/// ```
/// use taotie::comparison::Comparison;
///
/// /// Returns the reasons why methods are missing, one per line.
/// fn reasons(comparison: &Comparison) -> Vec<String> {
///     let skipped = comparison.skipped.iter();
///     skipped.map(|skipped| format!("{}: {}", skipped.method, skipped.reason)).collect()
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct SkippedMethod {
    /// The method, as [`Method::id`] writes it.
    pub method: String,
    /// The missing map, and what to do.
    pub reason: String,
}

impl RenderedSurface {
    /// Returns the method as [`Method::id`] writes it, or `reference`.
    pub fn id(&self) -> String {
        self.method.map_or_else(|| "reference".into(), Method::id)
    }

    /// Returns a short description of the method.
    pub fn describe(&self) -> String {
        self.method.map_or_else(|| "the geometry itself".into(), Method::describe)
    }

    /// Returns the file name for its image of this kind: `bump-5.normals.png`. Kinds are `normals`, `error`, the name
    /// of a shading, and that with `.flip`.
    pub fn file_name(&self, kind: &str) -> String {
        format!("{}.{kind}.png", self.file_stem())
    }

    /// Returns the file name for the exact values of this kind, `normals` or `error`: `bump-5.normals.exr`.
    pub fn exact_name(&self, kind: &str) -> String {
        format!("{}.{kind}.exr", self.file_stem())
    }

    fn file_stem(&self) -> String {
        self.method.map_or_else(|| "reference".into(), Method::file_stem)
    }

    /// Returns [`RenderedSurface::file_name`] of the image under a shading.
    pub fn picture_name(&self, shading: Shading) -> String {
        self.file_name(shading.name())
    }

    /// Returns [`RenderedSurface::file_name`] of the map of FLIP under a shading.
    pub fn flip_name(&self, shading: Shading) -> String {
        self.file_name(&format!("{}.flip", shading.name()))
    }

    /// Returns [`RenderedSurface::file_name`] of the map of FLIP between the images under two reflectance models:
    /// `smooth.phong-ggx.flip.png`.
    pub fn model_flip_name(&self, model: &ModelDifference) -> String {
        self.file_name(&format!("{}-{}.flip", model.shading.name(), model.baseline.name()))
    }
}

impl PictureDifference {
    /// Measures `picture` against the expected one, over the pixels that are `covered`.
    fn of(expected: &DisplayImage, picture: &DisplayImage, covered: &[bool]) -> Result<Self> {
        Ok(Self {
            rmse: compare::rmse_within(expected, picture, covered)?,
            psnr: compare::psnr_within(expected, picture, covered)?,
            ssim: compare::ssim_within(expected, picture, covered)?,
            flip: compare::flip(expected, picture, PIXELS_PER_DEGREE)?.within(covered)?,
            pixels: covered.iter().filter(|covered| **covered).count(),
        })
    }
}

/// The normals with which surfaces are compared, the pixels away from silhouettes, and those over which images are
/// compared.
pub(super) struct Expected<'a> {
    pub(super) normals: &'a Image,
    pub(super) inner: &'a [bool],
    pub(super) covered: &'a [bool],
}

/// Renders one image after the other.
pub(super) struct Photographer<'a> {
    pub(super) options: &'a ComparisonOptions,
    camera: Camera,
    lighting: Lighting,
    /// The model's.
    pub(super) diagonal: f64,
    /// The pixels that show the model in any sample; empty before the first picture of it.
    model_pixels: Vec<bool>,
    /// The same for the reference.
    reference_pixels: Vec<bool>,
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
            model_pixels: Vec::new(),
            reference_pixels: Vec::new(),
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
        let milliseconds = watch.milliseconds();
        let pixels = if method.is_some() { &mut self.model_pixels } else { &mut self.reference_pixels };
        if pixels.is_empty() {
            *pixels = covered_pixels(&mut renderer, &self.camera, &settings)?;
        }
        Ok(RenderedSurface {
            method,
            normals,
            pictures,
            milliseconds,
            difference: None,
            model_differences: Vec::new(),
        })
    }

    /// Returns the pixels that show the model or the reference, row by row.
    pub(super) fn covered(&self) -> Vec<bool> {
        let of_reference = self.reference_pixels.iter().copied().chain(std::iter::repeat(false));
        self.model_pixels.iter().zip(of_reference).map(|(model, reference)| *model || reference).collect()
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
            let pixels = if surface.method.is_some() { &self.model_pixels } else { &self.reference_pixels };
            let picture = PictureDifference::of(expected, picture, pixels)?;
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
        let covered = expected.covered;
        let mut pictures = Vec::new();
        for ((_, expected), (_, picture)) in against.pictures.iter().zip(&surface.pictures) {
            pictures.push(PictureDifference::of(expected, picture, covered)?);
            self.step()?;
        }
        Ok(Difference { inner_angles: angles.within(expected.inner)?, angles, pictures })
    }
}

/// Returns `true` for each pixel of a picture with these settings that shows the renderer's scene in any sample.
fn covered_pixels(renderer: &mut Renderer, camera: &Camera, settings: &RenderSettings) -> Result<Vec<bool>> {
    // Neither light nor background changes what is covered.
    let settings = RenderSettings { shadows: false, ground: false, aovs: false, ..settings.clone() };
    let shot = Shot { camera, lighting: &Lighting::default(), settings: &settings };
    let frame = renderer.render(&shot, Progress::SILENT)?;
    Ok(frame.color.pixels().iter().map(|pixel| pixel[3] > 0.0).collect())
}
