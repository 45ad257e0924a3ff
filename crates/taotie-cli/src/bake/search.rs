//! The target of a bake's search, unless triangles, size or packing are given.

use super::BakeArgs;
use super::images::Images;
use crate::studio::{Green, Space};
use anyhow::{Result, bail};
use taotie::asset::{Figure, Looking, Requirement, VerifyOptions};
use taotie_engine::bake::MapKind;
use taotie_engine::names::Named;
use taotie_io::CodecSet;

impl BakeArgs {
    /// Returns the requirements of a search for the smallest asset; `None` without one, or with only a number of
    /// bytes.
    pub(super) fn goal(&self) -> Option<Vec<Requirement>> {
        let is_asked = self.asked().is_some();
        if !is_asked && self.is_by_hand() {
            return None;
        }
        let target = self.target();
        let ceilings = self.ceilings();
        match (target.is_empty(), self.bytes.is_some()) {
            (true, true) => (!ceilings.is_empty()).then_some(ceilings),
            (true, false) => Some([Requirement::visually_lossless(), ceilings].concat()),
            (false, _) => Some([target, ceilings].concat()),
        }
    }

    /// Returns the limits on differences: those of the preset, unless an option limits the same figure.
    fn target(&self) -> Vec<Requirement> {
        let asked = self.error.map(Requirement::mean_angle_deg).into_iter().chain(self.proof.requirements());
        let asked: Vec<Requirement> = asked.collect();
        let of_preset = self.of_preset().filter(|own| !is_ceiling(own));
        let kept = of_preset.filter(|own| !self.overrides(own, &asked));
        kept.chain(asked.iter().copied()).collect()
    }

    /// Returns the ceilings of the options, otherwise of the preset.
    fn ceilings(&self) -> Vec<Requirement> {
        let triangles = self.max_triangles.map(f64::from).map(|most| (Figure::Triangles, most));
        let gpu_memory = self.max_gpu_memory.map(|most| (Figure::GpuMemory, most as f64));
        let given =
            triangles.into_iter().chain(gpu_memory).map(|(figure, most)| Requirement::of(figure, most));
        let given: Vec<Requirement> = given.collect();
        let required = self.proof.requirements();
        let of_preset = self.of_preset().filter(is_ceiling);
        let kept = of_preset.filter(|own| !self.overrides(own, &given) && !self.overrides(own, &required));
        kept.chain(given.iter().copied()).collect()
    }

    /// Returns `true` if one of `others` limits the same figure of the finest level as `own` of a preset; `--error`
    /// overrides all angle limits.
    fn overrides(&self, own: &Requirement, others: &[Requirement]) -> bool {
        let is_finest = |other: &Requirement| other.level.is_none_or(|level| level == 0);
        let is_angle = matches!(own.figure, Figure::MeanAngle | Figure::P95Angle);
        (self.error.is_some() && is_angle)
            || others.iter().any(|other| other.figure == own.figure && is_finest(other))
    }

    fn of_preset(&self) -> impl Iterator<Item = Requirement> {
        self.preset.into_iter().flat_map(|preset| preset.requirements())
    }

    /// Returns the options of the proof, which also checks ceilings and the number of bytes.
    pub(super) fn proof_options(&self) -> VerifyOptions {
        let mut options = self.proof.options();
        options.requirements.extend(self.ceilings());
        options.requirements.extend(self.bytes.map(Requirement::bytes));
        options
    }

    /// Rejects a search that could not find anything.
    pub(super) fn check_search(&self) -> Result<()> {
        if self.trials.is_some() && !self.searches() {
            bail!("--trials: these options run no search; leave it out");
        }
        if self.codecs != CodecSet::Portable && !self.searches() && !self.meshopt {
            bail!(
                "--codecs {}: these options run no search and do not compress geometry; add --meshopt",
                self.codecs.name()
            );
        }
        let Some(option) = self.asked() else { return Ok(()) };
        if self.space == Space::Object || !self.maps().contains(&MapKind::Normal) {
            bail!(
                "{option} needs a normal map in tangent space: add normal to --maps, and leave out --space object"
            );
        }
        if matches!(self.images, Images::Given(_)) {
            bail!("{option} chooses the quality of images: leave it out of --images");
        }
        Ok(())
    }

    /// Returns `true` if these options run a search.
    pub(super) fn searches(&self) -> bool {
        self.goal().is_some() || self.bytes.is_some()
    }

    /// Returns the option that requests a search.
    fn asked(&self) -> Option<&'static str> {
        let given = [
            ("--error", self.error.is_some()),
            ("--bytes", self.bytes.is_some()),
            ("--preset", self.preset.is_some()),
            ("--max-triangles", self.max_triangles.is_some()),
            ("--max-gpu-memory", self.max_gpu_memory.is_some()),
        ];
        given.into_iter().find(|(_, given)| *given).map(|(option, _)| option)
    }

    /// Returns `true` if triangles, size or packing are given, or an option that a search does not support.
    fn is_by_hand(&self) -> bool {
        let is_given = self.triangles.is_some() || self.size.is_some() || self.meshopt || self.bits.is_some();
        let is_unsearched = self.green == Green::Down || !self.unsearched().may_search();
        is_given || matches!(self.images, Images::Given(_)) || is_unsearched
    }
}

/// Returns `true` for a limit on the asset's resources rather than its appearance.
fn is_ceiling(required: &Requirement) -> bool {
    required.figure.looking() == Looking::Files
}
