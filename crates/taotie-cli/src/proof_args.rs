//! Options of a scan and of a proof against it, which `bake`, `verify` and `view` share.

use crate::options::named;
use clap::{Args, ValueEnum};
use taotie::asset::{Requirement, ScanOptions, Signature, VerifyOptions};
use taotie_engine::length::Unit;
use taotie_engine::scene::GreenChannel;
use taotie_report::bake_page;

/// How to read a scan whose file is ambiguous.
#[derive(Args)]
pub struct ScanArgs {
    /// Minimum angle between facets of a hard edge, degrees, for a scan without normals or with one normal per facet
    /// [default: smooth, except the hard edges of modelled shapes]
    #[arg(long, value_name = "DEG", value_parser = crease_angle, help_heading = "Scan")]
    pub crease_angle: Option<f64>,
    /// Keep the facets of such a scan flat, like --crease-angle 0
    #[arg(long, help_heading = "Scan", conflicts_with = "crease_angle")]
    pub flat: bool,
    /// Direction of green in the scan's normal maps: up (OpenGL), down (DirectX), or auto, which trusts the file
    /// unless the pixels contradict it
    #[arg(long, value_enum, default_value_t = ScanGreen::Auto, hide_possible_values = true, value_name = "auto|up|down", help_heading = "Scan")]
    pub scan_green: ScanGreen,
    /// Unit of the scan's coordinates, even of a glTF that is not in metres. The asset is then in metres, as glTF
    /// requires, and lengths in the proof have units. If a scan has files that state their unit (glTF, FBX) and others,
    /// it is the unit of the others, and required [default: m for glTF and FBX, otherwise unknown]
    #[arg(long, value_name = "mm|cm|m|in", value_parser = named::<Unit>, help_heading = "Scan")]
    pub unit: Option<Unit>,
}

/// The direction of green in a scan's normal maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ScanGreen {
    /// As the file states, unless the pixels contradict it.
    Auto,
    /// +Y.
    Up,
    /// −Y.
    Down,
}

impl ScanArgs {
    /// Returns the options for reading the scan.
    pub fn options(&self) -> ScanOptions {
        let crease_angle_deg = if self.flat { Some(0.0) } else { self.crease_angle };
        let green = match self.scan_green {
            ScanGreen::Auto => None,
            ScanGreen::Up => Some(GreenChannel::Up),
            ScanGreen::Down => Some(GreenChannel::Down),
        };
        ScanOptions { crease_angle_deg, green, unit: self.unit }
    }
}

fn crease_angle(text: &str) -> Result<f64, String> {
    let angle: f64 = text.parse().map_err(|_| "expected an angle in degrees")?;
    let range = 0.0..=180.0;
    if range.contains(&angle) { Ok(angle) } else { Err("expected an angle between 0 and 180 degrees".into()) }
}

/// The measurements, and their required limits.
#[derive(Args)]
#[command(next_help_heading = "Proof")]
pub struct ProofArgs {
    /// Exit with 1 unless every figure is within its limit. As seen, at the same pixel: mean-angle, p95-angle, max-angle
    /// (°), mean-color, p95-color (CIEDE2000), mean-material (metallic, roughness or occlusion, whichever differs most,
    /// %), and patch-angle, patch-color, patch-material (the mean in the worst 1 % of the surface, seen close up),
    /// patch-detail (relief or colours lost there, relative to how much they vary on the scan, %). within-Ndeg,
    /// within-NdE, within-N%, such as within-5deg=99% (at least, %: the share of the visible surface whose angle, colour
    /// difference or distance is at most N). On the surface, along the rays of a bake: surface-mean-angle,
    /// surface-p95-angle, surface-max-angle. Shape: missed (visible surface that the other mesh lacks, %), completeness
    /// (at least, %), hausdorff (upper bound of the largest distance, % of the diagonal or a length), silhouette (pixels
    /// of 512 or a length), texel (median width of the asset's texels, a length). Lengths are in um, mm, cm, m or in,
    /// such as hausdorff=0.2mm, and need a scan whose unit is known. Images: flip, worst-view, ssim (at least). Size:
    /// triangles, bytes, gpu-memory (vertices, and textures with mip levels); the latter two with B, kB, MB, GB, KiB,
    /// MiB or GiB. `standard` means mean-angle=1, p95-angle=5, patch-angle=10, patch-detail=30%, missed=0.1%,
    /// hausdorff=1%, mean-color=1, patch-color=3, mean-material=4%, patch-material=12%; `visually-lossless` means
    /// mean-angle=0.5, p95-angle=2, patch-detail=30%, missed=0.1%, hausdorff=1%, mean-color=0.5, p95-color=1.5,
    /// patch-color=3, mean-material=2%, patch-material=12%; `web`, `archive` and `engine` mean the target and the
    /// ceilings of that preset of `taotie bake`. Figures as seen apply to every level of detail, at the size at which it
    /// is shown; all others to the finest. mean-angle@1=5 applies to level 1 only, instead of the limit for all levels;
    /// level 0 is the finest
    #[arg(long, value_name = "standard|FIGURE[@LEVEL]=LIMIT[UNIT],...", value_delimiter = ',', value_parser = required)]
    require: Vec<Required>,
    /// Pixels of the overview and points of each surface to compare initially, at least 10. If a limit is within the
    /// 99 % interval of the result, more are taken, up to 4 million
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(10..=4_000_000), default_value_t = 20_000)]
    proof_points: u32,
    /// Width and height of the compared images from all sides, 11 to 4096 pixels
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(11..=4096), default_value_t = 384)]
    proof_view: u32,
    /// Date to print on the certificate; the machine's date is never used, so that the output stays reproducible
    #[arg(long, value_name = "TEXT")]
    date: Option<String>,
    /// Name of the operator to print on the certificate
    #[arg(long, value_name = "TEXT")]
    operator: Option<String>,
}

/// One requirement, or a named set.
#[derive(Debug, Clone)]
struct Required(Vec<Requirement>);

fn required(text: &str) -> Result<Required, String> {
    Requirement::read(text).map(Required).map_err(|error| error.to_string())
}

impl ProofArgs {
    /// Returns all requirements.
    pub fn requirements(&self) -> Vec<Requirement> {
        self.require.iter().flat_map(|required| required.0.clone()).collect()
    }

    /// Returns the date and the operator of the certificate.
    pub fn signature(&self) -> Signature {
        Signature { date: self.date.clone(), operator: self.operator.clone() }
    }

    /// Returns the options for measuring the error.
    pub fn options(&self) -> VerifyOptions {
        let (points, view) = (self.proof_points as usize, self.proof_view);
        VerifyOptions { points, view, requirements: self.requirements(), ..VerifyOptions::default() }
    }

    /// Returns the same, with maps of errors and pictures of the worst patches if a page is written.
    pub fn options_of_page(&self, is_written: bool) -> VerifyOptions {
        bake_page::options(self.options(), is_written)
    }
}
