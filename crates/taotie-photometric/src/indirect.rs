//! Light between parts of the object, and the normals without it.
//!
//! In a hollow, a surface is also lit by its surroundings. To a Lambertian fit this is a change of the normal, which no
//! residual reveals: hollows seem shallower (Nayar, Ikeuchi and Kanade 1991). With I_p the grey of pixel p,
//!
//! I_p = b_p · l + ρ_p · mean over cosine-distributed rays of I at the point they meet, 0 in the sky,
//!
//! so that the fitted vector exceeds the true one by ρ_p times the mean of the fitted vectors in sight, for all light
//! that falls on both. The relief in sight follows from the normals. The albedo ρ_p is |b_p| times one unknown factor,
//! which is measured in shadows, where all light is indirect.

use crate::grid::Grid;
use crate::relief::{RAYS, SKY, heights, visible};
use crate::samples::Samples;
use taotie_engine::error::Result;
use taotie_engine::math::Vec3;
use taotie_engine::{Progress, parallel};

/// The most cells along a side of the coarse relief: indirect light varies slowly.
const SIDE: usize = 128;
/// Rounds: the relief follows from the normals, and these from the light in the relief.
const ROUNDS: usize = 2;
/// Shadow samples below which the albedo is assumed.
const FEWEST_SHADOWS: usize = 50;
/// The albedo of bright pixels assumed without shadows.
const ASSUMED_ALBEDO: f64 = 0.5;
/// The fraction of the light in shadows that is assumed to be unexplained without shadows.
const ASSUMED_UNEXPLAINED: f64 = 0.5;
/// The quantile of |b| that counts as bright.
const BRIGHT: f64 = 0.95;
/// The fraction of the bright |b| below which a cell is background.
const DARK: f64 = 0.02;
/// The sine of the angle by which a surface must face away from a light to be in shadow.
const SHADOW: f64 = 0.05;
/// The least albedo of bright pixels: if shadows are darker than it makes them, black was subtracted from the photographs, or
/// they are clipped.
const LEAST_ALBEDO: f64 = 0.02;
/// The most albedo of bright pixels, as stray light in the room would make it larger.
pub const MOST_ALBEDO: f64 = 0.9;

/// The indirect light of all pixels.
#[derive(Debug, Clone)]
pub struct Indirect {
    /// Normal times albedo of each pixel, without the estimated indirect light.
    pub estimated: Vec<Vec3<f64>>,
    /// The same if that light is removed, otherwise the fitted vectors: of an assumed albedo, light may be removed that was
    /// never there.
    pub direct: Vec<Vec3<f64>>,
    /// `true` if it is removed: if the albedo is measured.
    pub is_removed: bool,
    /// Albedo of bright pixels (the 95th percentile).
    pub albedo: f64,
    /// The number of samples in shadow that it was measured in; 0 if it is assumed.
    pub shadows: usize,
    /// Light in shadows that the relief does not explain, relative to all light there: root mean squares, in [0, 1].
    pub unexplained: f64,
}

impl Indirect {
    /// Takes all light of the estimates as direct.
    pub fn none(fitted: Vec<Vec3<f64>>) -> Self {
        Self {
            estimated: fitted.clone(),
            direct: fitted,
            is_removed: false,
            albedo: ASSUMED_ALBEDO,
            shadows: 0,
            unexplained: 0.0,
        }
    }

    /// Removes indirect light from the estimates of all pixels.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Cancelled`].
    pub fn remove(
        samples: &Samples,
        grid: &Grid,
        fitted: &[Vec3<f64>],
        progress: Progress<'_>,
    ) -> Result<Self> {
        let coarse = Coarse::new(samples, grid, fitted);
        let mut direct = coarse.fitted.clone();
        let mut light = Light {
            in_sight: vec![Vec3::splat(0.0); direct.len()],
            factor: 0.0,
            bright: 1.0,
            shadows: 0,
            unexplained: ASSUMED_UNEXPLAINED,
        };
        for round in 0..ROUNDS {
            progress.at(round as f64 / ROUNDS as f64)?;
            let normals: Vec<_> = direct.iter().map(|b| b.normalize_or(Vec3::new(0.0, 0.0, 1.0))).collect();
            let heights = heights(&coarse.grid, &normals);
            progress.at((round as f64 + 0.5) / ROUNDS as f64)?;
            let hits = visible(&coarse.grid, &heights, &normals);
            light = coarse.light(samples, &direct, &hits);
            let fitted = coarse.fitted.iter().zip(&light.in_sight);
            direct = fitted.map(|(fitted, in_sight)| without(*fitted, *in_sight, light.factor)).collect();
        }
        let estimated = parallel::collect(fitted.len(), |i| {
            let in_sight = coarse.interpolated(grid.position(i), &light.in_sight);
            without(fitted[i], in_sight, light.factor).to_array()
        });
        let estimated: Vec<_> = estimated.into_iter().map(Vec3::from_array).collect();
        let is_removed = light.shadows > 0;
        let albedo = light.factor * light.bright;
        let is_measured = albedo >= LEAST_ALBEDO;
        Ok(Self {
            direct: if is_removed { estimated.clone() } else { fitted.to_vec() },
            estimated,
            is_removed,
            albedo: if is_measured { albedo } else { ASSUMED_ALBEDO },
            shadows: if is_measured { light.shadows } else { 0 },
            unexplained: light.unexplained,
        })
    }
}

