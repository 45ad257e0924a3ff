//! Relightable images of generated photographs: how close they are to the photographs, and the normals that follow
//! from them.

use crate::studio::{Finish, Photographs, Shooting, photograph, relief};
use std::path::Path;
use taotie_engine::compare::angular_error;
use taotie_engine::names::Named;
use taotie_engine::{Progress, Warnings};
use taotie_photometric::{
    Coefficients, ColorReader, Estimate, Estimator, PhotographSet, Quality, Reading, RelightFormat,
    Relightable, Samples, Transfer,
};

fn reading() -> Reading<'static> {
    Reading { mask: None, transfer: Transfer::Auto, flat: None, limits: Default::default() }
}

/// Returns the image in a format and its peak signal-to-noise ratio.
fn fitted(photographs: &Photographs, format: RelightFormat) -> (Relightable, f64) {
    let set = PhotographSet::open(&photographs.lp, &mut Warnings::default()).unwrap();
    let reading = reading();
    let reader = ColorReader::new(&set, &reading, 1.0).unwrap();
    let basis = format.basis(set.photographs.len());
    let image = Coefficients::fit(&reader, basis, Progress::SILENT).unwrap().stored(format.colors());
    let quality = Quality::of(&image, &reader, Progress::SILENT).unwrap();
    assert_eq!(quality.of_photographs.len(), set.photographs.len());
    (image, quality.psnr)
}

/// Returns the mean errors in degrees of least squares, the robust and the written normals of a relightable file, the mean
/// sigma, and the fraction of normals within it.
fn normals(path: &Path, photographs: &Photographs) -> [f64; 5] {
    let mut warnings = Warnings::default();
    let set = PhotographSet::open(path, &mut warnings).unwrap();
    assert!(warnings.list()[0].what.contains("sigma"), "{:?}", warnings.list());
    let mask = photographs.lp.with_file_name("mask.png");
    let reading = Reading { mask: Some(&mask), ..reading() };
    let samples = Samples::read(&set, &reading, Progress::SILENT).unwrap();
    let estimate = Estimate::of(&samples, Progress::SILENT).unwrap();
    let mean =
        |which| angular_error(&estimate.normals(which), &photographs.truth).unwrap().summary().unwrap().mean;
    let radius = estimate.coverage(&photographs.truth).unwrap().radius;
    [
        mean(Estimator::LeastSquares),
        mean(Estimator::Robust),
        mean(Estimator::Best),
        estimate.mean(|pixel| pixel.sigma_deg),
        radius,
    ]
}

/// Asserts that files of all formats are at least `psnr` decibels and at most `most` degrees from the truth.
fn assert_relightable(name: &str, photographs: &Photographs, (psnr, most): (f64, f64)) {
    for (format_name, format) in RelightFormat::NAMES {
        let (image, found) = fitted(photographs, *format);
        let folder = tempfile::tempdir().unwrap();
        let extension = if *format == RelightFormat::Rti { "rti" } else { "ptm" };
        let path = match format {
            RelightFormat::Web => folder.path().to_path_buf(),
            _ => folder.path().join("image").with_extension(extension),
        };
        let files = format.files(&image, &path).unwrap();
        files.iter().for_each(|file| std::fs::write(&file.path, &file.bytes).unwrap());
        let [least_squares, robust, best, sigma, radius] = normals(&path, photographs);
        println!(
            "| {name} | {format_name} | {found:.1} dB | {least_squares:.2}° | {robust:.2}° | {best:.2}° | \
             {sigma:.2}° | {:.0} % |",
            100.0 * radius
        );
        assert!(found > psnr && best < most, "{name}, {format_name}: {found}, {best}");
    }
}

#[test]
fn relit_images_resemble_the_photographs_and_give_their_normals() {
    let shooting = Shooting::default();
    let gentle = photograph(relief(0.6), &Finish::matt(0.6), shooting);
    assert_relightable("gentle relief, matt", &gentle, (32.0, 1.2));
    let deep = photograph(relief(1.6), &Finish::satin(0.5, 0.45), shooting);
    assert_relightable("relief, satin", &deep, (23.0, 6.0));
}
