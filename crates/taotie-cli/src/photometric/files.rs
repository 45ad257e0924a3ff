//! The files that `taotie photometric` writes.

use super::PhotometricArgs;
use anyhow::Result;
use taotie_engine::Warnings;
use taotie_engine::compare::{ColorMap, Field};
use taotie_engine::film::Development;
use taotie_engine::image::{Encoding, Image};
use taotie_engine::math::srgb::srgb_from_linear;
use taotie_io::{FileSet, ImageFormat, PngColor, PngImage, PngSamples};
use taotie_photometric::{Estimate, Estimator};
use taotie_report::heat_map::HeatMap;

/// Writes all files except the report, and returns warnings about the GLB.
pub fn write(args: &PhotometricArgs, files: &FileSet, estimate: &Estimate) -> Result<Warnings> {
    let normals = estimate.normals(Estimator::Best);
    write_floats(args, files, ("normals.exr", &normals))?;
    let codes: Vec<u16> = normals.pixels().iter().flat_map(|pixel| normal_codes(*pixel)).collect();
    let samples = PngSamples::U16(&codes);
    write_png(args, files, ("normals.png", estimate), (PngColor::Rgba, samples, Encoding::Linear))?;
    let sigma = estimate.image(|_, best| {
        let [larger, smaller] = best.covariance.eigenvalues().map(|variance| variance.sqrt().to_degrees());
        [best.sigma_deg, larger, smaller]
    });
    write_floats(args, files, ("sigma.exr", &sigma))?;
    write_sigma(args, files, &sigma)?;
    let residual = estimate.image(|_, best| [best.residual; 3]);
    write_floats(args, files, ("residual.exr", &residual))?;
    let mask: Vec<u8> = normals.pixels().iter().map(|pixel| if pixel[3] > 0.0 { 255 } else { 0 }).collect();
    let samples = PngSamples::U8(&mask);
    write_png(args, files, ("mask.png", estimate), (PngColor::Grey, samples, Encoding::Linear))?;
    let albedo = albedo_codes(estimate);
    let samples = PngSamples::U8(&albedo);
    write_png(args, files, ("albedo.png", estimate), (PngColor::Grey, samples, Encoding::Srgb))?;
    let mut warnings = Warnings::default();
    let plane = taotie_io::encode_scene(&estimate.plane()?, &["plane".to_owned()], &mut warnings)?;
    files.write_bytes(&args.path("plane.glb"), &plane)?;
    Ok(warnings)
}

fn write_floats(args: &PhotometricArgs, files: &FileSet, (name, image): (&str, &Image)) -> Result<()> {
    Ok(files.write_image(&args.path(name), image, &Development::default(), ImageFormat::Exr)?)
}

fn write_png(
    args: &PhotometricArgs,
    files: &FileSet,
    (name, estimate): (&str, &Estimate),
    (color, samples, encoding): (PngColor, PngSamples<'_>, Encoding),
) -> Result<()> {
    let (width, height) = (estimate.width(), estimate.height());
    Ok(files.write_png(&args.path(name), &PngImage { width, height, color, samples, encoding })?)
}

/// Returns a normal as codes of 16 bits; transparent without one.
fn normal_codes([x, y, z, has]: [f32; 4]) -> [u16; 4] {
    let code = |v: f32| ((0.5 * v + 0.5) * 65_535.0 + 0.5) as u16;
    if has > 0.0 { [code(x), code(y), code(z), u16::MAX] } else { [32_768, 32_768, u16::MAX, 0] }
}

/// Writes the uncertainty as colours; the last is for the 95th percentile.
fn write_sigma(args: &PhotometricArgs, files: &FileSet, sigma: &Image) -> Result<()> {
    let values = sigma.pixels().iter().map(|pixel| if pixel[3] > 0.0 { pixel[0] } else { f32::NAN });
    let field = Field::new(sigma.width(), sigma.height(), values.collect())?;
    let top = field.summary().map_or(1.0, |summary| summary.p95 as f32).max(1e-3);
    let title = "uncertainty of the normals (68 %)";
    let map = HeatMap { field: &field, title, unit: "°", map: ColorMap::Viridis, top }.with_scale();
    Ok(files.write_png(&args.path("sigma.png"), &map.png())?)
}

/// Returns the albedo in sRGB, relative to the 99th percentile.
fn albedo_codes(estimate: &Estimate) -> Vec<u8> {
    let mut sorted: Vec<f64> = estimate.best.iter().flatten().map(|best| best.albedo).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let white = sorted.get(sorted.len() * 99 / 100).copied().unwrap_or(1.0).max(f64::MIN_POSITIVE);
    let code = |v: f32| (srgb_from_linear(f64::from(v).clamp(0.0, 1.0)) * 255.0 + 0.5) as u8;
    let albedo = estimate.image(|_, best| [best.albedo / white; 3]);
    albedo.pixels().iter().map(|pixel| code(pixel[0])).collect()
}
