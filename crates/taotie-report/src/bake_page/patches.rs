//! The worst patches: scan, asset and difference side by side.

use crate::heat_map::HeatMap;
use crate::sheet::Sheet;
use crate::{Legend, Picture, View};
use taotie::asset::{Figures, PatchPictures, Proof};
use taotie_engine::Result;
use taotie_engine::compare::ColorMap;
use taotie_engine::length::place_text;
use taotie_engine::proof::PatchQuantity;

/// Possible values at the end of a colour scale: degrees or CIEDE2000.
const TOPS: [f32; 6] = [1.0, 2.0, 5.0, 10.0, 20.0, 45.0];
/// The end of the scale is at least this many times the mean of the patch.
const OVER_MEAN: f64 = 3.0;

/// Builds the pictures of all worst patches.
///
/// # Errors
/// [`taotie_engine::Error::Invalid`] if a picture has no pixels.
pub fn features(proof: &Proof) -> Result<Vec<View>> {
    proof.patches.iter().map(|pictures| feature(&proof.figures, pictures)).collect()
}

fn feature(figures: &Figures, pictures: &PatchPictures) -> Result<View> {
    let PatchPictures { patch, of, scan, asset, difference, flip, .. } = pictures;
    let (name, unit, map) = match of {
        PatchQuantity::Angle => ("Worst patch: normals", "°", ColorMap::Viridis),
        PatchQuantity::Color => ("Worst patch: colours", "ΔE00", ColorMap::Viridis),
    };
    let is_enough = |top: &&f32| f64::from(**top) >= patch.mean * OVER_MEAN;
    let top = *TOPS.iter().find(is_enough).unwrap_or(&TOPS[TOPS.len() - 1]);
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
            "Close-up of the window covering 1 % of the visible surface with the largest mean difference: {mean}, \
             measured at points of the {surface} around {place}. Both are rendered from the same direction, {look} \
             and under the same light; the mean FLIP is {flip:.4}. The window fills two thirds of the width. Grey \
             pixels have nothing to compare."
        ),
        pictures: vec![
            Picture::to_look_at("scan", "", &Sheet::developed(scan))?,
            Picture::to_look_at("asset", "", &Sheet::developed(asset))?,
            Picture::new("difference", "", &heat.plain())?,
        ],
        legend: Some(Legend::new("difference", unit, f64::from(top), map)),
    })
}
