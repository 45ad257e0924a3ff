//! `taotie compare`: one model by several surface methods, in pictures, tables and angles.

mod args;
mod comparison;
mod convert;
mod files;
mod look;
mod matching;
mod method;
mod page;
mod paper;
mod points;
mod reference;
mod relief;
mod report;
mod text;

pub use args::CompareArgs;
pub use comparison::{Comparison, Plan, Subject};
pub use matching::Matching;
pub use method::Method;
pub use points::PointChoice;
pub use report::{Report, SubjectReport};

use crate::console;
use crate::studio::{self, Viewpoint, in_pool};
use anyhow::{Context, Result};
use files::Files;
use std::path::{Path, PathBuf};
use taotie::render::{RenderSettings, SurfaceSettings};
use taotie::scene::Scene;

pub use files::{developed, heat_of_angles, heat_of_flip};
pub use page::legend;

/// Where a comparison is written to, and how.
pub struct Destination<'a> {
    /// The folder; made if it is not there.
    pub folder: &'a Path,
    /// The heading of the page.
    pub title: &'a str,
}

/// Runs the subcommand.
pub fn run(args: &CompareArgs) -> Result<()> {
    args.check()?;
    let (Some(model), Some(output)) = (&args.model, &args.output) else {
        return paper::run(args.running.json, args.output.as_deref());
    };
    let (report, files) = in_pool(args.running.threads, || compare_files(args, model, output))??;
    if args.running.json {
        return console::result(&serde_json::to_string_pretty(&report)?);
    }
    console::result(&text::of(&report))?;
    for file in &files {
        console::result(&format!("wrote {}", file.display()))?;
    }
    Ok(())
}

fn compare_files(args: &CompareArgs, model: &Path, output: &Path) -> Result<(Report, Vec<PathBuf>)> {
    let mut loaded = studio::load(model, &args.material, args.bump_scale)?;
    let mut warnings = std::mem::take(&mut loaded.warnings);
    let reference = match &args.reference {
        Some(path) => {
            Some(reference::load(path, args.material.material.as_deref(), &loaded.scene, &mut warnings)?)
        }
        None => None,
    };
    let viewpoint = Viewpoint::choose(&args.camera, args.framing(), &loaded.scene)?;
    let environment = args.light.environment(&mut warnings)?;
    let plan = Plan {
        methods: args.methods(),
        shadings: args.shadings(),
        points: args.points.clone(),
        matching: args.matching,
        camera: viewpoint.camera(0.0),
        lighting: studio::lighting(&args.light, environment.as_ref(), &loaded.scene, &viewpoint, 0.0)?,
        settings: settings(args),
        development: args.film.development(args.running.simd)?,
        heat_top_deg: args.heat_top_deg,
        material: args.material.json(),
        environment: args.light.environment_json(),
    };
    let subject = SubjectReport {
        model: model.display().to_string(),
        triangles: loaded.scene.triangle_count(),
        reference: args.reference.as_ref().map(|path| path.display().to_string()),
        reference_triangles: reference.as_ref().map(Scene::triangle_count),
    };
    let title = model.file_name().unwrap_or_default().to_string_lossy();
    let mut pair = Subject { scene: loaded.scene, reference };
    let mut comparison = Comparison::take(&mut pair, &plan).with_context(|| model.display().to_string())?;
    warnings.absorb(std::mem::take(&mut comparison.warnings));
    comparison.warnings = warnings;
    console::say_warnings(&comparison.warnings);
    let destination = Destination { folder: output, title: &title };
    write(&comparison, &plan, &subject, &destination)
}

/// Writes pictures, contact sheet, `report.json` and `report.html`; returns the report and the files.
///
/// # Errors
/// Where a file cannot be written.
pub fn write(
    comparison: &Comparison,
    plan: &Plan,
    subject: &SubjectReport,
    destination: &Destination<'_>,
) -> Result<(Report, Vec<PathBuf>)> {
    let mut files = Files::new(destination.folder, plan.heat_top_deg as f32)?;
    files.write(comparison)?;
    let report = Report::new(comparison, plan, subject)?;
    files.write_text("report.json", &serde_json::to_string_pretty(&report)?)?;
    let page = page::page(destination.title, &report, comparison, files.heat_top)?;
    files.write_text("report.html", &crate::report::html(&page))?;
    Ok((report, files.written))
}

fn settings(args: &CompareArgs) -> RenderSettings {
    args.reflection.apply(RenderSettings {
        width: args.size[0],
        height: args.size[1],
        samples: args.film.samples(),
        surface: SurfaceSettings {
            method: None,
            tangents: args.material.tangents,
            bump_scale: args.bump_scale.map(|scale| scale as f32),
            simd: args.running.simd,
        },
        shadows: args.light.shadows,
        ..RenderSettings::default()
    })
}
