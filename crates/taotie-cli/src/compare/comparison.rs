//! Every method's pictures from one camera in one light, and how they differ.

use super::look::{self, Look};
use super::matching::Matching;
use super::method::Method;
use super::points::PointChoice;
use super::relief::{Reason, Relief};
use crate::console::Bar;
use anyhow::{Result, bail};
use std::path::PathBuf;
use std::time::Instant;
use taotie::compare::{self, Field, PIXELS_PER_DEGREE, Picture};
use taotie::film::Development;
use taotie::image::Image;
use taotie::render::{Lighting, Prepared, RenderSettings, Renderer, SurfaceSettings};
use taotie::scene::{Camera, Scene};
use taotie::shade::Shading;
use taotie::surface::SurfaceMethod;
use taotie::{Progress, Warnings};

/// What is compared.
pub struct Subject {
    /// The model.
    pub scene: Scene,
    /// The truth, where there is one: the same object with its relief as geometry.
    pub reference: Option<Scene>,
}

/// How it is compared.
pub struct Plan {
    /// The surface methods, each once; the first is what the tables' angles are measured from.
    pub methods: Vec<Method>,
    /// The reflectance models, each once.
    pub shadings: Vec<Shading>,
    /// The places whose normals are told.
    pub points: PointChoice,
    /// Which place of the reference a place of the model is compared with.
    pub matching: Matching,
    /// Where all pictures are taken from.
    pub camera: Camera,
    /// The light of all pictures.
    pub lighting: Lighting,
    /// Size, samples, shadows, tangents, the height of white for `bump`, and the SIMD level.
    pub settings: RenderSettings,
    /// How all pictures are developed; with a background.
    pub development: Development,
    /// The angle at the top of the heat maps' scale, degrees.
    pub heat_top_deg: f64,
    /// What was asked of the materials, for the report.
    pub material: serde_json::Value,
    /// The environment, as the report tells it; null where there is none.
    pub environment: serde_json::Value,
}

/// A surface as seen.
pub struct Taken {
    /// The method, or `None` for the reference.
    pub method: Option<Method>,
    /// The mean normal of each pixel, as [`taotie::render::Aovs::normals`].
    pub normals: Image,
    /// The developed picture under each shading.
    pub pictures: Vec<(Shading, Picture)>,
    /// From scene to all of these.
    pub milliseconds: f64,
    /// From what it is compared with; `None` for that itself.
    pub difference: Option<Difference>,
}

/// How a surface differs from what it is compared with.
pub struct Difference {
    /// Degrees, where both are covered.
    pub angles: Field,
    /// The pictures under each shading, in the same order.
    pub pictures: Vec<PictureDifference>,
}

/// How two developed pictures differ.
pub struct PictureDifference {
    /// Root mean square error, in [0, 1] of encoded values.
    pub rmse: f64,
    /// Decibels; infinite for equal pictures.
    pub psnr: f64,
    /// Structural similarity, at most 1.
    pub ssim: f64,
    /// FLIP at each pixel, in [0, 1].
    pub flip: Field,
}

/// Methods that could not be drawn, and why.
pub type Skipped = Vec<(Method, Reason)>;

/// What came of it.
pub struct Comparison {
    /// The methods that could be drawn in their order, then the reference.
    pub taken: Vec<Taken>,
    /// Methods that could not be drawn, and why.
    pub skipped: Skipped,
    /// Which of `taken` the others are compared with: the reference, else the first method.
    pub against: usize,
    /// The true normal at the point of the model that each pixel shows, where there is one.
    pub truth: Image,
    /// Of the covered samples, the part whose place was not found on the reference.
    pub unmatched: f64,
    /// Which pixels are away from silhouettes, row by row.
    pub inner: Vec<bool>,
    /// The pixels whose normals are told.
    pub points: Vec<[u32; 2]>,
    /// What could not be drawn as asked.
    pub warnings: Warnings,
    /// What was derived from other maps.
    pub notes: Vec<String>,
}

