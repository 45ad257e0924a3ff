//! The options of `taotie bake`.

use crate::device::Device;
use crate::options::{self, fraction, positive};
use crate::proof_args::{ProofArgs, ScanArgs};
use crate::running::{LimitArgs, RunArgs};
use crate::studio::{Green, Space};
use clap::{Args, ValueHint};
use std::ffi::OsString;
use std::path::PathBuf;
use taotie::asset::{Channels, Lod, Preset, Requirement};
use taotie_engine::Error;
use taotie_engine::bake::{MapKind, MatchRule, SetSizes};
use taotie_engine::names::Named;
use taotie_engine::surface::NoiseHandling;
use taotie_io::{CodecKind, CodecSet, TextureCodecs};

/// Options that fix what a search would choose.
const BY_HAND: [&str; 6] = ["low", "triangles", "size", "bits", "meshopt", "channels"];

const EXAMPLES: &str = "\
Examples:
  taotie bake scan.ply -o scan.glb
  taotie bake scan.ply --low low.glb -o baked.glb --size 4096 --maps normal,ao
  taotie bake scan.ply --low low.glb -o normal.png
  taotie bake lid_high.ply body_high.ply --low low.glb -o vase.glb
  taotie bake scan.ply -o scan.glb --triangles 150000 --lods 50000,64px --meshopt
  taotie bake scan.ply -o scan.glb --preset web --max-gpu-memory 64MB
  taotie bake scan.ply -o scan.glb --error 0.9 --require standard,bytes=3MB

Without --low, finds the smallest asset that looks like the scan: made from it, or the scan itself, packed. \
The asset is read back and measured against the scan: OUT.report.html and OUT.report.json, next to OUT, \
state its normal error in degrees, its shape error, and where they occur.";

