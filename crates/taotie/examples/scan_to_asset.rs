//! Bakes a scan to a light asset, and reports its deviation from the scan.
//!
//! ```text
//! cargo run --release -p taotie --example scan_to_asset -- scan.ply scan.glb
//! ```
#![allow(clippy::print_stdout, reason = "an example prints")]

use std::path::Path;
use taotie::Limits;
use taotie::asset::{BakeOptions, Baker, Packing, Requirement, Scan, VerifyOptions};
use taotie::{Error, Progress, Result};

/// Bakes `scan` to `asset`; returns the figures in words.
pub fn run(scan: &Path, asset: &Path, options: BakeOptions) -> Result<String> {
    let progress = Progress::SILENT;
    let scan = Scan::read(scan, &Limits::default(), progress)?;
    let baked = Baker::new(options).bake(&scan, progress)?;
    let written = baked.write(asset, &Packing::default(), progress)?;
    let proof = written.verify(scan, &VerifyOptions::default(), progress)?;
    let met = proof.evaluate(&[Requirement::mean_angle_deg(2.0), Requirement::missed(0.001)]);
    Ok(format!(
        "{} triangles, {} bytes; mean normal error {:.2}°; required: {}",
        baked.levels().next().map_or(0, |mesh| mesh.triangles().len()),
        proof.figures.bytes_out,
        proof
            .figures
            .finest()
            .and_then(|finest| finest.overview.angles)
            .map_or(f64::NAN, |angles| angles.summary.mean),
        if met.iter().all(|met| met.met) { "met" } else { "not met" }
    ))
}

fn main() -> Result<()> {
    let files: Vec<String> = std::env::args().skip(1).collect();
    let [scan, asset] = files.as_slice() else {
        return Err(Error::invalid("the arguments", "expected the file of the scan and that of the asset"));
    };
    println!("{}", run(scan.as_ref(), asset.as_ref(), BakeOptions::default())?);
    Ok(())
}
