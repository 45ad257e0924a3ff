//! The options of `taotie diff`.

use crate::options;
use crate::running::RunArgs;
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use taotie::Warnings;
use taotie::asset::{Bytes, Limits};
use taotie::compare::{NormalEncoding, PIXELS_PER_DEGREE};
use taotie::comparison::diff::{self, DiffOptions, ImageContent, Metric};
use taotie::io::FileSet;
use taotie::math::Vec3;
use taotie::names::Named;

const EXAMPLES: &str = "\
Examples:
  taotie diff before.png after.png
  taotie diff before.png after.png --metric flip --threshold 0.02 --heat flip.png
  taotie diff scan_normals.png baked_normals.png --metric angle --heat angle.png --heat-top 5
  taotie diff high.normals.exr low.normals.exr --json

Pictures are compared as a screen shows them: sRGB, laid over --background; float files are linear \
and encoded first. Normals are compared by the angle between them, without texels that have alpha 0 \
or hold no unit vector (padding around UV islands).

Exit code: 0 fine, 1 worse than --threshold, 2 error";

/// Measures the difference of two pictures or normal maps (PNG, JPEG, WebP, KTX2, TGA, HDR, EXR).
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct DiffArgs {
    /// The first picture, the reference
    pub a: PathBuf,
    /// The second picture, of the same size
    pub b: PathBuf,

    /// The metric to compute; all that apply if not given: angle (between normals, degrees), flip (what the eye sees
    /// when one picture is flipped to the other: 0 alike, 1 most different), ssim (structural similarity: 1 alike),
    /// psnr (peak signal-to-noise ratio, decibels: infinite where equal) or rmse (root mean square error of the encoded
    /// channels, [0, 1])
    #[arg(long, value_parser = options::named::<Metric>)]
    pub metric: Option<Metric>,
    /// Exit with 1 where the metric is worse: a mean angle (degrees), mean FLIP error or RMSE above X, an SSIM or
    /// PSNR (dB) below X
    #[arg(long, value_name = "X", value_parser = options::number, requires = "metric", allow_negative_numbers = true)]
    pub threshold: Option<f64>,
    /// Meaning of the numbers in the files
    #[arg(long, value_enum, default_value_t = Encoding::Auto)]
    pub encoding: Encoding,
    /// Colour behind transparent pictures; black if not given
    #[arg(long, value_name = "COLOR", value_parser = options::color)]
    pub background: Option<Vec3>,
    /// Pixels per degree of the viewer's sight, for FLIP; 67 if not given: a screen 0.7 m and 3840 pixels wide, seen from
    /// 0.7 m
    #[arg(long, value_name = "N", value_parser = options::number)]
    pub pixels_per_degree: Option<f64>,

    /// Write a heat map of the difference (PNG), of --metric, else of FLIP or the angle
    #[arg(long, value_name = "OUT", help_heading = "Heat map")]
    pub heat: Option<PathBuf>,
    /// The difference shown by the last colour of the heat map; if not given 1 for FLIP and SSIM, else the 95 % quantile
    #[arg(long, value_name = "X", value_parser = options::number, requires = "heat", help_heading = "Heat map")]
    pub heat_top: Option<f64>,

    /// Largest amount of memory to use, such as 4G; the machine's free memory if not given
    #[arg(long, value_name = "BYTES", value_parser = options::memory, help_heading = "Running")]
    pub memory_limit: Option<Bytes>,
    #[command(flatten)]
    pub run: RunArgs,
}

/// The meaning of the numbers in the files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Encoding {
    /// Normals where both files look like normal maps, else colors
    Auto,
    /// Colors
    Color,
    /// Unit vectors n as (n + 1) / 2: normal maps
    Unit,
    /// Unit vectors as they are, in [-1, 1]: float files, such as those of `render --aov normals`
    Signed,
}

impl From<Encoding> for diff::Encoding {
    fn from(encoding: Encoding) -> Self {
        match encoding {
            Encoding::Auto => Self::Auto,
            Encoding::Color => Self::Color,
            Encoding::Unit => Self::Normals(NormalEncoding::Unit),
            Encoding::Signed => Self::Normals(NormalEncoding::Signed),
        }
    }
}

impl DiffArgs {
    /// Returns the limits, with what the machine has free where none is set.
    pub fn limits(&self) -> Limits {
        Limits { memory: self.memory_limit, ..Limits::default() }.or_free()
    }

    /// The same for the library.
    pub fn options(&self) -> DiffOptions {
        DiffOptions {
            metric: self.metric,
            encoding: self.encoding.into(),
            background: self.background.unwrap_or(Vec3::splat(0.0)),
            pixels_per_degree: self.pixels_per_degree(),
        }
    }

    /// Returns what FLIP assumes; 67 if not given, without the fraction that nobody writes.
    pub fn pixels_per_degree(&self) -> f64 {
        self.pixels_per_degree.unwrap_or(f64::from(PIXELS_PER_DEGREE.round()))
    }

    /// Notes options that a comparison of normals does not read.
    pub fn note_unread(&self, content: &ImageContent, warnings: &mut Warnings) {
        if matches!(content, ImageContent::Pictures(_)) {
            return;
        }
        let unread = [
            ("--background", self.background.is_some()),
            ("--pixels-per-degree", self.pixels_per_degree.is_some()),
        ];
        for (option, _) in unread.iter().filter(|(_, given)| *given) {
            warnings.note(format!("{option} is not read: normals are compared by their angle"), 1);
        }
    }

    /// Refuses options that cannot work together, before any work is done.
    pub fn check(&self) -> Result<()> {
        if self.heat_top.is_some_and(|top| top <= 0.0) {
            bail!("--heat-top: the top of the scale must be above 0");
        }
        if self.pixels_per_degree.is_some() && self.metric.is_some_and(|metric| metric != Metric::Flip) {
            bail!("--pixels-per-degree: only FLIP reads it; leave it out, or take --metric flip");
        }
        self.check_meaning()?;
        let Some(heat) = &self.heat else { return Ok(()) };
        if heat.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("png")) {
            bail!("{}: heat maps are written as .png", heat.display());
        }
        Ok(())
    }

    /// Refuses a heat map that cannot be written, or that is read.
    pub fn claim(&self, files: &FileSet) -> Result<()> {
        files.protect([&self.a, &self.b])?;
        Ok(self.heat.iter().try_for_each(|heat| files.claim(heat))?)
    }

    fn check_meaning(&self) -> Result<()> {
        match (self.metric, self.encoding) {
            (Some(Metric::Angle), Encoding::Color) => {
                bail!("--metric angle measures normals, but --encoding color says that the files hold colors")
            }
            (Some(metric), Encoding::Unit | Encoding::Signed) if metric != Metric::Angle => {
                bail!(
                    "--metric {} looks at colors, but --encoding says that the files hold normals",
                    metric.name()
                )
            }
            _ => Ok(()),
        }
    }
}
