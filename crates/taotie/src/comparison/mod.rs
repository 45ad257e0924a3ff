//! Comparisons: one model rendered by several surface methods, from one camera in one light, measured against a
//! high-poly reference or against the first method.
//!
//! [`Comparison::of`] renders and measures, [`Comparison::report`] returns the figures as plain data. [`diff`]
//! measures two images or normal maps.
//!
//! ```no_run
//! use taotie::comparison::{Comparison, ComparisonOptions, Method, Subject};
//! use taotie::{Progress, SurfaceMethod};
//!
//! # fn main() -> taotie::Result<()> {
//! let low = taotie::load_model("low.glb")?.scene;
//! let high = taotie::load_model("scan.ply")?.scene;
//! let subject = Subject::new("low.glb", &low).with_reference("scan.ply", &high);
//! let methods = [SurfaceMethod::Smooth, SurfaceMethod::TangentNormal].map(Method::from).to_vec();
//! let options = ComparisonOptions { methods, ..ComparisonOptions::default() };
//! let report = Comparison::of(&subject, &options, Progress::SILENT)?.report();
//! println!("{:?} degrees", report.method("tangent-normal").and_then(|method| method.inner_mean()));
//! # Ok(())
//! # }
//! ```

pub mod diff;
mod look;
mod options;
mod parameters;
mod relief;
mod report;
mod subject;
mod surfaces;

pub use look::Matching;
pub use options::{ComparisonOptions, Method, SamplePoints};
pub use parameters::{Parameters, Rules};
pub use report::{MethodReport, MethodTime, ModelReport, PictureFigures, PointNormal, PointReport, Report};
pub use subject::{NamedScene, Subject, SubjectReport};
pub use surfaces::{Difference, RenderedSurface, SkippedMethod};

use look::Look;
use relief::Relief;
use surfaces::{Expected, Photographer};
use taotie_engine::error::{Result, Warnings};
use taotie_engine::image::Image;
use taotie_engine::progress::Progress;
use taotie_engine::scene::Scene;
use taotie_engine::surface::SurfaceMethod;

/// A model rendered by several surface methods, with images and angles: see [`Comparison::of`].
///
/// ```
/// use taotie::comparison::{Comparison, ComparisonOptions, Method, Subject};
/// use taotie::{Material, Mesh, Progress, RenderSettings, Scene, SurfaceMethod};
///
/// let ball = Scene::of_mesh(Mesh::sphere(1.0, 24, 12), Material::default())?;
/// let options = ComparisonOptions {
///     methods: [SurfaceMethod::Facet, SurfaceMethod::Smooth].map(Method::from).to_vec(),
///     settings: RenderSettings { width: 64, height: 64, ..RenderSettings::default() },
///     ..ComparisonOptions::default()
/// };
/// let comparison = Comparison::of(&Subject::new("ball", &ball), &options, Progress::SILENT)?;
/// assert_eq!(comparison.against(), "facet");
/// let degrees = comparison.report().method("smooth").and_then(|method| method.inner_mean());
/// assert!(degrees.is_some_and(|degrees| (1.0..11.0).contains(&degrees)), "{degrees:?}");
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Comparison {
    /// Names and sizes of model and reference.
    pub subject: SubjectReport,
    /// All parameters of the images.
    pub parameters: Parameters,
    /// The rules behind the figures.
    pub rules: Rules,
    /// The methods that could be rendered, in their order, then the reference.
    pub surfaces: Vec<RenderedSurface>,
    /// The methods that could not be rendered.
    pub skipped: Vec<SkippedMethod>,
    /// The index in `surfaces` of the one with which the others are compared: the reference, else the first method.
    pub against: usize,
    /// The true normal at the point of the model seen in each pixel; the fourth channel is 1 where there is one.
    pub truth: Image,
    /// The fraction of covered samples without a corresponding point on the reference, [0, 1].
    pub unmatched: f64,
    /// `true` for each pixel away from silhouettes, row by row.
    pub inner: Vec<bool>,
    /// `true` for each pixel that shows the model or the reference, at least in one sample: images are compared over
    /// these pixels, and under a baseline over those of the surface.
    pub covered: Vec<bool>,
    /// The pixels whose normals are listed.
    pub points: Vec<[u32; 2]>,
    /// Counts of what could not be rendered as requested.
    pub warnings: Warnings,
    /// Notes on maps that were derived from others.
    pub notes: Vec<String>,
}

impl Comparison {
    /// Renders the model by every method and the reference, and measures them. `progress` has one stage, `compare`.
    ///
    /// A method that the model's materials do not support is skipped; see [`Comparison::skipped`].
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for options that cannot be satisfied and if no method can be
    /// rendered, those of rendering, and [`Error::Cancelled`](crate::Error::Cancelled).
    pub fn of(subject: &Subject<'_>, options: &ComparisonOptions, progress: Progress<'_>) -> Result<Self> {
        options.check()?;
        let mut photographer = Photographer::new(subject, options, progress.stage("compare"))?;
        subject.check_place(&mut photographer.warnings);
        let mut scene = subject.model.scene.clone();
        let mut relief = Relief::new(&mut scene, options.settings.surface.tangents)?;
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
        let covered = photographer.covered();
        let expected = Expected { normals: &truth.normals, inner: &inner, covered: &covered };
        photographer.measure(&mut surfaces, against, &expected)?;
        let seen = covered_samples(&smooth.normals);
        Ok(Self {
            subject: subject.report(),
            parameters: photographer.parameters(),
            rules: Rules::new(options.matching, &options.points),
            points: options.points.choose(&inner, options.settings.width as usize),
            unmatched: (seen - covered_samples(&truth.matched)) / seen.max(1.0),
            surfaces,
            skipped,
            against,
            truth: truth.normals,
            inner,
            covered,
            warnings: photographer.warnings,
            notes: relief.notes().to_vec(),
        })
    }

    /// Returns the name of the surface with which the others are compared.
    pub fn against(&self) -> String {
        self.surfaces[self.against].id()
    }
}

/// Returns the number of samples that saw something.
fn covered_samples(image: &Image) -> f64 {
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
    /// Returns the reference's normals at the points of the model that `smooth` shows.
    fn on(reference: &Scene, photographer: &Photographer<'_>, smooth: &Look) -> Result<Self> {
        let matched = match photographer.options.matching {
            Matching::Pixel => photographer.look(reference, None)?.normals,
            matching => matching.normals(smooth, reference, photographer.diagonal)?,
        };
        Ok(Self { normals: smooth.mean_normals(&matched)?, matched })
    }
}