impl Taken {
    /// The method as it is written, or `reference`.
    pub fn id(&self) -> String {
        self.method.map_or_else(|| "reference".into(), Method::id)
    }

    /// What the method does, in a few words.
    pub fn what(&self) -> String {
        self.method.map_or_else(|| "the geometry itself".into(), Method::describe)
    }

    /// The name of its picture of this kind: `bump-5.normals.png`.
    pub fn file_name(&self, kind: &str) -> PathBuf {
        let stem = self.method.map_or_else(|| "reference".into(), Method::file_stem);
        format!("{stem}.{kind}.png").into()
    }
}

impl Comparison {
    /// Takes all pictures and measures them.
    ///
    /// # Errors
    /// Where no method can be drawn, and those of rendering.
    pub fn take(subject: &mut Subject, plan: &Plan) -> Result<Self> {
        let mut studio = Studio::new(plan, subject.reference.is_some());
        let mut relief = Relief::new(&mut subject.scene, plan.settings.surface.tangents)?;
        let (mut taken, skipped) = studio.take_all(&mut subject.scene, &mut relief)?;
        if let Some(reference) = &subject.reference {
            taken.push(studio.take(reference, None)?);
        }
        let against = if subject.reference.is_some() { taken.len() - 1 } else { 0 };
        let smooth = studio.look(&subject.scene, Some(SurfaceMethod::Smooth))?;
        let (matched, truth) = match &subject.reference {
            Some(reference) => {
                let matched = studio.matched(&smooth, &subject.scene, reference)?;
                let truth = smooth.mean_normals(&matched)?;
                (matched, truth)
            }
            None => (smooth.normals.clone(), taken[0].normals.clone()),
        };
        studio.measure(&mut taken, against, &truth)?;
        let inner = smooth.inner(&matched, &plan.camera);
        let seen = covered(&smooth.normals);
        Ok(Self {
            points: plan.points.choose(&inner, plan.settings.width as usize),
            unmatched: (seen - covered(&matched)) / seen.max(1.0),
            taken,
            skipped,
            against,
            truth,
            inner,
            warnings: studio.warnings,
            notes: relief.notes().to_vec(),
        })
    }

    /// The name of what the others are compared with.
    pub fn against(&self) -> String {
        self.taken[self.against].id()
    }
}

/// How many samples saw something.
fn covered(image: &Image) -> f64 {
    image.pixels().iter().filter(|pixel| pixel[3] == 1.0).count() as f64
}

/// Takes one picture after the other.
struct Studio<'a> {
    plan: &'a Plan,
    progress: Bar,
    steps: usize,
    done: usize,
    warnings: Warnings,
}

impl<'a> Studio<'a> {
    fn new(plan: &'a Plan, with_reference: bool) -> Self {
        let surfaces = plan.methods.len() + usize::from(with_reference);
        // A look and a picture for each shading, and then measuring each picture.
        let steps = surfaces * (1 + 2 * plan.shadings.len());
        Self { plan, progress: Bar::new("compare"), steps, done: 0, warnings: Warnings::default() }
    }

    fn step(&mut self) {
        self.done += 1;
        self.progress.set(self.done as f64 / self.steps as f64);
    }

    /// Takes all pictures by every method that the model's relief allows; those that it does not, with the reasons.
    fn take_all(&mut self, scene: &mut Scene, relief: &mut Relief) -> Result<(Vec<Taken>, Skipped)> {
        let (mut taken, mut skipped) = (Vec::new(), Vec::new());
        for method in &self.plan.methods {
            match relief.apply(scene, *method)? {
                None => taken.push(self.take(scene, Some(*method))?),
                Some(reason) => skipped.push((*method, reason)),
            }
        }
        if taken.is_empty() {
            let reasons: Vec<String> = skipped.iter().map(|(m, why)| format!("{}: {why}", m.id())).collect();
            bail!("none of the methods can be drawn: {}", reasons.join("; "));
        }
        Ok((taken, skipped))
    }

