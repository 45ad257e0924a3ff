//! `taotie normals`: normal maps from heights and from one another.

mod args;
mod convert;
mod input;
mod mesh;
mod report;

pub use args::NormalsArgs;

use crate::{console, studio};
use anyhow::Result;
use input::Input;
use report::Report;
use taotie::image::Encoding;
use taotie::{Warnings, io};

/// Runs the subcommand.
pub fn run(args: &NormalsArgs) -> Result<()> {
    args.check()?;
    let (report, warnings) = studio::in_pool(args.threads, || convert(args))??;
    if args.json {
        return console::result(&serde_json::to_string_pretty(&report)?);
    }
    console::say_warnings(&warnings);
    console::result(&report.text())
}

fn convert(args: &NormalsArgs) -> Result<(Report, Warnings)> {
    let input = Input::read(args)?;
    let mut warnings = Warnings::default();
    let size = [input.bitmap.width(), input.bitmap.height()];
    let surface = mesh::laid_out(args, size, &mut warnings)?;
    let made = convert::convert(args, &input, surface.as_ref(), &mut warnings)?;
    io::write_png_bitmap(&args.output, &made.bitmap, Encoding::Linear)?;
    Ok((Report::new(args, &input, &made, &warnings), warnings))
}
