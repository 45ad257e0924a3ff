//! How close relit images are to the photographs that they were fitted to.

use super::colors::ColorReader;
use super::image::{PIECE, Relightable};
use taotie_engine::error::Result;
use taotie_engine::{Progress, parallel};

/// The difference between relit images and photographs.
#[derive(Debug, Clone, PartialEq)]
pub struct Quality {
    /// Peak signal-to-noise ratio of all photographs together, decibels.
    pub psnr: f64,
    /// That of each photograph.
    pub of_photographs: Vec<f64>,
}

impl Quality {
    /// Relights an image by the light of each photograph.
    ///
    /// # Errors
    /// Those of reading the photographs, [`taotie_engine::Error::Cancelled`].
    pub fn of(image: &Relightable, photographs: &ColorReader, progress: Progress<'_>) -> Result<Self> {
        let mut squares = Vec::new();
        photographs.each(progress, &mut |k, colors| {
            let relit = image.relit(photographs.lights()[k]);
            let pieces = parallel::collect(colors.len().div_ceil(PIECE), |piece| {
                let range = piece * PIECE..((piece + 1) * PIECE).min(colors.len());
                let pairs = colors[range.clone()].iter().flatten().zip(relit[range].iter().flatten());
                pairs.fold(0.0, |sum, (a, b)| {
                    let difference = f64::from(b.clamp(0.0, 1.0) - a);
                    sum + difference * difference
                })
            });
            squares.push(pieces.iter().sum::<f64>() / (3 * colors.len()) as f64);
        })?;
        let psnr = |square: f64| {
            -10.0 * taotie_engine::math::scalar::ln(square.max(1e-12)) / std::f64::consts::LN_10
        };
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        Ok(Self { psnr: psnr(mean), of_photographs: squares.into_iter().map(psnr).collect() })
    }
}
