//! The sources of uncertainty of all pixels, from the fits and the residuals.

use crate::grid::Grid;
use crate::indirect::{Indirect, quantile};
use crate::residuals::{PixelResiduals, SECTORS};
use crate::robust::Fit;
use crate::symmetric::Sym3;
use crate::uncertainty::{Sources, unit};
use taotie_engine::math::Vec3;
use taotie_engine::parallel;

/// The fraction of the bright pixels' albedo below which a pixel is background.
const BACKGROUND: f64 = 0.005;
/// The error that indirect light is expected to cause if it is not removed, as a multiple of that which is estimated with an
/// assumed albedo and of the factor of removed light.
const UNREMOVED: f64 = 2.0;

/// The comparisons between estimates, of each pixel and of the whole object.
pub struct AllSources<'a> {
    grid: &'a Grid,
    residuals: &'a [PixelResiduals],
    /// Normal times albedo.
    best: &'a [Vec3<f64>],
    pixels: Vec<Option<Pixel>>,
    /// The mean squared angle by which the removal of indirect light turns normals.
    turned: f64,
    /// The error of normals by indirect light, relative to that angle and its factor: the light in shadows that the relief
    /// does not explain.
    unexplained: f64,
    /// The root mean square difference between neighbouring normals.
    curved: f64,
}

/// The estimates that are compared, of all pixels.
pub struct Estimates<'a> {
    /// Before indirect light is removed.
    pub fits: &'a [Fit],
    /// After that.
    pub indirect: &'a Indirect,
    /// Normals times albedo, as written.
    pub best: &'a [Vec3<f64>],
}

/// A pixel with a normal.
#[derive(Debug, Clone, Copy)]
struct Pixel {
    /// The change of the unit normal by the estimated indirect light, whether it is removed or not.
    turned: Vec3<f64>,
    /// The change of the unit normal by rejection.
    rejected: Vec3<f64>,
    /// Covariance of the unit normal from sectors of lights.
    sectors: Sym3,
    /// Mean of the squared differences from the neighbours' unit normals.
    curvature: f64,
}

impl<'a> AllSources<'a> {
    /// Compares the estimates of all pixels. Dark ones have no normal.
    pub fn new(grid: &'a Grid, residuals: &'a [PixelResiduals], estimates: &Estimates<'a>) -> Self {
        let Estimates { fits, indirect, best } = *estimates;
        let background = BACKGROUND * quantile(best.iter().map(|b| b.length()).collect(), 0.95);
        let normals: Vec<Vec3<f64>> = best.iter().map(|b| unit(*b)).collect();
        let pixels = parallel::collect(best.len(), |i| {
            let (normal, length) = (normals[i], best[i].length());
            // An inverse exists if enough samples agree.
            residuals[i].inverse?;
            if normal.z.is_nan() || normal.z <= 0.0 || length <= background {
                return None;
            }
            let robust = unit(fits[i].robust);
            Some(Pixel {
                turned: unit(indirect.estimated[i]) - robust,
                rejected: robust - unit(fits[i].least_squares),
                sectors: residuals[i].sectors.scaled(1.0 / (length * length)),
                curvature: curvature(grid, &normals, i),
            })
        });
        let mean = |value: fn(&Pixel) -> f64| {
            let (sum, count) =
                pixels.iter().flatten().fold((0.0, 0.0), |(sum, count), p| (sum + value(p), count + 1.0));
            sum / f64::max(count, 1.0)
        };
        let turned = mean(|pixel| pixel.turned.dot(pixel.turned));
        let curved = mean(|pixel| pixel.curvature).sqrt();
        let unexplained = if indirect.is_removed { indirect.unexplained } else { UNREMOVED };
        Self { grid, residuals, best, pixels, turned, unexplained, curved }
    }

    /// Returns the sources of a pixel; `None` without a normal.
    pub fn of(&self, i: usize) -> Option<Sources> {
        let pixel = self.pixels[i].as_ref()?;
        let (mut sectors, mut turned) = (Sym3::default(), Sym3::default());
        let (mut variance, mut shared, mut count) = (0.0, 0.0, 0.0);
        for other in self.grid.around(i) {
            if let Some(pixel) = &self.pixels[other] {
                sectors.0.iter_mut().zip(pixel.sectors.0).for_each(|(sum, v)| *sum += v);
                turned.add(pixel.turned, 1.0);
                variance += self.residuals[other].variance;
                shared += self.residuals[other].shared;
                count += 1.0;
            }
        }
        let size = pixel.rejected.length();
        let length = self.best[i].length();
        let misfit = (shared / count).sqrt() / length;
        let inverse = self.residuals[i].inverse?;
        // Sectors also show noise: less than the covariance of noise, as three of their pulls are fitted.
        const FREE: f64 = (SECTORS - 3) as f64 / SECTORS as f64;
        let noise = inverse.scaled(FREE * (variance - shared).max(0.0) / (count * length * length));
        let normal = unit(self.best[i]);
        let across = |matrix: &Sym3| matrix.trace() - normal.dot(matrix.times(normal));
        let sectors = sectors.scaled(1.0 / count);
        let part = (1.0 - across(&noise) / across(&sectors).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let all = self.unexplained * self.turned;
        let unseen = if self.curved > 0.0 { all * pixel.curvature.sqrt() / self.curved } else { 0.0 };
        Some(Sources {
            b: self.best[i],
            noise: inverse.scaled(variance / count),
            sectors: sectors.scaled(part),
            turned: turned.scaled(self.unexplained * self.unexplained / count),
            rejected: if size > 0.0 { pixel.rejected * (misfit / size).sqrt() } else { pixel.rejected },
            unseen,
        })
    }
}

fn curvature(grid: &Grid, normals: &[Vec3<f64>], i: usize) -> f64 {
    let differences = grid.neighbours(i).map(|other| {
        let difference = normals[i] - normals[other];
        difference.dot(difference)
    });
    let (sum, count) = differences.fold((0.0, 0.0), |(sum, count), v| (sum + v, count + 1.0));
    if count > 0.0 { sum / count } else { 0.0 }
}
