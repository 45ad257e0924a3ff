//! The tables of differences between shaded pictures.

use super::Document;
use crate::summary;
use crate::{Cell, Column, Section};
use taotie::comparison::{MethodReport, ModelReport, PictureFigures};

/// Returns the table comparing pictures under one shading model with those of the surface all are measured against.
pub(super) fn of_surfaces(report: &Document, i: usize) -> Section {
    let row = |method: &MethodReport| {
        let difference = method.pictures[i].difference.as_ref()?;
        Some([vec![Cell::text(method.method.clone())], cells(difference)].concat())
    };
    Section::Table {
        title: format!("Shaded pictures, {}", report.methods[0].pictures[i].shading),
        note: format!("Compared with {}, over the whole picture.", report.against),
        columns: [vec![Column::words("method")], columns()].concat(),
        rows: report.methods.iter().filter_map(row).collect(),
    }
}

/// Returns the table comparing the shading models with the baseline; `None` without a baseline.
pub(super) fn of_models(report: &Document) -> Option<Section> {
    let baseline = &report.methods[0].models.first()?.baseline;
    let names = |method: &MethodReport, model: &ModelReport| {
        vec![Cell::text(method.method.clone()), Cell::text(model.shading.clone())]
    };
    let row = |method: &MethodReport, model: &ModelReport| {
        [names(method, model), cells(&model.difference)].concat()
    };
    let rows = report.methods.iter().flat_map(|method| method.models.iter().map(move |m| row(method, m)));
    Some(Section::Table {
        title: format!("Shading models against {baseline}"),
        note: format!(
            "Each surface's picture compared with its picture under {baseline}, over the whole picture."
        ),
        columns: [vec![Column::words("method"), Column::words("shading")], columns()].concat(),
        rows: rows.collect(),
    })
}

fn columns() -> Vec<Column> {
    let flip =
        ["FLIP mean", "FLIP median", "FLIP 95 %", "FLIP max"].map(|figure| Column::numbers(figure, ""));
    let others = [("RMSE", ""), ("PSNR", "dB"), ("SSIM", "")];
    others.into_iter().map(|(figure, unit)| Column::numbers(figure, unit)).chain(flip).collect()
}

fn cells(difference: &PictureFigures) -> Vec<Cell> {
    let mut cells = vec![
        Cell::number(difference.rmse, 4),
        Cell::Number { value: difference.psnr, digits: 2 },
        Cell::number(difference.ssim, 4),
    ];
    cells.extend(match difference.flip.as_ref().map(summary::figures) {
        Some(flip) => flip.map(|figure| Cell::number(figure, 4)),
        None => std::array::from_fn(|_| Cell::Number { value: None, digits: 4 }),
    });
    cells
}
