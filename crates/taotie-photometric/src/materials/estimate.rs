//! The materials of a model: all texels fitted, first each for itself, then with what the texels around let expect.

use super::fit::{Expected, Fitted, Observation, TexelFit};
use super::frame::Frame;
use super::gather::{ColorSample, Gathered, Photos};
use super::layout::{Layout, fitting_side};
use super::linear::squared;
use super::model::Model;
use super::neighbourhood::{Measured, Neighbourhood};
use super::reflection::{METALLIC, Reflection, VARIABLES};
use super::transforms::Transforms;
use crate::indirect::quantile;
use crate::photograph::Transfer;
use std::sync::atomic::{AtomicUsize, Ordering};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::{Progress, parallel};
use taotie_io::Limits;

/// The deviation of a black sample, relative to the median brightness.
const FLOOR: f64 = 0.02;
/// The least standard deviation of residuals, relative to that of samples.
const LEAST_SCALE: f64 = 0.02;
/// Numbers by which the whole material counts for the scale of a texel's residuals.
const SHARED: f64 = 10.0;
/// The deviation of a metallic that the model states.
const STATED: f64 = 1e-3;
/// Texels of a task.
const PART: usize = 1024;

/// The estimate of a texel.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TexelEstimate {
    /// Red, green and blue of the base colour (linear), roughness, metallic.
    pub values: [f32; VARIABLES],
    /// Their standard deviations.
    pub sigma: [f32; VARIABLES],
    /// The photographs that show it lit; 0 if its values are those of texels around it.
    pub samples: u32,
}

/// The estimate of one material.
pub struct MaterialEstimate {
    /// The texels of its maps.
    pub layout: Layout,
    /// The estimate of each.
    pub texels: Vec<TexelEstimate>,
    /// True if metallic is that of the model.
    pub has_metallic: bool,
    /// Samples left out because a pixel is saturated.
    pub saturated: usize,
}

/// How well the materials explain a photograph.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PhotographResiduals {
    /// Texels that it shows lit.
    pub texels: usize,
    /// Root mean square of sample less model, relative to that of the samples.
    pub relative: f64,
}

/// The materials of a model.
pub struct MaterialsEstimate {
    /// One for each material that triangles have, in the model's order.
    pub materials: Vec<MaterialEstimate>,
    /// The photographs, in order.
    pub photographs: Vec<PhotographResiduals>,
}

/// The photographs and the surface that materials are estimated from.
#[derive(Clone, Copy)]
pub struct MaterialsInput<'a> {
    /// The shape.
    pub model: &'a Model,
    /// The photographs with their cameras and lights.
    pub transforms: &'a Transforms,
    /// Texels along a side of the maps; `None` for texels about as large as the photographs' pixels.
    pub side: Option<u32>,
    /// The encoding of the photographs.
    pub transfer: Transfer,
    /// Limits of memory and image sizes.
    pub limits: Limits,
}

impl MaterialsEstimate {
    /// Estimates the materials.
    ///
    /// # Errors
    /// Those of reading photographs and laying out maps; [`Error::Invalid`] if no photograph shows the model lit,
    /// [`Error::Limit`], [`Error::Cancelled`].
    pub fn of(input: &MaterialsInput<'_>, warnings: &mut Warnings, progress: Progress<'_>) -> Result<Self> {
        let MaterialsInput { model, transforms, .. } = *input;
        progress.begin("layout")?;
        model.check_maps()?;
        let side = match input.side {
            Some(side) => side,
            None => fitting_side(model, &transforms.frames, &input.limits)?,
        };
        let layouts = model.materials().into_iter().map(|i| Layout::new(model, i, side, warnings));
        let layouts = layouts.collect::<Result<Vec<_>>>()?;
        let photos = Photos { frames: &transforms.frames, transfer: input.transfer, limits: input.limits };
        let gathered = Gathered::new(model, &layouts, &photos, progress.begin("read")?)?;
        check_seen(&gathered, transforms)?;
        let progress = progress.begin("fit")?;
        let mut materials = Vec::new();
        let mut squares = vec![[0.0; 2]; transforms.frames.len()];
        let mut shown = vec![0; transforms.frames.len()];
        let count = layouts.len() as f64;
        for (i, (layout, gathered)) in layouts.into_iter().zip(gathered).enumerate() {
            let part = progress.part(i as f64 / count, (i + 1) as f64 / count);
            shown.iter_mut().zip(&gathered.shown).for_each(|(sum, shown)| *sum += shown);
            let saturated = gathered.saturated;
            let material = model.material(layout.material);
            let has_metallic = material.metallic_roughness_texture.is_some();
            let fitting = Fitting {
                frames: &transforms.frames,
                floor: floor(&layout, &gathered),
                layout,
                gathered,
                reflection: Reflection::new(material),
                has_metallic,
            };
            let texels = fitting.texels(part)?;
            fitting.add_squares(&texels, &mut squares);
            materials.push(MaterialEstimate { layout: fitting.layout, texels, has_metallic, saturated });
        }
        let of_photograph = |([residual, sample], texels): (&[f64; 2], &usize)| PhotographResiduals {
            texels: *texels,
            relative: (residual / sample.max(f64::MIN_POSITIVE)).sqrt(),
        };
        Ok(Self { photographs: squares.iter().zip(&shown).map(of_photograph).collect(), materials })
    }
}

