//! `taotie diff`: the difference of two pictures, or of the normals that two maps hold.
//!
//! [`Report`] is the result; the text and the JSON are two ways to print it.

mod args;

pub use args::DiffArgs;

use crate::console::{self, Bar};
use crate::{Outcome, stop};
use anyhow::{Result, bail};
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;
use taotie::comparison::diff::{
    DiffFigures, DiffOptions, Encoding, ImageContent, ImagePair, Metric, NamedBitmap, guessed_encoding,
};
use taotie::{Bytes, Warning};
use taotie_engine::Progress;
use taotie_engine::compare::NormalEncoding;
use taotie_engine::image::Bitmap;
use taotie_engine::names::Named;
use taotie_io::FileSet;
use taotie_report::heat_map::HeatMap;
use taotie_report::table::summary_text;

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
    if args.run.json {
        return console::result(&serde_json::to_string_pretty(report)?);
    }
    console::result(report.text().trim_end())
}

fn compare(args: &DiffArgs, set: &FileSet) -> Result<Report> {
    /// Memory of the program itself, bytes.
    const PROGRAM: u64 = 32 << 20;
    let limits = args.memory.limits();
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
        write_heat_map(set, args, path, &pair)?;
        set.commit()?;
    }
    drop(bar);
    console::say_warnings(&pair.warnings);
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

/// Writes the heat map of the requested metric, otherwise of FLIP or the angle, with its scale below, as a file of a
/// set.
fn write_heat_map(set: &FileSet, args: &DiffArgs, path: &Path, pair: &ImagePair) -> Result<()> {
    let shown = pair.difference_map(&args.options())?;
    let top = args.heat_top.map_or(shown.top, |top| top as f32);
    let (title, unit) = (shown.title, shown.unit);
    let sheet = HeatMap { field: &shown.field, title, unit, map: shown.map, top }.with_scale();
    Ok(set.write_png(path, &sheet.png())?)
}

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 1;

/// The mean angle that 8-bit storage of normals accounts for, degrees
/// (`laws::bake::eight_bits_cost_a_sixth_of_a_degree`).
const FLOOR_OF_8_BITS: f64 = 0.17;

/// The two files as they are stored.
struct Files {
    /// Their paths.
    names: [String; 2],
    /// Their content.
    bitmaps: [Bitmap; 2],
}

/// The report on two files.
#[derive(Serialize)]
struct Report {
    schema: u32,
    /// Version of the program.
    version: &'static str,
    /// The first file.
    a: File,
    /// The second file.
    b: File,
    /// Pixels across and down.
    size: [u32; 2],
    /// The kind of comparison: `pictures` or `normals`.
    compared_as: &'static str,
    /// True if every stored number is the same in both.
    equal: bool,
    /// Texels that hold no normal in one of the files.
    left_out: usize,
    /// The differences.
    metrics: DiffFigures,
    /// The viewing distance that FLIP assumes.
    pixels_per_degree: f64,
    /// The requested limit.
    threshold: Option<Threshold>,
    /// The path of the written heat map.
    heat: Option<String>,
    /// Problems and corrections.
    warnings: Vec<Warning>,
}

/// One of the two files.
#[derive(Serialize)]
struct File {
    /// The path, as given.
    path: String,
    /// Bits per channel.
    bits: u8,
    /// The number of channels.
    channels: u8,
    /// The encoding of its normals: `unit` or `signed`.
    normals: Option<&'static str>,
    /// Texels without a normal because their alpha is 0.
    transparent: Option<usize>,
    /// Texels without a normal because they hold no unit vector.
    not_unit: Option<usize>,
}

/// A limit and whether it was exceeded.
#[derive(Debug, Clone, Copy, Serialize)]
struct Threshold {
    /// The name of the metric: `angle`, `flip`, `ssim`, `psnr` or `rmse`.
    metric: &'static str,
    /// The limit: the largest value, for `ssim` and `psnr` the smallest.
    limit: f64,
    /// True if the metric is worse than the limit.
    exceeded: bool,
}

