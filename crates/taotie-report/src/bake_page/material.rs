//! The colour and material errors of a proof.

use crate::heat_map::HeatMap;
use crate::summary::figures;
use crate::{Cell, Column, Legend, Picture, Section, View};
use taotie::asset::MaterialFigures;
use taotie_engine::Result;
use taotie_engine::compare::{ColorMap, Field, Summary};

/// The colour difference at the end of the colour scale.
const TOP: f32 = 10.0;

/// The maximum side of the picture of that map, pixels.
const MOST_SIDE: usize = 512;

/// Builds the table of all differences; `None` if nothing was compared.
pub fn section(material: &MaterialFigures) -> Option<Section> {
    if material.color.is_none() && material.not_finite == 0.0 {
        return None;
    }
    let mut columns = vec![Column::words("figure")];
    columns.extend(["mean", "median", "95 %", "max"].map(|name| Column::numbers(name, "")));
    let row = |(name, summary): (&str, Option<Summary>)| {
        let numbers = figures(&summary?).map(|value| Cell::number(value, 3));
        Some([Cell::text(name)].into_iter().chain(numbers).collect())
    };
    let color = [("colour (CIEDE2000)", material.color)];
    Some(Section::Table {
        title: "Colour and material error on the surface".into(),
        note: note(material),
        columns,
        rows: color.into_iter().chain(material.numbers()).filter_map(row).collect(),
    })
}

fn note(material: &MaterialFigures) -> String {
    let note = "Differences between the materials of asset and scan, at the points where normal errors are measured. \
                A CIEDE2000 difference of about 1 is just visible between adjacent colours. Baked roughness also \
                includes relief finer than a texel, which is counted as a difference here.";
    let part = material.not_finite * 100.0;
    if part == 0.0 {
        return note.into();
    }
    format!(
        "{note} At {part:.4} % of the points a value is not finite; such values are excluded from all figures."
    )
}

/// Builds the view of the colour error map.
///
/// # Errors
/// [`taotie_engine::Error::Invalid`] if the picture has no pixels.
pub fn view(field: &Field) -> Result<View> {
    let heat = HeatMap { field, title: "colour error", unit: "", map: ColorMap::Viridis, top: TOP };
    Ok(View {
        name: "colour error".into(),
        note: "CIEDE2000 difference between the base colours of asset and scan, in the layout of the maps."
            .into(),
        pictures: vec![Picture::to_look_at("colour error", "", &heat.plain().shrunk(MOST_SIDE))?],
        legend: Some(Legend::new("CIEDE2000", "", f64::from(TOP), ColorMap::Viridis)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_are_not_finite_are_reported() {
        let mut material = MaterialFigures::default();
        assert!(section(&material).is_none());
        material.not_finite = 0.25;
        let Some(Section::Table { note, .. }) = section(&material) else { panic!("no table") };
        assert!(note.contains("At 25.0000 % of the points"), "{note}");
    }
}
