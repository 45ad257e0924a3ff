//! The pictures of a proof: the worst patches, scan and asset from all directions and at each level of detail, and
//! the maps with errors, lost detail and missed rays.

use crate::heat_map::HeatMap;
use crate::sheet::{GROUND, Sheet};
use crate::{Legend, Picture, View};
use taotie::asset::{Asset, Figures, Misses, PatchPictures, Proof, Textures, Views};
use taotie_engine::Result;
use taotie_engine::bake::TexelStatus;
use taotie_engine::compare::{ColorMap, Field};
use taotie_engine::length::place_text;
use taotie_engine::names::Named;
use taotie_engine::proof::PatchQuantity;

/// The side of the pictures of maps, pixels; for several materials, of all of them together.
const MAP: usize = 512;
/// The minimum side of the picture of a map if there are many materials, pixels.
const LEAST_MAP: usize = 128;
/// The angle at the end of the colour scale of the error map, degrees.
const ANGLE_TOP: f32 = 10.0;
/// The ratio of texel widths, asset to scan, at the end of the colour scale of lost detail.
const MOST_COARSE: f32 = 8.0;
/// The colour difference at the end of the colour scale of the colour error map.
const COLOR_TOP: f32 = 10.0;
/// The maximum side of the picture of that map, pixels.
const MOST_COLOR_SIDE: usize = 512;
/// Possible values at the end of the colour scales of patches and of removed noise: degrees, CIEDE2000, or
/// fractions of the largest number.
const PATCH_TOPS: [f32; 6] = [1.0, 2.0, 5.0, 10.0, 20.0, 45.0];
/// The end of that scale is at least this many times the mean.
const OVER_MEAN: f64 = 3.0;

/// Builds all views, one tab each.
///
/// # Errors
/// [`taotie_engine::Error::Invalid`] if a picture has no pixels.
pub(super) fn views(proof: &Proof, asset: Option<&Asset>) -> Result<Vec<View>> {
    let mut views = sides(&proof.views, &GREY)?;
    if let Some(full) = &proof.full_views {
        views.extend(sides(full, &FULL)?);
    }
    views.extend(grouped(&maps(proof, asset)?));
    if let Some(field) = &proof.color_map {
        views.push(color_errors(field)?);
    }
    views.extend(proof.detail_map.as_ref().map(lost_detail).transpose()?);
    views.extend(removed_noise(&proof.noise_maps)?);
    for (material, textures) in asset.into_iter().flat_map(Asset::texture_sets) {
        views.extend(missed_rays(material, textures)?);
    }
    Ok(views)
}

/// Builds the pictures of all worst patches.
///
/// # Errors
/// [`taotie_engine::Error::Invalid`] if a picture has no pixels.
pub(super) fn worst_patches(proof: &Proof) -> Result<Vec<View>> {
    proof.patches.iter().map(|pictures| patch_view(&proof.figures, pictures)).collect()
}

