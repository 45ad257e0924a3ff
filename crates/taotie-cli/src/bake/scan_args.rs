//! The options for reading a scan.

use crate::options::named;
use clap::{Args, ValueEnum};
use taotie::asset::ScanOptions;
use taotie_engine::length::Unit;
use taotie_engine::scene::GreenChannel;

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
    /// requires, and lengths in the proof have units [default: m for glTF, otherwise unknown]
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
