//! The smallest candidate that reaches the goal.

use super::trial::Trial;
use super::workshop::{Draft, Rounding};

/// A candidate that reaches the goal.
pub(super) struct Winner {
    pub candidate: Candidate,
    pub trial: Trial,
}

/// What becomes the asset.
pub(super) enum Candidate {
    /// A mesh and maps that were made from the scan.
    Made(Box<Draft>, Rounding),
    /// The packed scan.
    Packed {
        glb: Vec<u8>,
        /// The bytes of its images that were encoded anew.
        of_images: u64,
    },
}

impl Winner {
    /// Returns a candidate that was made from the scan.
    pub fn made(draft: Draft, rounding: Rounding, trial: Trial) -> Self {
        Self { candidate: Candidate::Made(Box::new(draft), rounding), trial }
    }

    /// Returns `true` if most of its bytes are textures of the scan: what is made from the scan needs them, too, and has more
    /// vertices at UV islands of its own.
    pub fn is_mostly_textures(&self) -> bool {
        match self.candidate {
            Candidate::Packed { of_images, .. } => 2 * of_images > self.trial.bytes,
            Candidate::Made(..) => false,
        }
    }

    /// Puts a candidate in the place of a larger one.
    pub fn replace(best: &mut Option<Self>, new: Self) {
        if best.as_ref().is_none_or(|best| new.trial.bytes < best.trial.bytes) {
            *best = Some(new);
        }
    }
}
