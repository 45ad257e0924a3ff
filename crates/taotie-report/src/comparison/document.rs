//! `report.json`: the library's report with what the caller adds.

use super::Options;
use serde::Serialize;
use serde_json::{Value, json};
use taotie::comparison::{
    Comparison, CountedWarning, MethodReport, MethodTime, PointReport, Rules, SkippedMethod, SubjectReport,
};
use taotie::{Error, Result};

/// Version of `report.json`.
pub const SCHEMA: u32 = 3;

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
    /// Names and sizes of model and reference.
    pub subject: SubjectReport,
    /// The surface that errors are measured against: `reference`, or the first method.
    pub against: String,
    /// Camera, light, film and whatever else the pictures depend on.
    pub parameters: Value,
    /// Of the covered samples, the part without a corresponding point on the reference, [0, 1].
    pub unmatched: f64,
    /// The rules by which pixels and points are chosen, and the meaning of the figures.
    pub rules: Rules,
    /// The methods in their order, then the reference.
    pub methods: Vec<MethodReport>,
    /// Methods that could not be drawn.
    pub skipped: Vec<SkippedMethod>,
    /// Normals at sample points.
    pub points: Vec<PointReport>,
    /// Notes on maps that were derived from others.
    pub notes: Vec<String>,
    /// The duration of each of `methods`: all that differs from run to run.
    pub times: Vec<MethodTime>,
    /// Whatever could not be drawn as asked, counted.
    pub warnings: Vec<CountedWarning>,
}

impl Document {
    /// Adds the caller's options to the report of a comparison.
    ///
    /// # Errors
    /// [`Error::Invalid`] where a parameter cannot be written as JSON; every parameter can.
    pub fn new(comparison: &Comparison, options: &Options) -> Result<Self> {
        let report = comparison.report();
        let mut parameters = serde_json::to_value(&report.parameters).map_err(not_json)?;
        parameters["material"] = options.material.clone();
        parameters["environment"] = options.environment.clone();
        parameters["heat_top_deg"] = json!(options.heat_top_deg);
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

    /// Returns the document as JSON, without an end of line.
    ///
    /// # Errors
    /// [`Error::Invalid`] where a number cannot be written as JSON; every number can.
    pub fn json(&self) -> Result<String> {
        serde_json::to_string_pretty(self).map_err(not_json)
    }

    /// Returns `true` where a surface is measured against another; one alone is compared with its own pictures at most.
    pub fn is_compared(&self) -> bool {
        self.methods.iter().any(|method| method.error.is_some())
    }

    /// Returns the figures of a method by its name.
    pub fn method(&self, name: &str) -> Option<&MethodReport> {
        self.methods.iter().find(|method| method.method == name)
    }
}

fn not_json(error: serde_json::Error) -> Error {
    Error::invalid("report.json", error.to_string())
}
