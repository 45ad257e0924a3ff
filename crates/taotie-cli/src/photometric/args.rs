//! The options of `taotie photometric`.

use crate::options;
use crate::running::{MemoryArgs, RunArgs};
use anyhow::{Result, bail};
use clap::Args;
use std::path::PathBuf;
use taotie_engine::length::Unit;
use taotie_io::FileSet;
use taotie_photometric::{Circle, PhotographSet, PhotometricOptions, RelightFormat, Transfer, check_output};

const EXAMPLES: &str = "\
Examples:
  taotie photometric coin/dome.lp -o coin_normals
  taotie photometric relief -o relief_normals --mask mask.png --json
  taotie photometric with_chrome_balls -o out --pixel-size 0.05 --unit mm
  taotie photometric with_chrome_balls -o out --ball 310.5,220,64 --grey-ball 900,215,60
  taotie photometric generated -o out --truth truth.normals.exr
  taotie photometric coin/dome.lp -o coin_web --relight openlime,ptm
  taotie photometric old_scan.ptm -o out
  taotie photometric relief -o out --scan relief.ply --pose camera.json
  taotie photometric transforms.json --model vase.glb -o vase_materials

FOLDER holds photographs from one position under changing light, with an .lp file, or filenames.txt, \
light_directions.txt and light_intensities.txt as in the DiLiGenT data set; or the photographs show chrome balls, from \
whose highlights the lights follow. A .ptm or .rti file, or the info.json of relight, is relit by 40 lights. 16-bit and float files are read as \
linear, 8-bit files as sRGB. x points to the right, y up, z towards the camera.

With --model, photographs are from all sides, and transforms.json (NeRF, instant-ngp, nerfstudio) states their cameras and, \
in a key `light`, their lights: base colour, roughness and metallic are estimated instead of normals.

The displayed uncertainty is the radius in degrees that holds 68 % of the probability.";

/// Estimates normals from photographs, each with its uncertainty in degrees.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct PhotometricArgs {
    /// The folder of photographs, or their .lp file; or a relightable image; or with --model, their transforms.json
    #[arg(value_name = "FOLDER|FILE")]
    pub input: PathBuf,
    /// The folder to write: normals, uncertainty, albedo, base colour, roughness, residuals, mask, depth, plane.glb with the maps,
    /// relief.glb, report.html, and report.json; with --model, maps with their uncertainty, model.glb and report.json
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// The mask: white where normals are estimated [default: an image named mask next to the photographs, otherwise everything]
    #[arg(long, value_name = "FILE")]
    pub mask: Option<PathBuf>,
    /// Meaning of the numbers in the photographs: auto, linear, srgb
    #[arg(long, value_parser = options::named::<Transfer>, default_value = "auto")]
    pub encoding: Transfer,
    /// A chrome ball in pixels from the top left corner; may be repeated [default: found, if no file states the lights]
    #[arg(long = "ball", value_name = "X,Y,RADIUS")]
    pub balls: Vec<Circle>,
    /// A matt grey ball, which shows how bright each light is
    #[arg(long, value_name = "X,Y,RADIUS")]
    pub grey_ball: Option<Circle>,
    /// A folder with a photograph of a flat white board under each light, of the same names
    #[arg(long, value_name = "FOLDER", conflicts_with = "grey_ball")]
    pub flat: Option<PathBuf>,
    /// The side of a pixel on the object, e.g. in mm: the unit of depth, and of lamp positions in the .lp file, which are
    /// then near lamps
    #[arg(long, value_name = "X", value_parser = pixel_size)]
    pub pixel_size: Option<f64>,
    /// The unit of --pixel-size: mm, cm, m, in. plane.glb and relief.glb are then in metres, as glTF requires
    #[arg(long, value_name = "UNIT", value_parser = options::named::<Unit>, requires = "pixel_size")]
    pub unit: Option<Unit>,
    /// True normals to compare with (PNG, EXR), in the same coordinates; of a picture that is a whole number of times
    /// larger, their means over each pixel
    #[arg(long, value_name = "FILE")]
    pub truth: Option<PathBuf>,
    /// A scan of the object, from which large shapes of the depth are taken
    #[arg(long, value_name = "SCAN", requires = "pose")]
    pub scan: Option<PathBuf>,
    /// The camera of the photographs in the scan's coordinates: a JSON file with the keys `transform_matrix` and `fl_x` or
    /// `camera_angle_x` of transforms.json
    #[arg(long, value_name = "FILE", requires = "scan")]
    pub pose: Option<PathBuf>,
    /// Relightable images to write in addition: ptm, ptm-rgb, rti, openlime
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = options::named::<RelightFormat>)]
    pub relight: Vec<RelightFormat>,

    /// A model of the object in the coordinates of the cameras: estimate its materials. FILE is then a transforms.json
    #[arg(long, value_name = "MODEL", conflicts_with_all = ["mask", "balls", "grey_ball", "flat", "pixel_size", "unit", "truth", "scan", "pose", "relight"])]
    pub model: Option<PathBuf>,
    /// Texels along a side of the materials' maps [default: texels about as large as pixels]
    #[arg(long, value_name = "PIXELS", requires = "model", value_parser = clap::value_parser!(u32).range(1..=16384))]
    pub size: Option<u32>,

    #[command(flatten)]
    pub memory: MemoryArgs,
    #[command(flatten)]
    pub run: RunArgs,
}

/// The files that are written.
pub const OUTPUTS: [&str; 14] = [
    "normals.png",
    "normals.exr",
    "sigma.png",
    "sigma.exr",
    "albedo.png",
    "base_color.png",
    "roughness.png",
    "residual.exr",
    "mask.png",
    "depth.exr",
    "plane.glb",
    "relief.glb",
    "report.html",
    "report.json",
];

/// The file that is written in addition with a scan.
pub const ANCHORED: &str = "depth_anchored.png";

fn pixel_size(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(size) if size.is_finite() && size > 0.0 => Ok(size),
        _ => Err(format!("invalid size `{text}`: expected a number above 0, e.g. 0.05")),
    }
}

impl PhotometricArgs {
    /// Returns the options that collections have too.
    pub fn options(&self) -> PhotometricOptions {
        PhotometricOptions {
            mask: self.mask.clone(),
            encoding: self.encoding,
            balls: self.balls.clone(),
            grey_ball: self.grey_ball,
            flat: self.flat.clone(),
            pixel_size: self.pixel_size,
            unit: self.unit,
            relight: self.relight.clone(),
        }
    }

    /// Returns the path of an output.
    pub fn path(&self, name: &str) -> PathBuf {
        self.output.join(name)
    }

    /// Rejects outputs that cannot be written or that are inputs.
    pub fn claim(&self, files: &FileSet, set: &PhotographSet) -> Result<()> {
        files.protect(set.inputs())?;
        files.protect(self.mask.iter().chain(&self.truth).chain(&self.scan).chain(&self.pose))?;
        let photographs = set.photographs.iter().filter_map(|photograph| photograph.path.file_name());
        let flat: Vec<PathBuf> =
            self.flat.iter().flat_map(|folder| photographs.clone().map(|name| folder.join(name))).collect();
        files.protect(&flat)?;
        if let Err(error) = check_output(&set.inputs(), &self.output) {
            bail!("-o {error}");
        }
        files.claim_folder(&self.output)?;
        let anchored = self.scan.as_ref().map(|_| ANCHORED);
        OUTPUTS.into_iter().chain(anchored).try_for_each(|name| files.claim(&self.path(name)))?;
        Ok(())
    }
}
