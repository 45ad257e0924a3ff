//! Comparisons: one model rendered by several surface methods, from one camera in one light, measured against a
//! high-poly reference or against the first method.
//!
//! [`Comparison::of`] renders and measures, [`Comparison::report`] returns the figures as plain data. [`diff`]
//! measures two images or normal maps.
//!
//! ```no_run
//! use taotie::comparison::{Comparison, ComparisonOptions, Method, Subject};
//! use taotie::surface::SurfaceMethod;
//! use taotie::{Progress, io};
//!
//! # fn main() -> taotie::Result<()> {
//! let low = io::load_model("low.glb".as_ref())?.scene;
//! let high = io::load_model("scan.ply".as_ref())?.scene;
//! let subject = Subject::new("low.glb", &low).with_reference("scan.ply", &high);
//! let methods = [SurfaceMethod::Smooth, SurfaceMethod::TangentNormal].map(Method::from).to_vec();
//! let options = ComparisonOptions { methods, ..ComparisonOptions::default() };
//! let report = Comparison::of(&subject, &options, Progress::SILENT)?.report();
//! println!("{:?} degrees", report.method("tangent-normal").and_then(|method| method.inner_mean()));
//! # Ok(())
//! # }
//! ```

mod compared;
mod convert;
pub mod diff;
mod look;
mod matching;
mod memory;
mod method;
mod options;
mod parameters;
mod photographer;
mod relief;
mod report;
mod rules;
mod sample_points;
mod subject;
mod surfaces;

pub use compared::Comparison;
pub use matching::Matching;
pub use method::Method;
pub use options::ComparisonOptions;
pub use parameters::Parameters;
pub use report::{
    CountedWarning, ErrorReport, MethodReport, MethodTime, ModelReport, PictureFigures, PictureReport,
    PointNormal, PointReport, Report,
};
pub use rules::Rules;
pub use sample_points::SamplePoints;
pub use subject::{NamedScene, Subject, SubjectReport, dress_reference};
pub use surfaces::{Difference, ModelDifference, PictureDifference, RenderedSurface, SkippedMethod};
