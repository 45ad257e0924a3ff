//! `taotie compare`: one model with several surface methods, in pictures, tables and angles.

mod args;

pub use args::CompareArgs;

use crate::console::{self, Bar};
use crate::stop;
use crate::studio::{self, Viewpoint};
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};
use taotie::Bytes;
use taotie::comparison::{Comparison, ComparisonOptions, MethodReport, PictureFigures, Subject};
use taotie::studio::MaterialOptions;
use taotie_engine::compare::Summary;
use taotie_engine::render::{HeldPixels, RenderSettings, SurfaceSettings, image_bytes};
use taotie_engine::scene::Scene;
use taotie_engine::{Progress, Warnings};
use taotie_io::FileSet;
use taotie_report::comparison::{self, Document, Written};
use taotie_report::table::{Table, figures};
use taotie_study::paper::Study;

/// Runs the subcommand.
pub fn run(args: &CompareArgs) -> Result<()> {
    args.check()?;
    let files = stop::files();
    args.claim(&files)?;
    let (Some(model), Some(output)) = (&args.model, &args.output) else {
        return recompute_paper(args.running.run.json, &files, args.output.as_deref());
    };
    let places = Places { model, output, files: &files };
    let written = args.running.run.in_pool(|| compare_files(args, &places))??;
    if args.running.run.json {
        return console::result(&written.document.json()?);
    }
    console::result(&text(&written.document))?;
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
        reference.map(|path| load_reference(path, args, &loaded.scene, &mut warnings)).transpose()?;
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
    let written = comparison::write_in(files, &comparison, &page_options(args, model)?, output)?;
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
fn page_options(args: &CompareArgs, model: &Path) -> Result<comparison::Options> {
    Ok(comparison::Options {
        title: model.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        heat_top_deg: args.heat_top_deg,
        material: serde_json::to_value(args.material.report())?,
        environment: serde_json::to_value(args.light.environment_report())?,
        exr: args.exr,
    })
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

/// A high-poly reference that methods are measured against, and the other files that it was read from.
struct Reference {
    /// The reference.
    scene: Scene,
    /// The files.
    files: Vec<PathBuf>,
}

/// Reads the reference with the requested material, otherwise its own, otherwise the model's; applies the requested
/// factors.
///
/// # Errors
/// Those of the reader and of the material.
fn load_reference(
    path: &Path,
    args: &CompareArgs,
    model: &Scene,
    warnings: &mut Warnings,
) -> Result<Reference> {
    let limits = args.running.limits.limits();
    let mut loaded = taotie::studio::load(path, &MaterialOptions::default(), &limits)?;
    let args = &args.material;
    warnings.absorb(std::mem::take(&mut loaded.warnings));
    let mut scene = loaded.scene;
    match &args.material {
        Some(choice) => dress_as_chosen(&mut scene, choice)?,
        None => Subject::dress_reference(&mut scene, model)?,
    }
    args.factors().apply(&mut scene)?;
    Ok(Reference { scene, files: loaded.files })
}

fn dress_as_chosen(scene: &mut Scene, choice: &str) -> Result<()> {
    let own = scene.materials().to_vec();
    studio::apply_choice(choice, scene)?;
    // Relief in the material belongs to the model; the reference has its relief as geometry.
    Ok(scene.edit(|scene| {
        for (material, own) in scene.materials.iter_mut().zip(own) {
            (material.normal, material.height) = (own.normal, own.height);
        }
    })?)
}

/// Returns the angular errors, the picture errors of each shading, and the skipped methods.
fn text(report: &Document) -> String {
    let mut text = if report.is_compared() { surfaces(report) } else { String::new() };
    if let Some(model) = report.methods[0].models.first() {
        let gap = if text.is_empty() { "" } else { "\n" };
        text +=
            &format!("{gap}Pictures of each surface compared with its picture under {}\n", model.baseline);
        text += &models(report).lines(0);
    }
    text += "Pictures are compared over the pixels that show either surface, not the background\n";
    if !report.skipped.is_empty() || !report.notes.is_empty() {
        text += "\n";
    }
    for skipped in &report.skipped {
        text += &format!("{} could not be rendered: {}\n", skipped.method, skipped.reason);
    }
    for note in &report.notes {
        text += &format!("{note}\n");
    }
    text
}

/// Returns the figures that compare surfaces with one another.
fn surfaces(report: &Document) -> String {
    let mut text = format!("Angular error against {}, degrees\n", report.against);
    text += &angles(report).lines(0);
    text += "* only pixels away from silhouettes\n";
    for (i, picture) in report.methods[0].pictures.iter().enumerate() {
        text += &format!("\nPictures under {} against {}\n", picture.shading, report.against);
        text += &pictures(report, i).lines(0);
    }
    text
}

fn angles(report: &Document) -> Table {
    let titles = ["method", ">mean", ">median", ">95 %", ">max", ">mean*", ">median*", ">95 %*", ">max*"];
    let mut table = Table::new(&titles);
    for method in &report.methods {
        let Some(error) = &method.error else { continue };
        let [a, b, c, d] = texts(error.all.as_ref());
        let [e, f, g, h] = texts(error.inner.as_ref());
        table.row([method.method.clone(), a, b, c, d, e, f, g, h]);
    }
    table
}

fn texts(summary: Option<&Summary>) -> [String; 4] {
    match summary {
        Some(summary) => figures(summary).map(|figure| format!("{figure:.2}")),
        None => std::array::from_fn(|_| "-".into()),
    }
}

fn pictures(report: &Document, i: usize) -> Table {
    let mut table = Table::new(&["method", ">RMSE", ">PSNR dB", ">SSIM", ">FLIP"]);
    report.methods.iter().filter_map(|method| picture_row(method, i)).for_each(|row| table.row(row));
    table
}

fn picture_row(method: &MethodReport, i: usize) -> Option<[String; 5]> {
    let [rmse, psnr, ssim, flip] = picture_figures(method.pictures[i].difference.as_ref()?);
    Some([method.method.clone(), rmse, psnr, ssim, flip])
}

fn models(report: &Document) -> Table {
    let mut table = Table::new(&["method", "shading", ">RMSE", ">PSNR dB", ">SSIM", ">FLIP"]);
    for method in &report.methods {
        for model in &method.models {
            let [rmse, psnr, ssim, flip] = picture_figures(&model.difference);
            table.row([method.method.clone(), model.shading.clone(), rmse, psnr, ssim, flip]);
        }
    }
    table
}

fn picture_figures(figures: &PictureFigures) -> [String; 4] {
    let psnr = figures.psnr.map_or_else(|| "equal".into(), |psnr| format!("{psnr:.2}"));
    let flip = figures.flip.as_ref().map_or_else(|| "-".into(), |flip| format!("{:.4}", flip.mean));
    let [rmse, ssim] = [figures.rmse, figures.ssim].map(|figure| format!("{figure:.4}"));
    [rmse, psnr, ssim, flip]
}

/// Recomputes the tables of Guo and Wang 2025, for `--paper`, and prints them as text or JSON; with `out`, writes
/// them to that folder, as files of a set.
///
/// # Errors
/// If the folder cannot be created or written to.
fn recompute_paper(json: bool, set: &FileSet, out: Option<&Path>) -> Result<()> {
    let study = Study::new();
    let files = out.map(|folder| study.write(set, folder)).transpose()?.unwrap_or_default();
    set.commit()?;
    if json {
        return console::result(&study.json());
    }
    console::result(study.text().trim_end())?;
    if !files.is_empty() {
        console::result("")?;
    }
    for file in &files {
        console::result(&format!("wrote {}", file.display()))?;
    }
    Ok(())
}
