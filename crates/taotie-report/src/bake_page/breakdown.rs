//! The tables that show where the errors of an asset are: its share of surface beyond limits, its worst parts, its
//! materials, and its levels of detail.

use crate::table::map_error_texts;
use crate::{Cell, Column, Section};
use taotie::asset::{
    Beyond, Figures, LevelFigures, PartFigures, PartFlip, PartKind, Report, ViewFigures, WorstParts,
};
use taotie_engine::compare::Summary;
use taotie_engine::length::place_text;
use taotie_engine::proof::{Estimate, Exceedance, PatchQuantity, Region, WorstRegions};

/// The limits to report: degrees, CIEDE2000 and per cent of the diagonal.
const ANGLES: &[f64] = &[1.0, 2.0, 5.0, 10.0, 20.0];
const COLORS: &[f64] = &[1.0, 2.0, 3.0, 5.0, 10.0];
const DISTANCES: &[f64] = &[0.1, 0.2, 0.5, 1.0];

/// Builds the table of the shares of the surface beyond limits; `None` if nothing was compared.
pub(super) fn beyond(beyond: &Beyond) -> Option<Section> {
    let curves = [
        ("angle between normals", "°", ANGLES, &beyond.angle),
        ("colour difference", "ΔE00", COLORS, &beyond.color),
        ("distance", "% of the diagonal", DISTANCES, &beyond.distance),
    ];
    let rows = curves.into_iter().flat_map(|(name, unit, limits, curve)| {
        curve
            .iter()
            .flat_map(move |curve| limits.iter().map(move |limit| row_of_limit(name, (*limit, unit), curve)))
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

fn row_of_limit(name: &str, (limit, unit): (f64, &str), curve: &Exceedance) -> Vec<Cell> {
    let share = curve.beyond(limit);
    let [low, high] = share.interval;
    let percent = [share.value, low, high].map(|share| Cell::number(share * 100.0, 3));
    [Cell::text(name), Cell::number(limit, 1), Cell::text(unit)].into_iter().chain(percent).collect()
}

/// Builds the table of the worst UV island and material with their FLIP; `None` if there is only one of each.
pub(super) fn worst_parts(figures: &Figures, parts: &WorstParts, flips: &[PartFlip]) -> Option<Section> {
    let island = |number: usize| format!("UV island {number}");
    let material = |number: usize| parts.material_names.get(number).cloned().unwrap_or_default();
    let flip_of = |part: PartKind, of: PatchQuantity| {
        flips.iter().find(|found| (found.part, found.of) == (part, of)).map(|found| found.flip)
    };
    let of_island = |of| flip_of(PartKind::Island, of);
    let of_material = |of| flip_of(PartKind::Material, of);
    let of_islands =
        parts.islands.iter().flat_map(|worst| rows_of_regions(worst, (figures, &island), &of_island));
    let of_materials =
        parts.materials.iter().flat_map(|worst| rows_of_regions(worst, (figures, &material), &of_material));
    let rows: Vec<Vec<Cell>> = of_islands.chain(of_materials).collect();
    (!rows.is_empty()).then(|| Section::Table {
        title: "Worst parts of the asset".into(),
        note: note_of_parts(parts),
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

fn note_of_parts(parts: &WorstParts) -> String {
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

fn rows_of_regions(
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

/// Builds the table of all materials; `None` if there is only one.
pub(super) fn materials(parts: &[PartFigures]) -> Option<Section> {
    (!parts.is_empty()).then(|| Section::Table {
        title: "Materials".into(),
        note: "The triangles of each material of the low-poly mesh, with the maps baked for it. The error map stacks \
               the materials from top to bottom in this order."
            .into(),
        columns: columns_of_normals(Column::words("material")),
        rows: parts.iter().map(|part| cells_of_normals(Cell::text(part.material.as_str()), part)).collect(),
    })
}

/// Builds the table of the maps that no other figure covers; `None` if there are none.
pub(super) fn maps(report: &Report) -> Option<Section> {
    let mut rows = Vec::new();
    for (note, error) in report.maps.iter().filter_map(|note| Some((note, note.error.as_ref()?))) {
        let file = match note.file.as_deref() {
            Some(file) => file.file_name().unwrap_or_default().to_string_lossy(),
            None => "in the model file".into(),
        };
        let words = [&note.title(), note.material.as_deref().unwrap_or(""), &file].map(Cell::text);
        let numbers = map_error_texts(error, report.unit).map(Cell::text);
        let unseen = Cell::number(error.unseen * 100.0, 1);
        rows.push(words.into_iter().chain(numbers).chain([unseen]).collect());
    }
    let words = ["map", "material", "file", "mean", "p95", "max"].map(Column::words);
    let columns = words.into_iter().chain([Column::numbers("points that see no scan", "%")]).collect();
    (!rows.is_empty()).then(|| Section::Table {
        title: "Errors of other maps".into(),
        note: "Each map as its file stores it, at points spread over the low-poly mesh, compared with the scan straight along \
               the normal of the triangle, or at the same UV if these are matched. Occlusion and thickness are integrated \
               again, over 512 other directions. A packed channel is compared with what it holds, before it is inverted."
            .into(),
        columns,
        rows,
    })
}

/// Builds the table of all levels; `None` if there is only one.
pub(super) fn levels(levels: &[LevelFigures]) -> Option<Section> {
    let further = [
        Column::numbers("seen at", "pixels across"),
        Column::numbers("overview, mean", "°"),
        Column::numbers("close-up, worst 1 %", "°"),
        Column::numbers("shape error, at most", "% of the diagonal"),
        Column::numbers("colour error, overview, mean", "ΔE00"),
        Column::numbers("FLIP", ""),
        Column::numbers("SSIM", ""),
    ];
    (levels.len() > 1).then(|| Section::Table {
        title: "Levels of detail".into(),
        note: "Each level, as written and read back, compared with the scan. A level replaces the previous one when \
               the object is “seen at” this size on a 3840 × 2160 screen, which is also its size in the overview. \
               FLIP and SSIM are means over all grey views."
            .into(),
        columns: columns_of_normals(Column::numbers("level", "")).into_iter().chain(further).collect(),
        rows: levels.iter().enumerate().map(row_of_level).collect(),
    })
}

fn row_of_level((level, figures): (usize, &LevelFigures)) -> Vec<Cell> {
    let mean_of = |estimate: &Option<Estimate>| estimate.as_ref().map(|of| of.summary.mean);
    let further = [
        Cell::number(f64::from(figures.overview.across), 0),
        Cell::Number { value: mean_of(&figures.overview.angles), digits: 3 },
        Cell::Number { value: figures.patches.angle.map(|patch| patch.mean), digits: 2 },
        Cell::number(figures.hausdorff_of_diagonal.upper * 100.0, 4),
        Cell::Number { value: mean_of(&figures.overview.color), digits: 3 },
        mean_of_views(&figures.views, |view| view.flip),
        mean_of_views(&figures.views, |view| view.ssim),
    ];
    cells_of_normals(Cell::number(level as f64, 0), figures).into_iter().chain(further).collect()
}

fn mean_of_views(views: &[ViewFigures], of: fn(&ViewFigures) -> f64) -> Cell {
    let sum: f64 = views.iter().map(of).sum();
    Cell::Number { value: (!views.is_empty()).then(|| sum / views.len() as f64), digits: 4 }
}

/// The figures for a row of materials or of levels: triangles, normal errors, and missed rays.
struct NormalErrors<'a> {
    triangles: usize,
    angles: Option<&'a Summary>,
    without_map: Option<&'a Summary>,
    missed: f64,
}

impl<'a> From<&'a PartFigures> for NormalErrors<'a> {
    fn from(part: &'a PartFigures) -> Self {
        Self {
            triangles: part.triangles,
            angles: part.angles.as_ref(),
            without_map: part.without_map.as_ref(),
            missed: part.missed,
        }
    }
}

impl<'a> From<&'a LevelFigures> for NormalErrors<'a> {
    fn from(level: &'a LevelFigures) -> Self {
        Self {
            triangles: level.triangles,
            angles: level.surface_angles.as_ref(),
            without_map: level.without_map.as_ref(),
            missed: level.surface_missed,
        }
    }
}

/// Returns the columns, starting with `subject`, which names the row.
fn columns_of_normals(subject: Column) -> Vec<Column> {
    vec![
        subject,
        Column::numbers("triangles", ""),
        Column::numbers("normal error on the surface, mean", "°"),
        Column::numbers("95 %", "°"),
        Column::numbers("max", "°"),
        Column::numbers("without map, mean", "°"),
        Column::numbers("points with a missed ray", "%"),
    ]
}

/// Returns the cells, starting with `subject`.
fn cells_of_normals<'a>(subject: Cell, figures: impl Into<NormalErrors<'a>>) -> Vec<Cell> {
    let figures = figures.into();
    let degrees = |value: Option<f64>| Cell::Number { value, digits: 3 };
    vec![
        subject,
        Cell::number(figures.triangles as f64, 0),
        degrees(figures.angles.map(|angles| angles.mean)),
        degrees(figures.angles.map(|angles| angles.p95)),
        degrees(figures.angles.map(|angles| angles.max)),
        degrees(figures.without_map.map(|angles| angles.mean)),
        Cell::number(figures.missed * 100.0, 3),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_levels_have_a_row_each() {
        let level = |triangles: usize| {
            let mut level = LevelFigures::default();
            level.triangles = triangles;
            level.hausdorff_of_diagonal.upper = 0.01;
            level
        };
        assert_eq!(levels(&[level(300)]), None, "the other tables cover a single level");
        let Some(Section::Table { columns, rows, .. }) = levels(&[level(300), level(20)]) else {
            panic!("expected a table for two levels")
        };
        assert!(rows.len() == 2 && rows.iter().all(|row| row.len() == columns.len()));
        assert_eq!(rows[1][..2], [Cell::number(1.0, 0), Cell::number(20.0, 0)]);
        assert_eq!(rows[1][2], Cell::Number { value: None, digits: 3 }, "no angle was measured");
        assert_eq!(rows[1][7], Cell::number(512.0, 0), "pixels across");
        assert_eq!(rows[1][10], Cell::number(1.0, 4), "per cent");
    }
}