/// Returns the fitted vector less the indirect light: b = fitted − factor · |b| · in_sight.
fn without(fitted: Vec3<f64>, in_sight: Vec3<f64>, factor: f64) -> Vec3<f64> {
    let mut b = fitted;
    for _ in 0..3 {
        b = fitted - in_sight * (factor * b.length());
    }
    // More than half cannot be indirect on a convex mean surface; such a relief is wrong.
    if b.length() < 0.5 * fitted.length() { fitted } else { b }
}

/// Returns the element at a quantile, 0 of none.
pub fn quantile(mut values: Vec<f64>, q: f64) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.get((q * values.len() as f64) as usize).copied().unwrap_or(0.0)
}

/// Means over square cells of pixels.
struct Coarse {
    grid: Grid,
    /// Pixels along the side of a cell.
    size: usize,
    fitted: Vec<Vec3<f64>>,
    /// The middle pixel of each cell.
    middles: Vec<usize>,
    /// For each photograph the grey of each cell; NaN if samples are missing.
    images: Vec<Vec<f32>>,
}

/// A cell in attached shadow in one photograph.
struct Shadow {
    /// The indirect light of a factor of 1.
    expected: f64,
    /// The light that it has.
    grey: f64,
}

/// Returns the factor that minimises the sum of |grey − factor · expected|: the weighted median of their ratios. Single
/// lit pixels of rough cells, which are much brighter than indirect light, do not affect it.
fn factor(shadows: &mut [Shadow]) -> f64 {
    shadows.sort_unstable_by(|a, b| f64::total_cmp(&(a.grey * b.expected), &(b.grey * a.expected)));
    let half = 0.5 * shadows.iter().map(|shadow| shadow.expected).sum::<f64>();
    let mut below = 0.0;
    let median = shadows.iter().find(|shadow| {
        below += shadow.expected;
        below >= half
    });
    median.map_or(0.0, |shadow| shadow.grey / shadow.expected)
}

/// Light between cells.
struct Light {
    /// The mean of the fitted vectors that each cell sees.
    in_sight: Vec<Vec3<f64>>,
    /// The factor from |b| to albedo.
    factor: f64,
    /// |b| of bright cells.
    bright: f64,
    /// Samples in shadow.
    shadows: usize,
    /// Light in shadows that the relief does not explain.
    unexplained: f64,
}

impl Coarse {
    fn new(samples: &Samples, grid: &Grid, fitted: &[Vec3<f64>]) -> Self {
        let size = grid.width.max(grid.height).div_ceil(SIDE);
        let [width, height] = [grid.width.div_ceil(size), grid.height.div_ceil(size)];
        let mut members: Vec<Vec<u32>> = vec![Vec::new(); width * height];
        for element in 0..grid.pixels.len() {
            let [x, y] = grid.position(element);
            members[y / size * width + x / size].push(element as u32);
        }
        let mean = |members: &Vec<u32>| {
            let sum = members.iter().fold(Vec3::splat(0.0), |sum, i| sum + fitted[*i as usize]);
            sum / members.len().max(1) as f64
        };
        let means: Vec<Vec3<f64>> = members.iter().map(mean).collect();
        let dark = DARK * quantile(means.iter().map(|b| b.length()).collect(), BRIGHT);
        // At least half of a cell's pixels must belong to the object.
        let is_cell = |cell: &usize| 2 * members[*cell].len() >= size * size && means[*cell].length() > dark;
        let cells: Vec<usize> = (0..members.len()).filter(is_cell).collect();
        let members: Vec<&Vec<u32>> = cells.iter().map(|cell| &members[*cell]).collect();
        let fitted = cells.iter().map(|cell| means[*cell]).collect();
        let cells = cells.into_iter().map(|cell| cell as u32).collect();
        let images = parallel::tasks(samples.images.len(), &|k| {
            let grey = |i: &u32| {
                let sample = samples.images[k][*i as usize];
                if sample.is_missing() { f32::NAN } else { sample.grey() }
            };
            members
                .iter()
                .map(|members| members.iter().map(grey).sum::<f32>() / members.len() as f32)
                .collect()
        });
        let middles = members.iter().map(|members| members[members.len() / 2] as usize).collect();
        Self { grid: Grid::new(width, height, cells), size, fitted, middles, images }
    }

