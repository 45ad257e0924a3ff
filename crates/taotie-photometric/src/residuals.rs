//! The residuals of the fits: their variance in each pixel, how they pull at the fit from each side, and, of the robust
//! fit, their size under each light.

use crate::appearance::{Compared, Fitting};
use crate::block::weight;
use crate::grid::Grid;
use crate::program::Surface;
use crate::robust::Fit;
use crate::samples::Samples;
use crate::symmetric::Sym3;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::parallel;

/// The weight above which a sample's residual is compared with its neighbours'.
const COMPARED: f32 = 0.3;
/// Sectors of lights around the view.
pub const SECTORS: usize = 6;
/// A sample darker than this fraction of the fit is in shadow.
const SHADOW: f64 = 0.5;
/// Pixels of a part: sums do not depend on the number of threads.
const PART: usize = 2048;
/// Rows of a task.
const BAND: usize = 4;

/// The residuals of one pixel.
#[derive(Debug, Clone, Copy, Default)]
pub struct PixelResiduals {
    /// Inverse of Σ w g gᵀ, g the gradient of a sample by the normal times the albedo; `None` if too few samples agree with
    /// the fit.
    pub inverse: Option<Sym3>,
    /// Weighted variance.
    pub variance: f64,
    /// Mean product with the residuals of neighbours under the same light, from 0 to the variance: misfit is alike in
    /// both, noise is not.
    pub shared: f64,
    /// Covariance of the fit if the residuals of a sector of lights err together (a cluster-robust covariance: Liang
    /// and Zeger 1986).
    pub sectors: Sym3,
}

/// The residuals under one light.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LightResiduals {
    /// Root mean square of (I − b · l) / |b| over samples that are lit.
    pub relative: f64,
    /// Fraction of the samples that are in shadow.
    pub shadowed: f64,
    /// Fraction of the samples without weight in the fit.
    pub rejected: f64,
    /// How far the photograph is shifted from the others; `None` if the surface is too uniform to show it.
    pub shift: Option<Shift>,
}

/// A shift to the right and down, in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shift {
    /// Pixels to the right and down.
    pub pixels: [f64; 2],
    /// Its length, in blocks of pixels whose means are compared.
    pub(crate) blocks: f64,
}

impl Shift {
    /// Returns true if it is more than errors of the prediction explain.
    pub fn is_moved(self) -> bool {
        /// The largest shift in blocks of sets that did not move is 0.04.
        const MOVED: f64 = 0.125;
        self.blocks > MOVED
    }
}

/// Sums for one light.
#[derive(Debug, Clone, Copy, Default)]
struct LightSums {
    squares: f64,
    lit: f64,
    shadowed: f64,
    rejected: f64,
}

/// Computes residuals from fits.
pub struct Residuals<'a> {
    /// The samples.
    pub samples: &'a Samples,
    /// Their pixels.
    pub grid: &'a Grid,
    /// The fit of each pixel.
    pub fits: &'a [Fit],
    /// [`Fit::inverse_reach`] of each pixel.
    pub inverse_reaches: Vec<f64>,
    /// The sector of each light.
    sectors: Vec<usize>,
}

impl<'a> Residuals<'a> {
    /// Prepares the lights; sectors have equally many, by the angle around the view.
    pub fn new(samples: &'a Samples, grid: &'a Grid, fits: &'a [Fit]) -> Self {
        let lights = &samples.lights;
        let angle = |k: &usize| scalar::atan2(lights[*k].y, lights[*k].x);
        let mut order: Vec<usize> = (0..lights.len()).collect();
        order.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        let mut sectors = vec![0; lights.len()];
        for (i, k) in order.into_iter().enumerate() {
            sectors[k] = i * SECTORS / lights.len();
        }
        let inverse_reaches = fits.iter().map(Fit::inverse_reach).collect();
        Self { samples, grid, fits, inverse_reaches, sectors }
    }

