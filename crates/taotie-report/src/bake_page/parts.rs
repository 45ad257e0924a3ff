//! The materials of an asset that has several: a table of their figures.

use super::normal_errors::{cells, columns};
use crate::{Cell, Column, Section};
use taotie::asset::PartFigures;

/// Makes the table of all materials; `None` where there is one alone.
pub fn table(parts: &[PartFigures]) -> Option<Section> {
    (!parts.is_empty()).then(|| Section::Table {
        title: "Materials".into(),
        note: "The triangles of each material of the low-poly mesh, with the maps that were baked for it; in the map of \
               errors they stand one below the other in this order."
            .into(),
        columns: columns(Column::words("material")),
        rows: parts.iter().map(|part| cells(Cell::text(part.material.as_str()), part)).collect(),
    })
}