/// Rejects photographs that show nothing of the model.
fn check_seen(gathered: &[Gathered], transforms: &Transforms) -> Result<()> {
    match gathered.iter().flat_map(|of| &of.shown).all(|shown| *shown == 0) {
        true => Err(Error::invalid(
            format!("{}: no photograph shows a lit part of the model", transforms.path.display()),
            "cameras, lights and model must be in the same coordinates; a light's direction points from the model to the light",
        )),
        false => Ok(()),
    }
}

/// Returns the deviation of a black sample.
fn floor(layout: &Layout, gathered: &Gathered) -> f64 {
    /// The most texels that decide it.
    const ENOUGH: usize = 1 << 16;
    let step = layout.texels.len().div_ceil(ENOUGH).max(1);
    let of_texel = |i: usize| gathered.of(i).iter().map(|sample| grey(&sample.color));
    let greys: Vec<f64> = (0..layout.texels.len()).step_by(step).flat_map(of_texel).collect();
    FLOOR * if greys.is_empty() { 1.0 } else { quantile(greys, 0.5).max(1e-6) }
}

fn grey(color: &[f32; 3]) -> f64 {
    color.iter().map(|v| f64::from(*v)).sum::<f64>() / 3.0
}

/// A material ready to be fitted.
struct Fitting<'a> {
    frames: &'a [Frame],
    layout: Layout,
    gathered: Gathered,
    reflection: Reflection,
    floor: f64,
    has_metallic: bool,
}

/// A texel's fit for itself, as far as others need it.
#[derive(Debug, Clone, Copy, Default)]
struct First {
    values: [f64; VARIABLES],
    deviations: [f64; VARIABLES],
    squares: f64,
    weight: f64,
}

impl First {
    fn new(fitted: &Fitted) -> Self {
        let deviations = std::array::from_fn(|i| fitted.covariance[i][i].max(0.0).sqrt());
        Self { values: fitted.values, deviations, squares: fitted.squares, weight: fitted.weight }
    }

    /// Numbers beyond the variables.
    fn freedom(&self) -> f64 {
        self.weight - VARIABLES as f64
    }
}

