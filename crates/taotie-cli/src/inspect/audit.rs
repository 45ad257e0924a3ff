//! The report of `taotie inspect --audit`: checks a model against the schema of an auditor.

use super::InspectArgs;
use super::text::warnings;
use super::values::clean;
use crate::{Outcome, console};
use anyhow::Result;
use serde::Serialize;
use std::path::Path;
use taotie::asset::{Bytes, Limits};
use taotie::inspection::{Audit, AuditSchema, CheckStatus, ProductInfo, audit_bytes};
use taotie_engine::names::Named;
use taotie_engine::render::scene_bytes;
use taotie_io::Loaded;
use taotie_report::table::Table;

/// Version of the JSON that `--audit --json` prints.
const SCHEMA: u32 = 1;

/// The printed report.
#[derive(Debug, Serialize)]
struct Report {
    /// [`SCHEMA`].
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

/// Audits a model against the schema in a file.
pub fn run(args: &InspectArgs, schema_path: &Path) -> Result<Outcome> {
    let limits = args.limits.limits();
    let schema = AuditSchema::parse(&taotie_io::read_bytes(schema_path)?, schema_path.display())?;
    let product = args
        .product_info
        .as_ref()
        .map(|path| ProductInfo::parse(&taotie_io::read_bytes(path)?, path.display()));
    let product = product.transpose()?;
    let loaded = taotie_io::load_model_within(&args.model, &limits)?;
    check_memory(args, &loaded, (&schema, &limits))?;
    let report = Report {
        schema: SCHEMA,
        version: env!("CARGO_PKG_VERSION"),
        model: args.model.display().to_string(),
        audit_schema: schema_path.display().to_string(),
        audit: Audit::of(&loaded, &schema, product.as_ref())?,
    };
    let printed = match args.json {
        true => console::result(&serde_json::to_string_pretty(&report)?),
        false => console::result(text(&report).trim_end()),
    };
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
    let need = scene_bytes(&loaded.scene) + audit_bytes(&loaded.scene, schema);
    Ok(limits.check(args.model.display().to_string(), Bytes(need))?)
}

/// Returns the report as text.
fn text(report: &Report) -> String {
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
