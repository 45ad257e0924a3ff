//! The levels of detail to which a requirement applies.

use super::figure_words::Looking;
use super::figures::Figures;
use super::level_figures::LevelFigures;
use super::lod::Lod;
use super::requirement::Requirement;

impl Requirement {
    /// Returns `true` if it applies to a level of detail, given all requirements: it names that level, or it names
    /// none and no other requirement for the same figure names that coarser level.
    pub(super) fn counts_at(&self, level: usize, all: &[Self]) -> bool {
        let same = |other: &Self| (other.figure, other.within) == (self.figure, self.within);
        let is_replaced = || level > 0 && all.iter().any(|other| same(other) && other.level == Some(level));
        self.level == Some(level) || (self.level.is_none() && !is_replaced())
    }

    /// Returns the levels to which it applies if it names none: those displayed at the distance of the figure. Levels
    /// for small objects are never seen close up.
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
