//! The options of `taotie normals`.

use crate::options;
use crate::running::{LimitArgs, RunArgs};
use crate::studio::{Green, Space};
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use taotie_engine::image::Wrap;
use taotie_engine::surface::TangentMethod;
use taotie_io::FileSet;

const EXAMPLES: &str = "\
Examples:
  taotie normals height.png --height-scale 8 -o normals.png
  taotie normals directx.png --green-in down -o opengl.png
  taotie normals object.png --to tangent --mesh statue.glb -o tangent.png
  taotie normals normals16.png --bits 8 --dither -o normals8.png

Prints the angular error of the conversion: from storing the normals in the output's bits, and from converting them \
back to the input's space. Without --from and --green-in, both are guessed from the pixels.";

/// Makes normal maps from height maps, and converts normal maps: tangent and object space, green up and down, 8 and
/// 16 bits.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct NormalsArgs {
    /// The height map or normal map (PNG, JPEG, WebP, KTX2, TGA, HDR, EXR)
    pub input: PathBuf,
    /// The normal map to write (PNG)
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,

    /// Content of the input
    #[arg(long, value_enum, default_value_t = From::Auto)]
    pub from: From,
    /// Space of the output [default: that of the input; tangent for height maps]
    #[arg(long, value_enum)]
    pub to: Option<Space>,
    /// Direction of green in the input: up (OpenGL, glTF) or down (DirectX) [default: guessed]
    #[arg(long, value_enum)]
    pub green_in: Option<Green>,
    /// Direction of green in the output: up (OpenGL, glTF) or down (DirectX) [default: up]
    #[arg(long, value_enum)]
    pub green: Option<Green>,
    /// Bits per channel of the output [default: those of the input if its space is kept, otherwise 16]
    #[arg(long, value_parser = ["8", "16"])]
    pub bits: Option<String>,
    /// Dither before rounding: no banding on gentle curves, but more error in each texel
    #[arg(long)]
    pub dither: bool,

    /// Height of white, in texels of the map, or in model units with --mesh
    #[arg(long, value_name = "X", value_parser = options::number, allow_negative_numbers = true, help_heading = "Heights")]
    pub height_scale: Option<f64>,
    /// Heights beyond the border of the map [default: repeat]
    #[arg(long, value_enum, help_heading = "Heights")]
    pub border: Option<Border>,

    /// The model that the map is for, needed between tangent and object space (.gltf, .glb, .obj, .ply, .stl, .fbx)
    #[arg(long, value_name = "MODEL", help_heading = "Mesh")]
    pub mesh: Option<PathBuf>,
    /// The mesh of the model, by name or number as listed by `inspect`; needed if there are several
    #[arg(long, value_name = "NAME|N", requires = "mesh", help_heading = "Mesh")]
    pub part: Option<String>,
    /// UV set of the mesh, from 0
    #[arg(long, value_name = "N", default_value_t = 0, requires = "mesh", help_heading = "Mesh")]
    pub uv_set: usize,
    /// Tangents: face, averaged, mikktspace [default: those of the file, otherwise mikktspace]
    #[arg(long, value_parser = options::named::<TangentMethod>, requires = "mesh", help_heading = "Mesh")]
    pub tangents: Option<TangentMethod>,
    /// Padding around UV islands, texels
    #[arg(long, alias = "margin", value_name = "N", default_value_t = 16, requires = "mesh", value_parser = clap::value_parser!(u32).range(..=1024), help_heading = "Mesh")]
    pub dilation: u32,

    #[command(flatten)]
    pub limits: LimitArgs,
    #[command(flatten)]
    pub run: RunArgs,
}

/// The content of the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum From {
    /// Guessed from its pixels
    Auto,
    /// Heights, white is high; the first channel
    Height,
    /// Normals relative to tangent, bitangent and normal
    Tangent,
    /// Normals in object space
    Object,
}

/// The heights beyond the border of a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Border {
    /// The map repeats
    Repeat,
    /// Every second copy is mirrored
    Mirror,
    /// The border texel is repeated
    Clamp,
}

impl Border {
    /// Returns the same for a texture.
    pub fn wrap(self) -> Wrap {
        match self {
            Self::Repeat => Wrap::Repeat,
            Self::Mirror => Wrap::Mirror,
            Self::Clamp => Wrap::Clamp,
        }
    }
}

impl NormalsArgs {
    /// Rejects options that cannot work together, before any work is done.
    pub fn check(&self) -> Result<()> {
        if self.output.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("png")) {
            bail!("{}: normal maps are written as .png", self.output.display());
        }
        Ok(())
    }

    /// Rejects a map that cannot be written or that is an input.
    pub fn claim(&self, files: &FileSet) -> Result<()> {
        files.protect(std::iter::once(&self.input).chain(&self.mesh))?;
        Ok(files.claim(&self.output)?)
    }
}
