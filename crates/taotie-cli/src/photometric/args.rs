//! The options of `taotie photometric`.

use crate::options;
use crate::running::{MemoryArgs, RunArgs};
use anyhow::Result;
use clap::Args;
use std::path::PathBuf;
use taotie_io::FileSet;
use taotie_photometric::{PhotographSet, Transfer};

const EXAMPLES: &str = "\
Examples:
  taotie photometric coin/dome.lp -o coin_normals
  taotie photometric relief -o relief_normals --mask mask.png --json
  taotie photometric generated -o out --truth truth.normals.exr

FOLDER holds photographs from one position under changing light, with an .lp file, or filenames.txt, \
light_directions.txt and light_intensities.txt as in the DiLiGenT data set. 16-bit PNGs and float files are read as \
linear, 8-bit files as sRGB. x points to the right, y up, z towards the camera.

The displayed uncertainty is the radius in degrees that holds 68 % of the probability.";

/// Estimates normals from photographs, each with its uncertainty in degrees.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct PhotometricArgs {
    /// The folder of photographs, or their .lp file
    #[arg(value_name = "FOLDER|FILE.lp")]
    pub input: PathBuf,
    /// The folder to write: normals, uncertainty, albedo, residuals, mask, plane.glb
    /// with the maps, and report.json
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// The mask: white where normals are estimated [default: mask.png next to the photographs, otherwise everything]
    #[arg(long, value_name = "FILE")]
    pub mask: Option<PathBuf>,
    /// Meaning of the numbers in the photographs: auto, linear, srgb
    #[arg(long, value_parser = options::named::<Transfer>, default_value = "auto")]
    pub encoding: Transfer,
    /// True normals to compare with (PNG, EXR), in the same coordinates; of a picture that is a whole number of times
    /// larger, their means over each pixel
    #[arg(long, value_name = "FILE")]
    pub truth: Option<PathBuf>,

    #[command(flatten)]
    pub memory: MemoryArgs,
    #[command(flatten)]
    pub run: RunArgs,
}

/// The files that are written.
pub const OUTPUTS: [&str; 9] = [
    "normals.png",
    "normals.exr",
    "sigma.png",
    "sigma.exr",
    "albedo.png",
    "residual.exr",
    "mask.png",
    "plane.glb",
    "report.json",
];

impl PhotometricArgs {
    /// Returns the path of an output.
    pub fn path(&self, name: &str) -> PathBuf {
        self.output.join(name)
    }

    /// Rejects outputs that cannot be written or that are inputs.
    pub fn claim(&self, files: &FileSet, set: &PhotographSet) -> Result<()> {
        files.protect(set.photographs.iter().map(|photograph| &photograph.path))?;
        files.protect(set.files.iter().chain(&set.mask).chain(&self.mask).chain(&self.truth))?;
        files.claim_folder(&self.output)?;
        OUTPUTS.iter().try_for_each(|name| files.claim(&self.path(name)))?;
        Ok(())
    }
}
