//! Every method's pictures from one camera in one light, measured.

use super::look::{self, Look};
use super::matching::Matching;
use super::method::Method;
use super::options::ComparisonOptions;
use super::parameters::Parameters;
use super::relief::Relief;
use super::rules::Rules;
use super::subject::{Subject, SubjectReport};
use super::surfaces::{Difference, PictureDifference, RenderedSurface, SkippedMethod};
use crate::compare::{self, Picture};
use crate::error::{Error, Result, Warnings};
use crate::image::Image;
use crate::io::Stopwatch;
use crate::progress::Progress;
use crate::render::{Lighting, Prepared, RenderSettings, Renderer, SurfaceSettings};
use crate::scene::{Camera, Scene};
use crate::surface::SurfaceMethod;

/// A model by several surface methods in pictures and angles: see [`Comparison::of`].
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Comparison {
    /// Names and sizes of model and reference.
    pub subject: SubjectReport,
    /// Everything that the pictures depend on.
    pub parameters: Parameters,
    /// The rules behind the figures.
    pub rules: Rules,
    /// The methods that could be drawn in their order, then the reference.
    pub surfaces: Vec<RenderedSurface>,
    /// The methods that could not be drawn.
    pub skipped: Vec<SkippedMethod>,
    /// Which of `surfaces` the others are compared with: the reference, else the first method.
    pub against: usize,
    /// The true normal at the point of the model that each pixel shows; the fourth channel is 1 where there is one.
    pub truth: Image,
    /// Of the covered samples, the part without a corresponding point on the reference, [0, 1].
    pub unmatched: f64,
    /// Which pixels are away from silhouettes, row by row.
    pub inner: Vec<bool>,
    /// The pixels whose normals are listed.
    pub points: Vec<[u32; 2]>,
    /// Whatever could not be drawn as asked, counted.
    pub warnings: Warnings,
    /// Notes on maps that were derived from others.
    pub notes: Vec<String>,
}

impl Comparison {
    /// Renders the model by every method and the reference, and measures them. `progress` has one stage, `compare`.
    ///
    /// A method that the model's materials do not allow is skipped; see [`Comparison::skipped`].
    ///
    /// # Errors
    /// [`Error::Invalid`] for options that cannot be met and where no method can be drawn, those of rendering, and
    /// [`Error::Cancelled`].
    pub fn of(subject: &Subject<'_>, options: &ComparisonOptions, progress: Progress<'_>) -> Result<Self> {
        options.check()?;
        let mut photographer = Photographer::new(subject, options, progress.stage("compare"))?;
        subject.check_place(&mut photographer.warnings);
        let mut scene = subject.model.scene.clone();
        let mut relief = Relief::new(&mut scene, options.settings.surface.tangents);
        let (mut surfaces, skipped) = photographer.by_all_methods(&mut scene, &mut relief)?;
        let smooth = photographer.look(&scene, Some(SurfaceMethod::Smooth))?;
        let truth = match subject.reference {
            Some(reference) => {
                surfaces.push(photographer.surface(reference.scene, None)?);
                Truth::on(reference.scene, &photographer, &smooth)?
            }
            None => Truth { matched: smooth.normals.clone(), normals: surfaces[0].normals.clone() },
        };
        let against = if subject.reference.is_some() { surfaces.len() - 1 } else { 0 };
        let inner = smooth.inner(&truth.matched);
        photographer.measure(&mut surfaces, against, &Expected { normals: &truth.normals, inner: &inner })?;
        let seen = covered(&smooth.normals);
        Ok(Self {
            subject: subject.report(),
            parameters: photographer.parameters(),
            rules: Rules::new(options.matching, &options.points),
            points: options.points.choose(&inner, options.settings.width as usize),
            unmatched: (seen - covered(&truth.matched)) / seen.max(1.0),
            surfaces,
            skipped,
            against,
            truth: truth.normals,
            inner,
            warnings: photographer.warnings,
            notes: relief.notes().to_vec(),
        })
    }

    /// Returns the name of what the others are compared with.
    pub fn against(&self) -> String {
        self.surfaces[self.against].id()
    }
}

/// How many samples saw something.
fn covered(image: &Image) -> f64 {
    image.pixels().iter().filter(|pixel| pixel[3] == 1.0).count() as f64
}

/// The true normals.
struct Truth {
    /// At the points that samples show.
    matched: Image,
    /// At the points that pixels show: the means of their samples.
    normals: Image,
}

impl Truth {
    /// The reference's normals at the points of the model that `smooth` shows.
    fn on(reference: &Scene, photographer: &Photographer<'_>, smooth: &Look) -> Result<Self> {
        let matched = match photographer.options.matching {
            Matching::Pixel => photographer.look(reference, None)?.normals,
            matching => matching.normals(smooth, reference, photographer.diagonal)?,
        };
        Ok(Self { normals: smooth.mean_normals(&matched)?, matched })
    }
}

