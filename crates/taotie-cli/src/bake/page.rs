//! `OUT.report.html`: the proof as a page that opens from disk.

use super::pictures;
use anyhow::Result;
use taotie::asset::{BIN_WIDTH, Figures, Met, Proof, Report, StageTime, Textures, ViewFigures, Warning};
use taotie::compare::{ColorMap, Summary};
use taotie::names::Named;
use taotie_report::heat_map::HeatMap;
use taotie_report::sheet::Sheet;
use taotie_report::{Cell, Column, Fact, Legend, Page, Picture, Section, Series, Tone, View};

/// Pixels along a side of the pictures of maps.
const MAP: usize = 1024;
/// The last colour of the map of errors stands for this many degrees.
const TOP: f32 = 10.0;

/// The page of a bake.
///
/// # Errors
/// Where a picture cannot be encoded.
pub fn page(report: &Report, proof: &Proof, textures: &Textures) -> Result<Page> {
    let figures = &proof.figures;
    let title = std::path::Path::new(&report.high).file_name().unwrap_or_default().to_string_lossy();
    Ok(Page {
        title: title.into_owned(),
        subtitle: "The scan, and the light asset that stands for it".into(),
        facts: facts(report, figures),
        views: views(proof, textures)?,
        sections: sections(report, figures),
        footer: format!(
            "Made by taotie {}. All figures stand in the .json file beside this page.",
            report.version
        ),
    })
}

fn facts(report: &Report, proof: &Figures) -> Vec<Fact> {
    let triangles = report.triangles.first().copied().unwrap_or_default();
    let mut facts = vec![
        Fact::new("Scan", format!("{} triangles, {} bytes", report.high_triangles, proof.bytes_in)),
        Fact::new("Asset", format!("{triangles} triangles, {} bytes", proof.bytes_out)),
        Fact::new("Maps", format!("{} × {}", report.size[0], report.size[1])),
    ];
    if let Some(angles) = &proof.angles {
        facts.push(Fact::new("Normals off, mean", format!("{:.2}°", angles.mean)));
    }
    facts.push(Fact::new("Texels that missed", format!("{:.3} %", proof.missed_texels * 100.0)));
    facts.push(Fact::new(
        "Shape off, at most",
        format!("{:.3} % of the diagonal", proof.hausdorff_of_diagonal * 100.0),
    ));
    facts
}

fn views(proof: &Proof, textures: &Textures) -> Result<Vec<View>> {
    let mut views = Vec::new();
    let shots = &proof.views;
    for (i, ((scan, asset), flip)) in shots.scan.iter().zip(&shots.asset).zip(&shots.flip).enumerate() {
        let figures = shots.figures[i];
        views.push(View {
            name: format!("{:.0}°", figures.azimuth_deg),
            note: "Scan and asset of one grey material in the same light, and what an observer sees of the difference."
                .into(),
            pictures: vec![
                Picture::new("scan", "", &Sheet::developed(scan))?,
                Picture::new("FLIP", "", &HeatMap::of_flip(flip).plain())?,
                Picture::new("asset", seen(&figures), &Sheet::developed(asset))?,
            ],
            legend: Some(Legend::new("FLIP", "", 1.0, ColorMap::Magma)),
        });
    }
    let mut maps = vec![Picture::new("error", "", &HeatMap::of_angles(&proof.error_map, TOP).plain())?];
    let inside = [("normal", &textures.normal), ("albedo", &textures.color), ("orm", &textures.orm)];
    for (name, bitmap) in inside {
        if let Some(bitmap) = bitmap {
            maps.push(Picture::new(name, "", &Sheet::preview(bitmap, MAP))?);
        }
    }
    for beside in &textures.beside {
        maps.push(Picture::new(beside.map.name(), "", &Sheet::preview(&beside.bitmap, MAP))?);
    }
    let note = "Degrees between the normals of asset and scan on the map; and the maps themselves.";
    let scale = Some(Legend::new("Angular error", "°", f64::from(TOP), ColorMap::Viridis));
    views.extend(sized(&maps).into_iter().enumerate().map(|(i, pictures)| View {
        name: if i == 0 { "maps".into() } else { format!("maps {}", i + 1) },
        note: note.into(),
        pictures,
        legend: scale.clone(),
    }));
    if let Some(misses) = &textures.misses {
        views.push(View {
            name: "misses".into(),
            note: "Texels whose rays missed the scan: amber took the closest point of it, red found nothing."
                .into(),
            pictures: vec![Picture::new("misses", "", &pictures::misses(misses))?],
            legend: None,
        });
    }
    Ok(views)
}

/// Pictures in groups of one size: only those can be laid over one another.
fn sized(pictures: &[Picture]) -> Vec<Vec<Picture>> {
    let mut groups: Vec<Vec<Picture>> = Vec::new();
    for picture in pictures {
        match groups.iter_mut().find(|group| group[0].size() == picture.size()) {
            Some(group) => group.push(picture.clone()),
            None => groups.push(vec![picture.clone()]),
        }
    }
    groups
}

fn seen(figures: &ViewFigures) -> String {
    format!("FLIP {:.4}, SSIM {:.4}", figures.flip, figures.ssim)
}

