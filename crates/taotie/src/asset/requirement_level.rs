//! The levels of detail at which a requirement counts.

use super::figure_words::Looking;
use super::figures::Figures;
use super::level_figures::LevelFigures;
use super::lod::Lod;
use super::requirement::Requirement;

impl Requirement {
    /// Returns `true` if it counts at a level of detail, among all that is required: it names that one, or none, and no other
    /// names it for the same figure of a coarser level.
    pub(super) fn counts_at(&self, level: usize, all: &[Self]) -> bool {
        let same = |other: &Self| (other.figure, other.within) == (self.figure, self.within);
        let is_replaced = || level > 0 && all.iter().any(|other| same(other) && other.level == Some(level));
        self.level == Some(level) || (self.level.is_none() && !is_replaced())
    }

    /// Returns the levels at which it counts that names none: those that are shown where the figure looks. Levels for small objects
    /// are never seen from nearby.
    pub(super) fn levels_of(&self, figures: &Figures, all: &[Self]) -> Vec<usize> {
        let is_anywhere = matches!(self.figure.looking(), Looking::Overview | Looking::Files);
        let is_whole = |level: &LevelFigures| level.overview.across >= Lod::FINEST as f32;
        let counts = |(number, level): &(usize, &LevelFigures)| {
            self.counts_at(*number, all) && (*number == 0 || is_anywhere || is_whole(level))
        };
        let levels = figures.levels.iter().enumerate().filter(counts).map(|(number, _)| number);
        if figures.levels.is_empty() { vec![0] } else { levels.collect() }
    }
}
