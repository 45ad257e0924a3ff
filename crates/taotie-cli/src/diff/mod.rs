//! `taotie diff`: the difference of two pictures, or of the normals that two maps hold.
//!
//! [`Report`] is the result; the text and the JSON are two ways to print it.

mod args;
mod heat;
mod report;

pub use args::DiffArgs;

use crate::console::{self, Bar};
use crate::{Outcome, stop};
use anyhow::{Result, bail};
use report::{Files, Report};
use taotie::asset::Bytes;
use taotie::comparison::diff::{DiffOptions, Encoding, ImagePair, Metric, NamedBitmap, guessed_encoding};
use taotie_engine::Progress;
use taotie_engine::image::Bitmap;
use taotie_io::FileSet;

/// Runs the subcommand.
pub fn run(args: &DiffArgs) -> Result<Outcome> {
    args.check()?;
    let files = stop::files();
    args.claim(&files)?;
    let report = args.run.in_pool(|| compare(args, &files))??;
    match print(args, &report) {
        // The exit code stays the same if the pipe is closed.
        Err(error) if !console::is_broken_pipe(&error) => return Err(error),
        _ => {}
    }
    Ok(if report.threshold.is_some_and(|threshold| threshold.exceeded) {
        Outcome::Different
    } else {
        Outcome::Fine
    })
}

fn print(args: &DiffArgs, report: &Report) -> Result<()> {
    console::say_warnings(&report.warnings);
    if args.run.json {
        return console::result(&serde_json::to_string_pretty(report)?);
    }
    console::result(report.text().trim_end())
}

fn compare(args: &DiffArgs, set: &FileSet) -> Result<Report> {
    /// Memory of the program itself, bytes.
    const PROGRAM: u64 = 32 << 20;
    let limits = args.limits();
    let names = [&args.a, &args.b].map(|path| path.display().to_string());
    let first = taotie_io::read_bitmap_within(&args.a, &limits)?;
    let title = format!("{}: a comparison of {}x{} pixels", names[0], first.width(), first.height());
    limits.check(title.as_str(), Bytes(ImagePair::least_bytes(&first)))?;
    let files = Files { names, bitmaps: [first, taotie_io::read_bitmap_within(&args.b, &limits)?] };
    let options = args.options();
    let images = [0, 1].map(|i| NamedBitmap { name: &files.names[i], bitmap: &files.bitmaps[i] });
    check_normals(images, &options)?;
    limits.check(title, Bytes(PROGRAM + ImagePair::bytes(images, &options)?))?;
    let mut pair = ImagePair::new(images, &options)?;
    args.note_unread(&pair.content, &mut pair.warnings);
    if pair.shared_normals() == Some(0) {
        bail!("no texel holds a normal in both files; there is nothing to compare");
    }
    let bar = Bar::new("diff");
    let listener = |_: &'static str, done: f64| {
        bar.set(done);
        true
    };
    let figures = pair.figures(&options, Progress::new(&listener))?;
    if let Some(path) = &args.heat {
        heat::write(set, args, path, &pair)?;
        set.commit()?;
    }
    Ok(Report::new(args, &files, &pair, figures))
}

/// Rejects files to compare as normals that do not look like normal maps, naming the option that decides.
fn check_normals(images: [NamedBitmap<'_>; 2], options: &DiffOptions) -> Result<()> {
    let same_size = |a: &Bitmap, b: &Bitmap| (a.width(), a.height()) == (b.width(), b.height());
    let guessing = options.metric == Some(Metric::Angle) && options.encoding == Encoding::Auto;
    if !guessing || !same_size(images[0].bitmap, images[1].bitmap) {
        return Ok(());
    }
    for image in images {
        if guessed_encoding(image.bitmap)?.is_none() {
            bail!(
                "{}: it does not look like a normal map; if it is one, specify --encoding unit or signed",
                image.name
            );
        }
    }
    Ok(())
}
