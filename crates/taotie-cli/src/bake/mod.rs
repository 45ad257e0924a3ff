//! `taotie bake`: a high-poly scan to a low-poly asset with a normal map, and its measured error.

mod args;
pub mod clock;
mod request;
pub mod text;

pub use args::BakeArgs;

use crate::device::{Device, DeviceReport, Machine};
use crate::{Outcome, console, stop};
use anyhow::Result;
use clock::{Clock, Schedule};
use serde::Serialize;
use taotie::Limits;
use taotie::asset::{Baker, Certificate, MemoryEstimate, Proof, Report, Requirement, ScanFile, WrittenAsset};
use taotie_engine::{Progress, Warnings};
use taotie_io::FileSet;
use taotie_report::bake_page;

/// Runs the subcommand.
pub fn run(args: &BakeArgs) -> Result<Outcome> {
    args.check()?;
    let files = stop::files();
    args.claim(&files)?;
    let machine = Machine::find(args.device, None)?;
    let report = args.run.in_pool(|| bake(args, &files, &machine))??;
    machine.report("cast rays", "");
    console::report(args.run.json, &Printed::of(&report, (args.device, &machine)), |printed| {
        text::of(printed.report)
    })?;
    Ok(if report.is_met() { Outcome::Fine } else { Outcome::Different })
}

/// The report as `--json` prints it.
#[derive(Serialize)]
struct Printed<'a> {
    #[serde(flatten)]
    report: &'a Report,
    /// The device that cast the rays of projections, occlusion and bent normals; only written if the CPU was not requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    device: Option<DeviceReport<'a>>,
}

impl<'a> Printed<'a> {
    fn of(report: &'a Report, (device, machine): (Device, &'a Machine)) -> Self {
        Self { report, device: (device != Device::Cpu).then(|| machine.report_of(device, false)) }
    }
}

fn bake(args: &BakeArgs, files: &FileSet, machine: &Machine) -> Result<Report> {
    let clock = Clock::default();
    let listener = |stage: &'static str, fraction: f64| {
        clock.hear(stage, fraction);
        true
    };
    let progress = Progress::new(&listener);
    let limits = args.limits();
    let baker = Baker::new(args.options()).with_limits(limits).with_files(files);
    let file = ScanFile::read_all(&args.high, args.scan.options(), &limits, progress)?;
    Requirement::check_unit(&args.proof.requirements(), file.unit())?;
    let need = baker.need(file.size());
    check_memory(args, &if machine.is_gpu() { need.with_device() } else { need }, limits)?;
    if let Some(schedule) = Schedule::of(baker.options(), file.size(), args.is_packed()) {
        clock.expect(schedule);
    }
    files.protect(file.files())?;
    let scan = machine.casting(file.into_scan(progress)?);
    let asset = baker.bake(&scan, progress)?;
    console::say_warnings(asset.warnings());
    let written = asset.write_in(files, &args.output, &args.packing(), progress)?;
    console::say_warnings(written.warnings());
    let mut report = Report::of(&written)?;
    let proved = match args.no_verify {
        true => None,
        false => Some(written.verify(scan, &bake_page::options(args.proof_options(), true), progress)),
    };
    if let Some(path) = &args.trials {
        files.write_text(path, &bake_page::trials_csv(&report.trials))?;
        report.files.push(path.clone());
    }
    report.stages = clock.done();
    if let Some(proof) = proved {
        let proof = proof?;
        add_proof(args, &mut report, (&written, &proof))?;
        let shown = args.shown_model().map(|path| files.current(path));
        let page = bake_page::page(&report, &proof, Some(written.asset()))?;
        console::show(&page.features);
        let (page, warnings) = match &shown {
            Some(path) => bake_page::html_with_asset(&page, (&proof, Some(written.asset())), path),
            None => (taotie_report::html(&page), Warnings::default()),
        };
        console::say_warnings(&warnings);
        report.warnings.extend(warnings.list());
        let [html, json] = args.reports();
        files.write_text(&html, &page)?;
        let printed = Printed::of(&report, (args.device, machine));
        files.write_text(&json, &serde_json::to_string_pretty(&printed)?)?;
    }
    files.commit()?;
    Ok(report)
}

/// Checks and prints the memory that the bake of a scan needs, before it starts.
fn check_memory(args: &BakeArgs, baked: &MemoryEstimate, limits: Limits) -> Result<()> {
    let written = baked.with_packing(&args.packing());
    let need = match (args.no_verify, args.shown_model()) {
        (true, _) => written,
        (false, None) => written.with_proof(),
        (false, Some(_)) => written.with_proof().with_viewer(taotie_report::viewer::MOST_TEXTURE_SIDE),
    };
    need.check(limits)?;
    let (triangles, bytes) = (need.scan.triangles, need.bytes());
    console::say(&format!("baking {triangles} triangles needs about {bytes} of memory"));
    Ok(())
}

/// Adds the measurements to the report.
fn add_proof(args: &BakeArgs, report: &mut Report, (written, proof): (&WrittenAsset, &Proof)) -> Result<()> {
    let (options, signature) = (args.proof_options(), args.proof.signature());
    console::say_warnings(&proof.warnings);
    report.warnings.extend(proof.warnings.list());
    report.prove(proof.figures.clone(), proof.maps.clone());
    report.certificate = Some(Certificate::of_written(written, &proof.figures, &options, &signature)?);
    report.files.extend(args.reports());
    Ok(())
}
