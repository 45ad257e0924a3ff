//! `taotie inspect`: the content of a model file and its defects, or its audit against a schema.
//!
//! The library's [`Inspection`] is made once; the text and the JSON are two ways to print it.

mod report;
pub(crate) mod words;

use crate::running::{LimitArgs, in_pool};
use crate::{Outcome, console};
use anyhow::Result;
use clap::Args;
use report::{Report, warnings};
use serde::Serialize;
use std::path::{Path, PathBuf};
use taotie::inspection::{Audit, AuditSchema, CheckStatus, Inspection, ProductInfo};
use taotie::{Bytes, Limits};
use taotie_engine::names::Named;
use taotie_engine::render::{framing_bytes, scene_bytes};
use taotie_engine::scene::Scene;
use taotie_io::Loaded;
use taotie_report::table::Table;
use words::clean;

const EXAMPLES: &str = "\
Examples:
  taotie inspect statue.glb
  taotie inspect statue.obj --json
  taotie inspect statue.glb --audit schema.json

Counted as defects:
  UVs       triangles with a corner outside [0, 1], without UV area, or mirrored (UVs run clockwise)
  tangents  more than 1 % from unit length, more than 1 degree from perpendicular to the normal,
            triangles whose corners differ in handedness; if the material has a normal map, the
            angle to MikkTSpace's tangents
  texels    of a tangent-space normal map whose blue is not above one half";

/// Lists the content of a model file and its defects.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct InspectArgs {
    /// The model: .gltf, .glb, .obj, .ply, .stl or .fbx
    pub model: PathBuf,
    /// Print the report as JSON
    #[arg(long)]
    pub json: bool,
    /// Check the model against a schema of the Khronos glTF Asset Auditor instead; exit with 1 if a check fails
    #[arg(long, value_name = "SCHEMA")]
    pub audit: Option<PathBuf>,
    /// Dimensions of the product that the model shows, as JSON in the auditor's format
    #[arg(long, value_name = "FILE", requires = "audit")]
    pub product_info: Option<PathBuf>,
    #[command(flatten)]
    pub limits: LimitArgs,
}

/// Runs the subcommand.
pub fn run(args: &InspectArgs) -> Result<Outcome> {
    in_pool(None, || match &args.audit {
        Some(schema) => audit(args, schema),
        None => inspect(args).map(|()| Outcome::Fine),
    })?
}

fn inspect(args: &InspectArgs) -> Result<()> {
    let limits = args.limits.limits();
    let (loaded, sizes) = taotie_io::load_model_and_sizes(&args.model, &limits)?;
    limits.check(args.model.display().to_string(), Bytes(need(&loaded.scene)))?;
    let mut inspection = Inspection::of(&loaded);
    inspection.sizes = sizes;
    let report = Report::new(&args.model, inspection);
    console::report(args.json, &report, |report| report::text(report).trim_end().to_owned())
}

/// Returns the memory of an inspection, bytes: the scene, the tangents to compare its own with, and the counts.
fn need(scene: &Scene) -> u64 {
    /// Counts of a triangle, over all instances, bytes.
    const TRIANGLE: u64 = 12;
    scene_bytes(scene) + framing_bytes(scene, |_| true) + scene.triangle_count() as u64 * TRIANGLE
}

/// Version of the JSON that `--audit --json` prints.
const AUDIT_SCHEMA: u32 = 1;

/// The printed report of an audit.
#[derive(Debug, Serialize)]
struct AuditReport {
    /// [`AUDIT_SCHEMA`].
    schema: u32,
    /// Version of the program.
    version: &'static str,
    /// The path as given.
    model: String,
    /// The path of the schema.
    audit_schema: String,
    #[serde(flatten)]
    audit: Audit,
}

/// Audits a model against the schema in a file, for `--audit`.
fn audit(args: &InspectArgs, schema_path: &Path) -> Result<Outcome> {
    let limits = args.limits.limits();
    let schema = AuditSchema::parse(&taotie_io::read_bytes(schema_path)?, schema_path.display())?;
    let product = args
        .product_info
        .as_ref()
        .map(|path| ProductInfo::parse(&taotie_io::read_bytes(path)?, path.display()));
    let product = product.transpose()?;
    let loaded = taotie_io::load_model_within(&args.model, &limits)?;
    check_memory(args, &loaded, (&schema, &limits))?;
    let report = AuditReport {
        schema: AUDIT_SCHEMA,
        version: env!("CARGO_PKG_VERSION"),
        model: args.model.display().to_string(),
        audit_schema: schema_path.display().to_string(),
        audit: Audit::of(&loaded, &schema, product.as_ref())?,
    };
    let printed = console::report(args.json, &report, |report| audit_text(report).trim_end().to_owned());
    match printed {
        // The exit code stays the same if the pipe is closed.
        Err(error) if !console::is_broken_pipe(&error) => return Err(error),
        _ => {}
    }
    Ok(if report.audit.passed { Outcome::Fine } else { Outcome::Different })
}

fn check_memory(
    args: &InspectArgs,
    loaded: &Loaded,
    (schema, limits): (&AuditSchema, &Limits),
) -> Result<()> {
    let need = scene_bytes(&loaded.scene) + Audit::memory(&loaded.scene, schema);
    Ok(limits.check(args.model.display().to_string(), Bytes(need))?)
}

/// Returns the report of an audit as text.
fn audit_text(report: &AuditReport) -> String {
    let audit = &report.audit;
    let mut head = Table::untitled(&["", ""]);
    head.row(["model".into(), clean(&report.model)]);
    let schema = format!("{}, version {}", report.audit_schema, audit.schema_version);
    head.row(["schema".into(), clean(&schema)]);
    head.row(["result".into(), summary(audit)]);
    let mut checks = Table::untitled(&["", "", ""]);
    for check in &audit.checks {
        let name = |name: &str| name.replace('-', " ");
        checks.row([name(check.status.name()), name(check.name.name()), clean(&check.message)]);
    }
    let text = format!("{}\nChecks\n{}", head.lines(0), checks.lines(2));
    match warnings(&audit.warnings) {
        lines if lines.is_empty() => text,
        lines => format!("{text}\nWarnings\n{lines}"),
    }
}

fn summary(audit: &Audit) -> String {
    let count = |status| audit.checks.iter().filter(|check| check.status == status).count();
    let [passed, failed, not_tested] =
        [CheckStatus::Pass, CheckStatus::Fail, CheckStatus::NotTested].map(count);
    format!("{failed} failed, {passed} passed, {not_tested} not tested")
}
