//! Levels of detail: a table of their figures, and the view in which each differs most from the scan.

use super::normal_errors::{cells, columns};
use super::views::{GREY, side};
use crate::{Cell, Column, Section, View};
use taotie::asset::{LevelFigures, Proof, ViewFigures, Views};
use taotie_engine::Result;

/// Builds the table of all levels; `None` if there is only one.
pub fn table(levels: &[LevelFigures]) -> Option<Section> {
    let further = [
        Column::numbers("seen at", "pixels across"),
        Column::numbers("overview, mean", "°"),
        Column::numbers("close-up, worst 1 %", "°"),
        Column::numbers("shape error, at most", "% of the diagonal"),
        Column::numbers("colour error, overview, mean", "ΔE00"),
        Column::numbers("FLIP", ""),
        Column::numbers("SSIM", ""),
    ];
    (levels.len() > 1).then(|| Section::Table {
        title: "Levels of detail".into(),
        note: "Each level, as written and read back, compared with the scan. A level replaces the previous one when \
               the object is “seen at” this size on a 3840 × 2160 screen, which is also its size in the overview. \
               FLIP and SSIM are means over all grey views."
            .into(),
        columns: columns(Column::numbers("level", "")).into_iter().chain(further).collect(),
        rows: levels.iter().enumerate().map(row).collect(),
    })
}

fn row((level, figures): (usize, &LevelFigures)) -> Vec<Cell> {
    let mean_of =
        |estimate: &Option<taotie_engine::proof::Estimate>| estimate.as_ref().map(|of| of.summary.mean);
    let further = [
        Cell::number(f64::from(figures.overview.across), 0),
        Cell::Number { value: mean_of(&figures.overview.angles), digits: 3 },
        Cell::Number { value: figures.patches.angle.map(|patch| patch.mean), digits: 2 },
        Cell::number(figures.hausdorff_of_diagonal.upper * 100.0, 4),
        Cell::Number { value: mean_of(&figures.overview.color), digits: 3 },
        mean(&figures.views, |view| view.flip),
        mean(&figures.views, |view| view.ssim),
    ];
    cells(Cell::number(level as f64, 0), figures).into_iter().chain(further).collect()
}

fn mean(views: &[ViewFigures], of: fn(&ViewFigures) -> f64) -> Cell {
    let sum: f64 = views.iter().map(of).sum();
    Cell::Number { value: (!views.is_empty()).then(|| sum / views.len() as f64), digits: 4 }
}

/// Builds a view of each coarser level, from the direction with the largest FLIP.
///
/// # Errors
/// [`taotie_engine::Error::Invalid`] if a picture has no pixels.
pub fn worst_views(proof: &Proof) -> Result<Vec<View>> {
    let worst = proof.coarser_views.iter().enumerate().map(|(i, shots)| worst_view(i + 1, shots));
    worst.filter_map(Result::transpose).collect()
}

fn worst_view(level: usize, shots: &Views) -> Result<Option<View>> {
    let by_flip = |a: &usize, b: &usize| shots.figures[*a].flip.total_cmp(&shots.figures[*b].flip);
    let Some(i) = (0..shots.figures.len()).max_by(by_flip) else { return Ok(None) };
    let view = side(shots, i, &GREY)?;
    let name = format!("level {level}, {}", view.name);
    let note = format!("Level of detail {level} from the direction in which it differs most. {}", view.note);
    Ok(Some(View { name, note, ..view }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_levels_have_a_row_each() {
        let level = |triangles: usize| {
            let mut level = LevelFigures::default();
            level.triangles = triangles;
            level.hausdorff_of_diagonal.upper = 0.01;
            level
        };
        assert_eq!(table(&[level(300)]), None, "the other tables cover a single level");
        let Some(Section::Table { columns, rows, .. }) = table(&[level(300), level(20)]) else {
            panic!("expected a table for two levels")
        };
        assert!(rows.len() == 2 && rows.iter().all(|row| row.len() == columns.len()));
        assert_eq!(rows[1][..2], [Cell::number(1.0, 0), Cell::number(20.0, 0)]);
        assert_eq!(rows[1][2], Cell::Number { value: None, digits: 3 }, "no angle was measured");
        assert_eq!(rows[1][7], Cell::number(512.0, 0), "pixels across");
        assert_eq!(rows[1][10], Cell::number(1.0, 4), "per cent");
    }
}