impl Fitting<'_> {
    /// Fits all texels.
    fn texels(&self, progress: Progress<'_>) -> Result<Vec<TexelEstimate>> {
        let count = self.layout.texels.len();
        let first = self.each(progress.part(0.0, 0.7), &|texel, observations| {
            First::new(&self.fit(texel, observations).searched(self.metallic_starts(texel)))
        })?;
        let scale = self.scale(&first);
        let around: [Neighbourhood; VARIABLES] = std::array::from_fn(|variable| {
            let measured: Vec<Measured> =
                (0..count).filter_map(|i| self.measured(i, &first, variable)).collect();
            Neighbourhood::new(self.layout.side as usize, &measured)
        });
        let expected = |i: usize| -> [Option<Expected>; VARIABLES] {
            std::array::from_fn(|variable| {
                let own = self.measured(i, &first, variable);
                match variable == METALLIC && self.has_metallic {
                    true => self.stated(i),
                    false => Some(around[variable].expected(self.layout.texels[i].index, own.as_ref())),
                }
            })
        };
        self.each(progress.part(0.7, 1.0), &|i, observations| {
            let expected = expected(i);
            let own = first[i].freedom().max(0.0);
            let square = (SHARED * scale * scale + first[i].squares) / (SHARED + own);
            let tilted =
                |of: &Observation| of.with_tilt(&self.reflection, &self.layout.texels[i], &first[i].values);
            let observations: Vec<Observation> = observations.iter().map(tilted).collect();
            let fit = TexelFit { scale: square.sqrt(), expected, ..self.fit(i, &observations) };
            let alike =
                std::array::from_fn(|variable| expected[variable].map_or(0.5, |expected| expected.mean));
            let start = if fit.cost(&alike) < fit.cost(&first[i].values) { alike } else { first[i].values };
            let best = First::new(&fit.refined(start));
            TexelEstimate {
                values: best.values.map(|v| v as f32),
                sigma: best.deviations.map(|v| v as f32),
                samples: observations.len() as u32,
            }
        })
    }

    /// Returns a result for each texel, the default without samples.
    fn each<T: Send + Copy + Default>(
        &self,
        progress: Progress<'_>,
        work: &(dyn Fn(usize, &[Observation]) -> T + Sync),
    ) -> Result<Vec<T>> {
        let count = self.layout.texels.len();
        let done = AtomicUsize::new(0);
        let parts = parallel::try_tasks(count.div_ceil(PART), &|part| {
            progress.at(done.fetch_add(PART, Ordering::Relaxed) as f64 / count as f64)?;
            let texels = part * PART..((part + 1) * PART).min(count);
            let results = texels.map(|i| match self.observations(i) {
                observations if observations.is_empty() => T::default(),
                observations => work(i, &observations),
            });
            Ok(results.collect::<Vec<T>>())
        })?;
        Ok(parts.concat())
    }

    fn observations(&self, i: usize) -> Vec<Observation> {
        let texel = &self.layout.texels[i];
        let of = |sample: &ColorSample| {
            let incident = self.frames[sample.frame as usize].incident(texel, f64::from(sample.footprint));
            Observation::new(incident, sample.color.map(f64::from), self.floor)
        };
        self.gathered.of(i).iter().map(of).collect()
    }

    /// Returns the fit of a texel for itself.
    fn fit<'a>(&'a self, i: usize, observations: &'a [Observation]) -> TexelFit<'a> {
        let metallic = if self.has_metallic { self.stated(i) } else { None };
        TexelFit {
            reflection: &self.reflection,
            normal: self.layout.texels[i].normal,
            observations,
            scale: f64::INFINITY,
            expected: [None, None, None, None, metallic],
        }
    }

    fn stated(&self, i: usize) -> Option<Expected> {
        Some(Expected { mean: self.layout.texels[i].metallic, deviation: STATED })
    }

    fn metallic_starts(&self, i: usize) -> &[f64] {
        match self.has_metallic {
            true => std::slice::from_ref(&self.layout.texels[i].metallic),
            false => &[0.0, 1.0],
        }
    }

    fn measured(&self, i: usize, first: &[First], variable: usize) -> Option<Measured> {
        let has = !self.gathered.of(i).is_empty();
        let (value, deviation) = (first[i].values[variable], first[i].deviations[variable]);
        has.then_some(Measured { texel: self.layout.texels[i].index, value, deviation })
    }

    /// Returns the typical standard deviation of residuals, relative to that of samples.
    fn scale(&self, first: &[First]) -> f64 {
        let scales = first.iter().filter(|first| first.freedom() > VARIABLES as f64);
        let scales: Vec<f64> = scales.map(|first| (first.squares / first.freedom()).sqrt()).collect();
        if scales.is_empty() { 1.0 } else { quantile(scales, 0.5).max(LEAST_SCALE) }
    }

    /// Adds the squares of residuals and samples of each photograph.
    fn add_squares(&self, texels: &[TexelEstimate], sums: &mut [[f64; 2]]) {
        let count = texels.len();
        let parts = parallel::tasks(count.div_ceil(PART), &|part| {
            let mut sums = vec![[0.0; 2]; self.frames.len()];
            let range = part * PART..((part + 1) * PART).min(count);
            for (i, found) in texels.iter().enumerate().take(range.end).skip(range.start) {
                let (texel, values) = (&self.layout.texels[i], found.values.map(f64::from));
                for sample in self.gathered.of(i) {
                    let incident =
                        self.frames[sample.frame as usize].incident(texel, f64::from(sample.footprint));
                    let model = self.reflection.radiance(&values, texel.normal, &incident).to_array();
                    let [residuals, samples] = &mut sums[sample.frame as usize];
                    for (color, model) in sample.color.map(f64::from).into_iter().zip(model) {
                        *residuals += squared(color - model);
                        *samples += squared(color);
                    }
                }
            }
            sums
        });
        for part in parts {
            for (sum, part) in sums.iter_mut().zip(part) {
                *sum = [sum[0] + part[0], sum[1] + part[1]];
            }
        }
    }
}
