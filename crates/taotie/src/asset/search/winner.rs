//! The best candidate so far.

use super::trial::Trial;
use super::workshop::{Draft, Rounding};
use crate::io::{PackedGeometry, PackedImage};

/// A candidate and its measurements.
pub(super) struct Winner {
    pub candidate: Candidate,
    pub trial: Trial,
}

/// The contents of the asset.
pub(super) enum Candidate {
    /// A mesh and maps generated from the scan.
    Made(Box<Draft>, Rounding),
    /// The packed scan.
    Packed {
        glb: Vec<u8>,
        geometry: PackedGeometry,
        /// Those that were re-encoded.
        images: Vec<PackedImage>,
    },
}

/// The smallest candidate that reaches the goal; until there is one, the nearest one, within the ceilings if
/// possible.
#[derive(Default)]
pub(super) struct Best {
    so_far: Option<Winner>,
    /// The smallest ratio of any candidate within the ceilings.
    least_ratio: Option<f64>,
}

/// Ratios up to this factor above the smallest one count as equal; then bytes decide.
const EQUAL: f64 = 1.05;

impl Best {
    /// Replaces the best candidate if this one is better.
    pub fn offer(&mut self, candidate: Candidate, trial: Trial) {
        let known = self.least_ratio.unwrap_or(f64::INFINITY);
        let least_ratio = if trial.is_within() { known.min(trial.ratio()) } else { known };
        self.least_ratio = Some(least_ratio);
        let is_better = |than: &Trial| match (trial.is_near, than.is_near) {
            (true, true) => trial.bytes < than.bytes,
            (false, false) => match (trial.is_within(), than.is_within()) {
                (true, true) => {
                    let is_equal = |ratio: f64| ratio <= EQUAL * least_ratio;
                    match (is_equal(trial.ratio()), is_equal(than.ratio())) {
                        (true, true) => trial.bytes < than.bytes,
                        (false, false) => trial.ratio() < than.ratio(),
                        (is_equal, _) => is_equal,
                    }
                }
                (false, false) => trial.ceiling_ratio < than.ceiling_ratio,
                (is_within, _) => is_within,
            },
            (is_near, _) => is_near,
        };
        if self.so_far.as_ref().is_none_or(|winner| is_better(&winner.trial)) {
            self.so_far = Some(Winner { candidate, trial });
        }
    }

    /// Returns `true` if the best candidate is within all ceilings.
    pub fn is_within(&self) -> bool {
        self.so_far.as_ref().is_some_and(|winner| winner.trial.is_within())
    }

    /// Returns the fewest bytes with which the goal is reached; infinite if it has not been reached.
    pub fn bytes(&self) -> f64 {
        self.near().map_or(f64::INFINITY, |winner| winner.trial.bytes as f64)
    }

    /// Applies [`Trial::scale`].
    pub fn scale(&mut self, factor: f64) {
        self.least_ratio = self.least_ratio.map(|ratio| ratio * factor);
        if let Some(winner) = &mut self.so_far {
            winner.trial.scale(factor);
        }
    }

    /// Returns the bytes of the best candidate; infinite if there is none.
    pub fn least_bytes(&self) -> f64 {
        self.so_far.as_ref().map_or(f64::INFINITY, |winner| winner.trial.bytes as f64)
    }

    /// Returns `true` if most of its bytes are textures of the scan: candidates made from the scan need them too, and
    /// have more vertices at their own UV islands.
    pub fn is_mostly_textures(&self) -> bool {
        self.near().is_some_and(|winner| match &winner.candidate {
            Candidate::Packed { images, .. } => {
                let of_images: usize = images.iter().map(|image| image.bytes.len()).sum();
                2 * of_images as u64 > winner.trial.bytes
            }
            Candidate::Made(..) => false,
        })
    }

    /// Returns the best candidate.
    pub fn into_winner(self) -> Option<Winner> {
        self.so_far
    }

    fn near(&self) -> Option<&Winner> {
        self.so_far.as_ref().filter(|winner| winner.trial.is_near)
    }
}

impl Candidate {
    /// Returns a candidate generated from the scan.
    pub fn made(draft: Draft, rounding: Rounding) -> Self {
        Self::Made(Box::new(draft), rounding)
    }
}