fn patch_view(figures: &Figures, pictures: &PatchPictures) -> Result<View> {
    let PatchPictures { patch, of, scan, asset, difference, flip, .. } = pictures;
    let (name, unit, mean) = match of {
        PatchQuantity::Angle => ("normals", "°", format!("{:.2}°", patch.mean)),
        PatchQuantity::Color => ("colours", "ΔE00", format!("ΔE00 {:.2}", patch.mean)),
        PatchQuantity::Detail => ("lost detail", "", format!("{:.3}", patch.mean)),
        PatchQuantity::Material => ("metallic, roughness or occlusion", "", format!("{:.3}", patch.mean)),
    };
    let look = if *of == PatchQuantity::Angle { "in one grey material" } else { "in their own materials" };
    let (top, map) = (top_over(patch.mean), ColorMap::Viridis);
    let place = place_text(patch.center, figures.diagonal, figures.unit);
    let surface = if patch.is_of_scan { "scan" } else { "asset" };
    let heat = HeatMap { field: difference, title: "difference", unit, map, top };
    Ok(View {
        name: format!("Worst patch: {name}"),
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

/// Builds a view of each coarser level, from the direction with the largest FLIP.
///
/// # Errors
/// [`taotie_engine::Error::Invalid`] if a picture has no pixels.
pub(super) fn worst_views(proof: &Proof) -> Result<Vec<View>> {
    let worst = proof.coarser_views.iter().enumerate().map(|(i, shots)| worst_view(i + 1, shots));
    worst.filter_map(Result::transpose).collect()
}

fn worst_view(level: usize, shots: &Views) -> Result<Option<View>> {
    let by_flip = |a: &usize, b: &usize| shots.figures[*a].flip.total_cmp(&shots.figures[*b].flip);
    let Some(i) = (0..shots.figures.len()).max_by(by_flip) else { return Ok(None) };
    let view = side(shots, i, &GREY)?;
    let name = format!("level {level}, {}", view.name);
    let note = format!("Level of detail {level} from the direction in which it differs most. {}", view.note);
    Ok(Some(View { name, note, ..view }))
}

/// Builds the view of the colour error map.
fn color_errors(field: &Field) -> Result<View> {
    let heat = HeatMap { field, title: "colour error", unit: "", map: ColorMap::Viridis, top: COLOR_TOP };
    Ok(View {
        name: "colour error".into(),
        note: "CIEDE2000 difference between the base colours of asset and scan, in the layout of the maps."
            .into(),
        pictures: vec![Picture::to_look_at("colour error", "", &heat.plain().shrunk(MOST_COLOR_SIDE))?],
        legend: Some(Legend::new("CIEDE2000", "", f64::from(COLOR_TOP), ColorMap::Viridis)),
    })
}

/// Builds the view that shows how much coarser the asset's texels are than the scan's detail.
fn lost_detail(field: &Field) -> Result<View> {
    let (title, map) = ("times as wide as the scan's detail", ColorMap::Magma);
    let heat = HeatMap { field, title, unit: " ×", map, top: MOST_COARSE };
    Ok(View {
        name: "lost detail".into(),
        note: "How many times wider the asset's texels are than the scan's finest detail at the same place: a texel \
               of its textures or half its median edge length, but at least 1/4096 of the object. Above 2, detail \
               is lost."
            .into(),
        pictures: vec![Picture::new("lost detail", "", &heat.plain())?],
        legend: Some(Legend::new("Texel width by scan detail", " ×", f64::from(MOST_COARSE), ColorMap::Magma)),
    })
}

/// Builds the view that shows how much the removal of noise changed the scan; `None` if none was removed.
fn removed_noise(maps: &[Field]) -> Result<Option<View>> {
    let means = maps.iter().filter_map(Field::mean);
    let top = top_over(means.fold(0.0, f64::max));
    let pictures = maps.iter().zip(["front", "back"]).map(|(field, side)| {
        let heat = HeatMap { field, title: "removed noise", unit: "°", map: ColorMap::Viridis, top };
        Picture::new(side, "", &heat.plain())
    });
    let pictures = pictures.collect::<Result<Vec<_>>>()?;
    Ok((!pictures.is_empty()).then(|| View {
        name: "removed noise".into(),
        note: "The angle between the normals of the scan as given and without its noise, from which the asset was \
               made. All other comparisons are with the scan as given."
            .into(),
        pictures,
        legend: Some(Legend::new("Change of the normals", "°", f64::from(top), ColorMap::Viridis)),
    }))
}

/// Returns the end of a colour scale for differences with this mean.
fn top_over(mean: f64) -> f32 {
    let is_enough = |top: &&f32| f64::from(**top) >= mean * OVER_MEAN;
    *PATCH_TOPS.iter().find(is_enough).unwrap_or(&PATCH_TOPS[PATCH_TOPS.len() - 1])
}

/// Builds the view of rays that missed the scan; `None` if none were recorded.
fn missed_rays(material: &str, textures: &Textures) -> Result<Option<View>> {
    let Some(texels) = &textures.misses else { return Ok(None) };
    Ok(Some(View {
        name: named(material, "missed rays"),
        note: "Texels whose rays missed the scan. Amber: the scan's closest point was used. Red: no hit."
            .into(),
        pictures: vec![Picture::new("missed rays", "", &draw_misses(texels))?],
        legend: None,
    }))
}

/// Draws texels whose rays missed the scan: amber if the closest point was used, red if there was no hit.
fn draw_misses(misses: &Misses) -> Sheet {
    const COVERED: [u8; 3] = [70, 90, 80];
    const CLOSEST: [u8; 3] = [240, 170, 40];
    const LOST: [u8; 3] = [230, 50, 40];
    let color = |texel: &TexelStatus| match texel {
        TexelStatus::Free => GROUND,
        TexelStatus::Met => COVERED,
        TexelStatus::Closest => CLOSEST,
        TexelStatus::Lost => LOST,
    };
    let pixels = misses.texels.iter().map(color).collect();
    Sheet { width: misses.width, height: misses.height, pixels }
}

/// Returns a name, prefixed by its material if the asset has several.
fn named(material: &str, name: &str) -> String {
    if material.is_empty() { name.to_owned() } else { format!("{material}: {name}") }
}

/// How scan and asset look.
struct Look {
    name: &'static str,
    note: &'static str,
}

/// One grey material.
const GREY: Look = Look {
    name: "grey",
    note: "Scan and asset in the same grey material under the same light, to show only shape and normals. FLIP \
           estimates the difference that an observer perceives.",
};

const FULL: Look = Look {
    name: "full",
    note: "Scan and asset in their own materials under the same light, that of the built-in studio if either is \
           metallic. FLIP estimates the difference that an observer perceives.",
};

/// Builds a view of scan and asset from each direction.
fn sides(shots: &Views, look: &Look) -> Result<Vec<View>> {
    (0..shots.figures.len()).map(|i| side(shots, i, look)).collect()
}

/// Builds the view of scan and asset from direction number `i`.
fn side(shots: &Views, i: usize, look: &Look) -> Result<View> {
    let figures = &shots.figures[i];
    let visual_difference = format!("FLIP {:.4}, SSIM {:.4}", figures.flip, figures.ssim);
    Ok(View {
        name: format!("{} {:.0}°", look.name, figures.azimuth_deg),
        note: look.note.into(),
        pictures: vec![
            Picture::to_look_at("scan", "", &Sheet::developed(&shots.scan[i]))?,
            Picture::to_look_at("FLIP", "", &HeatMap::of_flip(&shots.flip[i]).plain())?,
            Picture::to_look_at("asset", visual_difference, &Sheet::developed(&shots.asset[i]))?,
        ],
        legend: Some(Legend::new("FLIP", "", 1.0, ColorMap::Magma)),
    })
}

/// The error map, then the baked maps of each material.
fn maps(proof: &Proof, asset: Option<&Asset>) -> Result<Vec<Picture>> {
    let mut maps = Vec::new();
    let count = asset.map_or(1, |asset| asset.texture_sets().count().max(1));
    let side = (MAP / count.isqrt().next_power_of_two()).max(LEAST_MAP);
    if let Some(errors) = &proof.error_map {
        let sheet = HeatMap::of_angles(errors, ANGLE_TOP).plain().shrunk(side * count);
        maps.push(Picture::to_look_at("normal error", "", &sheet)?);
    }
    for (material, textures) in asset.into_iter().flat_map(Asset::texture_sets) {
        let inside = [("normal", &textures.normal), ("albedo", &textures.color), ("orm", &textures.orm)];
        for (name, bitmap) in inside {
            if let Some(bitmap) = bitmap {
                maps.push(Picture::to_look_at(named(material, name), "", &Sheet::preview(bitmap, side))?);
            }
        }
        for separate in &textures.separate {
            let name = named(material, separate.map.name());
            maps.push(Picture::to_look_at(&name, "", &Sheet::preview(&separate.bitmap, side))?);
        }
    }
    Ok(maps)
}

/// Groups pictures into views by size, since only pictures of equal size can be overlaid.
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
        note:
            "The angle between the normals of asset and scan, in the layout of the maps, and the baked maps."
                .into(),
        pictures,
        legend: Some(Legend::new("Normal error", "°", f64::from(ANGLE_TOP), ColorMap::Viridis)),
    }
}
