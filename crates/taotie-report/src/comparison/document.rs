//! `report.json`: the library's report of a comparison with the caller's options.

use serde::Serialize;
use serde_json::Value;
use taotie::Warning;
use taotie::comparison::{
    Comparison, MethodReport, MethodTime, Parameters, PointReport, Rules, SkippedMethod, SubjectReport,
};
use taotie_engine::{Error, Result};

/// Version of `report.json`.
pub const SCHEMA: u32 = 4;

/// The content of `report.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Document {
    /// Version of this layout.
    pub schema: u32,
    /// The kind of report.
    pub kind: &'static str,
    /// Version of the program.
    pub version: &'static str,
    /// The names and sizes of model and reference.
    pub subject: SubjectReport,
    /// The surface that errors are measured against: `reference`, or the first method.
    pub against: String,
    /// Camera, light, film and all other inputs of the pictures.
    pub parameters: Value,
    /// The share of covered samples without a corresponding point on the reference, [0, 1].
    pub unmatched: f64,
    /// The rules for choosing pixels and points, and the meaning of the figures.
    pub rules: Rules,
    /// The methods in order, then the reference.
    pub methods: Vec<MethodReport>,
    /// Methods that could not be rendered.
    pub skipped: Vec<SkippedMethod>,
    /// Normals at sample points.
    pub points: Vec<PointReport>,
    /// Notes on maps that were derived from others.
    pub notes: Vec<String>,
    /// The duration of each of `methods`; everything else is the same in every run.
    pub times: Vec<MethodTime>,
    /// Warnings about anything that could not be rendered as requested, with counts.
    pub warnings: Vec<Warning>,
}

/// The inputs of the pictures: those of the comparison, and the caller's.
#[derive(Serialize)]
struct DocumentParameters<'a> {
    #[serde(flatten)]
    parameters: &'a Parameters,
    /// The options that replace parts of the model's materials; `None` if there are none.
    material: &'a Value,
    /// The environment; `None` if there is none.
    environment: &'a Value,
    /// The angle at the top of the heat maps' scale, degrees.
    heat_top_deg: f64,
}

/// The options for the files of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// The heading of the page.
    pub title: String,
    /// The angle at the top of the heat maps' scale, degrees.
    pub heat_top_deg: f64,
    /// The choice of material, repeated in `report.json`; null if there is none.
    pub material: Value,
    /// The choice of environment, repeated in `report.json`; null if there is none.
    pub environment: Value,
    /// Also writes normals and angular errors as OpenEXR: unencoded unit vectors in world space, and degrees.
    pub exr: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            title: "Comparison".into(),
            heat_top_deg: 30.0,
            material: Value::Null,
            environment: Value::Null,
            exr: false,
        }
    }
}

impl Document {
    /// Adds the caller's options to the report of a comparison.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a parameter cannot be written as JSON, which does not occur.
    pub fn new(comparison: &Comparison, options: &Options) -> Result<Self> {
        let report = comparison.report();
        let parameters = DocumentParameters {
            parameters: &report.parameters,
            material: &options.material,
            environment: &options.environment,
            heat_top_deg: options.heat_top_deg,
        };
        let parameters = serde_json::to_value(parameters).map_err(not_json)?;
        Ok(Self {
            schema: SCHEMA,
            kind: "taotie compare",
            version: env!("CARGO_PKG_VERSION"),
            subject: report.subject,
            against: report.against,
            parameters,
            unmatched: report.unmatched,
            rules: report.rules,
            methods: report.methods,
            skipped: report.skipped,
            points: report.points,
            notes: report.notes,
            times: report.times,
            warnings: report.warnings,
        })
    }

    /// Returns the document as JSON, without a trailing newline.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a number cannot be written as JSON, which does not occur.
    pub fn json(&self) -> Result<String> {
        serde_json::to_string_pretty(self).map_err(not_json)
    }

    /// Returns `true` if a surface is measured against another; a single surface is at most compared with its
    /// own image under the baseline.
    pub fn is_compared(&self) -> bool {
        self.methods.iter().any(|method| method.error.is_some())
    }

    /// Returns the figures of the method `name`.
    pub fn method(&self, name: &str) -> Option<&MethodReport> {
        self.methods.iter().find(|method| method.method == name)
    }
}

fn not_json(error: serde_json::Error) -> Error {
    Error::invalid("report.json", error.to_string())
}