/// Bakes a high-poly scan to the smallest glTF asset that looks the same, and measures the error.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct BakeArgs {
    /// The high-poly scan (.gltf, .glb, .obj, .ply, .stl, .fbx). Several files in one place are one scan: their surfaces
    /// are joined, each with its own materials. Objects without a name have that of their file, so that lid_high.ply
    /// matches lid_low of --low
    #[arg(required = true)]
    pub high: Vec<PathBuf>,
    /// The asset to write: .glb, or .gltf with its files next to it. A .png, .tiff, .exr, .tga, .dds or .webp gets only the maps, for a
    /// --low with UVs: the first (by default the normal map) in OUT, the others next to it, such as OUT.ao.png.
    /// OUT.<UDIM>.png gets a set of maps for each UDIM tile
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// The low-poly mesh; its UVs and triangles are kept, as are meshes, materials, skins and animations of glTF:
    /// each material gets its own maps [default: made from the scan]
    #[arg(long, value_name = "LOW")]
    pub low: Option<PathBuf>,
    /// Ignore the UVs and materials of --low: a new atlas for a textured model, if it is its own scan
    #[arg(long, requires = "low", help_heading = "Low-poly mesh")]
    pub new_uvs: bool,
    #[command(flatten)]
    pub scan: ScanArgs,
    /// Measure the scan's noise, and keep or remove it. With remove, everything is made from the scan without it: only
    /// what its noise explains is smoothed, not relief or creases. The proof compares with the scan as given, so that
    /// its errors include what was removed [default: kept, not measured]
    #[arg(long, value_name = "keep|remove", value_parser = options::named::<NoiseHandling>, help_heading = "Scan")]
    pub noise: Option<NoiseHandling>,

    /// Triangles of the low-poly mesh; turns the search off [default: 50000 if only size or packing is given]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..), help_heading = "Low-poly mesh", conflicts_with = "low")]
    pub triangles: Option<u32>,
    /// Make the low-poly mesh from a watertight outer surface of the scan, built from voxels of 0.25 % of its diagonal:
    /// for generated meshes and polygon soups. Holes narrower than 2 % are closed, inner parts left out, and sheets
    /// become thin shells
    #[arg(long, help_heading = "Low-poly mesh", conflicts_with = "low")]
    pub remesh: bool,
    /// Target and ceilings for a use: web (mean 1°, 100,000 triangles, 80 MB of GPU memory), archive (mean
    /// 0.1°, no ceilings), or engine (mean 0.5°, 50,000 triangles, 32 MB, textures in KTX2). --error (all angle
    /// limits), --require, --images and explicit ceilings override them; --lods overrides the levels of detail of
    /// engine
    #[arg(long, value_name = "web|archive|engine", value_parser = options::named::<Preset>, help_heading = "Search", conflicts_with_all = BY_HAND)]
    pub preset: Option<Preset>,
    /// Find the smallest asset with a mean normal error, as seen, of at most DEG degrees: made from the scan, or the
    /// scan itself, packed. The search chooses triangles, vertex bits, normal map or none, sizes, formats and
    /// qualities by their cost [default, unless triangles, size or packing are given: the target of --preset, or the
    /// limits of --require on angles and colours as seen, missed and hausdorff, or `visually-lossless`]
    #[arg(long, value_name = "DEG", value_parser = degrees, help_heading = "Search", conflicts_with_all = BY_HAND)]
    pub error: Option<f64>,
    /// Find the asset closest to the scan within SIZE bytes, such as 500kB. With --error, --preset or --require, an
    /// asset that meets them is good enough. Exit with 1 if none is that small
    #[arg(long, value_name = "SIZE", value_parser = bytes, help_heading = "Search", conflicts_with_all = BY_HAND, conflicts_with_all = ["lods", "no_verify"])]
    pub bytes: Option<u64>,
    /// Maximum number of triangles of the asset that a search finds. Exit with 1 if it has more
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..), help_heading = "Search", conflicts_with_all = BY_HAND)]
    pub max_triangles: Option<u32>,
    /// Maximum GPU memory of the asset, such as 64MB: vertices, and textures with mip levels at four
    /// bytes per texel, or one with KTX2. Exit with 1 if it takes more
    #[arg(long, value_name = "SIZE", value_parser = bytes, help_heading = "Search", conflicts_with_all = BY_HAND)]
    pub max_gpu_memory: Option<u64>,
    /// Write every trial of the search as CSV: bytes, GPU memory, triangles, maps, degrees, ΔE
    #[arg(long, value_name = "FILE.csv", help_heading = "Search", conflicts_with_all = BY_HAND)]
    pub trials: Option<PathBuf>,
    /// Coarser levels of detail in the same file (MSFT_lod), separated by commas. Npx (32 to 511) is the lightest
    /// level that meets the target when the object fills N² pixels; N is a level of N triangles, shown at the size at
    /// which it meets the target [default: none; 256px,128px,64px with --preset engine]
    #[arg(long, value_name = "Npx|N,...", value_delimiter = ',', help_heading = "Low-poly mesh")]
    pub lods: Vec<Lod>,

    /// Width and height of the maps, texels: one number, two as in 2048x1024 for a --low with UVs, or auto: the
    /// smallest power of two, 256 to 8192, that preserves the scan's detail [default: 2048]
    #[arg(long, value_name = "N|WxH|auto", value_parser = options::map_size, help_heading = "Maps")]
    pub size: Option<[u32; 2]>,
    /// Sizes of the maps of the materials of --low, or of its UDIM tiles: even gives all texels the same width on the
    /// surface, and the largest maps --size; or by name [default: all --size]
    #[arg(long, value_name = "even|NAME=N,...", requires = "low", help_heading = "Maps")]
    pub sizes: Option<SetSizes>,
    /// Maps to bake, separated by commas: auto (normal, and all that varies in the scan's materials), normal, ao
    /// (ambient occlusion), albedo (base colour), height, bent (bent normals), curvature, roughness (widened by fine
    /// relief), metallic-roughness, emission, alpha, occlusion (the scan's own texture), position, world-normal,
    /// thickness, vertex-color, material-id, object-id, wireframe (the low-poly mesh's edges), bevel (normals with rounded
    /// edges), vector-displacement, convexity, concavity, gradient (height from the scan's lowest to its highest point)
    #[arg(long, value_name = "auto|MAP,...", value_delimiter = ',', default_value = "auto", value_parser = map, help_heading = "Maps")]
    pub maps: Vec<Auto<MapKind>>,
    /// Space of the normal map. glTF has only tangent space, so an object-space map is written next to the asset
    #[arg(long, value_enum, default_value_t = Space::Tangent, help_heading = "Maps")]
    pub space: Space,
    /// Direction of green in maps for other programs: down (DirectX) adds OUT.normal.png, and also applies to
    /// OUT.bent.png and to standalone maps. The asset's own normal map always points up, as glTF requires
    #[arg(long, value_enum, default_value_t = Green::Up, help_heading = "Maps")]
    pub green: Green,
    /// Another texture next to the asset that packs maps into its channels: orm, unreal, unity-mask, or a list such as
    /// dirt:R=ao,G=curvature,B=1-height. May be repeated
    #[arg(long, value_name = "RECIPE|[NAME:]R=MAP,...", help_heading = "Maps")]
    pub channels: Vec<Channels>,
    /// Samples per texel
    #[arg(long, value_name = "K", default_value = "4", value_parser = ["1", "4", "9", "16", "25", "36", "49", "64"], help_heading = "Maps")]
    pub samples: String,
    /// Bits per channel of normal maps; 8-bit maps are dithered where they would show banding. 32 stores all maps as
    /// floats, in a .tiff; an .exr always does [default: 8]
    #[arg(long, value_parser = ["8", "16", "32"], help_heading = "Maps")]
    pub bits: Option<String>,
    /// Padding around UV islands, 0 to 16384 texels; auto fills the whole map
    #[arg(long, value_name = "auto|N", default_value = "auto", value_parser = dilation, help_heading = "Maps")]
    pub dilation: Auto<u32>,
    /// Rays per texel over the hemisphere, for ao, bent and thickness, or through the edges, for bevel [default: 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096), help_heading = "Maps")]
    pub ao_rays: Option<u32>,
    /// Maximum distance at which the scan occludes, for ao and bent, model units [default: unlimited]
    #[arg(long, value_name = "X", value_parser = positive, help_heading = "Maps")]
    pub ao_distance: Option<f64>,
    /// Radius of rounded edges for bevel, model units [default: 1 % of the scan's diagonal]
    #[arg(long, value_name = "X", value_parser = positive, help_heading = "Maps")]
    pub bevel_radius: Option<f64>,
    /// Roughness of the scan's surface, 0 to 1 [default: that of its material]
    #[arg(long, value_name = "X", value_parser = fraction, help_heading = "Maps")]
    pub roughness: Option<f64>,

    /// Length of the projection rays, model units; auto measures the gap between the meshes
    #[arg(long, value_name = "auto|X", default_value = "auto", value_parser = distance, help_heading = "Rays", conflicts_with = "cage")]
    pub ray_distance: Auto<f64>,
    /// How points of the low-poly mesh find the scan. by-name: X_low shows only X_high, in glTF by node and in OBJ by
    /// object, if such names exist; isolated: so do rays for ao, bent, thickness and bevel; nearest ignores names; uv:
    /// points of the same UV correspond, wherever they are [default: by-name]
    #[arg(long = "match", value_name = "by-name|isolated|nearest|uv", value_parser = options::named::<MatchRule>, requires = "low", help_heading = "Rays")]
    pub matching: Option<MatchRule>,
    /// Multiply ray distances, also those of a cage, by the red channel of the low-poly mesh's vertex colours, linear
    #[arg(long, requires = "low", help_heading = "Rays")]
    pub ray_colors: bool,
    /// Skew correction, so that relief on flat faces is not shifted by rays along averaged normals. auto: rays follow flat
    /// faces, except near their edges, where the scan does; keep: averaged normals everywhere; or a mask on the UVs of
    /// --low: triangle normals where white [default: auto; keep with --cage]
    #[arg(long, value_name = "auto|keep|MASK", value_parser = clap::value_parser!(Skew), value_hint = ValueHint::FilePath, help_heading = "Rays")]
    pub skew: Option<Skew>,
    /// The low-poly mesh with its vertices moved outward, where projection rays start
    #[arg(long, value_name = "FILE", requires = "low", help_heading = "Rays")]
    pub cage: Option<PathBuf>,

    /// Device that casts projection, ao and bent rays; the CPU casts all others. Only maps by the CPU are bit-identical
    /// everywhere. A scan that does not fit the GPU is an error, with auto too
    #[arg(long, value_enum, default_value_t = Device::Cpu, help_heading = "Rays")]
    pub device: Device,

    /// Image formats of textures. For a search, the candidates: names separated by commas, or auto for those of
    /// --codecs. Otherwise one format: png, webp (lossless), ktx2 (UASTC with Zstandard), or with a quality: webp:85,
    /// jpeg:85 and avif:80 (base colour and emission; the rest stays lossless), ktx2:2 (λ of rate–distortion
    /// optimisation, 1 to 64, for all but normals). Separate formats for colours, normals and numbers:
    /// jpeg:90/webp/webp:75. A quality turns the search off
    #[arg(long, value_name = "auto|FORMAT[:QUALITY],...", value_parser = images, default_value = "auto", help_heading = "File")]
    pub images: Images,
    /// Compress geometry with meshoptimizer
    #[arg(long, help_heading = "File")]
    pub meshopt: bool,
    /// Codecs for a search, and the extension for --meshopt: portable (PNG, JPEG, WebP, EXT_meshopt_compression), or
    /// web-latest for the newest web viewers (also AVIF, KHR_meshopt_compression). --images overrides the image
    /// formats
    #[arg(long, value_name = "portable|web-latest", value_parser = options::named::<CodecSet>, default_value = "portable", help_heading = "File")]
    pub codecs: CodecSet,
    /// XMP metadata (JSON-LD, such as dc:title or dc:rights) to add to the scan's. If the scan has no copyright
    /// notice, dc:rights becomes the asset's
    #[arg(long, value_name = "FILE.json", help_heading = "File")]
    pub provenance: Option<PathBuf>,

    #[command(flatten)]
    pub proof: ProofArgs,
    /// Do not measure the error or write a report
    #[arg(long, help_heading = "Proof", conflicts_with_all = ["require", "proof_points", "proof_view", "date", "operator"])]
    pub no_verify: bool,

    #[command(flatten)]
    pub limits: LimitArgs,
    #[command(flatten)]
    pub run: RunArgs,
}

