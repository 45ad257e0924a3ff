//! The relief that has the estimated normals: heights by integration that keeps depth edges.
//!
//! Errors of normals add up over the picture: large shapes are unreliable, small ones are not.

use crate::bilateral::{heights, slope};
use crate::estimate::Estimate;
use crate::grid::Grid;
use taotie_engine::error::Result;
use taotie_engine::math::Vec3;
use taotie_engine::{Progress, parallel};

/// Heights of all pixels with a normal.
#[derive(Debug, Clone)]
pub struct Relief {
    /// Their pixels.
    pub grid: Grid,
    /// Heights in pixels, towards the camera; the mean is 0.
    pub heights: Vec<f64>,
    /// For each pixel, whether the surface continues to the pixel on the right, and to that above.
    pub continues: Vec<[bool; 2]>,
}

impl Estimate {
    /// Integrates the best normals.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Cancelled`].
    pub fn relief(&self, progress: Progress<'_>) -> Result<Relief> {
        let has = |(pixel, best): (&u32, &Option<crate::estimate::PixelEstimate>)| {
            Some((*pixel, best.as_ref()?.normal))
        };
        let (pixels, normals): (Vec<u32>, Vec<Vec3<f64>>) =
            self.pixels.iter().zip(&self.best).filter_map(has).unzip();
        let grid = Grid::new(self.width() as usize, self.height() as usize, pixels);
        integrated(grid, &normals, progress)
    }
}

fn integrated(grid: Grid, normals: &[Vec3<f64>], progress: Progress<'_>) -> Result<Relief> {
    let mut heights = heights(&grid, normals, progress)?;
    let mean = heights.iter().sum::<f64>() / heights.len().max(1) as f64;
    heights.iter_mut().for_each(|height| *height -= mean);
    let continues = parallel::collect(heights.len(), |a| {
        let [x, y] = grid.position(a).map(|v| v as i64);
        let continues = |axis: usize, to: Option<usize>| {
            to.is_some_and(|b| {
                let step = heights[b] - heights[a];
                // The edge follows at least one of the two slopes, or hides less than a pixel.
                let off = |i: usize| (step - slope(normals[i], axis)).abs();
                off(a).min(off(b)) < 1.0 + 0.5 * step.abs()
            })
        };
        [continues(0, grid.at(x + 1, y)), continues(1, grid.at(x, y - 1))]
    });
    Ok(Relief { grid, heights, continues })
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::math::scalar;

    fn grid(side: usize) -> Grid {
        Grid::new(side, side, (0..(side * side) as u32).collect())
    }

    fn errors(found: &Relief, truth: impl Fn(f64, f64) -> f64) -> f64 {
        let place = |i: usize| found.grid.position(i).map(|v| v as f64);
        let truth: Vec<f64> = (0..found.heights.len()).map(|i| truth(place(i)[0], place(i)[1])).collect();
        let mean = truth.iter().sum::<f64>() / truth.len() as f64;
        let squares = found.heights.iter().zip(&truth).map(|(a, b)| (a - b + mean) * (a - b + mean));
        (squares.sum::<f64>() / truth.len() as f64).sqrt()
    }

    fn normal(p: f64, q: f64) -> Vec3<f64> {
        Vec3::new(-p, -q, 1.0).normalize_or(Vec3::splat(0.0))
    }

    #[test]
    fn a_smooth_relief_is_integrated_to_a_hundredth_of_a_pixel() {
        let side = 96;
        let height = |x: f64, y: f64| 6.0 * scalar::sin(0.1 * x) * scalar::cos(0.08 * y);
        let normals: Vec<Vec3<f64>> = (0..side * side)
            .map(|i| {
                let [x, y] = [i % side, i / side].map(|v| v as f64);
                // y points up, rows down.
                normal(
                    0.6 * scalar::cos(0.1 * x) * scalar::cos(0.08 * y),
                    0.48 * scalar::sin(0.1 * x) * scalar::sin(0.08 * y),
                )
            })
            .collect();
        let found = integrated(grid(side), &normals, Progress::SILENT).unwrap();
        let error = errors(&found, height);
        assert!(error < 0.03, "{error}");
        assert!(found.continues.iter().filter(|c| **c != [true; 2]).count() <= 2 * side);
    }

    #[test]
    fn a_flap_that_lifts_off_a_plane_stays_a_flap() {
        // The right half rises from the plane along y; the step between the halves has no normals.
        let side = 64;
        let height = |x: f64, y: f64| if x < 32.0 { 0.0 } else { 0.6 * y };
        let normals: Vec<Vec3<f64>> =
            (0..side * side).map(|i| normal(0.0, if i % side < 32 { 0.0 } else { 0.6 })).collect();
        let found = integrated(grid(side), &normals, Progress::SILENT).unwrap();
        // The step itself is unknown at every place: each half is compared for itself.
        for half in [0, 1] {
            let inside = |i: &usize| (i % side < 32) == (half == 0);
            let off = (0..side * side)
                .filter(inside)
                .map(|i| found.heights[i] - height((i % side) as f64, 63.0 - (i / side) as f64));
            let off: Vec<f64> = off.collect();
            let mean = off.iter().sum::<f64>() / off.len() as f64;
            assert!(off.iter().all(|v| (v - mean).abs() < 0.6), "{half}: {mean}");
        }
        let cut = (0..side * side).filter(|i| i % side == 31 && !found.continues[*i][0]).count();
        assert!(cut > side / 2, "{cut}");
    }
}
