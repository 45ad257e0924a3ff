//! The worst parts of an asset, and the share of its surface beyond limits.

use crate::{Cell, Column, Section};
use taotie::asset::{Beyond, Figures, PartFlip, PartKind, WorstParts};
use taotie_engine::length::place_text;
use taotie_engine::proof::{Exceedance, PatchQuantity, Region, WorstRegions};

/// The limits to report: degrees, CIEDE2000 and per cent of the diagonal.
const ANGLES: &[f64] = &[1.0, 2.0, 5.0, 10.0, 20.0];
const COLORS: &[f64] = &[1.0, 2.0, 3.0, 5.0, 10.0];
const DISTANCES: &[f64] = &[0.1, 0.2, 0.5, 1.0];

/// Builds the table of the shares of the surface beyond limits; `None` if nothing was compared.
pub fn beyond(beyond: &Beyond) -> Option<Section> {
    let curves = [
        ("angle between normals", "°", ANGLES, &beyond.angle),
        ("colour difference", "ΔE00", COLORS, &beyond.color),
        ("distance", "% of the diagonal", DISTANCES, &beyond.distance),
    ];
    let rows = curves.into_iter().flat_map(|(name, unit, limits, curve)| {
        curve.iter().flat_map(move |curve| limits.iter().map(move |limit| row(name, (*limit, unit), curve)))
    });
    let rows: Vec<Vec<Cell>> = rows.collect();
    (!rows.is_empty()).then(|| Section::Table {
        title: "Share of the surface beyond limits".into(),
        note: "Share of the visible surface, seen close up, with its 99 % interval; the worse of scan and asset. \
               --require within-5deg=99% requires that at most 1 % is beyond 5°."
            .into(),
        columns: vec![
            Column::words("figure"),
            Column::numbers("limit", ""),
            Column::words("unit"),
            Column::numbers("beyond", "%"),
            Column::numbers("at least", "%"),
            Column::numbers("at most", "%"),
        ],
        rows,
    })
}

fn row(name: &str, (limit, unit): (f64, &str), curve: &Exceedance) -> Vec<Cell> {
    let share = curve.beyond(limit);
    let [low, high] = share.interval;
    let percent = [share.value, low, high].map(|share| Cell::number(share * 100.0, 3));
    [Cell::text(name), Cell::number(limit, 1), Cell::text(unit)].into_iter().chain(percent).collect()
}

/// Builds the table of the worst UV island and material with their FLIP; `None` if there is only one of each.
pub fn parts(figures: &Figures, parts: &WorstParts, flips: &[PartFlip]) -> Option<Section> {
    let island = |number: usize| format!("UV island {number}");
    let material = |number: usize| parts.material_names.get(number).cloned().unwrap_or_default();
    let flip_of = |part: PartKind, of: PatchQuantity| {
        flips.iter().find(|found| (found.part, found.of) == (part, of)).map(|found| found.flip)
    };
    let of_island = |of| flip_of(PartKind::Island, of);
    let of_material = |of| flip_of(PartKind::Material, of);
    let of_islands = parts.islands.iter().flat_map(|worst| rows(worst, (figures, &island), &of_island));
    let of_materials =
        parts.materials.iter().flat_map(|worst| rows(worst, (figures, &material), &of_material));
    let rows: Vec<Vec<Cell>> = of_islands.chain(of_materials).collect();
    (!rows.is_empty()).then(|| Section::Table {
        title: "Worst parts of the asset".into(),
        note: note(parts),
        columns: vec![
            Column::words("part"),
            Column::words("figure"),
            Column::numbers("mean", ""),
            Column::numbers("at least", ""),
            Column::numbers("at most", ""),
            Column::numbers("share of the area", "%"),
            Column::words("location"),
            Column::numbers("FLIP of its worst window", ""),
        ],
        rows,
    })
}

fn note(parts: &WorstParts) -> String {
    let mut note =
        "The UV island and the material with the largest mean difference, seen close up and measured again at \
                    separate points, with 99 % intervals. FLIP is the mean over close-ups of the 1 % of the surface \
                    where the part differs most, rendered like those of the worst patches at half the resolution."
            .to_owned();
    if let Some(WorstRegions { count, skipped, .. }) = &parts.islands {
        note += &format!(" {skipped} of {count} UV islands are too small to compare.");
    }
    note
}

fn rows(
    worst: &WorstRegions,
    (all, name): (&Figures, &dyn Fn(usize) -> String),
    flip_of: &dyn Fn(PatchQuantity) -> Option<f64>,
) -> Vec<Vec<Cell>> {
    let figures = [
        ("normals (°)", PatchQuantity::Angle, &worst.angle),
        ("colours (ΔE00)", PatchQuantity::Color, &worst.color),
    ];
    let row = |(figure, of, region): (&str, PatchQuantity, &Option<Region>)| {
        let region = region.as_ref()?;
        let place = place_text(region.center, all.diagonal, all.unit);
        let numbers = [region.mean, region.interval[0], region.interval[1], region.share * 100.0];
        let words = [Cell::text(name(region.number)), Cell::text(figure)];
        let cells = words.into_iter().chain(numbers.map(|value| Cell::number(value, 3)));
        Some(cells.chain([Cell::text(place), Cell::Number { value: flip_of(of), digits: 4 }]).collect())
    };
    figures.into_iter().filter_map(row).collect()
}