/// The normals that surfaces are measured against, and the pixels away from silhouettes.
struct Expected<'a> {
    normals: &'a Image,
    inner: &'a [bool],
}

/// Takes one picture after the other.
struct Photographer<'a> {
    options: &'a ComparisonOptions,
    camera: Camera,
    lighting: Lighting,
    /// The model's.
    diagonal: f64,
    progress: Progress<'a>,
    steps: usize,
    done: usize,
    warnings: Warnings,
}

impl<'a> Photographer<'a> {
    fn new(subject: &Subject<'_>, options: &'a ComparisonOptions, progress: Progress<'a>) -> Result<Self> {
        let model = subject.model.scene;
        let camera = options.camera_for(model)?;
        let surfaces = options.methods.len() + usize::from(subject.reference.is_some());
        Ok(Self {
            options,
            lighting: options.lighting_for(model, &camera),
            camera,
            diagonal: model.bounds().map_or(0.0, |bounds| bounds.diagonal()),
            progress,
            // A look and a picture for each shading, and then measuring each picture.
            steps: surfaces * (1 + 2 * options.shadings.len()),
            done: 0,
            warnings: Warnings::default(),
        })
    }

    fn parameters(&self) -> Parameters {
        Parameters::new(self.options, &self.camera, &self.lighting)
    }

    /// The part of the progress that the next step makes.
    fn next_step(&self) -> Progress<'a> {
        self.progress.part(self.fraction(self.done), self.fraction(self.done + 1))
    }

    /// The progress as it stands, for work that makes no step.
    fn between_steps(&self) -> Progress<'a> {
        self.progress.part(self.fraction(self.done), self.fraction(self.done))
    }

    fn fraction(&self, steps: usize) -> f64 {
        steps as f64 / self.steps as f64
    }

    fn step(&mut self) -> Result<()> {
        self.done += 1;
        self.progress.at(self.fraction(self.done))
    }

    /// Takes all pictures by every method that the model's relief allows, and lists those that it does not.
    fn by_all_methods(
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
            return Err(Error::invalid("none of the methods can be drawn", reasons.join("; ")));
        }
        Ok((surfaces, skipped))
    }

    /// Takes all pictures of a scene by `method`, or by the best that its materials provide.
    fn surface(&mut self, scene: &Scene, method: Option<Method>) -> Result<RenderedSurface> {
        let watch = Stopwatch::start();
        let surface = self.surface_settings(method);
        let mut renderer = Renderer::new(scene, &surface)?;
        self.warnings.absorb(renderer.prepared().warnings().clone());
        let settings = RenderSettings { surface, ..self.options.settings.clone() };
        let look = look::look(renderer.prepared(), &self.camera, &settings, self.next_step())?;
        let normals = look.mean_normals(&look.normals)?;
        self.step()?;
        let (mut pictures, mut codes) = (Vec::new(), Vec::new());
        for shading in &self.options.shadings {
            let settings = RenderSettings { shading: *shading, ..settings.clone() };
            let (seen, development) = ((&self.camera, &self.lighting), &self.options.development);
            renderer.develop(seen, &settings, development, &mut codes, self.next_step())?;
            pictures.push((*shading, Picture::from_developed(settings.width, settings.height, &codes)?));
            self.step()?;
        }
        Ok(RenderedSurface {
            method,
            normals,
            pictures,
            milliseconds: watch.milliseconds(),
            difference: None,
        })
    }

    /// Looks at a scene by a method that needs no map, or by the best that its materials provide.
    fn look(&self, scene: &Scene, method: Option<SurfaceMethod>) -> Result<Look> {
        let surface = SurfaceSettings { method, ..self.options.settings.surface };
        let settings = RenderSettings { surface, ..self.options.settings.clone() };
        look::look(&Prepared::new(scene, &surface)?, &self.camera, &settings, self.between_steps())
    }

    fn surface_settings(&self, method: Option<Method>) -> SurfaceSettings {
        let asked = &self.options.settings.surface;
        let bump_scale = method.and_then(|method| match (method.surface, method.factor) {
            (SurfaceMethod::BumpPrinted, factor) => factor,
            // The factor already stands in the materials.
            (_, Some(_)) => None,
            (_, None) => asked.bump_scale,
        });
        SurfaceSettings { method: method.map(|m| m.surface), tangents: asked.tangents, bump_scale }
    }

    /// Compares all normals with the expected ones, and all pictures with those of `surfaces[against]`.
    fn measure(
        &mut self,
        surfaces: &mut [RenderedSurface],
        against: usize,
        expected: &Expected<'_>,
    ) -> Result<()> {
        for i in (0..surfaces.len()).filter(|i| *i != against) {
            let difference = self.difference(&surfaces[i], &surfaces[against], expected)?;
            surfaces[i].difference = Some(difference);
        }
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
