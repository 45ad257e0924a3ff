//! Normals of all pixels by several estimators, with their uncertainty.

use crate::appearance::Fitting;
use crate::block::LANES;
use crate::finish::FEWEST_LIGHTS;
use crate::grid::Grid;
use crate::indirect::{Indirect, quantile};
use crate::program::Finish;
use crate::residuals::{LightResiduals, PixelResiduals, Residuals};
use crate::robust::{self, Fit, Robust, Scratch};
use crate::samples::Samples;
use crate::sources::{AllSources, Estimates};
use crate::surfaces::{RegionFinish, Surfaces};
use crate::symmetric::Sym2;
use crate::uncertainty::{RadiusTable, tangents, unit};
use std::sync::atomic::{AtomicUsize, Ordering};
use taotie_engine::compare::Field;
use taotie_engine::error::{Error, Result};
use taotie_engine::image::Image;
use taotie_engine::math::Vec3;
use taotie_engine::{Progress, parallel};

/// The largest uncertainty of a normal, degrees. Beyond it, as in a dark background, the normal means nothing.
const MOST_SIGMA_DEG: f64 = 45.0;

/// The residual of lit samples relative to the albedo beyond which few photographs do not show the reflection.
const MOST_RESIDUAL: f64 = 0.1;

/// The fraction of the samples that may be saturated: a bright background may surround the object.
const OVEREXPOSED: f64 = 0.95;

/// Blocks of a task.
const BLOCKS: usize = 64;

/// The estimate of one pixel.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PixelEstimate {
    /// Unit normal: x to the right, y up, z towards the camera.
    pub normal: Vec3<f64>,
    /// |b|: the grey under light along the normal.
    pub albedo: f64,
    /// Covariance on the tangent plane, square radians, in the basis of [`PixelEstimate::tangents`].
    pub covariance: Sym2,
    /// Radius in degrees that holds 68 % of the probability.
    pub sigma_deg: f64,
    /// Standard deviation of the residuals relative to the albedo.
    pub residual: f64,
}

impl PixelEstimate {
    /// The two unit vectors of the tangent plane that the covariance refers to.
    pub fn tangents(&self) -> [Vec3<f64>; 2] {
        tangents(self.normal)
    }
}

/// Normals of all pixels.
#[derive(Debug, Clone)]
pub struct Estimate {
    width: u32,
    height: u32,
    /// The number of the pixel of each estimate, row by row.
    pub pixels: Vec<u32>,
    /// The best estimate of each pixel; `None` if it is black, too few samples agree, the normal faces
    /// away, or its uncertainty is above 45°.
    pub best: Vec<Option<PixelEstimate>>,
    /// Unit normals by least squares; zero without light.
    least_squares: Vec<Vec3<f64>>,
    /// Unit normals by the robust estimator, before indirect light is removed.
    robust: Vec<Vec3<f64>>,
    /// Unit normals after indirect light is removed.
    direct: Vec<Vec3<f64>>,
    /// The residuals under each light.
    pub lights: Vec<LightResiduals>,
    /// The median over pixels of the residuals' standard deviation, relative to the grey of the robust fit.
    pub misfit: f64,
    /// `true` if no reflection is fitted since residuals are large, as by highlights, and photographs few.
    pub is_glossy: bool,
    /// The exponent between fitted and measured brightness: near 1 if the photographs are linear.
    pub exponent: Option<f64>,
    /// Albedo of bright pixels, as indirect light shows it.
    pub albedo: f64,
    /// The samples in shadow that it was measured in; 0 if it is assumed.
    pub shadows: usize,
    /// Light in shadows that the estimated relief does not explain, relative to all light there, in [0, 1].
    pub unexplained: f64,
    /// The regions of one highlight, the darkest first; none with fewer than eight photographs.
    pub regions: Vec<RegionFinish>,
    /// The highlight of each pixel; `None` if it is matt or not fitted.
    pub finishes: Vec<Option<Finish>>,
    /// Red, green and blue of each pixel relative to their mean, which is 1; empty if the photographs are grey.
    pub(crate) chroma: Vec<[f32; 3]>,
}

/// An estimator of normals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Estimator {
    /// Least squares over all samples.
    LeastSquares,
    /// Without shadows and highlights.
    Robust,
    /// Without shadows, highlights and indirect light.
    Direct,
    /// The pixel program fitted to samples without shadows and indirect light.
    Best,
}

