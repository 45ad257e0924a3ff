//! The columns shared by the tables of materials and of levels: triangles, normal errors, and missed rays.

use crate::{Cell, Column};
use taotie::asset::{LevelFigures, PartFigures};
use taotie_engine::compare::Summary;

/// The figures for a row.
pub struct NormalErrors<'a> {
    triangles: usize,
    angles: Option<&'a Summary>,
    without_map: Option<&'a Summary>,
    missed: f64,
}

impl<'a> From<&'a PartFigures> for NormalErrors<'a> {
    fn from(part: &'a PartFigures) -> Self {
        Self {
            triangles: part.triangles,
            angles: part.angles.as_ref(),
            without_map: part.without_map.as_ref(),
            missed: part.missed,
        }
    }
}

impl<'a> From<&'a LevelFigures> for NormalErrors<'a> {
    fn from(level: &'a LevelFigures) -> Self {
        Self {
            triangles: level.triangles,
            angles: level.surface_angles.as_ref(),
            without_map: level.without_map.as_ref(),
            missed: level.surface_missed,
        }
    }
}

/// Returns the columns, starting with `subject`, which names the row.
pub fn columns(subject: Column) -> Vec<Column> {
    vec![
        subject,
        Column::numbers("triangles", ""),
        Column::numbers("normal error on the surface, mean", "°"),
        Column::numbers("95 %", "°"),
        Column::numbers("max", "°"),
        Column::numbers("without map, mean", "°"),
        Column::numbers("points with a missed ray", "%"),
    ]
}

/// Returns the cells, starting with `subject`.
pub fn cells<'a>(subject: Cell, figures: impl Into<NormalErrors<'a>>) -> Vec<Cell> {
    let figures = figures.into();
    let degrees = |value: Option<f64>| Cell::Number { value, digits: 3 };
    vec![
        subject,
        Cell::number(figures.triangles as f64, 0),
        degrees(figures.angles.map(|angles| angles.mean)),
        degrees(figures.angles.map(|angles| angles.p95)),
        degrees(figures.angles.map(|angles| angles.max)),
        degrees(figures.without_map.map(|angles| angles.mean)),
        Cell::number(figures.missed * 100.0, 3),
    ]
}
