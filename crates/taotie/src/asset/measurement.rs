//! The measurement of levels of detail at as many points as it takes to decide the requirements.

use super::figures::{Figures, FitFigures};
use super::level_figures::{LevelFigures, Measured, measured};
use super::lod::Lod;
use super::part_figures::PartFigures;
use super::requirement;
use super::scan::Scan;
use super::seen::{Counts, Seen};
use super::shown::ShownLevel;
use super::verify_options::VerifyOptions;
use crate::error::Result;
use crate::length::Unit;
use crate::progress::Progress;
use crate::proof::{Pair, Side};
use crate::scene::Scene;

/// Measures levels of detail until all requirements are decided.
pub(super) struct Measurement<'a> {
    pub scan: &'a Scan,
    pub unit: Option<Unit>,
    pub options: &'a VerifyOptions,
    /// The pixels across the object at which each level is first shown; `None` for the finest, and for files that do
    /// not state it.
    pub across: &'a [Option<f32>],
}

impl<'a> Measurement<'a> {
    /// Returns the figures of all levels, the coarser ones initially at a quarter of the points, and those of the
    /// finest level's materials.
    pub fn all(
        &self,
        finest: &ShownLevel<'a>,
        coarser: &[Scene],
        level: &dyn Fn(&Scene) -> Result<ShownLevel<'a>>,
        progress: Progress<'_>,
    ) -> Result<(Figures, Vec<PartFigures>)> {
        let Self { scan, unit, options, .. } = *self;
        let side = Side::of(scan.sorted());
        let diagonal = scan.mesh().diagonal();
        let fit = finest.whole().fit((options.points / 2).max(1), diagonal).map(FitFigures::from);
        let mut figures = Figures { unit, diagonal, fit, ..Figures::default() };
        let found = self.add_level(&mut figures, (finest, &side), progress)?;
        if !coarser.is_empty() {
            progress.begin("measure levels")?;
        }
        for scene in coarser {
            self.add_level(&mut figures, (&level(scene)?, &side), progress)?;
        }
        Ok((figures, part_figures(finest, &found)))
    }

    /// Adds the figures of the next level, and returns the measurements on the surfaces of its materials.
    fn add_level(
        &self,
        figures: &mut Figures,
        (level, scan): (&ShownLevel<'_>, &Side<'a>),
        progress: Progress<'_>,
    ) -> Result<Vec<Measured>> {
        let number = figures.levels.len();
        let mut counts = Counts::of(self.options.points, number == 0);
        let found = measured(&level.part_surfaces(), counts.surface)?;
        let on_surface = LevelFigures::on_surface(&found, level.surface.mesh().triangles().len())?;
        let asset = Side::of(&level.surface);
        let diagonal = self.scan.mesh().diagonal() as f32;
        let pair = Pair { scan, asset: &asset, diagonal, has_material: level.has_material() };
        let asked = requirement::asked_limits(&self.options.requirements);
        let across = self.across.get(number).copied().flatten().unwrap_or(Lod::FINEST as f32);
        let mut seen = Seen::of(&pair, (across, counts))?;
        loop {
            figures.levels.push(on_surface.clone().with_seen(&pair, &seen, &asked)?);
            let met = figures.require(&self.options.requirements);
            counts = counts.to_decide(met.iter().filter(|met| met.level == Some(number)));
            if counts == seen.counts() {
                return Ok(found);
            }
            figures.levels.pop();
            progress.begin("measure more points")?;
            seen.refine(&pair, counts)?;
        }
    }
}

/// Returns the figures of each material, if there are several.
fn part_figures(level: &ShownLevel<'_>, found: &[Measured]) -> Vec<PartFigures> {
    let parts = level.parts.iter().zip(found).filter(|(part, _)| !part.label.is_empty());
    parts
        .map(|(part, found)| PartFigures::of(&part.label, part.shown.mesh().triangles().len(), found))
        .collect()
}
