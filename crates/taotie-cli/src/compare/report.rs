//! `report.json`: the library's report with what the command line adds.

use serde::Serialize;
use serde_json::{Value, json};
use taotie::compare::Summary;
use taotie::comparison::{
    self, CountedWarning, MethodReport, PointReport, Rules, SkippedMethod, SubjectReport,
};

/// Version of `report.json`.
pub const SCHEMA: u32 = 1;

/// The file as a whole.
#[derive(Serialize)]
pub struct Report {
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
    /// How pixels and points are chosen and what the figures mean.
    pub rules: Rules,
    /// The methods in their order, then the reference.
    pub methods: Vec<MethodReport>,
    /// Methods that could not be drawn.
    pub skipped: Vec<SkippedMethod>,
    /// Normals at sample points.
    pub points: Vec<PointReport>,
    /// Notes on maps that were derived from others.
    pub notes: Vec<String>,
    /// Whatever could not be drawn as asked, counted.
    pub warnings: Vec<CountedWarning>,
}

/// Options of the command line that the library does not know, for the report.
pub struct Echoes {
    /// The options of materials; null where there are none.
    pub material: Value,
    /// The environment; null where there is none.
    pub environment: Value,
    /// The angle at the top of the heat maps' scale, degrees.
    pub heat_top_deg: f64,
}

impl Report {
    /// Adds what the command knows to the library's report.
    ///
    /// # Errors
    /// Where a parameter cannot be written as JSON, which all can.
    pub fn new(report: comparison::Report, echoes: &Echoes) -> serde_json::Result<Self> {
        let mut parameters = serde_json::to_value(&report.parameters)?;
        parameters["material"] = echoes.material.clone();
        parameters["environment"] = echoes.environment.clone();
        parameters["heat_top_deg"] = json!(echoes.heat_top_deg);
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
            warnings: report.warnings,
        })
    }

    /// The figures of a method by its name.
    pub fn method(&self, name: &str) -> Option<&MethodReport> {
        self.methods.iter().find(|method| method.method == name)
    }
}

/// Mean, median, 95th percentile and maximum.
pub fn figures(summary: &Summary) -> [f64; 4] {
    [summary.mean, summary.median, summary.p95, summary.max]
}