    /// Returns the residuals of each pixel, from its surface or, without one, from its robust fit.
    pub fn of_pixels(&self, fitting: &Fitting<'_>, surfaces: &[Option<Surface>]) -> Vec<PixelResiduals> {
        let rows = self.grid.rows();
        let bands = parallel::tasks(rows.len().saturating_sub(1).div_ceil(BAND), &|band| {
            let last = ((band + 1) * BAND).min(rows.len() - 1);
            let (first, end) = (rows[band * BAND], rows[last]);
            // The row below the band is compared with its last one.
            let known = first..rows[(last + 1).min(rows.len() - 1)];
            let count = self.samples.lights.len();
            let mut compared = vec![Compared::default(); count];
            let mut table = Vec::with_capacity(known.len() * count);
            let mut residuals = Vec::with_capacity(end - first);
            for pixel in known {
                compared.fill(Compared::default());
                match &surfaces[pixel] {
                    Some(surface) => fitting.compare(pixel, surface, &mut compared),
                    None => self.compare(pixel, &mut compared),
                }
                table.extend(compared.iter().map(|sample| [sample.residual as f32, sample.weight as f32]));
                if pixel < end {
                    residuals.push(self.of_pixel(&compared));
                }
            }
            let of = |pixel: usize| &table[(pixel - first) * count..(pixel - first + 1) * count];
            for (pixel, residuals) in (first..end).zip(&mut residuals) {
                residuals.shared = self.shared(pixel, &of).max(0.0).min(residuals.variance);
            }
            residuals
        });
        bands.concat()
    }

    /// Writes how each sample compares with the robust fit.
    fn compare(&self, pixel: usize, out: &mut [Compared]) {
        for (k, out) in out.iter_mut().enumerate() {
            let (residual, weight) = self.residual(pixel, k);
            *out = Compared { residual, weight, gradient: self.samples.direction(k, pixel) };
        }
    }

    /// Returns the residuals of a pixel, without those shared with its neighbours.
    fn of_pixel(&self, compared: &[Compared]) -> PixelResiduals {
        let (mut matrix, mut squares, mut total) = (Sym3::default(), 0.0, 0.0);
        let mut pulls = [Vec3::splat(0.0); SECTORS];
        for (Compared { residual, weight, gradient }, sector) in compared.iter().zip(&self.sectors) {
            matrix.add(*gradient, *weight);
            squares += weight * residual * residual;
            total += weight;
            pulls[*sector] += *gradient * (weight * residual);
        }
        let variance = squares / (total - 3.0).max(1.0);
        let inverse = if total > 3.0 { matrix.inverse() } else { None };
        let mut sectors = Sym3::default();
        if let Some(inverse) = inverse {
            pulls.iter().for_each(|pull| sectors.add(inverse.times(*pull), 1.0));
        }
        PixelResiduals { inverse, variance, shared: 0.0, sectors }
    }

