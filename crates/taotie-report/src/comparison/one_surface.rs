//! The views of a single surface: its shading models side by side.

use crate::heat_map::HeatMap;
use crate::sheet::Sheet;
use crate::{Legend, Picture, View};
use taotie::comparison::RenderedSurface;
use taotie_engine::Result;
use taotie_engine::compare::ColorMap;
use taotie_engine::names::Named;

/// Builds the views of its pictures, and of their differences from the baseline picture.
///
/// # Errors
/// [`taotie_engine::Error::Invalid`] if a picture has no pixels.
pub(super) fn views(surface: &RenderedSurface) -> Result<Vec<View>> {
    let pictures = surface
        .pictures
        .iter()
        .map(|(shading, picture)| Picture::new(shading.name(), "", &Sheet::developed(picture)));
    let flips = surface.model_differences.iter().map(|model| {
        let note = format!("against {}", model.baseline.name());
        Picture::new(model.shading.name(), note, &HeatMap::of_flip(&model.picture.flip).plain())
    });
    let models = View {
        name: "shading models".into(),
        note: format!("The surface method {} under each shading model, in the same light.", surface.id()),
        pictures: pictures.collect::<Result<_>>()?,
        legend: None,
    };
    let differences = View {
        name: "shading models: FLIP".into(),
        note: "FLIP estimates the perceived difference from the baseline.".into(),
        pictures: flips.collect::<Result<_>>()?,
        legend: Some(Legend::new("FLIP", "", 1.0, ColorMap::Magma)),
    };
    Ok(vec![models, differences])
}
