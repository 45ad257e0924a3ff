//! Relightable images that `taotie photometric` writes in addition.

use super::files::white;
use super::order::Order;
use crate::console::name_of;
use anyhow::{Result, bail};
use serde::Serialize;
use std::path::PathBuf;
use taotie_engine::Progress;
use taotie_engine::names::Named;
use taotie_io::FileBytes;
use taotie_photometric::{Basis, Coefficients, ColorReader, Estimate, Quality, Reading, RelightFormat};

/// The first file of each format.
const FILES: [(RelightFormat, &str); 4] = [
    (RelightFormat::Ptm, "relight.ptm"),
    (RelightFormat::PtmRgb, "relight_rgb.ptm"),
    (RelightFormat::Rti, "relight.rti"),
    (RelightFormat::Web, "openlime/info.json"),
];

/// A relightable image and how close it is to the photographs.
#[derive(Serialize)]
pub struct RelightReport {
    /// The file, or the first of several, in the output folder.
    pub file: &'static str,
    /// Coefficients of a pixel and channel.
    pub terms: usize,
    /// The size of all its files.
    pub bytes: u64,
    /// How much brighter it is than the photographs: those of 8 bits keep their brightness, and others are shown with the 99th
    /// percentile of the albedo as white.
    pub exposure: f64,
    /// Peak signal-to-noise ratio of the stored image, relit by the lights of all photographs, decibels.
    pub psnr: f64,
    /// That of the worst photograph.
    pub worst_psnr: f64,
    /// The name of the worst photograph.
    pub worst: String,
}

/// Returns the name of a format's first file.
pub fn file_of(format: RelightFormat) -> &'static str {
    FILES.iter().find(|(of, _)| *of == format).map_or("", |(_, file)| file)
}

/// Rejects outputs that cannot be written, and inputs that relightable images cannot be made from.
pub fn claim(order: &Order<'_>) -> Result<()> {
    let Some(first) = order.options.relight.first() else { return Ok(()) };
    if order.set.relightable.is_some() {
        bail!("--relight {}: {} is relightable already", first.name(), order.input);
    }
    for format in &order.options.relight {
        let path = order.path(file_of(*format));
        if *format == RelightFormat::Web {
            order.files.claim_folder(&folder_of(order))?;
        }
        order.files.claim(&path)?;
    }
    Ok(())
}

fn folder_of(order: &Order<'_>) -> PathBuf {
    order.path("openlime")
}

/// Photographs to write relightable images of.
pub struct Relighting<'a> {
    /// The photographs, the formats, and where to write.
    pub order: &'a Order<'a>,
    /// How to read them.
    pub reading: &'a Reading<'a>,
}

impl Relighting<'_> {
    /// Fits and writes all formats that are asked for.
    pub fn write(&self, estimate: &Estimate) -> Result<Vec<RelightReport>> {
        let Self { order, reading } = *self;
        let Order { set, files, .. } = order;
        let formats = &order.options.relight;
        if formats.is_empty() {
            return Ok(Vec::new());
        }
        let progress = order.progress.begin("relight")?;
        let photographs = ColorReader::new(set, reading, white(estimate))?;
        let mut fitted: Option<(Basis, Coefficients)> = None;
        let mut reports = Vec::new();
        let count = formats.len() as f64;
        for (i, format) in formats.iter().enumerate() {
            let part = |from: f64, to: f64| progress.part((i as f64 + from) / count, (i as f64 + to) / count);
            let basis = format.basis(set.photographs.len());
            let coefficients = match fitted.take() {
                Some((known, coefficients)) if known == basis => coefficients,
                _ => Coefficients::fit(&photographs, basis, part(0.0, 0.5))?,
            };
            let image = coefficients.stored(format.colors());
            fitted = Some((basis, coefficients));
            let path = match format {
                RelightFormat::Web => folder_of(order),
                _ => order.path(file_of(*format)),
            };
            let written: Vec<FileBytes> = format.files(&image, &path)?;
            let image = format.held(image, &written)?;
            let quality = Quality::of(&image, &photographs, part(0.5, 1.0))?;
            files.write_files(&written, Progress::SILENT)?;
            let worst = quality.of_photographs.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
            reports.push(RelightReport {
                file: file_of(*format),
                terms: basis.terms(),
                bytes: written.iter().map(|file| file.bytes.len() as u64).sum(),
                exposure: photographs.exposure(),
                psnr: quality.psnr,
                worst_psnr: worst.map_or(f64::NAN, |(_, psnr)| *psnr),
                worst: worst.map_or(String::new(), |(k, _)| name_of(&set.photographs[k].path)),
            });
        }
        Ok(reports)
    }
}