    /// Returns the mean product of a pixel's residuals with those of the pixels on the right and below; 0 without any.
    fn shared<'t>(&self, pixel: usize, of: &dyn Fn(usize) -> &'t [[f32; 2]]) -> f64 {
        let [x, y] = self.grid.position(pixel).map(|v| v as i64);
        let (mut products, mut pairs) = (0.0, 0.0);
        for other in [self.grid.at(x + 1, y), self.grid.at(x, y + 1)].into_iter().flatten() {
            for ([a, of_a], [b, of_b]) in of(pixel).iter().zip(of(other)) {
                if *of_a > COMPARED && *of_b > COMPARED {
                    products += f64::from(*a) * f64::from(*b);
                    pairs += 1.0;
                }
            }
        }
        if pairs > 0.0 { products / pairs } else { 0.0 }
    }

    /// Returns the residual of a sample and its weight in the fit.
    #[inline]
    fn residual(&self, pixel: usize, k: usize) -> (f64, f64) {
        let (fit, sample) = (&self.fits[pixel], self.samples.images[k][pixel]);
        let Vec3 { x, y, z } = self.samples.direction(k, pixel);
        let shaded = fit.robust.x * x + fit.robust.y * y + fit.robust.z * z;
        let residual = f64::from(sample.grey()) - shaded;
        (residual, if sample.is_usable() { weight(residual, self.inverse_reaches[pixel]) } else { 0.0 })
    }

    /// Returns the exponent that best turns fitted into measured brightness, over samples that agree with the fit: 1 if
    /// the photographs are linear, less if they are encoded by a curve; `None` without samples.
    pub fn exponent(&self) -> Option<f64> {
        /// The fraction of the albedo below which a sample says little about the curve.
        const DARKEST: f64 = 0.15;
        /// One pixel in this number is enough.
        const EVERY: usize = 16;
        let parts = parallel::tasks(self.fits.len().div_ceil(PART), &|part| {
            let (mut product, mut square) = (0.0, 0.0);
            for pixel in (part * PART..((part + 1) * PART).min(self.fits.len())).step_by(EVERY) {
                let length = self.fits[pixel].robust.length();
                let mut logs = Vec::with_capacity(self.samples.lights.len());
                for k in 0..self.samples.lights.len() {
                    let (residual, weight) = self.residual(pixel, k);
                    let grey = f64::from(self.samples.images[k][pixel].grey());
                    let fitted = grey - residual;
                    if weight > 0.0 && grey.min(fitted) > DARKEST * length {
                        logs.push([scalar::ln(fitted), scalar::ln(grey)]);
                    }
                }
                let count = logs.len().max(1) as f64;
                let mean = [0, 1].map(|c| logs.iter().map(|v| v[c]).sum::<f64>() / count);
                for [fitted, grey] in logs {
                    product += (fitted - mean[0]) * (grey - mean[1]);
                    square += (fitted - mean[0]) * (fitted - mean[0]);
                }
            }
            [product, square]
        });
        let [product, square] = [0, 1].map(|c| parts.iter().map(|part| part[c]).sum::<f64>());
        (square > 0.0).then(|| product / square)
    }

    /// Returns the residuals under each light.
    pub fn of_lights(&self) -> Vec<LightResiduals> {
        let parts = parallel::tasks(self.fits.len().div_ceil(PART), &|part| {
            let pixels = part * PART..((part + 1) * PART).min(self.fits.len());
            let mut sums = vec![LightSums::default(); self.samples.lights.len()];
            pixels.for_each(|pixel| self.add(pixel, &mut sums));
            sums
        });
        let (count, shifts) = (self.fits.len() as f64, self.shifts());
        let of_light = |k: usize| {
            let sum = |field: fn(&LightSums) -> f64| parts.iter().map(|part| field(&part[k])).sum::<f64>();
            LightResiduals {
                relative: (sum(|s| s.squares) / sum(|s| s.lit).max(1.0)).sqrt(),
                shadowed: sum(|s| s.shadowed) / count,
                rejected: sum(|s| s.rejected) / count,
                shift: shifts[k],
            }
        };
        (0..self.samples.lights.len()).map(of_light).collect()
    }

    fn add(&self, pixel: usize, sums: &mut [LightSums]) {
        let length = self.fits[pixel].robust.length();
        if length <= 0.0 {
            return;
        }
        for (k, sums) in sums.iter_mut().enumerate() {
            let (residual, weight) = self.residual(pixel, k);
            let sample = self.samples.images[k][pixel];
            let grey = f64::from(sample.grey());
            if sample.is_missing() {
                // It is neither lit nor in shadow.
            } else if grey < SHADOW * (grey - residual) || grey <= residual {
                sums.shadowed += 1.0;
            } else {
                sums.squares += (residual / length) * (residual / length);
                sums.lit += 1.0;
            }
            if weight == 0.0 {
                sums.rejected += 1.0;
            }
        }
    }
}
