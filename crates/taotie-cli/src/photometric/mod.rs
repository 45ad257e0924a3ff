//! `taotie photometric`: normals from photographs, with their uncertainty.

mod args;
mod files;
mod materials;
mod order;
mod page;
mod relight;
mod report;
mod scan;

pub use args::PhotometricArgs;
pub use files::Output;

use crate::bake::clock::Clock;
use crate::{console, stop};
use anyhow::{Result, bail};
use args::ANCHORED;
use files::albedo_codes;
use materials::MaterialsReport;
use order::Order;
use page::PhotometricPage;
use relight::Relighting;
use report::{Errors, Report};
use scan::Scan;
use std::path::Path;
use taotie::comparison::diff::guessed_encoding;
use taotie_batch::EstimateFigures;
use taotie_engine::compare::{NormalEncoding, Summary, angular_error, stored_normals};
use taotie_engine::image::Image;
use taotie_engine::{Error, Progress, Warnings};
use taotie_photometric::{Estimate, Estimator, PhotographSet, Samples, averaged};

/// Runs the subcommand.
pub fn run(args: &PhotometricArgs) -> Result<()> {
    if let Some(model) = &args.model {
        let report = args.run.in_pool(|| materials::run(args, model))??;
        return console::report(args.run.json, &report, MaterialsReport::text);
    }
    let report = args.run.in_pool(|| estimate(args))??;
    console::report(args.run.json, &report, Report::text)
}

fn estimate(args: &PhotometricArgs) -> Result<Report> {
    let mut warnings = Warnings::default();
    let files = stop::files();
    let clock = Clock::default();
    let listener = |stage: &'static str, fraction: f64| {
        clock.hear(stage, fraction);
        true
    };
    let progress = Progress::new(&listener);
    let (options, limits) = (args.options(), args.memory.limits());
    options.check()?;
    let set = PhotographSet::open_with(&args.input, &options.setup(limits), &mut warnings, progress)?;
    args.claim(&files, &set)?;
    let scan = Scan::read(args, &files, &mut warnings)?;
    let truth = args.truth.as_deref().map(|path| read_truth(args, path)).transpose()?;
    let order = Order {
        input: args.input.display().to_string(),
        set: &set,
        options: &options,
        output: &args.output,
        files: &files,
        limits,
        has_page: true,
        is_portable: false,
        scan,
        truth,
        progress,
    };
    relight::claim(&order)?;
    let mut report = make(&order, &mut warnings)?;
    report.stages = clock.done();
    files.write_text(&order.path("report.json"), &serde_json::to_string_pretty(&report)?)?;
    files.commit()?;
    console::say_warnings(&warnings);
    Ok(report)
}

/// Makes an estimate that a collection orders: adds its files to their set. None of them contains folder names or times.
///
/// # Errors
/// Those of the estimate, and of files that cannot be written.
pub fn fill(
    order: &taotie_batch::Order<'_>,
    warnings: &mut Warnings,
) -> taotie_engine::Result<EstimateFigures> {
    let report = report_of(order, warnings).map_err(|error| match error.downcast::<Error>() {
        Ok(error) => error,
        Err(error) => Error::invalid(order.name, console::causes(&error)),
    })?;
    let sigma = |of: fn(&Summary) -> f64| report.sigma.as_ref().map(of);
    Ok(EstimateFigures {
        photographs: report.photographs.len(),
        size: report.size,
        pixels: report.pixels,
        layout: report.layout.into(),
        sigma_median: sigma(|sigma| sigma.median),
        sigma_mean: sigma(|sigma| sigma.mean),
        sigma_p95: sigma(|sigma| sigma.p95),
        worst_residual: report.photographs.iter().map(|photograph| photograph.residual).reduce(f64::max),
        ..EstimateFigures::default()
    })
}

fn report_of(order: &taotie_batch::Order<'_>, warnings: &mut Warnings) -> Result<Report> {
    let order = Order {
        input: order.name.into(),
        set: order.set,
        options: &order.settings.options,
        output: order.folder,
        files: order.files,
        limits: order.limits,
        has_page: order.settings.report,
        is_portable: true,
        scan: None,
        truth: None,
        progress: order.progress,
    };
    relight::claim(&order)?;
    let report = make(&order, warnings)?;
    order.files.write_text(&order.path("report.json"), &serde_json::to_string_pretty(&report)?)?;
    Ok(report)
}

/// Estimates the normals, and adds all files to the set except for `report.json`, which is for the caller.
fn make(order: &Order<'_>, warnings: &mut Warnings) -> Result<Report> {
    let Order { set, options, files, progress, .. } = *order;
    let reading = options.reading(order.limits);
    let samples = Samples::read(set, &reading, progress.begin("read")?)?;
    let size = [samples.width, samples.height];
    let truth = order.truth.as_ref().map(|truth| averaged(truth, size)).transpose()?;
    let estimate = Estimate::noted(&samples, warnings, progress)?;
    let mut relief = estimate.relief(progress.begin("depth")?)?;
    let anchor = |scan: &Scan| scan.anchor(&mut relief, (&order.path(ANCHORED), files), warnings);
    let anchoring = order.scan.as_ref().map(anchor).transpose()?;
    progress.begin("write")?;
    let output = Output { folder: order.output, options, files, estimate: &estimate, relief: &relief };
    warnings.absorb(output.write()?);
    let relightable = Relighting { order, reading: &reading }.write(&estimate)?;
    let mut report = Report::new(order, &samples, &estimate);
    report.truth = truth.as_ref().map(|truth| errors(&estimate, truth)).transpose()?;
    report.scan = anchoring;
    report.relight = relightable;
    report.warnings = warnings.list();
    if order.has_page {
        let page = PhotometricPage {
            report: &report,
            estimate: &estimate,
            albedo: &albedo_codes(&estimate),
            truth: truth.as_ref(),
        };
        let (page, found) = page.html(&files.current(&order.path("relief.glb")))?;
        warnings.absorb(found);
        files.write_text(&order.path("report.html"), &page)?;
        report.warnings = warnings.list();
    }
    Ok(report)
}

/// Returns the errors of each estimator in degrees.
fn errors(estimate: &Estimate, truth: &Image) -> Result<Errors> {
    let of = |estimator| -> Result<_> {
        match angular_error(&estimate.normals(estimator), truth)?.summary() {
            Some(summary) => Ok(summary),
            None => bail!("the true normals and the mask share no pixel"),
        }
    };
    Ok(Errors {
        least_squares: of(Estimator::LeastSquares)?,
        robust: of(Estimator::Robust)?,
        direct: of(Estimator::Direct)?,
        best: of(Estimator::Best)?,
        coverage: estimate.coverage(truth),
    })
}

/// Reads true normals.
fn read_truth(args: &PhotometricArgs, path: &Path) -> Result<Image> {
    let bitmap = taotie_io::read_bitmap_within(path, &args.memory.limits())?;
    let encoding = guessed_encoding(&bitmap)?.unwrap_or(NormalEncoding::Unit);
    Ok(stored_normals(&bitmap, encoding)?.normals)
}
