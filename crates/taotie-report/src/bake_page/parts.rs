//! The table of figures for each material of an asset with several.

use super::normal_errors::{cells, columns};
use crate::{Cell, Column, Section};
use taotie::asset::PartFigures;

/// Builds the table of all materials; `None` if there is only one.
pub fn table(parts: &[PartFigures]) -> Option<Section> {
    (!parts.is_empty()).then(|| Section::Table {
        title: "Materials".into(),
        note: "The triangles of each material of the low-poly mesh, with the maps baked for it. The error map stacks \
               the materials from top to bottom in this order."
            .into(),
        columns: columns(Column::words("material")),
        rows: parts.iter().map(|part| cells(Cell::text(part.material.as_str()), part)).collect(),
    })
}
