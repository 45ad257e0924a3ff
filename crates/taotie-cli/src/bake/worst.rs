//! The worst parts of an asset, and its share beyond limits, as text.

use taotie::asset::{Beyond, Figures, WorstParts};
use taotie_engine::length::place_text;
use taotie_engine::proof::{Region, WorstRegions};
use taotie_report::table::Table;

/// Adds the shares of the surface beyond the usual limits.
pub fn beyond(beyond: &Beyond, table: &mut Table) {
    let curves = [
        (&beyond.angle, 5.0, "beyond 5°"),
        (&beyond.angle, 10.0, "beyond 10°"),
        (&beyond.color, 3.0, "beyond ΔE 3"),
    ];
    let shares: Vec<String> = curves
        .into_iter()
        .filter_map(|(curve, limit, words)| {
            let share = curve.as_ref()?.beyond(limit);
            let [low, high] = share.interval.map(|bound| bound * 100.0);
            Some(format!("{:.2} % {words} ({low:.2} to {high:.2})", share.value * 100.0))
        })
        .collect();
    if !shares.is_empty() {
        table.row(["share of the surface".into(), shares.join("; ")]);
    }
}

/// Adds the worst UV island and the worst material.
pub fn parts(figures: &Figures, parts: &WorstParts, table: &mut Table) {
    let place = |region: &Region| place_text(region.center, figures.diagonal, figures.unit);
    if let Some(islands) = &parts.islands {
        let name = |number: usize| format!("island {number} of {}", islands.count);
        let mut text = worst(islands, &name, &place);
        if islands.skipped > 0 {
            text += &format!("; {} islands are too small to compare", islands.skipped);
        }
        table.row(["worst UV island".into(), text]);
    }
    if let Some(materials) = &parts.materials {
        let name = |number: usize| parts.material_names.get(number).cloned().unwrap_or_default();
        table.row(["worst material".into(), worst(materials, &name, &place)]);
    }
}

fn worst(
    regions: &WorstRegions,
    name: &dyn Fn(usize) -> String,
    place: &dyn Fn(&Region) -> String,
) -> String {
    let words = |(region, before, after): (&Option<Region>, &str, &str)| {
        let region = region.as_ref()?;
        let Region { number, mean, share, .. } = region;
        let (name, share, place) = (name(*number), share * 100.0, place(region));
        Some(format!("{before}{mean:.2}{after} on {name} ({share:.2} % of the area) around {place}"))
    };
    let found = [(&regions.angle, "", "°"), (&regions.color, "ΔE ", "")];
    let found: Vec<String> = found.into_iter().filter_map(words).collect();
    if found.is_empty() { "could not be measured".into() } else { found.join("; ") }
}
