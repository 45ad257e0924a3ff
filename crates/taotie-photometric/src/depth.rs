//! The relief that has the estimated normals: heights by integration that keeps depth edges.
//!
//! A height differs from its neighbour's by the slope of the surface between them, unless there is an edge in between. On
//! each axis a pixel has a neighbour on both sides, and of two that contradict each other, the one with the smaller step
//! is on the same surface (bilateral normal integration: Cao, Santo, Shi, Okura and Matsushita 2022). Weights and heights
//! are found in turn. Errors of normals add up over the picture: large shapes are unreliable, small ones are not.

use crate::estimate::Estimate;
use crate::grid::Grid;
use crate::multigrid::{Edge, Multigrid};
use taotie_engine::Progress;
use taotie_engine::error::Result;
use taotie_engine::math::{Vec3, scalar};

/// How sharply a side is preferred: the value of the publication.
const SHARPNESS: f64 = 2.0;
/// The most rounds.
const ROUNDS: usize = 80;
/// The change of the energy below which rounds end.
const ENOUGH: f64 = 1e-4;
/// The relative residual to which each round is solved.
const TOLERANCE: f64 = 1e-4;
/// Weight of a pair that both sides reject: parts stay where their neighbours are.
const LEAST: f64 = 1e-6;

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

/// A pair of neighbours on one axis: the second is to the right of the first, or above.
#[derive(Clone, Copy)]
struct Pair {
    ends: [u32; 2],
    axis: usize,
}

pub fn integrated(grid: Grid, normals: &[Vec3<f64>], progress: Progress<'_>) -> Result<Relief> {
    let pairs = pairs(&grid);
    let mut heights = vec![0.0; normals.len()];
    let mut energy = f64::INFINITY;
    for round in 0..ROUNDS {
        progress.at(round as f64 / ROUNDS as f64)?;
        let sides = sides(&grid, normals, &heights);
        let (edges, right) = system(&pairs, normals, &sides);
        heights = Multigrid::new(&grid, edges).solve(&right, heights, TOLERANCE);
        let next = misfit(&pairs, normals, (&sides, &heights));
        let settled = (energy - next).abs() <= ENOUGH * energy.min(f64::MAX);
        energy = next;
        if settled {
            break;
        }
    }
    let mean = heights.iter().sum::<f64>() / heights.len().max(1) as f64;
    heights.iter_mut().for_each(|height| *height -= mean);
    let mut continues = vec![[false; 2]; heights.len()];
    for pair in &pairs {
        let [a, b] = pair.ends.map(|end| end as usize);
        let step = heights[b] - heights[a];
        // The edge follows at least one of the two slopes, or hides less than a pixel.
        let off = |i: usize| (step - slope(normals[i], pair.axis)).abs();
        continues[a][pair.axis] = off(a).min(off(b)) < 1.0 + 0.5 * step.abs();
    }
    Ok(Relief { grid, heights, continues })
}

/// Returns the step to the next pixel that a normal implies; bounded, as grazing normals are uncertain.
fn slope(n: Vec3<f64>, axis: usize) -> f64 {
    -[n.x, n.y][axis] / n.z.max(0.05)
}

fn pairs(grid: &Grid) -> Vec<Pair> {
    let mut pairs = Vec::with_capacity(2 * grid.pixels.len());
    for from in 0..grid.pixels.len() {
        let [x, y] = grid.position(from).map(|v| v as i64);
        for (axis, to) in [grid.at(x + 1, y), grid.at(x, y - 1)].into_iter().enumerate() {
            if let Some(to) = to {
                pairs.push(Pair { ends: [from as u32, to as u32], axis });
            }
        }
    }
    pairs
}

/// Returns for each pixel and axis how much its forward neighbour counts, in [0, 1]; the backward one has the rest.
fn sides(grid: &Grid, normals: &[Vec3<f64>], heights: &[f64]) -> Vec<[f64; 2]> {
    taotie_engine::parallel::collect(heights.len(), |i| {
        let [x, y] = grid.position(i).map(|v| v as i64);
        let both = [[grid.at(x + 1, y), grid.at(x - 1, y)], [grid.at(x, y - 1), grid.at(x, y + 1)]];
        both.map(|both| match both {
            [Some(forward), Some(backward)] => {
                let step = |other: usize| normals[i].z * (heights[other] - heights[i]);
                let [forward, backward] = [step(forward), step(backward)];
                let preference = SHARPNESS * (backward * backward - forward * forward);
                1.0 / (1.0 + scalar::exp(-preference.clamp(-60.0, 60.0)))
            }
            [Some(_), None] => 1.0,
            _ => 0.0,
        })
    })
}

/// Returns the edges and the right side of the weighted least squares: n_z · step = −n_x or −n_y at both ends.
fn system(pairs: &[Pair], normals: &[Vec3<f64>], sides: &[[f64; 2]]) -> (Vec<Edge>, Vec<f64>) {
    let mut right = vec![0.0; normals.len()];
    let edges = pairs.iter().map(|pair| {
        let [a, b] = pair.ends.map(|end| end as usize);
        let (mut weight, mut product) = (LEAST, 0.0);
        for (i, side) in [(a, sides[a][pair.axis]), (b, 1.0 - sides[b][pair.axis])] {
            let z = normals[i].z.max(0.05);
            weight += side * z * z;
            product += side * z * z * slope(normals[i], pair.axis);
        }
        right[b] += product;
        right[a] -= product;
        Edge { ends: pair.ends, weight }
    });
    let edges = edges.collect();
    (edges, right)
}

fn misfit(pairs: &[Pair], normals: &[Vec3<f64>], (sides, heights): (&[[f64; 2]], &[f64])) -> f64 {
    let of_pair = |pair: &Pair| {
        let [a, b] = pair.ends.map(|end| end as usize);
        let step = heights[b] - heights[a];
        let term = |i: usize, side: f64| {
            let off = normals[i].z * (step - slope(normals[i], pair.axis));
            side * off * off
        };
        term(a, sides[a][pair.axis]) + term(b, 1.0 - sides[b][pair.axis])
    };
    pairs.iter().map(of_pair).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

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
