//! The pixel program fitted to the samples of a pixel: normal and base colour, given the highlight of its region.
//!
//! Samples are those without indirect light. Shadows are left out, as the robust estimate finds them; highlights count,
//! since the model explains them, but the less the brighter they are, since it does so only roughly. Gauss-Newton with
//! Levenberg's damping minimises Tukey's biweight.

use crate::grid::Grid;
use crate::indirect::{Indirect, quantile};
use crate::program::{ALL, Finish, Lit, OWN, Surface};
use crate::robust::Fit;
use crate::samples::Samples;
use crate::symmetric::Sym3;
use crate::uncertainty::{tangents, unit};
use std::f64::consts::PI;
use taotie_engine::math::{Dual, Vec3};
use taotie_engine::parallel;

/// Standard deviation of a highlight, relative to itself.
const HIGHLIGHT: f64 = 0.05;
/// n · l from which a light counts: below, it grazes the surface, and parts of a pixel are in shadow.
const GRAZING: f64 = 0.15;
/// Deviations in which a sample is darker than the robust fit if it is in shadow.
const SHADOW: f64 = 3.0;
/// Deviations from which a sample has no weight, if the robust fit rejects some, and if it rejects none.
const CUT: [f64; 2] = [3.0, 10.0];
/// The smallest deviation, relative to the albedo.
const LEAST: f64 = 1e-3;
/// Steps of Gauss-Newton.
const STEPS: usize = 6;
/// The shift of the normal below which steps end.
const ENOUGH: f64 = 5e-4;
/// The longest shift of the normal in a step.
const LONGEST: f64 = 0.2;
/// Sum of weights below which a pixel is not fitted.
const FEWEST: f64 = 5.0;
/// The difference from its neighbours' median normal from which a pixel is fitted again, radians.
const DIFFERENT: f64 = 0.02;
/// The fewest neighbours with a surface that a pixel is compared with.
const FEWEST_AROUND: usize = 4;
/// Pixels of a task.
const PART: usize = 512;

/// The robust fit of a pixel that its samples are compared with.
#[derive(Debug, Clone, Copy)]
pub struct Reference {
    pixel: usize,
    /// Normal times albedo: darker samples are in shadow.
    b: Vec3<f64>,
    /// Standard deviation of the residuals.
    scale: f64,
    /// Deviations from which a sample has no weight.
    cut: f64,
    /// The indirect light that `b` contains.
    removed: Vec3<f64>,
}

impl Reference {
    fn new(pixel: usize, fit: &Fit, direct: Vec3<f64>) -> Self {
        let (scale, cut) = match fit.scale.is_finite() {
            true => (fit.scale, CUT[0]),
            false => (fit.deviation, CUT[1]),
        };
        let scale = scale.max(LEAST * fit.robust.length()).max(f64::MIN_POSITIVE);
        Self { pixel, b: fit.robust, scale, cut, removed: fit.robust - direct }
    }
}

/// The samples of all pixels with their robust fits.
pub struct Fitting<'a> {
    samples: &'a Samples,
    indirect: &'a Indirect,
    references: Vec<Reference>,
    /// Irradiance on a plane that faces the light, so that base colours are those that indirect light shows.
    pub irradiance: f64,
}

/// A sample compared with the model.
#[derive(Debug, Clone, Copy, Default)]
pub struct Compared {
    /// Sample less model.
    pub residual: f64,
    /// Its weight in the fit, [0, 1].
    pub weight: f64,
    /// Derivative of the sample by the normal times the albedo.
    pub gradient: Vec3<f64>,
}

/// Sums over the samples of a pixel: the normal equations.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sums {
    /// Of the pixel's own variables.
    pub own: Sym3,
    /// Between these, and roughness and F0.
    pub cross: [Vec3<f64>; 2],
    /// Of roughness and F0: the diagonal, and between them.
    pub shared: [f64; 3],
    /// The right side of the pixel's own variables.
    pub pull: Vec3<f64>,
    /// That of roughness and F0.
    pub shared_pull: [f64; 2],
    /// Sum of bounded squares: 1 for each sample without weight.
    pub cost: f64,
    /// Sum of the weights.
    pub weight: f64,
}

