//! `taotie verify`: measures how far an asset, made with any program, is from its scan.

use crate::bake::clock::Clock;
use crate::bake::text;
use crate::proof_args::{ProofArgs, ScanArgs};
use crate::running::{LimitArgs, RunArgs};
use crate::{Outcome, console, stop};
use anyhow::{Result, bail};
use clap::Args;
use std::path::PathBuf;
use taotie::Limits;
use taotie::asset::{self, Certificate, ProvedFile, Report, Requirement, Scan, ScanFile, ScanOptions};
use taotie_engine::Progress;
use taotie_report::bake_page;

const EXAMPLES: &str = "\
Examples:
  taotie verify asset.glb --scan scan.ply --require standard
  taotie verify asset.glb --scan scan.stl --unit mm --require hausdorff=0.2mm,texel=50um
  taotie verify packed.glb --scan scan.glb -o packed.proof.html
  taotie verify bracket.glb --scan bracket.stl --crease-angle 30";

/// Compares an asset, made with any program, with the scan that it should look like.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct VerifyArgs {
    /// The asset (.gltf, .glb, .obj, .ply, .stl, .fbx), in the position of the scan: glTF in metres if the scan's unit is
    /// known, other formats in that unit. All of its levels of detail are compared
    pub asset: PathBuf,
    /// The high-poly scan (.gltf, .glb, .obj, .ply, .stl, .fbx). It is read as it was for the bake, if the asset records
    /// that; scan options override the record. May be repeated for a scan of several files
    #[arg(long, value_name = "SCAN", required = true)]
    pub scan: Vec<PathBuf>,
    /// The page to write (.html), with its figures as .json next to it
    #[arg(short, long, value_name = "OUT.html")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub reading: ScanArgs,
    #[command(flatten)]
    pub proof: ProofArgs,
    #[command(flatten)]
    pub limits: LimitArgs,
    #[command(flatten)]
    pub run: RunArgs,
}

impl VerifyArgs {
    /// Rejects options that cannot work, before any work is done.
    fn check(&self) -> Result<()> {
        self.proof.signature().check()?;
        match &self.output {
            Some(path) if !path.extension().is_some_and(|end| end.eq_ignore_ascii_case("html")) => {
                bail!("{}: the proof page is written as .html", path.display())
            }
            _ => Ok(()),
        }
    }
}

/// Runs the subcommand.
pub fn run(args: &VerifyArgs) -> Result<Outcome> {
    args.check()?;
    let report = args.run.in_pool(|| verify(args))??;
    console::report(args.run.json, &report, text::of)?;
    Ok(if report.is_met() { Outcome::Fine } else { Outcome::Different })
}

/// Reads the scan as the options specify, otherwise as the asset records it.
fn read_scan(args: &VerifyArgs, limits: &Limits, progress: Progress<'_>) -> Result<Scan> {
    let options = args.reading.options().or(ScanOptions::recorded(&args.asset, limits)?);
    let file = ScanFile::read_all(&args.scan, options, limits, progress)?;
    Requirement::check_unit(&args.proof.requirements(), file.unit())?;
    Ok(file.into_scan(progress)?)
}

fn verify(args: &VerifyArgs) -> Result<Report> {
    let files = stop::files();
    files.protect(args.scan.iter().chain([&args.asset]))?;
    let pages: Vec<PathBuf> =
        args.output.iter().flat_map(|html| [html.clone(), html.with_extension("json")]).collect();
    pages.iter().try_for_each(|path| files.claim(path))?;
    let clock = Clock::default();
    let listener = |stage: &'static str, fraction: f64| {
        clock.hear(stage, fraction);
        true
    };
    let progress = Progress::new(&listener);
    let scan = read_scan(args, &args.limits.limits(), progress)?;
    console::say_warnings(scan.warnings());
    let has_page = args.output.is_some() || console::shows_pictures();
    let options = args.proof.options_of_page(has_page);
    let proof = asset::verify(&args.asset, &scan, &options, progress)?;
    console::say_warnings(&proof.warnings);
    let mut report = Report::of_proof(&args.asset, &scan, &proof)?;
    let proved = ProvedFile { asset: &args.asset, scan: &scan };
    let certificate = Certificate::of_file(&proved, &proof.figures, &options, &args.proof.signature())?;
    report.certificate = Some(certificate);
    report.stages = clock.done();
    let page = if has_page { Some(bake_page::page(&report, &proof, None)?) } else { None };
    if let Some(page) = &page {
        console::show(&page.features);
    }
    if let (Some(page), [html, json]) = (&page, &pages[..]) {
        let (page, warnings) = bake_page::html_with_asset(page, (&proof, None), &args.asset);
        console::say_warnings(&warnings);
        report.warnings.extend(warnings.list());
        report.files.clone_from(&pages);
        files.write_text(html, &page)?;
        files.write_text(json, &serde_json::to_string_pretty(&report)?)?;
        files.commit()?;
    }
    Ok(report)
}
