//! What a proof says of colour and material.

use crate::heat_map::HeatMap;
use crate::summary::figures;
use crate::{Cell, Column, Fact, Legend, Picture, Section, View};
use taotie::Result;
use taotie::asset::MaterialFigures;
use taotie::compare::{ColorMap, Field, Summary};

/// The last colour of the map of colour errors stands for this difference.
const TOP: f32 = 10.0;

/// Makes the mean as a fact; none where colours were not compared.
pub fn fact(material: &MaterialFigures) -> Option<Fact> {
    Some(Fact::new("Colour error, mean", format!("ΔE00 {:.2}", material.color?.mean)))
}

/// Makes the table of all differences; none where nothing was compared.
pub fn section(material: &MaterialFigures) -> Option<Section> {
    material.color?;
    let mut columns = vec![Column::words("figure")];
    columns.extend(["mean", "median", "95 %", "max"].map(|name| Column::numbers(name, "")));
    let row = |(name, summary): (&str, Option<Summary>)| {
        let numbers = figures(&summary?).map(|value| Cell::number(value, 3));
        Some([Cell::text(name)].into_iter().chain(numbers).collect())
    };
    let color = [("colour (CIEDE2000)", material.color)];
    Some(Section::Table {
        title: "Colour and material error".into(),
        note: "The difference of what asset and scan say of their material at the points of the normal error. Of two \
               colours side by side, a CIEDE2000 of about 1 is just visible. A baked roughness is widened by the \
               relief that is finer than a texel, which counts here as well."
            .into(),
        columns,
        rows: color.into_iter().chain(material.numbers()).filter_map(row).collect(),
    })
}

/// Makes the view of the colour error on the map.
///
/// # Errors
/// [`taotie::Error::Invalid`] where the picture has no pixels.
pub fn view(field: &Field) -> Result<View> {
    let heat = HeatMap { field, title: "colour error", unit: "", map: ColorMap::Viridis, top: TOP };
    Ok(View {
        name: "colour error".into(),
        note: "The difference of the base colours of asset and scan, CIEDE2000, laid out on the map.".into(),
        pictures: vec![Picture::new("colour error", "", &heat.plain())?],
        legend: Some(Legend::new("CIEDE2000", "", f64::from(TOP), ColorMap::Viridis)),
    })
}
