//! The report on two files, for people and for machines.

use super::args::DiffArgs;
use crate::console;
use serde::{Serialize, Serializer};
use std::fmt::Write;
use taotie::comparison::diff::{DiffFigures, ImageContent, ImagePair};
use taotie_engine::Warnings;
use taotie_engine::compare::NormalEncoding;
use taotie_engine::image::Bitmap;
use taotie_engine::names::Named;
use taotie_report::summary;

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 1;

/// The mean angle that 8-bit storage of normals accounts for, degrees
/// (`laws::bake::eight_bits_cost_a_sixth_of_a_degree`).
const FLOOR_OF_8_BITS: f64 = 0.17;

/// The two files as they are stored.
pub struct Files {
    /// Their paths.
    pub names: [String; 2],
    /// Their content.
    pub bitmaps: [Bitmap; 2],
}

/// The report on two files.
#[derive(Serialize)]
pub struct Report {
    schema: u32,
    version: &'static str,
    a: File,
    b: File,
    size: [u32; 2],
    /// `pictures` or `normals`.
    compared_as: &'static str,
    /// True if every stored number is the same in both.
    equal: bool,
    /// Texels that hold no normal in one of the files.
    left_out: usize,
    metrics: DiffFigures,
    pixels_per_degree: f64,
    /// The requested limit.
    pub threshold: Option<Threshold>,
    heat: Option<String>,
    /// Warnings with their counts.
    #[serde(serialize_with = "counted")]
    pub warnings: Warnings,
}

/// One of the two files.
#[derive(Serialize)]
struct File {
    path: String,
    bits: u8,
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
pub struct Threshold {
    metric: &'static str,
    limit: f64,
    /// True if the metric is worse than the limit.
    pub exceeded: bool,
}

fn counted<S: Serializer>(warnings: &Warnings, serializer: S) -> Result<S::Ok, S::Error> {
    console::json_warnings(warnings).serialize(serializer)
}

impl Report {
    /// Makes the report on two compared files.
    pub fn new(args: &DiffArgs, files: &Files, pair: &ImagePair, metrics: DiffFigures) -> Self {
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
            warnings: pair.warnings.clone(),
        }
    }

    /// Returns the report as text.
    pub fn text(&self) -> String {
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
            let _ = writeln!(text, "angle  {}", summary::text(angle, 3, "°"));
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
                summary::text(flip, 4, ""),
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
