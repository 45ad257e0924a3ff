//! `taotie verify`: how far an asset, made by any program, is from its scan.

use crate::bake::clock::Clock;
use crate::bake::scan_args::ScanArgs;
use crate::bake::text;
use crate::limits::LimitArgs;
use crate::proof_args::ProofArgs;
use crate::running::RunArgs;
use crate::{Outcome, console, stop};
use anyhow::{Result, bail};
use clap::Args;
use std::path::PathBuf;
use taotie::Progress;
use taotie::asset::{self, Report, ScanFile, Warning};
use taotie_report::bake_page;

const EXAMPLES: &str = "\
Examples:
  taotie verify asset.glb --scan scan.ply --require standard
  taotie verify packed.glb --scan scan.glb -o packed.proof.html
  taotie verify bracket.glb --scan bracket.stl --crease-angle 30";

/// Compares an asset, made by any program, with the scan that it should look like.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct VerifyArgs {
    /// The asset (.gltf, .glb, .obj, .ply, .stl), in the space of the scan. Each of its levels of detail is compared
    pub asset: PathBuf,
    /// The high-poly scan (.gltf, .glb, .obj, .ply, .stl)
    #[arg(long, value_name = "SCAN")]
    pub scan: PathBuf,
    /// The page to write (.html), with its figures as .json beside it
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
    /// Refuses options that cannot work, before any work is done.
    fn check(&self) -> Result<()> {
        match &self.output {
            Some(path) if !path.extension().is_some_and(|end| end.eq_ignore_ascii_case("html")) => {
                bail!("{}: the page of a proof is written as .html", path.display())
            }
            _ => Ok(()),
        }
    }
}

/// Runs the subcommand.
pub fn run(args: &VerifyArgs) -> Result<Outcome> {
    args.check()?;
    let report = args.run.in_pool(|| verify(args))??;
    match args.run.json {
        true => console::result(&serde_json::to_string_pretty(&report)?)?,
        false => console::result(&text::of(&report))?,
    }
    Ok(if report.is_met() { Outcome::Fine } else { Outcome::Different })
}

fn verify(args: &VerifyArgs) -> Result<Report> {
    let files = stop::files();
    files.protect([&args.asset, &args.scan])?;
    let pages: Vec<PathBuf> =
        args.output.iter().flat_map(|html| [html.clone(), html.with_extension("json")]).collect();
    pages.iter().try_for_each(|path| files.claim(path))?;
    let clock = Clock::default();
    let listener = |stage: &'static str, fraction: f64| {
        clock.hear(stage, fraction);
        true
    };
    let progress = Progress::new(&listener);
    let file = ScanFile::read(&args.scan, &args.limits.limits(), progress)?;
    let scan = file.with_options(args.reading.options()).into_scan(progress)?;
    console::say_warnings(scan.warnings());
    let proof = asset::verify(&args.asset, &scan, &args.proof.options(), progress)?;
    console::say_warnings(&proof.warnings);
    let mut report = Report::of_proof(&args.asset, &scan, &proof)?;
    report.required = proof.require(&args.proof.requirements());
    report.stages = clock.done();
    if let [html, json] = &pages[..] {
        let page = bake_page::page(&report, &proof, None)?;
        let (page, warnings) = bake_page::html_with_asset(&page, &proof, &args.asset);
        console::say_warnings(&warnings);
        report.warnings.extend(Warning::list(&warnings));
        report.files.clone_from(&pages);
        files.write_text(html, &page)?;
        files.write_text(json, &serde_json::to_string_pretty(&report)?)?;
        files.commit()?;
    }
    Ok(report)
}