impl<'a> Fitting<'a> {
    /// Prepares the fit.
    pub fn new(samples: &'a Samples, fits: &'a [Fit], indirect: &'a Indirect) -> Self {
        let bright = quantile(indirect.direct.iter().map(|b| b.length()).collect(), 0.95);
        let irradiance = PI * bright / indirect.albedo;
        let pixels = fits.iter().zip(&indirect.direct).enumerate();
        let references = pixels.map(|(i, (fit, direct))| Reference::new(i, fit, *direct)).collect();
        Self { samples, indirect, references, irradiance }
    }

    /// The number of lights.
    pub fn lights(&self) -> usize {
        self.samples.lights.len()
    }

    /// Returns the surface that the robust estimate shows, with a highlight.
    pub fn start(&self, pixel: usize, finish: Option<Finish>) -> Surface {
        let b = self.indirect.direct[pixel];
        let normal = unit(b);
        Surface { normal, tangents: tangents(normal), color: b.length() * PI / self.irradiance, finish }
    }

    /// Returns the normal times the albedo of each pixel: of its surface or, without one, of the robust estimate.
    pub fn vectors(&self, surfaces: &[Option<Surface>]) -> Vec<Vec3<f64>> {
        let vector = |pixel: usize| match &surfaces[pixel] {
            Some(surface) => surface.normal * surface.under::<OWN>(self.irradiance).diffuse(),
            None => self.indirect.direct[pixel],
        };
        let vectors = parallel::collect(surfaces.len(), |pixel| vector(pixel).to_array());
        vectors.into_iter().map(Vec3::from_array).collect()
    }

    /// Calls `out` with each usable sample that is not in shadow: its light, the sample, the model's, the
    /// standard deviation of their difference, and the weight.
    #[inline(always)]
    fn visit<const N: usize>(
        &self,
        reference: &Reference,
        surface: &Surface,
        lights: impl Fn(usize) -> bool,
        mut out: impl FnMut(usize, f64, Dual<f64, N>, [f64; 2]),
    ) {
        let Reference { pixel, b, scale, cut, removed } = *reference;
        let lit: Lit<N> = surface.under(self.irradiance);
        let diffuse = lit.diffuse();
        for k in (0..self.lights()).filter(|k| lights(*k)) {
            let (l, sample) = (self.samples.direction(k, pixel), self.samples.images[k][pixel]);
            let (cosine, grey) = (surface.normal.dot(l), f64::from(sample.grey()));
            let in_shadow = cosine < GRAZING || grey < b.dot(l) - SHADOW * scale;
            if !sample.is_usable() || in_shadow {
                continue;
            }
            let model = lit.sample(l);
            let deviation = scale + HIGHLIGHT * (model.value - diffuse * cosine).max(0.0);
            let sample = grey - removed.dot(l).max(0.0);
            let relative = (sample - model.value) / (cut * deviation);
            let inside = 1.0 - relative * relative;
            let inside = if inside > 0.0 { inside } else { 0.0 };
            let precision = scale / deviation;
            out(k, sample, model, [inside, precision * precision]);
        }
    }

    /// Returns the sums of a pixel over some of the lights.
    pub fn sums<const N: usize>(
        &self,
        pixel: usize,
        surface: &Surface,
        lights: impl Fn(usize) -> bool,
    ) -> Sums {
        self.sums_at::<N>(&self.references[pixel], surface, lights)
    }

