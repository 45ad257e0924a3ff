//! The options of `taotie diff`.

use crate::options;
use crate::running::{MemoryArgs, RunArgs};
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use taotie::comparison::diff::{self, DiffOptions, ImageContent, Metric};
use taotie_engine::Warnings;
use taotie_engine::compare::{NormalEncoding, PIXELS_PER_DEGREE};
use taotie_engine::math::Vec3;
use taotie_engine::names::Named;
use taotie_io::FileSet;

const EXAMPLES: &str = "\
Examples:
  taotie diff before.png after.png
  taotie diff before.png after.png --metric flip --threshold 0.02 --heat flip.png
  taotie diff scan_normals.png baked_normals.png --metric angle --heat angle.png --heat-top 5
  taotie diff high.normals.exr low.normals.exr --json

Pictures are compared as displayed: in sRGB, over --background; float files are linear and are encoded \
first. Normals are compared by the angle between them, except texels with alpha 0 or without a unit \
vector (padding around UV islands).

Exit code: 0 fine, 1 worse than --threshold, 2 error";

/// Measures the difference of two pictures or normal maps (PNG, JPEG, WebP, KTX2, TGA, HDR, EXR).
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct DiffArgs {
    /// The first picture, the reference
    pub a: PathBuf,
    /// The second picture, of the same size
    pub b: PathBuf,

    /// The metric to compute: angle (between normals, degrees), flip (perceived difference when flipping between the
    /// pictures: 0 alike, 1 most different), ssim (structural similarity: 1 alike), psnr (peak signal-to-noise ratio,
    /// decibels: infinite if equal) or rmse (root mean square error of the encoded channels, 0 to 1) [default: all
    /// that apply]
    #[arg(long, value_parser = options::named::<Metric>)]
    pub metric: Option<Metric>,
    /// Exit with 1 if the metric is worse: a mean angle (degrees), mean FLIP error or RMSE above X, or an SSIM or
    /// PSNR (dB) below X
    #[arg(long, value_name = "X", value_parser = options::number, requires = "metric", allow_negative_numbers = true)]
    pub threshold: Option<f64>,
    /// Meaning of the numbers in the files
    #[arg(long, value_enum, default_value_t = Encoding::Auto)]
    pub encoding: Encoding,
    /// Colour behind transparent pictures [default: black]
    #[arg(long, value_name = "COLOR", value_parser = options::color)]
    pub background: Option<Vec3>,
    /// Pixels per degree of visual angle, for FLIP [default: 67, a screen 0.7 m and 3840 pixels wide, seen from 0.7
    /// m]
    #[arg(long, value_name = "N", value_parser = options::number)]
    pub pixels_per_degree: Option<f64>,

    /// Write a heat map of the difference (PNG): of --metric, otherwise of FLIP or the angle
    #[arg(long, value_name = "OUT", help_heading = "Heat map")]
    pub heat: Option<PathBuf>,
    /// The difference at the last colour of the heat map [default: 1 for FLIP and SSIM, otherwise the 95 % quantile]
    #[arg(long, value_name = "X", value_parser = options::number, requires = "heat", help_heading = "Heat map")]
    pub heat_top: Option<f64>,

    #[command(flatten)]
    pub memory: MemoryArgs,
    #[command(flatten)]
    pub run: RunArgs,
}

/// The meaning of the numbers in the files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Encoding {
    /// Normals if both files look like normal maps, otherwise colours
    Auto,
    /// Colours
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
    /// Returns the options for the library.
    pub fn options(&self) -> DiffOptions {
        DiffOptions {
            metric: self.metric,
            encoding: self.encoding.into(),
            background: self.background.unwrap_or(Vec3::splat(0.0)),
            pixels_per_degree: self.pixels_per_degree(),
        }
    }

    /// Returns the pixels per degree for FLIP, by default rounded to 67.
    pub fn pixels_per_degree(&self) -> f64 {
        self.pixels_per_degree.unwrap_or(f64::from(PIXELS_PER_DEGREE.round()))
    }

    /// Adds a warning for each option that has no effect on a comparison of normals.
    pub fn note_unread(&self, content: &ImageContent, warnings: &mut Warnings) {
        if matches!(content, ImageContent::Pictures(_)) {
            return;
        }
        let unread = [
            ("--background", self.background.is_some()),
            ("--pixels-per-degree", self.pixels_per_degree.is_some()),
        ];
        for (option, _) in unread.iter().filter(|(_, given)| *given) {
            warnings.note(format!("{option} has no effect: normals are compared by angle"), 1);
        }
    }

    /// Rejects options that cannot work together, before any work is done.
    pub fn check(&self) -> Result<()> {
        if self.heat_top.is_some_and(|top| top <= 0.0) {
            bail!("--heat-top: the top of the scale must be above 0");
        }
        if self.pixels_per_degree.is_some() && self.metric.is_some_and(|metric| metric != Metric::Flip) {
            bail!("--pixels-per-degree: only FLIP uses it; leave it out, or use --metric flip");
        }
        self.check_meaning()?;
        let Some(heat) = &self.heat else { return Ok(()) };
        if heat.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("png")) {
            bail!("{}: heat maps are written as .png", heat.display());
        }
        Ok(())
    }

    /// Rejects a heat map that cannot be written or that is an input.
    pub fn claim(&self, files: &FileSet) -> Result<()> {
        files.protect([&self.a, &self.b])?;
        Ok(self.heat.iter().try_for_each(|heat| files.claim(heat))?)
    }

    fn check_meaning(&self) -> Result<()> {
        match (self.metric, self.encoding) {
            (Some(Metric::Angle), Encoding::Color) => {
                bail!("--metric angle compares normals, but --encoding color specifies colours")
            }
            (Some(metric), Encoding::Unit | Encoding::Signed) if metric != Metric::Angle => {
                bail!("--metric {} compares colours, but --encoding specifies normals", metric.name())
            }
            _ => Ok(()),
        }
    }
}