impl Estimate {
    /// Estimates the normals.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; [`Error::Invalid`] if no pixel has a normal.
    pub fn of(samples: &Samples, progress: Progress<'_>) -> Result<Self> {
        if saturated(samples) > OVEREXPOSED {
            return Err(Error::invalid("no pixel has a normal", why_none(samples)));
        }
        let [width, height] = [samples.width, samples.height].map(|v| v as usize);
        let grid = Grid::new(width, height, samples.pixels.clone());
        let robust = Robust::new(samples);
        let fits = fits(&robust, samples, progress.stage("fit"))?;
        let residuals = Residuals::new(samples, &grid, &fits);
        let lights = residuals.of_lights();
        let is_glossy =
            !samples.is_relit && lights.len() < FEWEST_LIGHTS && lit_residual(&lights) > MOST_RESIDUAL;
        let fitted: Vec<Vec3<f64>> = fits.iter().map(|fit| fit.robust).collect();
        let few = samples.lights.len() < robust::FEWEST;
        let indirect = match few {
            true => Indirect::none(fitted),
            false => Indirect::remove(samples, &grid, &fitted, progress.begin("indirect light")?)?,
        };
        let mut fitting = Fitting::new(samples, &fits, &indirect);
        let surfaces = match few || samples.is_relit || is_glossy {
            true => Surfaces { of_pixels: vec![None; fits.len()], regions: Vec::new() },
            false => Surfaces::fit(&mut fitting, &grid, progress.begin("surfaces")?)?,
        };
        progress.begin("uncertainty")?;
        let of_pixels = residuals.of_pixels(&fitting, &surfaces.of_pixels);
        let b = fitting.vectors(&surfaces.of_pixels);
        let sources =
            AllSources::new(&grid, &of_pixels, &Estimates { fits: &fits, indirect: &indirect, best: &b });
        let best = best(&sources, &of_pixels, &b);
        if best.iter().all(Option::is_none) {
            return Err(Error::invalid("no pixel has a normal", why_none(samples)));
        }
        let estimate = Self {
            width: samples.width,
            height: samples.height,
            pixels: samples.pixels.clone(),
            best,
            least_squares: fits.iter().map(|fit| unit(fit.least_squares)).collect(),
            robust: fits.iter().map(|fit| unit(fit.robust)).collect(),
            direct: indirect.direct.iter().map(|b| unit(*b)).collect(),
            lights,
            misfit: misfit(&of_pixels, &fits),
            is_glossy,
            exponent: residuals.exponent(),
            albedo: indirect.albedo,
            shadows: indirect.shadows,
            unexplained: indirect.unexplained,
            finishes: surfaces.of_pixels.iter().map(|surface| surface.as_ref()?.finish).collect(),
            regions: surfaces.regions,
            chroma: Vec::new(),
        };
        estimate.with_chroma(samples, progress.begin("color")?)
    }

    /// Width of the photographs in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height of the photographs in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Returns the normals by an estimator as an image: x, y, z in [-1, 1], and a fourth channel of 1 where the best
    /// estimate exists, else 0.
    pub fn normals(&self, estimator: Estimator) -> Image {
        self.image(|i, best| {
            let normal = match estimator {
                Estimator::LeastSquares => self.least_squares[i],
                Estimator::Robust => self.robust[i],
                Estimator::Direct => self.direct[i],
                Estimator::Best => best.normal,
            };
            normal.to_array()
        })
    }

    /// Returns true if the photographs are in colour.
    pub fn has_color(&self) -> bool {
        !self.chroma.is_empty()
    }

    /// Returns the albedo in colour, whose mean over the channels is [`PixelEstimate::albedo`], and a fourth channel of 1;
    /// zeros without an estimate.
    pub fn albedos(&self) -> Image {
        self.image(|i, best| {
            let chroma = self.chroma.get(i).copied().unwrap_or([1.0; 3]);
            chroma.map(|v| best.albedo * f64::from(v))
        })
    }

    /// Returns an image of three numbers for each pixel with an estimate, and a fourth channel of 1; zeros elsewhere.
    pub fn image(&self, value: impl Fn(usize, &PixelEstimate) -> [f64; 3]) -> Image {
        let mut pixels = vec![[0.0; 4]; self.width as usize * self.height as usize];
        for (i, (pixel, best)) in self.pixels.iter().zip(&self.best).enumerate() {
            if let Some(best) = best {
                let [x, y, z] = value(i, best).map(|v| v as f32);
                pixels[*pixel as usize] = [x, y, z, 1.0];
            }
        }
        Image::from_pixels(self.width, self.height, pixels).expect("the size is that of the photographs")
    }

    /// Returns the uncertainty in degrees; NaN without a normal.
    ///
    /// # Errors
    /// Those of [`Field::new`], none of which can occur.
    pub fn sigma(&self) -> Result<Field> {
        let image = self.image(|_, best| [best.sigma_deg; 3]);
        let values = image.pixels().iter().map(|pixel| if pixel[3] > 0.0 { pixel[0] } else { f32::NAN });
        Field::new(self.width, self.height, values.collect())
    }