    fn sums_at<const N: usize>(
        &self,
        reference: &Reference,
        surface: &Surface,
        lights: impl Fn(usize) -> bool,
    ) -> Sums {
        let mut sums = Sums::default();
        self.visit::<N>(reference, surface, lights, |_, sample, model, [inside, precision]| {
            sums.cost += 1.0 - inside * inside * inside;
            let weight = inside * inside * precision;
            let off = (sample - model.value) * weight;
            let own = Vec3::new(model.partials[0], model.partials[1], model.partials[2]);
            sums.own.add(own, weight);
            sums.pull += own * off;
            sums.weight += weight;
            if N == ALL {
                let shared = [model.partials[N - 2], model.partials[N - 1]];
                for (c, by_shared) in shared.into_iter().enumerate() {
                    sums.cross[c] += own * (by_shared * weight);
                    sums.shared_pull[c] += by_shared * off;
                }
                sums.shared[0] += shared[0] * shared[0] * weight;
                sums.shared[1] += shared[1] * shared[1] * weight;
                sums.shared[2] += shared[0] * shared[1] * weight;
            }
        });
        sums
    }

    /// Fits normal and base colour to some of the lights; `None` if too few samples agree with any surface nearby.
    pub fn surface(&self, pixel: usize, start: Surface, lights: impl Fn(usize) -> bool) -> Option<Surface> {
        self.surface_at(&self.references[pixel], start, lights)
    }

    fn surface_at(
        &self,
        reference: &Reference,
        start: Surface,
        lights: impl Fn(usize) -> bool,
    ) -> Option<Surface> {
        let mut surface = start;
        let mut sums = self.sums_at::<OWN>(reference, &surface, &lights);
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            let Some(inverse) = damped(&sums.own, damping).inverse() else { break };
            let step = inverse.times(sums.pull);
            let next = moved(&surface, step);
            let of_next = self.sums_at::<OWN>(reference, &next, &lights);
            if of_next.cost > sums.cost {
                damping *= 10.0;
                continue;
            }
            (surface, sums) = (next, of_next);
            damping *= 0.1;
            if step.x.hypot(step.y) < ENOUGH {
                break;
            }
        }
        (sums.weight >= FEWEST && surface.normal.z > 0.0).then_some(surface)
    }

    /// Writes how each sample compares with the model, by light; those left out have no weight.
    pub fn compare(&self, pixel: usize, surface: &Surface, out: &mut [Compared]) {
        let length = surface.under::<OWN>(self.irradiance).diffuse().max(f64::MIN_POSITIVE);
        let [t, u] = surface.tangents;
        self.visit::<OWN>(
            &self.references[pixel],
            surface,
            |_| true,
            |k, sample, model, [inside, precision]| {
                let [by_t, by_u, by_color] = model.partials;
                out[k] = Compared {
                    residual: sample - model.value,
                    weight: inside * inside * precision,
                    gradient: (t * by_t + u * by_u + surface.normal * (by_color * surface.color)) / length,
                };
            },
        );
    }
}