fn sections(report: &Report, proof: &Figures) -> Vec<Section> {
    let mut sections = Vec::new();
    if !report.required.is_empty() {
        sections.push(required(report));
    }
    sections.extend([angles(proof), histogram(proof), shape(proof), views_table(proof), stages(report)]);
    let warnings: Vec<String> = report.warnings.iter().map(warning).collect();
    if !warnings.is_empty() {
        sections.push(Section::Text { title: "Warnings".into(), paragraphs: warnings });
    }
    sections
}

fn warning(warning: &Warning) -> String {
    match warning.count {
        1 => warning.what.clone(),
        count => format!("{} ({count} times)", warning.what),
    }
}

fn required(report: &Report) -> Section {
    let row = |met: &Met| {
        let (text, tone) = if met.met { ("met", Tone::Good) } else { ("not met", Tone::Bad) };
        vec![
            Cell::text(met.figure.name()),
            met.value.map_or_else(|| Cell::text("not measured"), |value| Cell::number(value, 4)),
            Cell::number(met.most, 4),
            Cell::Mark { text: text.into(), tone, why: String::new() },
        ]
    };
    Section::Table {
        title: "Required".into(),
        note: String::new(),
        columns: vec![
            Column::words("figure"),
            Column::numbers("is", ""),
            Column::numbers("at most", ""),
            Column::words("verdict"),
        ],
        rows: report.required.iter().map(row).collect(),
    }
}

fn angles(proof: &Figures) -> Section {
    let figures = ["mean", "median", "95 %", "max"];
    let mut columns = vec![Column::words("normals of")];
    columns.extend(figures.map(|figure| Column::numbers(figure, "°")));
    let rows = [("the asset", &proof.angles), ("its mesh without the map", &proof.without_map)];
    let row = |(name, spread): (&str, &Option<Summary>)| {
        let spread = spread.as_ref()?;
        let numbers = [spread.mean, spread.median, spread.p95, spread.max];
        Some([Cell::text(name)].into_iter().chain(numbers.map(|v| Cell::number(v, 3))).collect())
    };
    Section::Table {
        title: "Angular error".into(),
        note: format!(
            "Degrees to the scan's normals, at points spread evenly over the asset, as it was written and read back. \
             Eight bits cost {}° on the average and {}° at most; dithering adds to the first and takes steps out of \
             gentle curves.",
            proof.floor_8_bit[0], proof.floor_8_bit[1]
        ),
        columns,
        rows: rows.into_iter().filter_map(row).collect(),
    }
}

fn histogram(proof: &Figures) -> Section {
    Section::Histogram {
        title: "Histogram of angular error".into(),
        note: "Points by their angle to the scan; the last bin holds all that is larger.".into(),
        unit: "°".into(),
        bin_width: BIN_WIDTH,
        last_is_open: true,
        series: vec![Series { label: "asset".into(), counts: proof.histogram.clone() }],
    }
}

fn shape(proof: &Figures) -> Section {
    let row = |name: &str, value: f64, digits: usize, unit: &str| {
        vec![Cell::text(name), Cell::number(value, digits), Cell::text(unit)]
    };
    let mut rows = vec![
        row("largest distance (Hausdorff)", proof.hausdorff, 6, "model units"),
        row("largest distance", proof.hausdorff_of_diagonal * 100.0, 4, "% of the diagonal"),
        row("root mean square distance", proof.rms, 6, "model units"),
        row("root mean square distance", proof.rms_of_diagonal * 100.0, 4, "% of the diagonal"),
        row("texels with a ray that missed", proof.missed_texels * 100.0, 4, "%"),
        row("samples that took the closest point", proof.fallback * 100.0, 4, "%"),
        row("samples that found nothing", proof.lost * 100.0, 4, "%"),
        row("map covered by charts", proof.uv_use * 100.0, 1, "%"),
    ];
    if let Some(density) = &proof.density {
        rows.push(row("texel density, median", density.median, 2, "texels a model unit"));
    }
    Section::Table {
        title: "Shape, rays and map".into(),
        note: "Distances from points spread evenly over each surface to the other.".into(),
        columns: vec![Column::words("what"), Column::numbers("value", ""), Column::words("unit")],
        rows,
    }
}

fn views_table(proof: &Figures) -> Section {
    let row = |view: &ViewFigures| {
        vec![
            Cell::number(view.azimuth_deg, 0),
            Cell::number(view.elevation_deg, 0),
            Cell::number(view.flip, 4),
            Cell::number(view.ssim, 4),
        ]
    };
    Section::Table {
        title: "Views".into(),
        note: "Pixel by pixel, so these figures count where the light mesh lies beside the scan as well."
            .into(),
        columns: vec![
            Column::numbers("azimuth", "°"),
            Column::numbers("elevation", "°"),
            Column::numbers("FLIP", ""),
            Column::numbers("SSIM", ""),
        ],
        rows: proof.views.iter().map(row).collect(),
    }
}

fn stages(report: &Report) -> Section {
    let row = |stage: &StageTime| vec![Cell::text(stage.stage), Cell::number(stage.milliseconds, 1)];
    Section::Table {
        title: "Time".into(),
        note: String::new(),
        columns: vec![Column::words("stage"), Column::numbers("time", "ms")],
        rows: report.stages.iter().map(row).collect(),
    }
}