/// The normals that projection rays follow on flat faces.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Skew {
    /// Those of the faces, where the scan does.
    Auto,
    /// The averaged normals.
    Keep,
    /// Those of the triangles, by a mask.
    Mask(PathBuf),
}

impl From<OsString> for Skew {
    fn from(text: OsString) -> Self {
        match text.to_str() {
            Some("auto") => Self::Auto,
            Some("keep") => Self::Keep,
            _ => Self::Mask(text.into()),
        }
    }
}

/// A value, or the program's choice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Auto<T> {
    /// The program's choice.
    Auto,
    /// An explicit value.
    Given(T),
}

fn map(text: &str) -> Result<Auto<MapKind>, String> {
    match text.trim() {
        "auto" => Ok(Auto::Auto),
        name => options::named(name).map(Auto::Given).map_err(|error| format!("{error}, or auto")),
    }
}

fn dilation(text: &str) -> Result<Auto<u32>, String> {
    match text {
        "auto" => Ok(Auto::Auto),
        _ => match text.parse() {
            Ok(texels) if texels <= 16_384 => Ok(Auto::Given(texels)),
            _ => Err("expected auto or 0 to 16384 texels".into()),
        },
    }
}

fn distance(text: &str) -> Result<Auto<f64>, String> {
    match text {
        "auto" => Ok(Auto::Auto),
        _ => positive(text).map(Auto::Given),
    }
}

