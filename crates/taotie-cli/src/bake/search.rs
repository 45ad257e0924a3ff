//! What a bake searches for, unless triangles, size or packing are chosen by hand.

use super::BakeArgs;
use crate::studio::{Green, Space};
use anyhow::{Result, bail};
use taotie::asset::Requirement;
use taotie::bake::MapKind;

impl BakeArgs {
    /// Returns what the smallest asset is searched for that meets it; `None` if nothing is searched.
    pub(super) fn goal(&self) -> Option<Vec<Requirement>> {
        let required = self.proof.requirements();
        match self.error {
            Some(most) => Some([vec![Requirement::mean_angle_deg(most)], required].concat()),
            None if self.is_by_hand() => None,
            None if required.is_empty() => Some(Requirement::visually_lossless()),
            None => Some(required),
        }
    }

    /// Refuses a search that could not find anything.
    pub(super) fn check_search(&self) -> Result<()> {
        if self.error.is_some() && (self.space == Space::Object || !self.maps().contains(&MapKind::Normal)) {
            bail!(
                "--error needs a normal map in tangent space: add normal to --maps, leave out --space object"
            );
        }
        Ok(())
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
