//! The worst patches: scan, asset and difference side by side.

use crate::heat_map::HeatMap;
use crate::sheet::Sheet;
use crate::{Legend, Picture, View};
use taotie::Result;
use taotie::asset::{Figures, PatchPictures, Proof};
use taotie::compare::ColorMap;
use taotie::length::place_text;
use taotie::proof::PatchQuantity;

/// The last colour of the map of angles stands for this many degrees.
const TOP_DEG: f32 = 30.0;
/// The same of the map of colour differences, CIEDE2000.
const TOP_COLOR: f32 = 10.0;

/// Makes the pictures of all worst patches.
///
/// # Errors
/// [`taotie::Error::Invalid`] if a picture has no pixels.
pub fn features(proof: &Proof) -> Result<Vec<View>> {
    proof.patches.iter().map(|pictures| feature(&proof.figures, pictures)).collect()
}

fn feature(figures: &Figures, pictures: &PatchPictures) -> Result<View> {
    let PatchPictures { patch, of, scan, asset, difference, .. } = pictures;
    let (name, unit, top, map) = match of {
        PatchQuantity::Angle => ("Worst patch: normals", "°", TOP_DEG, ColorMap::Viridis),
        PatchQuantity::Color => ("Worst patch: colours", "ΔE00", TOP_COLOR, ColorMap::Viridis),
    };
    let (look, mean) = match of {
        PatchQuantity::Angle => ("in one grey material", format!("{:.2}°", patch.mean)),
        PatchQuantity::Color => ("in their own materials", format!("ΔE00 {:.2}", patch.mean)),
    };
    let place = place_text(patch.center, figures.diagonal, figures.unit);
    let surface = if patch.is_of_scan { "scan" } else { "asset" };
    let heat = HeatMap { field: difference, title: "difference", unit, map, top };
    Ok(View {
        name: name.into(),
        note: format!(
            "Close-up of the window of 1 % of the visible surface with the largest mean difference: {mean}, measured at points \
             of the {surface} around {place}. Both are seen from the same direction, {look} and the same \
             light; the window fills two thirds of the width. Grey pixels have nothing to compare."
        ),
        pictures: vec![
            Picture::new("scan", "", &Sheet::developed(scan))?,
            Picture::new("asset", "", &Sheet::developed(asset))?,
            Picture::new("difference", "", &heat.plain())?,
        ],
        legend: Some(Legend::new("difference", unit, f64::from(top), map)),
    })
}