    /// Returns the root mean square residual of lit samples under all lights, relative to the albedo.
    pub fn lit_residual(&self) -> f64 {
        lit_residual(&self.lights)
    }

    /// Returns the mean of a number over all pixels with an estimate.
    pub fn mean(&self, value: impl Fn(&PixelEstimate) -> f64) -> f64 {
        let found = self.best.iter().flatten();
        let (sum, count) = found.fold((0.0, 0.0), |(sum, count), best| (sum + value(best), count + 1.0));
        sum / count
    }
}

/// Returns the root mean square residual of lit samples, relative to the albedo.
fn lit_residual(lights: &[LightResiduals]) -> f64 {
    let squares = lights.iter().map(|light| light.relative * light.relative);
    (squares.sum::<f64>() / lights.len().max(1) as f64).sqrt()
}

/// Returns the median residual relative to the robust fit.
fn misfit(residuals: &[PixelResiduals], fits: &[Fit]) -> f64 {
    let relative = residuals.iter().zip(fits).filter(|(residuals, _)| residuals.inverse.is_some());
    let relative = relative
        .map(|(residuals, fit)| residuals.variance.sqrt() / fit.robust.length().max(f64::MIN_POSITIVE));
    quantile(relative.collect(), 0.5)
}

/// Returns the fraction of the samples that are saturated.
fn saturated(samples: &Samples) -> f64 {
    samples.saturated() as f64 / (samples.pixels.len() * samples.images.len()) as f64
}

/// Returns the reason why no pixel has a normal.
fn why_none(samples: &Samples) -> String {
    if saturated(samples) < 0.5 {
        return "the photographs are black within the mask, or do not fit the lights".to_owned();
    }
    let (count, all) = (samples.saturated(), samples.pixels.len() * samples.images.len());
    format!("{count} of {all} samples within the mask are saturated: expose the photographs less")
}

/// Returns the fit of each pixel.
fn fits(robust: &Robust, samples: &Samples, progress: Progress<'_>) -> Result<Vec<Fit>> {
    let count = samples.pixels.len();
    let size = BLOCKS * LANES;
    let tasks = count.div_ceil(size);
    let done = AtomicUsize::new(0);
    let report = |progress: Progress<'_>| {
        progress.at((done.fetch_add(1, Ordering::Relaxed) % tasks) as f64 / tasks as f64)
    };
    let each = |work: &(dyn Fn(usize, &mut Scratch) -> [Fit; LANES] + Sync), progress: Progress<'_>| {
        let parts = parallel::try_tasks(tasks, &|task| {
            report(progress)?;
            let mut scratch = Scratch::default();
            let last = ((task + 1) * size).min(count);
            let firsts = (task * size..last).step_by(LANES);
            let mut fits: Vec<Fit> = firsts.flat_map(|first| work(first, &mut scratch)).collect();
            fits.truncate(last - task * size);
            Ok(fits)
        })?;
        Ok::<Vec<Fit>, Error>(parts.concat())
    };
    let starts = each(&|first, scratch| robust.start(first, scratch), progress.part(0.0, 0.7))?;
    let mut scales: Vec<f64> = starts.iter().map(|fit| fit.scale).collect();
    let middle = scales.len() / 2;
    let typical = *scales.select_nth_unstable_by(middle, f64::total_cmp).1;
    let refined = |first: usize, scratch: &mut Scratch| {
        let fits = std::array::from_fn(|lane| starts[(first + lane).min(count - 1)]);
        robust.refine(first, fits, typical, scratch)
    };
    each(&refined, progress.part(0.7, 1.0))
}

/// Returns the best estimate of each pixel, whose normal times albedo is `b`.
fn best(sources: &AllSources, residuals: &[PixelResiduals], b: &[Vec3<f64>]) -> Vec<Option<PixelEstimate>> {
    let table = RadiusTable::new();
    parallel::collect(b.len(), |i| {
        let covariance = sources.of(i)?.covariance();
        let deviations = covariance.eigenvalues().map(f64::sqrt);
        let sigma_deg = table.radius(deviations).to_degrees();
        if sigma_deg.is_nan() || sigma_deg > MOST_SIGMA_DEG {
            return None;
        }
        let albedo = b[i].length();
        Some(PixelEstimate {
            normal: unit(b[i]),
            albedo,
            covariance,
            sigma_deg,
            residual: residuals[i].variance.sqrt() / albedo,
        })
    })
}
