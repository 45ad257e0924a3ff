//! Warnings about photographs and lights that do not fit each other.

use crate::estimate::Estimate;
use crate::finish::FEWEST_LIGHTS;
use crate::samples::Samples;
use taotie_engine::Warnings;
use taotie_engine::names::Named;

/// How far the exponent between light and brightness may be from 1: highlights reach half of it.
const CURVED: f64 = 0.15;
/// The exponents that a curve of brightness may have: that of sRGB is 0.5 read as linear, and linear light has 1.8 read
/// as sRGB.
const ENCODINGS: [f64; 2] = [0.3, 3.0];
/// The median residual, relative to the albedo, that no curve of brightness explains.
const UNEXPLAINED: f64 = 0.12;

impl Estimate {
    /// Notes what is likely wrong with photographs or lights.
    pub fn note_doubts(&self, samples: &Samples, warnings: &mut Warnings) {
        // Polynomials bend the curve of brightness and smooth highlights.
        if !samples.is_relit {
            self.note_misfit(samples, warnings);
        }
        if let Some(curl) = self.curl().filter(|curl| curl.is_negated()) {
            let what = format!(
                "the lights' y seems to point down, or their x to the left: the curl of the slopes is {:.4}, but {:.4} with y \
                 negated; x must point to the right and y up",
                curl.estimated, curl.negated
            );
            warnings.note(what, 1);
        }
    }

    fn note_misfit(&self, samples: &Samples, warnings: &mut Warnings) {
        let residual = self.misfit;
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
