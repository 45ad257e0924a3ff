//! What a proof says of colour and material.

use crate::heat_map::HeatMap;
use crate::summary::figures;
use crate::{Cell, Column, Legend, Picture, Section, View};
use taotie::Result;
use taotie::asset::MaterialFigures;
use taotie::compare::{ColorMap, Field, Summary};

/// The last colour of the map of colour errors stands for this difference.
const TOP: f32 = 10.0;

/// Makes the table of all differences; none where nothing was compared.
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
    let note = "The difference of what asset and scan say of their material at the points of the normal error. Of two \
                colours side by side, a CIEDE2000 of about 1 is just visible. A baked roughness is widened by the \
                relief that is finer than a texel, which counts here as well.";
    let part = material.not_finite * 100.0;
    if part == 0.0 {
        return note.into();
    }
    format!(
        "{note} At {part:.4} % of the points a value is not finite; what is not finite is in none of the figures."
    )
}

/// Makes the view of the colour error on the map.
///
/// # Errors
/// [`taotie::Error::Invalid`] where the picture has no pixels.
pub fn view(field: &Field) -> Result<View> {
    let heat = HeatMap { field, title: "colour error", unit: "", map: ColorMap::Viridis, top: TOP };
    Ok(View {
        name: "colour error".into(),
        note: "The difference of the base colours of asset and scan on the surface, CIEDE2000, laid out on the map.".into(),
        pictures: vec![Picture::new("colour error", "", &heat.plain())?],
        legend: Some(Legend::new("CIEDE2000", "", f64::from(TOP), ColorMap::Viridis)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_are_not_finite_are_told() {
        let mut material = MaterialFigures::default();
        assert!(section(&material).is_none());
        material.not_finite = 0.25;
        let Some(Section::Table { note, .. }) = section(&material) else { panic!("no table") };
        assert!(note.contains("At 25.0000 % of the points"), "{note}");
    }
}