fn bytes(text: &str) -> Result<u64, String> {
    let required: Requirement = format!("bytes={text}").parse().map_err(|error: Error| error.to_string())?;
    Ok(required.most as u64)
}

fn degrees(text: &str) -> Result<f64, String> {
    let number = positive(text)?;
    if number < 180.0 { Ok(number) } else { Err(format!("{text} is not below 180")) }
}

impl<T> Auto<T> {
    /// Returns the explicit value.
    pub fn given(self) -> Option<T> {
        match self {
            Self::Auto => None,
            Self::Given(value) => Some(value),
        }
    }
}

/// The formats of textures: candidates for a search, or fixed ones.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Images {
    /// The program's choice.
    Auto,
    /// Candidate formats; a search chooses the quality.
    Kinds(Vec<CodecKind>),
    /// Formats with a given quality.
    Given(TextureCodecs),
}

impl Images {
    /// Returns the formats to choose from; empty for the program's choice.
    pub fn kinds(&self) -> Vec<CodecKind> {
        match self {
            Self::Kinds(kinds) => kinds.clone(),
            Self::Auto | Self::Given(_) => Vec::new(),
        }
    }

    /// Returns the formats of a bake without a search.
    ///
    /// # Errors
    /// Several formats, and JPEG or AVIF without a quality.
    pub fn codecs(&self) -> Result<TextureCodecs, String> {
        match self {
            Self::Auto => Ok(TextureCodecs::default()),
            Self::Given(codecs) => Ok(*codecs),
            Self::Kinds(kinds) => match kinds[..] {
                [kind] => {
                    let without = || format!("specify a quality, such as {}:85", kind.name());
                    let codec = kind.least_lossy().ok_or_else(without)?;
                    Ok(codec.into())
                }
                _ => Err("these options run no search; specify one format".into()),
            },
        }
    }
}

