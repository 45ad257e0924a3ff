//! The colour of each pixel. Normals are estimated from grey; for the colour, photographs are read once more.

use crate::estimate::PixelEstimate;
use crate::photograph::{Decoder, Shape, linear_of_displayed};
use crate::relight::Relightable;
use crate::samples::Samples;
use std::path::{Path, PathBuf};
use taotie_engine::error::Result;
use taotie_engine::image::Bitmap;
use taotie_engine::{Progress, parallel};
use taotie_io::{Limits, read_photograph_within};

/// Photographs in colour.
#[derive(Debug, Clone)]
pub enum ColorSource {
    /// Files, and the limits of reading them.
    Files(Vec<PathBuf>, Limits),
    /// Decoded photographs.
    Bitmaps(Vec<Bitmap>),
    /// An image that is relit by each light.
    Relightable(Relightable),
}

/// Photographs that are decoded at the same time.
const BATCH: usize = 4;
/// Pixels of a task.
const PART: usize = 4096;
/// n · l below which a sample does not count.
const GRAZING: f64 = 0.15;
/// The difference from a matt surface, in standard deviations of the pixel's residuals, from which a sample has no weight:
/// highlights have the colour of the light.
const CUT: f64 = 3.0;
/// The least such difference, relative to the albedo.
const LEAST: f64 = 0.05;

/// Returns red, green and blue of each pixel relative to their mean, which is 1: of the light that its samples reflect
/// like a matt surface. Empty if the photographs are grey.
///
/// # Errors
/// Those of reading photographs, [`taotie_engine::Error::Cancelled`].
pub fn chroma(
    samples: &Samples,
    best: &[Option<PixelEstimate>],
    progress: Progress<'_>,
) -> Result<Vec<[f32; 3]>> {
    let mut sums = vec![[0.0; 3]; best.len()];
    let count = samples.images.len();
    for first in (0..count).step_by(BATCH) {
        progress.at(first as f64 / count as f64)?;
        let read = parallel::try_tasks(BATCH.min(count - first), &|i| samples.colors(first + i))?;
        let Some(read) = read.into_iter().collect::<Option<Vec<_>>>() else { return Ok(Vec::new()) };
        parallel::pieces(&mut sums, PART, &|part, sums| {
            for (i, sums) in sums.iter_mut().enumerate() {
                let i = part * PART + i;
                let Some(best) = &best[i] else { continue };
                for (k, colors) in read.iter().enumerate() {
                    let weight = samples.weight(first + k, i, best);
                    sums.iter_mut().zip(colors[i]).for_each(|(sum, v)| *sum += weight * f64::from(v));
                }
            }
        });
    }
    Ok(parallel::collect(sums.len(), |i| relative(sums[i])))
}

/// Returns a colour relative to the mean of its channels.
fn relative(color: [f64; 3]) -> [f32; 3] {
    let mean = color.iter().sum::<f64>() / 3.0;
    if mean > 0.0 { color.map(|v| (v / mean) as f32) } else { [1.0; 3] }
}

impl Samples {
    /// Returns how much a sample counts for the colour: less the more it differs from a matt surface.
    fn weight(&self, light: usize, pixel: usize, best: &PixelEstimate) -> f64 {
        let sample = self.images[light][pixel];
        let cosine = best.normal.dot(self.direction(light, pixel));
        if sample.is_saturated() || cosine < GRAZING {
            return 0.0;
        }
        let difference = f64::from(sample.grey()) - best.albedo * cosine;
        let cut = best.albedo * (CUT * best.residual).max(LEAST);
        let rest = (1.0 - difference * difference / (cut * cut)).max(0.0);
        rest * rest
    }

    /// Returns the linear colours of a photograph's pixels, relative to its light; `None` if it has no colour.
    fn colors(&self, k: usize) -> Result<Option<Vec<[f32; 3]>>> {
        let decoded = |path: &Path, bitmap: &Bitmap| {
            let shape = Shape { width: self.width, height: self.height, bits: self.bits };
            let decoder = Decoder::new((path, shape), &self.pixels, self.transfer);
            let colors = || decoder.colors(path, bitmap, self.intensities[k]);
            (bitmap.channels() > 2).then(colors).transpose()
        };
        match &self.source {
            ColorSource::Files(paths, limits) => {
                decoded(&paths[k], &read_photograph_within(&paths[k], limits)?)
            }
            ColorSource::Bitmaps(bitmaps) => decoded(Path::new("images"), &bitmaps[k]),
            ColorSource::Relightable(image) => {
                let relit = image.relit(self.lights[k]);
                let color =
                    |i: &u32| relit[*i as usize].map(|v| linear_of_displayed(v, self.transfer) as f32);
                Ok(Some(self.pixels.iter().map(color).collect()))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_relative_to_their_mean() {
        assert_eq!(relative([0.2, 0.1, 0.0]), [2.0, 1.0, 0.0]);
        assert_eq!(relative([0.0; 3]), [1.0; 3]);
    }
}
