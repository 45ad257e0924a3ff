//! Warnings about photographs and lights that do not fit each other.

use crate::estimate::Estimate;
use crate::finish::FEWEST_LIGHTS;
use crate::indirect::{MOST_ALBEDO, quantile};
use crate::residuals::LightResiduals;
use crate::samples::Samples;
use crate::symmetric::Sym3;
use taotie_engine::math::Vec3;
use taotie_engine::names::Named;
use taotie_engine::{Progress, Result, Warnings, parallel};
use taotie_io::listed;

/// How far the exponent between light and brightness may be from 1: highlights reach half of it.
const CURVED: f64 = 0.15;
/// The exponents that a curve of brightness may have: that of sRGB is 0.5 read as linear, and linear light has 1.8 read
/// as sRGB.
const ENCODINGS: [f64; 2] = [0.3, 3.0];
/// The median residual, relative to the albedo, that no curve of brightness explains.
const UNEXPLAINED: f64 = 0.12;

impl Estimate {
    /// Estimates the normals, and notes samples that are left out, pixels without a normal, and likely mistakes.
    ///
    /// # Errors
    /// As [`Estimate::of`].
    pub fn noted(samples: &Samples, warnings: &mut Warnings, progress: Progress<'_>) -> Result<Self> {
        samples.note(warnings);
        let estimate = Self::of(samples, progress)?;
        let without = estimate.best.iter().filter(|best| best.is_none()).count();
        warnings.note("a pixel has no normal: too little light, or too few samples that agree", without);
        estimate.note_doubts(samples, warnings);
        Ok(estimate)
    }

    /// Notes what is likely wrong with photographs or lights.
    pub fn note_doubts(&self, samples: &Samples, warnings: &mut Warnings) {
        // Polynomials bend the curve of brightness and smooth highlights.
        if !samples.is_relit {
            self.note_misfit(samples, warnings);
        }
        let clipped = self.shadows > 0 && self.albedo >= MOST_ALBEDO * 0.999;
        let what = format!(
            "shadows are brighter than light between parts of the object explains, as with stray light in the room: bright \
             pixels are assumed to have an albedo of {MOST_ALBEDO}, so base colours may be too bright and too much indirect \
             light may be removed"
        );
        warnings.note(what, usize::from(clipped));
        if let Some(curl) = self.curl().filter(|curl| curl.is_negated()) {
            let what = format!(
                "the lights' y seems to point down, or their x to the left: the curl of the slopes is {:.4}, but {:.4} with y \
                 negated; x must point to the right and y up",
                curl.estimated, curl.negated
            );
            warnings.note(what, 1);
        } else if self.misfit <= UNEXPLAINED {
            let moved = self.moved(samples);
            let what = format!(
                "photographs are shifted, as if the camera or the object had moved: {}; align them, or leave them out",
                listed(&moved)
            );
            warnings.note(what, moved.len());
        }
    }

    /// Describes the photographs that are shifted.
    fn moved(&self, samples: &Samples) -> Vec<String> {
        let describe = |(k, light): (usize, &LightResiduals)| {
            let shift = light.shift.filter(|shift| shift.is_moved())?;
            let [x, y] = shift.pixels;
            let (across, along) =
                (if x < 0.0 { "left" } else { "right" }, if y < 0.0 { "up" } else { "down" });
            Some(format!("{} by {:.1} pixels {across} and {:.1} {along}", samples.name(k), x.abs(), y.abs()))
        };
        self.lights.iter().enumerate().filter_map(describe).collect()
    }

    fn note_misfit(&self, samples: &Samples, warnings: &mut Warnings) {
        let residual = self.misfit;
        if let Some(order) = better_order(samples) {
            let what = format!(
                "the photographs fit the lights better if {order}: check the order of the lights and the names of the photographs"
            );
            return warnings.note(what, 1);
        }
        let curved = self.exponent.filter(|exponent| (exponent - 1.0).abs() > CURVED);
        let is_encoding = |exponent: f64| (ENCODINGS[0]..ENCODINGS[1]).contains(&exponent);
        if residual > UNEXPLAINED || curved.is_some_and(|exponent| !is_encoding(exponent)) {
            let what = format!(
                "the lights do not explain the photographs, with residuals of {:.0} % of the albedo: check the order \
                 of the lights, the names of the photographs, and how bright each light is",
                100.0 * residual
            );
            warnings.note(what, 1);
        } else if let Some(exponent) = curved {
            let what = format!(
                "brightness grows like the power {exponent:.2} of the light: the photographs may not be {}; see --encoding",
                samples.transfer.name()
            );
            warnings.note(what, 1);
        }
        if self.is_glossy && residual < UNEXPLAINED {
            let what = format!(
                "residuals of {:.0} % of the albedo, as of highlights or shadows: {} photographs are too few to fit them, so that \
                 normals are less accurate; take at least {FEWEST_LIGHTS}, or 24 of glossy surfaces",
                100.0 * self.lit_residual(),
                samples.images.len()
            );
            warnings.note(what, 1);
        }
    }
}

/// The number of the light that photograph k of n has in a list with a mistake.
type Order = fn(usize, usize) -> usize;

/// Mistakes in lists of lights, as the warning names their correction.
const ORDERS: [(&str, Order); 3] = [
    ("each has the light after its own", |k, n| (k + 1) % n),
    ("each has the light before its own", |k, n| (k + n - 1) % n),
    ("the list of lights is reversed", |k, n| n - 1 - k),
];
/// Pixels that are tried with other lights.
const TRIED: usize = 4000;
/// The squared residual relative to that of the given order below which another order is better.
const BETTER: f64 = 0.5;

/// Returns the correction of the list of lights that makes residuals of least squares much smaller, if there is one.
fn better_order(samples: &Samples) -> Option<&'static str> {
    if samples.is_near() {
        return None;
    }
    let given = misfit(samples, |k, _| k)?;
    let tried = ORDERS.iter().filter_map(|(name, order)| Some((misfit(samples, order)?, *name)));
    let (best, name) = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (best < BETTER * given).then_some(name)
}

/// Returns the median over pixels of the squared residuals of least squares, relative to the squared samples.
fn misfit(samples: &Samples, order: impl Fn(usize, usize) -> usize + Sync) -> Option<f64> {
    let lights = &samples.lights;
    let mut matrix = Sym3::default();
    lights.iter().for_each(|light| matrix.add(*light, 1.0));
    let inverse = matrix.inverse()?;
    let step = samples.pixels.len().div_ceil(TRIED).max(1);
    let relative = parallel::collect(samples.pixels.len().div_ceil(step), |pixel| {
        let (mut pull, mut squares) = (Vec3::splat(0.0), 0.0);
        for (k, image) in samples.images.iter().enumerate() {
            let grey = f64::from(image[pixel * step].grey());
            pull += lights[order(k, lights.len())] * grey;
            squares += grey * grey;
        }
        let explained = pull.dot(inverse.times(pull));
        if squares > 0.0 { (squares - explained).max(0.0) / squares } else { f64::NAN }
    });
    let lit: Vec<f64> = relative.into_iter().filter(|v| !v.is_nan()).collect();
    (!lit.is_empty()).then(|| quantile(lit, 0.5))
}