/// Parses `auto`, names of formats separated by commas, or formats with their quality.
fn images(text: &str) -> Result<Images, String> {
    if text == "auto" {
        return Ok(Images::Auto);
    }
    let is_no_name = |name: &str| name.trim() == "auto" || name.contains([':', '/']);
    if text.contains(',') && text.split(',').any(is_no_name) {
        return Err(
            "a list takes names only: write webp,png, or one format with its quality, such as webp:85".into(),
        );
    }
    if text.contains([':', '/']) {
        return text.parse().map(Images::Given).map_err(|error: Error| error.to_string());
    }
    let mut kinds = text.split(',').map(options::named).collect::<Result<Vec<CodecKind>, _>>()?;
    kinds.sort_unstable();
    kinds.dedup();
    Ok(Images::Kinds(kinds))
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_io::ImageCodec;

    #[test]
    fn sets_and_formats_are_told_apart() {
        assert_eq!(images("auto"), Ok(Images::Auto));
        assert_eq!(images("webp, png,webp"), Ok(Images::Kinds(vec![CodecKind::Png, CodecKind::WebP])));
        assert_eq!(images("webp:85"), Ok(Images::Given(ImageCodec::LossyWebP(85).into())));
        assert!(images("webp:85,png").is_err() && images("gif").is_err());
        let codecs = |text: &str| images(text).unwrap().codecs();
        assert_eq!(codecs("ktx2"), Ok(ImageCodec::Ktx2(0).into()));
        assert!(
            codecs("jpeg").unwrap_err().contains("quality")
                && codecs("avif").unwrap_err().contains("avif:85")
                && codecs("png,webp").is_err()
        );
    }
}