impl Fitting<'_> {
    /// Fits pixels again from the surfaces of their neighbours, if theirs differ, and keeps what explains the samples better:
    /// of a pixel whose robust fit is wrong, the wrong samples are taken for shadows.
    pub fn retry(&mut self, grid: &Grid, surfaces: &mut [Option<Surface>]) {
        let found = parallel::tasks(surfaces.len().div_ceil(PART), &|part| {
            let pixels = part * PART..((part + 1) * PART).min(surfaces.len());
            pixels.filter_map(|pixel| self.retried(grid, surfaces, pixel)).collect::<Vec<_>>()
        });
        for (reference, surface) in found.into_iter().flatten() {
            surfaces[reference.pixel] = Some(surface);
            self.references[reference.pixel] = reference;
        }
    }

    fn retried(
        &self,
        grid: &Grid,
        surfaces: &[Option<Surface>],
        pixel: usize,
    ) -> Option<(Reference, Surface)> {
        let around: Vec<(&Reference, Surface)> = grid
            .around(pixel)
            .filter(|other| *other != pixel)
            .filter_map(|other| Some((&self.references[other], surfaces[other]?)))
            .collect();
        let finish = around.first()?.1.finish;
        let own = surfaces[pixel].unwrap_or_else(|| self.start(pixel, finish));
        if around.len() < FEWEST_AROUND {
            return None;
        }
        let median = |value: &dyn Fn(&Reference, &Surface) -> f64| {
            quantile(around.iter().map(|(reference, surface)| value(reference, surface)).collect(), 0.5)
        };
        let normal = unit(Vec3::new(
            median(&|_, surface| surface.normal.x),
            median(&|_, surface| surface.normal.y),
            median(&|_, surface| surface.normal.z),
        ));
        if (normal - own.normal).length() < DIFFERENT {
            return None;
        }
        let start = self.with_color(pixel, Surface { normal, tangents: tangents(normal), ..own });
        let removed = self.references[pixel].removed;
        let b = normal * start.under::<OWN>(self.irradiance).diffuse() + removed;
        let relative = |reference: &Reference, _: &Surface| {
            reference.scale / reference.b.length().max(f64::MIN_POSITIVE)
        };
        let scale = (median(&relative) * b.length()).max(f64::MIN_POSITIVE);
        let reference = Reference { pixel, b, scale, cut: median(&|reference, _| reference.cut), removed };
        let surface = self.surface_at(&reference, start, |_| true)?;
        (self.misfit(&reference, &surface) < self.misfit(&reference, &own)).then_some((reference, surface))
    }

    /// Returns a surface with the colour that the median sample of a pixel shows.
    fn with_color(&self, pixel: usize, surface: Surface) -> Surface {
        let lit: Lit<OWN> = surface.under(self.irradiance);
        let ratios = (0..self.lights()).filter_map(|k| {
            let l = self.samples.direction(k, pixel);
            let model = lit.sample(l).value;
            let sample = self.samples.images[k][pixel];
            (surface.normal.dot(l) > GRAZING && model > 0.0 && !sample.is_missing())
                .then(|| f64::from(sample.grey()) / model)
        });
        Surface { color: (surface.color * quantile(ratios.collect(), 0.5)).clamp(1e-6, 1e6), ..surface }
    }

    /// Returns the sum of bounded squares of all usable samples, in shadow or not.
    fn misfit(&self, reference: &Reference, surface: &Surface) -> f64 {
        let Reference { pixel, scale, cut, removed, .. } = *reference;
        let lit: Lit<OWN> = surface.under(self.irradiance);
        let diffuse = lit.diffuse();
        let bounded = |k: usize| {
            let (l, sample) = (self.samples.direction(k, pixel), self.samples.images[k][pixel]);
            let cosine = surface.normal.dot(l);
            let model = if cosine > 0.0 { lit.sample(l).value } else { 0.0 };
            let deviation = scale + HIGHLIGHT * (model - diffuse * cosine.max(0.0)).max(0.0);
            let off = f64::from(sample.grey()) - removed.dot(l).max(0.0) - model;
            let relative = off / (cut * deviation);
            if !sample.is_usable() { 0.0 } else { (relative * relative).min(1.0) }
        };
        (0..self.lights()).map(bounded).sum()
    }
}

/// Returns a matrix with its diagonal enlarged.
pub fn damped(matrix: &Sym3, damping: f64) -> Sym3 {
    let mut damped = *matrix;
    [0, 3, 5].into_iter().for_each(|i| damped.0[i] *= 1.0 + damping);
    damped
}

/// Returns a surface after a step of its variables.
pub fn moved(surface: &Surface, step: Vec3<f64>) -> Surface {
    let [t, u] = surface.tangents;
    let limit = LONGEST / step.x.hypot(step.y).max(LONGEST);
    let normal = unit(surface.normal + (t * step.x + u * step.y) * limit);
    let color = (surface.color + step.z).clamp(1e-6, 1e6);
    Surface { normal, tangents: tangents(normal), color, ..*surface }
}
