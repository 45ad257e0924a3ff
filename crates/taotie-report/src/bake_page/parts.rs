//! The materials of an asset that has several: a table of their figures.

use crate::{Cell, Column, Section};
use taotie::asset::PartFigures;

/// Makes the table of all materials; `None` where there is one alone.
pub fn table(parts: &[PartFigures]) -> Option<Section> {
    let columns = vec![
        Column::words("material"),
        Column::numbers("triangles", ""),
        Column::numbers("normal error, mean", "°"),
        Column::numbers("95 %", "°"),
        Column::numbers("max", "°"),
        Column::numbers("without map, mean", "°"),
        Column::numbers("points with a missed ray", "%"),
        Column::numbers("points with no hit", "%"),
    ];
    (!parts.is_empty()).then(|| Section::Table {
        title: "Materials".into(),
        note: "The triangles of each material of the low-poly mesh, with the maps that were baked for it; in the map of \
               errors they stand one below the other in this order."
            .into(),
        columns,
        rows: parts.iter().map(row).collect(),
    })
}

fn row(part: &PartFigures) -> Vec<Cell> {
    let degrees = |value: Option<f64>| Cell::Number { value, digits: 3 };
    let angles = part.angles.as_ref();
    vec![
        Cell::text(part.material.as_str()),
        Cell::number(part.triangles as f64, 0),
        degrees(angles.map(|angles| angles.mean)),
        degrees(angles.map(|angles| angles.p95)),
        degrees(angles.map(|angles| angles.max)),
        degrees(part.without_map.as_ref().map(|angles| angles.mean)),
        Cell::number(part.missed * 100.0, 3),
        Cell::number(part.lost * 100.0, 3),
    ]
}
