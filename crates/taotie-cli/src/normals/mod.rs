//! `taotie normals`: makes normal maps from heights, and converts them.

mod args;
mod input;
mod mesh;
mod report;
mod unread;

pub use args::NormalsArgs;

use crate::studio::Green;
use crate::{console, stop};
use anyhow::{Result, bail};
use args::Border;
use report::Report;
use taotie_engine::Warnings;
use taotie_engine::bake::TexelSurface;
use taotie_engine::image::Encoding;
use taotie_engine::normal_map::{ConversionOptions, MapContent, MapSource, convert_map};
use taotie_engine::scene::NormalSpace;
use taotie_io::FileSet;

/// Runs the subcommand.
pub fn run(args: &NormalsArgs) -> Result<()> {
    args.check()?;
    let files = stop::files();
    args.claim(&files)?;
    let (report, warnings) = args.run.in_pool(|| convert(args, &files))??;
    console::say_warnings(&warnings);
    if args.run.json {
        return console::result(&serde_json::to_string_pretty(&report)?);
    }
    console::result(&report.text())
}

fn convert(args: &NormalsArgs, files: &FileSet) -> Result<(Report, Warnings)> {
    let source = input::read(args)?;
    let mut warnings = Warnings::default();
    unread::note(args, &source, &mut warnings);
    let size = [source.bitmap.width(), source.bitmap.height()];
    let surface = mesh::laid_out(args, files, size, &mut warnings)?;
    let options = options(args);
    check(&source, &options, surface.as_ref())?;
    let made = convert_map(&source, &options, surface.as_ref())?;
    warnings.absorb(made.warnings.clone());
    files.write_png_bitmap(&args.output, &made.bitmap, Encoding::Linear)?;
    files.commit()?;
    Ok((Report::new(args, &source, &made, &warnings), warnings))
}

fn options(args: &NormalsArgs) -> ConversionOptions {
    ConversionOptions {
        space: args.to.map(Into::into),
        green: args.green.unwrap_or(Green::Up).into(),
        bits: args.bits.as_deref().map(|bits| if bits == "8" { 8 } else { 16 }),
        dither: args.dither,
        height_scale: args.height_scale,
        border: args.border.unwrap_or(Border::Repeat).wrap(),
    }
}

/// Rejects a conversion that lacks an option, naming it.
fn check(source: &MapSource, options: &ConversionOptions, surface: Option<&TexelSurface>) -> Result<()> {
    let what = match (source.content, options.space) {
        (MapContent::Heights, _) if options.height_scale.is_none() => bail!(
            "--height-scale is needed for heights: the height of white in texels, or in model units with --mesh"
        ),
        (MapContent::Heights, Some(NormalSpace::Object)) => "object space needs the mesh",
        (MapContent::Normals(own), Some(space)) if own != space => "changing the space needs the mesh",
        _ => return Ok(()),
    };
    if surface.is_none() {
        bail!("{what}; name the model with --mesh");
    }
    Ok(())
}
