//! What a bake searches for, unless triangles, size or packing are chosen by hand.

use super::BakeArgs;
use crate::studio::{Green, Space};
use anyhow::{Result, bail};
use taotie::asset::{Requirement, VerifyOptions};
use taotie::bake::MapKind;

impl BakeArgs {
    /// Returns what the smallest asset is searched for that meets it; `None` if nothing is searched.
    pub(super) fn goal(&self) -> Option<Vec<Requirement>> {
        let required = self.proof.requirements();
        match self.error {
            Some(most) => Some([vec![Requirement::mean_angle_deg(most)], required].concat()),
            None if self.bytes.is_none() && self.is_by_hand() => None,
            None if required.is_empty() && self.bytes.is_some() => None,
            None if required.is_empty() => Some(Requirement::visually_lossless()),
            None => Some(required),
        }
    }

    /// Returns the options of the proof, which judges the number of bytes, too.
    pub(super) fn proof_options(&self) -> VerifyOptions {
        let mut options = self.proof.options();
        options.requirements.extend(self.bytes.map(Requirement::bytes));
        options
    }

    /// Refuses a search that could not find anything.
    pub(super) fn check_search(&self) -> Result<()> {
        let option = if self.error.is_some() { "--error" } else { "--bytes" };
        let is_asked = self.error.is_some() || self.bytes.is_some();
        if is_asked && (self.space == Space::Object || !self.maps().contains(&MapKind::Normal)) {
            bail!(
                "{option} needs a normal map in tangent space: add normal to --maps, leave out --space object"
            );
        }
        Ok(())
    }

    /// Says whether an asset is searched for.
    pub(super) fn searches(&self) -> bool {
        self.goal().is_some() || self.bytes.is_some()
    }

    /// Says whether triangles, size or packing are chosen by hand, or something is asked for that no search can judge.
    fn is_by_hand(&self) -> bool {
        let is_chosen = self.triangles.is_some() || self.size.is_some() || self.purpose.is_some();
        is_chosen || self.packs_by_hand() || self.green == Green::Down || !self.unsearched().may_search()
    }

    fn packs_by_hand(&self) -> bool {
        let qualities = [self.webp_quality, self.uastc_rdo, self.jpeg];
        let is_chosen = self.ktx2 || self.webp || self.meshopt || self.bits.is_some();
        is_chosen || qualities.iter().any(Option::is_some)
    }
}
