//! `taotie bake`: a scan's relief on a light mesh, and the proof that it looks the same.

mod args;
mod judgement;
mod memory;
mod page;
mod proof;
mod provenance;
mod report;
mod requirement;
mod search;
mod stages;
mod stop;
mod textures;
mod views;
mod work;

pub use args::BakeArgs;

use crate::{Outcome, console, studio};
use anyhow::Result;
use proof::Subject;
use report::Report;
use stages::Stages;
use taotie::Warnings;
use taotie::io::{self, GltfAsset, GltfFormat, GltfImages, GltfLevel};
use taotie::mesh::Mesh;
use work::{Light, Made, Source};

/// Runs the subcommand.
pub fn run(args: &BakeArgs) -> Result<Outcome> {
    args.check()?;
    stop::listen();
    let report = studio::in_pool(args.threads, || bake(args))??;
    if args.json {
        console::result(&serde_json::to_string_pretty(&report)?)?;
    } else {
        console::result(&report.text())?;
    }
    Ok(if report.is_met() { Outcome::Fine } else { Outcome::Different })
}

fn bake(args: &BakeArgs) -> Result<Report> {
    let (mut stages, mut warnings) = (Stages::default(), Warnings::default());
    let mut report = Report::begin(args);
    let source = Source::read(args, &mut stages, &mut warnings)?;
    report.high_triangles = source.scan.mesh().triangles().len();
    let (light, made) = lightened(args, &source, &mut report, (&mut stages, &mut warnings))?;
    let coarser = work::levels(args, &light, (&mut stages, &mut warnings))?;
    judgement::judge(&source, &light, &made, &mut warnings);
    if !args.no_verify {
        stages.run("inspect the scan", |_| {
            judgement::inspect(source.scan.mesh(), &mut warnings);
            Ok(())
        })?;
    }
    report.warnings = console::json_warnings(&warnings);
    if !args.json {
        console::say_warnings(&warnings);
    }
    report.maps = made.textures.notes();
    report.light = light.origin.clone();
    let ended = finish(args, Parts { source, light, coarser, made }, &mut report, &mut stages);
    if ended.as_ref().is_err_and(crate::console::is_cancelled) {
        // What stands there is of this run already, and nobody has proved it.
        report.files.iter().for_each(|file| drop(std::fs::remove_file(file)));
    }
    ended?;
    report.stages = stages.done().to_vec();
    Ok(report)
}

/// The light mesh and what was baked onto it; with `--error` the smallest that meets it.
fn lightened(
    args: &BakeArgs,
    source: &Source,
    report: &mut Report,
    (stages, warnings): (&mut Stages, &mut Warnings),
) -> Result<(Light, Made)> {
    if let Some(most) = args.error {
        let found = search::smallest(args, source, most, stages)?;
        report.size = [found.size; 2];
        report.trials = found.trials;
        warnings.absorb(found.warnings);
        return Ok((found.light, found.made));
    }
    let light = match &args.low {
        Some(path) => Light::read(path, args, stages, warnings)?,
        None => {
            let simplified = work::simplified(source, args.triangles, stages)?;
            work::note_simplified(&simplified, args.triangles, warnings);
            Light::made(source, &simplified, args.size, stages)?
        }
    };
    let made = work::bake_maps(args, args.size, (source, &light), stages)?;
    Ok((light, made))
}

/// What an asset is made of.
struct Parts {
    source: Source,
    light: Light,
    /// The levels of detail after the first.
    coarser: Vec<Mesh>,
    made: Made,
}

/// Writes the asset and its proof.
fn finish(args: &BakeArgs, parts: Parts, report: &mut Report, stages: &mut Stages) -> Result<()> {
    write(args, &parts, report, stages)?;
    if args.no_verify {
        return Ok(());
    }
    prove(args, parts, report, stages)
}

/// Writes the asset and what goes beside it, and notes the files in the report.
fn write(args: &BakeArgs, parts: &Parts, report: &mut Report, stages: &mut Stages) -> Result<()> {
    let Parts { source, light, coarser, made } = parts;
    let meshes: Vec<_> = std::iter::once(&light.mesh).chain(coarser).collect();
    report.triangles = meshes.iter().map(|mesh| mesh.triangles().len()).collect();
    report.high_sha256 = source.sha256()?;
    let xmp = provenance::packet(args, source, &report.high_sha256)?;
    let coverages = work::coverages(meshes.len());
    let levels: Vec<GltfLevel> = meshes
        .into_iter()
        .zip(coverages)
        .map(|(mesh, coverage)| GltfLevel { mesh, coverage: Some(coverage) })
        .collect();
    let name = args.output.file_stem().unwrap_or_default().to_string_lossy();
    let extras = made.textures.extras();
    let asset = GltfAsset {
        name: &name,
        levels: &levels,
        material: made.textures.material(&light.material, &light.kept),
        copyright: source.loaded.copyright.as_deref(),
        xmp: Some(&xmp),
        extras: extras.as_ref(),
    };
    let images = match (args.ktx2, args.webp) {
        (true, _) => GltfImages::Ktx2,
        (_, true) => GltfImages::WebP,
        _ => GltfImages::Png,
    };
    stages.run("write", |_| {
        let beside = made.textures.write_beside()?;
        report.files = io::write_gltf(&args.output, &asset, &GltfFormat { images, meshopt: args.meshopt })?;
        report.files.extend(beside);
        Ok(())
    })
}

/// Reads the asset back, measures it, and writes the report.
fn prove(args: &BakeArgs, parts: Parts, report: &mut Report, stages: &mut Stages) -> Result<()> {
    let Parts { source, light, made, .. } = parts;
    let object_map = made.textures.object_map();
    let subject = Subject {
        output: &args.output,
        files: &report.files,
        high: &args.high,
        light: &light.mesh,
        cage: &made.cage,
        counts: &made.counts,
        object_map: object_map.as_deref(),
        size: report.size[0],
    };
    let proved = proof::prove(&subject, source, stages)?;
    report.proof = Some(proved.proof.clone());
    report.required = args.require.iter().map(|asked| asked.against(&proved.proof)).collect();
    report.stages = stages.done().to_vec();
    let [html, json] = ["report.html", "report.json"].map(|kind| args.output.with_extension(kind));
    report.files.extend([html.clone(), json.clone()]);
    io::write_text(&html, &taotie_report::html(&page::page(report, &proved, &made.textures)?))?;
    io::write_text(&json, &serde_json::to_string_pretty(report)?)?;
    Ok(())
}
