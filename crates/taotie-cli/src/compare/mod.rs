//! `taotie compare`: one model with several surface methods, in pictures, tables and angles.

mod args;
mod method;
mod paper;
mod points;
mod reference;
mod text;

pub use args::CompareArgs;

use crate::console::{self, Bar};
use crate::stop;
use crate::studio::{self, Viewpoint};
use anyhow::{Context, Result};
use reference::Reference;
use std::path::Path;
use taotie::asset::Bytes;
use taotie::comparison::{Comparison, ComparisonOptions, Subject};
use taotie_engine::Progress;
use taotie_engine::render::{HeldPixels, RenderSettings, SurfaceSettings, image_bytes};
use taotie_io::FileSet;
use taotie_report::comparison::{self, Written};

/// Runs the subcommand.
pub fn run(args: &CompareArgs) -> Result<()> {
    args.check()?;
    let files = stop::files();
    args.claim(&files)?;
    let (Some(model), Some(output)) = (&args.model, &args.output) else {
        return paper::run(args.running.run.json, &files, args.output.as_deref());
    };
    let places = Places { model, output, files: &files };
    let written = args.running.run.in_pool(|| compare_files(args, &places))??;
    if args.running.run.json {
        return console::result(&written.document.json()?);
    }
    console::result(&text::of(&written.document))?;
    for file in &written.files {
        console::result(&format!("wrote {}", file.display()))?;
    }
    Ok(())
}

/// The model to compare, and the output.
struct Places<'a> {
    model: &'a Path,
    output: &'a Path,
    files: &'a FileSet,
}

fn compare_files(args: &CompareArgs, places: &Places<'_>) -> Result<Written> {
    let Places { model, output, files } = *places;
    let limits = args.running.limits.limits();
    let [width, height] = args.size;
    let title = format!("a comparison with {width}x{height} pictures");
    let (of_pictures, settings) = (options(args)?.image_bytes(), options(args)?.settings);
    limits.check(title.as_str(), Bytes(of_pictures))?;
    let mut loaded = studio::load(model, &args.material, args.bump_scale, &limits)?;
    let of_scene = image_bytes(&loaded.scene, &settings, HeldPixels::Codes);
    limits.check(title, Bytes(of_pictures + of_scene))?;
    let mut warnings = std::mem::take(&mut loaded.warnings);
    args.light.note_unread(&loaded.scene, &mut warnings);
    args.material.note_tangents(args.reads_normal_maps(), &loaded.scene, &mut warnings);
    let reference = args.reference.as_deref();
    let reference =
        reference.map(|path| reference::load(path, args, &loaded.scene, &mut warnings)).transpose()?;
    files.protect(&loaded.files)?;
    let reference = match reference {
        Some(Reference { scene, files: read }) => {
            files.protect(read)?;
            Some(scene)
        }
        None => None,
    };
    let viewpoint = Viewpoint::choose(&args.camera, args.framing(), &loaded.scene)?;
    let environment = args.light.environment(&limits, &mut warnings)?;
    let lighting = studio::lighting(&args.light, environment.as_ref(), &loaded.scene, viewpoint.at(0.0))?;
    let camera = viewpoint.camera(0.0);
    let options = ComparisonOptions { camera: Some(camera), lighting: Some(lighting), ..options(args)? };
    reserve(files, &options, output)?;
    let name = console::name_of(model);
    let reference_name = args.reference.as_deref().map(console::name_of);
    let mut subject = Subject::new(&name, &loaded.scene);
    if let (Some(name), Some(reference)) = (&reference_name, &reference) {
        subject = subject.with_reference(name, reference);
    }
    let bar = Bar::new("compare");
    let listener = |_: &'static str, done: f64| bar.hear(done);
    let compared = Comparison::of(&subject, &options, Progress::new(&listener));
    let mut comparison = compared.with_context(|| name.clone())?;
    drop(bar);
    warnings.absorb(std::mem::take(&mut comparison.warnings));
    comparison.warnings = warnings;
    console::say_warnings(&comparison.warnings);
    let written = comparison::write_in(files, &comparison, &page_options(args, model), output)?;
    files.commit()?;
    Ok(written)
}

/// Rejects outputs that are inputs.
fn reserve(files: &FileSet, options: &ComparisonOptions, output: &Path) -> Result<()> {
    let all = comparison::possible_files(options, output);
    Ok(all.iter().try_for_each(|path| files.reserve(path))?)
}

/// Returns all options except camera and light.
fn options(args: &CompareArgs) -> Result<ComparisonOptions> {
    Ok(ComparisonOptions {
        methods: args.methods(),
        shadings: args.shadings(),
        baseline: args.baseline,
        points: args.points.clone(),
        matching: args.matching,
        settings: settings(args),
        development: args.film.development(args.running.simd)?,
        ..ComparisonOptions::default()
    })
}

/// Returns the options of the written files, with facts unknown to the library.
fn page_options(args: &CompareArgs, model: &Path) -> comparison::Options {
    comparison::Options {
        title: model.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        heat_top_deg: args.heat_top_deg,
        material: args.material.json(),
        environment: args.light.environment_json(),
        exr: args.exr,
    }
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
