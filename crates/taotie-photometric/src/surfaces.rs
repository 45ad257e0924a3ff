//! The surfaces of all pixels: the highlights of regions, then normal and base colour of each pixel.

use crate::appearance::Fitting;
use crate::grid::Grid;
use crate::indirect::quantile;
use crate::program::{Finish, Surface};
use crate::regions::regions;
use std::sync::atomic::{AtomicUsize, Ordering};
use taotie_engine::error::Result;
use taotie_engine::{Progress, parallel};

/// The fraction of the median base colour from which a pixel helps to find highlights.
const BRIGHT: f64 = 0.1;
/// The least z of its normal.
const FACING: f64 = 0.3;
/// Pixels of a task.
const PART: usize = 512;

/// A region of pixels with one highlight.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct RegionFinish {
    /// The number of its pixels.
    pub pixels: usize,
    /// Roughness and F0; `None` if it is matt.
    pub finish: Option<Finish>,
}

/// The surfaces of all pixels.
pub struct Surfaces {
    /// `None` if too few samples agree with any surface.
    pub of_pixels: Vec<Option<Surface>>,
    /// The regions, the darkest first.
    pub regions: Vec<RegionFinish>,
}

impl Surfaces {
    /// Fits all pixels.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Cancelled`].
    pub fn fit(fitting: &mut Fitting<'_>, grid: &Grid, progress: Progress<'_>) -> Result<Self> {
        let count = grid.pixels.len();
        let starts: Vec<Surface> = (0..count).map(|pixel| fitting.start(pixel, None)).collect();
        let dark = BRIGHT * quantile(starts.iter().map(|start| start.color).collect(), 0.5);
        let helps = |start: &Surface| start.color > dark && start.normal.z > FACING;
        let pixels: Vec<(usize, f64)> = starts
            .iter()
            .enumerate()
            .filter(|(_, start)| helps(start))
            .map(|(pixel, start)| (pixel, start.color))
            .collect();
        let found = regions(fitting, &pixels);
        let region = |start: &Surface| found.iter().position(|region| start.color < region.below);
        let done = AtomicUsize::new(0);
        let parts = parallel::try_tasks(count.div_ceil(PART), &|part| {
            progress.at(0.95 * done.fetch_add(PART, Ordering::Relaxed) as f64 / count as f64)?;
            let pixels = part * PART..((part + 1) * PART).min(count);
            let fitted = pixels.map(|pixel| {
                let finish = found[region(&starts[pixel])?].finish;
                fitting.surface(pixel, Surface { finish, ..starts[pixel] }, |_| true)
            });
            Ok(fitted.collect::<Vec<_>>())
        })?;
        let regions = found.iter().enumerate().map(|(i, of)| RegionFinish {
            pixels: starts.iter().filter(|start| region(start) == Some(i)).count(),
            finish: of.finish,
        });
        let mut of_pixels = parts.concat();
        fitting.retry(grid, &mut of_pixels);
        Ok(Self { of_pixels, regions: regions.collect() })
    }
}