    /// Takes all pictures of a scene by `method`, or by the best that its materials provide.
    fn take(&mut self, scene: &Scene, method: Option<Method>) -> Result<Taken> {
        let start = Instant::now();
        let surface = self.surface(method);
        let mut renderer = Renderer::new(scene, &surface)?;
        self.warnings.absorb(renderer.prepared().warnings().clone());
        let settings = RenderSettings { surface, ..self.plan.settings.clone() };
        let look = look::look(renderer.prepared(), &self.plan.camera, &settings)?;
        let normals = look.mean_normals(&look.normals)?;
        self.step();
        let (mut pictures, mut codes) = (Vec::new(), Vec::new());
        for shading in &self.plan.shadings {
            let settings = RenderSettings { shading: *shading, ..settings.clone() };
            let seen = (&self.plan.camera, &self.plan.lighting);
            renderer.develop(seen, &settings, &self.plan.development, &mut codes, Progress::SILENT)?;
            pictures.push((*shading, Picture::from_developed(settings.width, settings.height, &codes)?));
            self.step();
        }
        let milliseconds = start.elapsed().as_secs_f64() * 1e3;
        Ok(Taken { method, normals, pictures, milliseconds, difference: None })
    }

    /// A scene by a method that needs no map, or by the best that its materials provide.
    fn look(&self, scene: &Scene, method: Option<SurfaceMethod>) -> Result<Look> {
        let surface = SurfaceSettings { method, ..self.plan.settings.surface };
        let settings = RenderSettings { surface, ..self.plan.settings.clone() };
        Ok(look::look(&Prepared::new(scene, &surface)?, &self.plan.camera, &settings)?)
    }

    /// The reference's normals at the places that `smooth` shows of the model.
    fn matched(&self, smooth: &Look, model: &Scene, reference: &Scene) -> Result<Image> {
        let (camera, matching) = (&self.plan.camera, self.plan.matching);
        if matching == Matching::Pixel {
            return Ok(self.look(reference, None)?.normals);
        }
        let diagonal = model.bounds().map_or(0.0, |bounds| bounds.diagonal());
        Ok(matching.normals(smooth, reference, camera, diagonal)?)
    }

    fn surface(&self, method: Option<Method>) -> SurfaceSettings {
        let asked = &self.plan.settings.surface;
        let bump_scale = method.and_then(|method| match (method.surface, method.factor) {
            (SurfaceMethod::BumpPrinted, factor) => factor,
            // The factor already stands in the materials.
            (_, Some(_)) => None,
            (_, None) => asked.bump_scale,
        });
        SurfaceSettings { method: method.map(|m| m.surface), tangents: asked.tangents, bump_scale }
    }

    /// Compares all normals with `truth`, and all pictures with those of `taken[against]`.
    fn measure(&mut self, taken: &mut [Taken], against: usize, truth: &Image) -> Result<()> {
        for i in (0..taken.len()).filter(|i| *i != against) {
            let (one, expected) = (&taken[i], &taken[against]);
            let angles = compare::angular_error(truth, &one.normals)?;
            let mut pictures = Vec::new();
            for ((_, expected), (_, picture)) in expected.pictures.iter().zip(&one.pictures) {
                pictures.push(picture_difference(expected, picture)?);
                self.step();
            }
            taken[i].difference = Some(Difference { angles, pictures });
        }
        Ok(())
    }
}

fn picture_difference(expected: &Picture, picture: &Picture) -> Result<PictureDifference> {
    Ok(PictureDifference {
        rmse: compare::rmse(expected, picture)?,
        psnr: compare::psnr(expected, picture)?,
        ssim: compare::ssim(expected, picture)?,
        flip: compare::flip(expected, picture, PIXELS_PER_DEGREE)?,
    })
}
