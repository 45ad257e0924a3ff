//! `taotie bake`: a high-poly scan to a low-poly asset with a normal map, and its measured error.

mod args;
mod clock;
mod purpose;
mod stop;
mod text;

pub use args::BakeArgs;

use crate::{Outcome, console, studio};
use anyhow::Result;
use clock::Clock;
use taotie::asset::{Asset, Baker, Limits, Proof, Report, Scan, ScanFile, VerifyOptions, Warning};
use taotie::{Progress, io};
use taotie_report::bake_page;

/// Runs the subcommand.
pub fn run(args: &BakeArgs) -> Result<Outcome> {
    args.check()?;
    if let Some(chosen) = args.chosen() {
        console::say(&format!("taotie: {chosen}"));
    }
    stop::listen();
    let report = studio::in_pool(args.threads, || bake(args))??;
    if args.json {
        console::result(&serde_json::to_string_pretty(&report)?)?;
    } else {
        console::result(&text::of(&report))?;
    }
    Ok(if report.is_met() { Outcome::Fine } else { Outcome::Different })
}

fn bake(args: &BakeArgs) -> Result<Report> {
    let clock = Clock::default();
    let listener = |stage: &'static str, fraction: f64| {
        clock.hear(stage, fraction);
        stop::go_on()
    };
    let progress = Progress::new(&listener);
    let limits = args.limits();
    let baker = Baker::new(args.options()).with_limits(limits);
    let scan = read(args, &baker, limits, progress)?;
    let asset = baker.bake(&scan, progress)?;
    console::say_warnings(asset.warnings());
    let written = asset.write(&args.output, &args.packing(), progress)?;
    console::say_warnings(written.warnings());
    let mut report = Report::of(&written)?;
    let proved = match args.no_verify {
        true => None,
        false => Some(written.verify(scan, &VerifyOptions::default(), progress)),
    };
    if matches!(proved, Some(Err(taotie::Error::Cancelled))) {
        // The files are of this run, and were not verified.
        report.files.iter().for_each(|file| drop(std::fs::remove_file(file)));
    }
    report.stages = clock.done();
    if let Some(proof) = proved {
        tell(args, &mut report, &proof?, written.asset())?;
    }
    Ok(report)
}

/// Reads the scan, and says how much memory its bake needs before it begins.
fn read(args: &BakeArgs, baker: &Baker, limits: Limits, progress: Progress<'_>) -> Result<Scan> {
    let file = ScanFile::read(&args.high, &limits, progress)?;
    let need = baker.need(file.size());
    need.check(limits)?;
    let (triangles, bytes) = (need.scan.triangles, need.bytes());
    console::say(&format!("baking {triangles} triangles needs about {bytes} of memory"));
    Ok(file.sort(progress)?)
}

/// Puts what was measured into the report, and writes it beside the asset.
fn tell(args: &BakeArgs, report: &mut Report, proof: &Proof, asset: &Asset) -> Result<()> {
    console::say_warnings(&proof.warnings);
    report.warnings.extend(Warning::list(&proof.warnings));
    report.proof = Some(proof.figures.clone());
    report.required = proof.require(&args.require);
    let [html, json] = ["report.html", "report.json"].map(|kind| args.output.with_extension(kind));
    report.files.extend([html.clone(), json.clone()]);
    let page = bake_page::page(report, proof, asset)?;
    io::write_text(&html, &taotie_report::html(&page))?;
    io::write_text(&json, &serde_json::to_string_pretty(report)?)?;
    Ok(())
}
