//! The pictures of a proof: scan and asset from all sides, the maps, and the missed rays.

use super::misses::misses;
use crate::heat_map::HeatMap;
use crate::sheet::Sheet;
use crate::{Legend, Picture, View};
use taotie::Result;
use taotie::asset::{Proof, Textures, ViewFigures};
use taotie::compare::{ColorMap, DisplayImage, Field};
use taotie::names::Named;

/// Pixels along a side of the pictures of maps.
const MAP: usize = 1024;
/// The last colour of the map of errors stands for this many degrees.
const TOP: f32 = 10.0;

/// Makes all views, a tab each.
///
/// # Errors
/// [`taotie::Error::Invalid`] where a picture has no pixels.
pub fn views(proof: &Proof, textures: &Textures) -> Result<Vec<View>> {
    let shots = &proof.views;
    let pairs = shots.scan.iter().zip(&shots.asset).zip(&shots.flip).zip(&shots.figures);
    let sides = pairs.map(|(((scan, asset), flip), figures)| side([scan, asset], flip, figures));
    let mut views = sides.collect::<Result<Vec<_>>>()?;
    views.extend(grouped(&maps(proof, textures)?));
    if let Some(texels) = &textures.misses {
        views.push(View {
            name: "missed rays".into(),
            note:
                "Texels with rays that missed the scan: amber used the scan's closest point, red had no hit."
                    .into(),
            pictures: vec![Picture::new("missed rays", "", &misses(texels))?],
            legend: None,
        });
    }
    Ok(views)
}

/// Makes the view of scan and asset from one side.
///
/// # Errors
/// [`taotie::Error::Invalid`] where a picture has no pixels.
pub fn side([scan, asset]: [&DisplayImage; 2], flip: &Field, figures: &ViewFigures) -> Result<View> {
    let visual_difference = format!("FLIP {:.4}, SSIM {:.4}", figures.flip, figures.ssim);
    Ok(View {
        name: format!("{:.0}°", figures.azimuth_deg),
        note: "Scan and asset in one grey material under the same light. FLIP is the difference that an observer sees."
            .into(),
        pictures: vec![
            Picture::new("scan", "", &Sheet::developed(scan))?,
            Picture::new("FLIP", "", &HeatMap::of_flip(flip).plain())?,
            Picture::new("asset", visual_difference, &Sheet::developed(asset))?,
        ],
        legend: Some(Legend::new("FLIP", "", 1.0, ColorMap::Magma)),
    })
}

/// The map of errors, then the baked maps.
fn maps(proof: &Proof, textures: &Textures) -> Result<Vec<Picture>> {
    let mut maps =
        vec![Picture::new("normal error", "", &HeatMap::of_angles(&proof.error_map, TOP).plain())?];
    let inside = [("normal", &textures.normal), ("albedo", &textures.color), ("orm", &textures.orm)];
    for (name, bitmap) in inside {
        if let Some(bitmap) = bitmap {
            maps.push(Picture::new(name, "", &Sheet::preview(bitmap, MAP))?);
        }
    }
    for beside in &textures.beside {
        maps.push(Picture::new(beside.map.name(), "", &Sheet::preview(&beside.bitmap, MAP))?);
    }
    Ok(maps)
}

/// A view for each size: only pictures of one size can be laid over one another.
fn grouped(pictures: &[Picture]) -> Vec<View> {
    let mut groups: Vec<Vec<Picture>> = Vec::new();
    for picture in pictures {
        match groups.iter_mut().find(|group| group[0].size() == picture.size()) {
            Some(group) => group.push(picture.clone()),
            None => groups.push(vec![picture.clone()]),
        }
    }
    groups.into_iter().enumerate().map(|(i, pictures)| view_of_maps(i, pictures)).collect()
}

fn view_of_maps(i: usize, pictures: Vec<Picture>) -> View {
    View {
        name: if i == 0 { "maps".into() } else { format!("maps {}", i + 1) },
        note: "The angle between the normals of asset and scan, laid out on the map; and the baked maps."
            .into(),
        pictures,
        legend: Some(Legend::new("Normal error", "°", f64::from(TOP), ColorMap::Viridis)),
    }
}