    /// Returns the indirect light, given the cells that rays from each cell meet.
    fn light(&self, samples: &Samples, direct: &[Vec3<f64>], hits: &[u32]) -> Light {
        let rays = |cell: usize| hits[cell * RAYS..(cell + 1) * RAYS].iter().filter(|hit| **hit != SKY);
        let in_sight = (0..direct.len()).map(|cell| {
            rays(cell).fold(Vec3::splat(0.0), |sum, hit| sum + self.fitted[*hit as usize]) / RAYS as f64
        });
        let in_sight = in_sight.collect();
        if direct.is_empty() {
            return Light {
                in_sight,
                factor: ASSUMED_ALBEDO,
                bright: 1.0,
                shadows: 0,
                unexplained: ASSUMED_UNEXPLAINED,
            };
        }
        let lengths: Vec<f64> = direct.iter().map(|b| b.length()).collect();
        let typical = quantile(lengths.clone(), 0.5);
        let bright = quantile(lengths.clone(), BRIGHT).max(f64::MIN_POSITIVE);
        let mut shadows = Vec::new();
        for (cell, b) in direct.iter().enumerate() {
            let in_shadow =
                |k: &usize| b.dot(samples.direction(*k, self.middles[cell])) < -SHADOW * lengths[cell];
            for k in (0..samples.lights.len()).filter(in_shadow) {
                let seen: f64 = rays(cell).map(|hit| f64::from(self.images[k][*hit as usize])).sum();
                let (expected, grey) = (lengths[cell] * seen / RAYS as f64, f64::from(self.images[k][cell]));
                if expected > 1e-4 * typical * typical && !grey.is_nan() {
                    shadows.push(Shadow { expected, grey });
                }
            }
        }
        // Shadows of relit images are artefacts of few coefficients.
        if shadows.len() < FEWEST_SHADOWS || samples.is_relit {
            let factor = ASSUMED_ALBEDO / bright;
            return Light { in_sight, factor, bright, shadows: 0, unexplained: ASSUMED_UNEXPLAINED };
        }
        let factor = factor(&mut shadows).min(MOST_ALBEDO / bright);
        let squares = |grey: &dyn Fn(&Shadow) -> f64| shadows.iter().map(|s| grey(s) * grey(s)).sum::<f64>();
        let rest = squares(&|s| s.grey - factor * s.expected);
        let total = squares(&|s| s.grey);
        let unexplained = (rest / total.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0).sqrt();
        Light { in_sight, factor, bright, shadows: shadows.len(), unexplained }
    }

    /// Returns the value at a pixel, interpolated between the centres of cells.
    fn interpolated(&self, position: [usize; 2], values: &[Vec3<f64>]) -> Vec3<f64> {
        let [x, y] = position.map(|v| (v as f64 + 0.5) / self.size as f64 - 0.5);
        let (left, above) = (x.floor(), y.floor());
        let (mut sum, mut total) = (Vec3::splat(0.0), 0.0);
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let share = (1.0 - (x - left - dx).abs()) * (1.0 - (y - above - dy).abs());
            if let Some(cell) = self.grid.at((left + dx) as i64, (above + dy) as i64) {
                sum += values[cell] * share;
                total += share;
            }
        }
        if total > 1e-9 { sum / total } else { sum }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_lit_cells_leave_the_factor() {
        let shadow = |i: u32| {
            let expected = f64::from(1 + i % 7);
            Shadow { expected, grey: if i.is_multiple_of(3) { 50.0 } else { 0.25 * expected } }
        };
        let mut shadows: Vec<_> = (0..90).map(shadow).collect();
        assert_eq!(factor(&mut shadows), 0.25);
        shadows.iter_mut().filter(|shadow| shadow.grey < 50.0).for_each(|shadow| shadow.grey = 0.0);
        assert_eq!(factor(&mut shadows), 0.0, "without indirect light nothing is removed");
        assert_eq!(factor(&mut []), 0.0);
    }
}
