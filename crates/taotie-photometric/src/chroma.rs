//! The colour of each pixel. Normals are estimated from grey; for the colour, photographs are read again.

use crate::estimate::{Estimate, PixelEstimate};
use crate::relight::BATCH;
use crate::samples::Samples;
use taotie_engine::error::Result;
use taotie_engine::{Progress, parallel};

/// Pixels of a task.
const PART: usize = 4096;
/// n · l below which a sample does not count.
const GRAZING: f64 = 0.15;
/// The difference from a matt surface, in standard deviations of the pixel's residuals, from which a sample has no weight:
/// highlights have the colour of the light.
const CUT: f64 = 3.0;
/// The least such difference, relative to the albedo.
const LEAST: f64 = 0.05;

impl Estimate {
    /// Returns the estimate with the colour of each pixel: of the light that its samples reflect like a matt surface. None is
    /// added if the photographs are grey.
    ///
    /// # Errors
    /// Those of reading photographs, [`taotie_engine::Error::Cancelled`].
    pub(crate) fn with_chroma(mut self, samples: &Samples, progress: Progress<'_>) -> Result<Self> {
        let mut sums = vec![[0.0; 3]; self.best.len()];
        let count = samples.images.len();
        for first in (0..count).step_by(BATCH) {
            progress.at(first as f64 / count as f64)?;
            let read = parallel::try_tasks(BATCH.min(count - first), &|i| samples.colors(first + i))?;
            let Some(read) = read.into_iter().collect::<Option<Vec<_>>>() else { return Ok(self) };
            parallel::pieces(&mut sums, PART, &|part, sums| {
                for (i, sums) in sums.iter_mut().enumerate() {
                    let i = part * PART + i;
                    let Some(best) = &self.best[i] else { continue };
                    for (k, colors) in read.iter().enumerate() {
                        let weight = samples.weight(first + k, i, best);
                        sums.iter_mut().zip(colors[i]).for_each(|(sum, v)| *sum += weight * f64::from(v));
                    }
                }
            });
        }
        self.chroma = parallel::collect(sums.len(), |i| relative(sums[i]));
        Ok(self)
    }
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
        if !sample.is_usable() || cosine < GRAZING {
            return 0.0;
        }
        let difference = f64::from(sample.grey()) - best.albedo * cosine;
        let cut = best.albedo * (CUT * best.residual).max(LEAST);
        let rest = (1.0 - difference * difference / (cut * cut)).max(0.0);
        rest * rest
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