impl Report {
    /// Makes the report on two compared files.
    fn new(args: &DiffArgs, files: &Files, pair: &ImagePair, metrics: DiffFigures) -> Self {
        let [a, b] = &files.bitmaps;
        let count = a.texels().len();
        let value = args.metric.and_then(|metric| metrics.value(metric));
        let threshold = args.metric.zip(args.threshold).zip(value);
        let normals = matches!(pair.content, ImageContent::Normals(_));
        Self {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            a: File::new(files, pair, 0),
            b: File::new(files, pair, 1),
            size: [a.width(), a.height()],
            compared_as: if normals { "normals" } else { "pictures" },
            equal: a.texels() == b.texels(),
            left_out: metrics.angle.map_or(0, |angle| count - angle.count),
            pixels_per_degree: args.pixels_per_degree(),
            threshold: threshold.map(|((metric, limit), value)| Threshold {
                metric: metric.name(),
                limit,
                exceeded: metric.is_worse(value, limit),
            }),
            metrics,
            heat: args.heat.as_ref().map(|path| path.display().to_string()),
            warnings: pair.warnings.list(),
        }
    }

    /// Returns the report as text.
    fn text(&self) -> String {
        let mut text = format!("a         {}\nb         {}\n", self.a.text(), self.b.text());
        let _ =
            writeln!(text, "size      {}x{}, compared as {}", self.size[0], self.size[1], self.compared_as);
        if self.compared_as == "normals" {
            let _ = writeln!(text, "left out  {} texels without a normal in one of the files", self.left_out);
        }
        if self.equal {
            text.push_str("equal     every number is the same in both files\n");
        }
        text.push('\n');
        self.metrics_text(&mut text);
        if let Some(Threshold { metric, limit, exceeded }) = self.threshold {
            let verdict = if exceeded { "worse than" } else { "within" };
            let _ = writeln!(text, "\n{metric} is {verdict} the threshold {limit}");
        }
        if let Some(heat) = &self.heat {
            let _ = writeln!(text, "\nwrote {heat}");
        }
        text
    }

    fn metrics_text(&self, text: &mut String) {
        let m = &self.metrics;
        if let Some(angle) = &m.angle {
            let _ = writeln!(text, "angle  {}", summary_text(angle, 3, "°"));
            let _ =
                writeln!(text, "       8-bit storage of normals accounts for {FLOOR_OF_8_BITS}° on average");
        }
        if let Some(rmse) = m.rmse {
            let _ = writeln!(text, "rmse   {rmse:.5}");
        }
        if let Some(psnr) = m.psnr {
            let _ = match psnr.is_finite() {
                true => writeln!(text, "psnr   {psnr:.2} dB"),
                false => writeln!(text, "psnr   infinite"),
            };
        }
        if let Some(ssim) = m.ssim {
            let _ = writeln!(text, "ssim   {ssim:.5}");
        }
        if let Some(flip) = &m.flip {
            let _ = writeln!(
                text,
                "flip   {}, at {} pixels per degree",
                summary_text(flip, 4, ""),
                self.pixels_per_degree
            );
        }
    }
}

impl File {
    fn new(files: &Files, pair: &ImagePair, index: usize) -> Self {
        let bitmap = &files.bitmaps[index];
        let stored = match &pair.content {
            ImageContent::Normals(normals) => Some(&normals[index]),
            ImageContent::Pictures(_) => None,
        };
        let name = |encoding: NormalEncoding| match encoding {
            NormalEncoding::Unit => "unit",
            NormalEncoding::Signed => "signed",
        };
        Self {
            path: files.names[index].clone(),
            bits: bitmap.bits(),
            channels: bitmap.channels(),
            normals: stored.map(|(_, encoding)| name(*encoding)),
            transparent: stored.map(|(normals, _)| normals.transparent),
            not_unit: stored.map(|(normals, _)| normals.not_unit),
        }
    }

    fn text(&self) -> String {
        let mut text = format!("{}: {} bits, {} channels", self.path, self.bits, self.channels);
        if let (Some(normals), Some(transparent), Some(not_unit)) =
            (self.normals, self.transparent, self.not_unit)
        {
            let _ = write!(
                text,
                ", {normals} normals; {transparent} texels transparent, {not_unit} without a unit vector"
            );
        }
        text
    }
}
