//! `report.html`: the page for a comparison, which opens from disk.

use super::document::{Document, Options};
use crate::heat_map::HeatMap;
use crate::sheet::Sheet;
use crate::table::figures;
use crate::{Cell, Column, Fact, Legend, Notice, Page, Picture, Section, Series, Tone, View};
use taotie::comparison::{Comparison, MethodReport, ModelReport, PictureFigures, RenderedSurface};
use taotie_engine::Result;
use taotie_engine::compare::{ColorMap, Summary};
use taotie_engine::names::Named;

/// Builds the page for a comparison with the figures in `report`.
///
/// # Errors
/// [`taotie_engine::Error::Invalid`] if a picture has no pixels.
pub(super) fn page(comparison: &Comparison, report: &Document, options: &Options) -> Result<Page> {
    let subtitle = match &report.subject.reference {
        Some(reference) => format!("Surface methods measured against {reference}"),
        None if !report.is_compared() => format!("Shading models on {}", report.against),
        None => format!(
            "Surface methods measured against the first one, {}, since there is no reference",
            report.against
        ),
    };
    Ok(Page {
        title: options.title.clone(),
        subtitle,
        notices: notices(report),
        facts: facts(report),
        views: views(report, comparison, options.heat_top_deg as f32)?,
        sections: sections(report),
        footer: format!("Made by taotie {}. All figures are in report.json.", report.version),
        ..Page::default()
    })
}

/// Returns notices of the most accurate method, of methods that could not be rendered, and of warnings.
fn notices(report: &Document) -> Vec<Notice> {
    let skipped = report.skipped.iter();
    let skipped =
        skipped.map(|skipped| format!("{} could not be rendered: {}.", skipped.method, skipped.reason));
    let warnings = report.warnings.iter().map(ToString::to_string);
    let wrong = skipped.chain(warnings).map(|text| Notice::new(text, Tone::Changed));
    nearest(report).into_iter().chain(wrong).collect()
}

/// Returns a notice of the method with the smallest mean error away from silhouettes.
fn nearest(report: &Document) -> Option<Notice> {
    let errors = report.methods.iter().filter_map(|method| Some((method.inner_mean()?, &method.method)));
    let (mean, name) = errors.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
    let text = format!(
        "Closest to {}: {name}, with a mean error of {mean:.2}° away from silhouettes.",
        report.against
    );
    Some(Notice::new(text, Tone::Good))
}

fn facts(report: &Document) -> Vec<Fact> {
    let subject = &report.subject;
    let mut facts = vec![
        Fact::new("Model", subject.model.clone()),
        Fact::new("Triangles", subject.triangles.to_string()),
    ];
    if let (Some(reference), Some(triangles)) = (&subject.reference, subject.reference_triangles) {
        facts.push(Fact::new("Reference", reference.clone()));
        facts.push(Fact::new("Reference triangles", triangles.to_string()));
    }
    let size = &report.parameters["size"];
    facts.push(Fact::new("Pictures", format!("{} × {}", size[0], size[1])));
    facts.push(Fact::new("Samples per pixel", report.parameters["samples"].to_string()));
    facts
}

fn views(report: &Document, comparison: &Comparison, top: f32) -> Result<Vec<View>> {
    let mut views = match report.is_compared() {
        true => picture_views(report, comparison)?,
        false => surface_views(&comparison.surfaces[0])?,
    };
    let normals = |surface: &RenderedSurface| Some(Sheet::of_normals(&surface.normals));
    let note = "Shading normals in world space as colours, (n + 1) / 2.";
    views.push(view("normals".into(), note.into(), comparison, &normals)?);
    let errors = |surface: &RenderedSurface| {
        surface.difference.as_ref().map(|difference| HeatMap::of_angles(&difference.angles, top).plain())
    };
    let note = format!("Angle between the shading normal and that of {}.", report.against);
    let view = view("angular error".into(), note, comparison, &errors)?;
    let legend = Legend::new("Angular error", "°", f64::from(top), ColorMap::Viridis);
    views.push(View { legend: Some(legend), ..view });
    // A surface without a counterpart has no differences.
    views.retain(|view| !view.pictures.is_empty());
    Ok(views)
}

/// Builds the views of a single surface: its shading models side by side, and their differences from the baseline.
fn surface_views(surface: &RenderedSurface) -> Result<Vec<View>> {
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

/// Returns the views of pictures and of their differences for each shading model.
fn picture_views(report: &Document, comparison: &Comparison) -> Result<Vec<View>> {
    let mut views = Vec::new();
    for (i, picture) in report.methods[0].pictures.iter().enumerate() {
        let shading = &picture.shading;
        let developed = |surface: &RenderedSurface| Some(Sheet::developed(&surface.pictures[i].1));
        let note = format!("Each surface under the shading model {shading}, in the same light.");
        views.push(view(shading.clone(), note, comparison, &developed)?);
        let flip = |surface: &RenderedSurface| {
            surface
                .difference
                .as_ref()
                .map(|difference| HeatMap::of_flip(&difference.pictures[i].flip).plain())
        };
        let note = format!("FLIP estimates the perceived difference from {}.", report.against);
        let view = view(format!("{shading}: FLIP"), note, comparison, &flip)?;
        views.push(View { legend: Some(Legend::new("FLIP", "", 1.0, ColorMap::Magma)), ..view });
    }
    let models = report.methods[0].models.iter().enumerate();
    let models = models.map(|(i, model)| model_view(model, i, comparison));
    views.extend(models.collect::<Result<Vec<View>>>()?);
    Ok(views)
}

/// Returns the view of the difference that the `i`th shading model makes to each surface.
fn model_view(model: &ModelReport, i: usize, comparison: &Comparison) -> Result<View> {
    let ModelReport { shading, baseline, .. } = model;
    let flip = |surface: &RenderedSurface| {
        Some(HeatMap::of_flip(&surface.model_differences.get(i)?.picture.flip).plain())
    };
    let note = format!(
        "FLIP estimates the perceived difference between each surface's picture under {shading} \
                        and its picture under {baseline}."
    );
    let view = view(format!("{shading}: FLIP against {baseline}"), note, comparison, &flip)?;
    Ok(View { legend: Some(Legend::new("FLIP", "", 1.0, ColorMap::Magma)), ..view })
}

fn view(
    name: String,
    note: String,
    comparison: &Comparison,
    pixels: &dyn Fn(&RenderedSurface) -> Option<Sheet>,
) -> Result<View> {
    let mut pictures = Vec::new();
    for surface in &comparison.surfaces {
        let Some(pixels) = pixels(surface) else { continue };
        pictures.push(Picture::new(surface.id(), surface.describe(), &pixels)?);
    }
    Ok(View { name, note, pictures, legend: None })
}

fn sections(report: &Document) -> Vec<Section> {
    let mut sections = Vec::new();
    if report.is_compared() {
        sections.extend([error_table(report), histogram(report)]);
        let shadings = 0..report.methods[0].pictures.len();
        sections.extend(shadings.map(|i| picture_table(report, i)));
    }
    sections.extend(model_table(report));
    if !report.points.is_empty() {
        sections.push(normals_table(report));
        sections.push(angles_table(report));
    }
    sections.push(remarks(report));
    sections
}

fn error_table(report: &Document) -> Section {
    let figures = ["mean", "median", "95 %", "max"];
    let mut columns = vec![Column::words("method")];
    columns.extend(figures.map(|figure| Column::numbers(figure, "°")));
    columns.extend(figures.map(|figure| Column::numbers(format!("{figure}, inner"), "°")));
    let row = |method: &MethodReport| {
        let error = method.error.as_ref()?;
        let mut cells = vec![Cell::text(method.method.clone())];
        for summary in [&error.all, &error.inner] {
            cells.extend(figure_cells(summary.as_ref()));
        }
        Some(cells)
    };
    Section::Table {
        title: "Angular error".into(),
        note: format!(
            "The angle to the normals of {}, over all pixels with a corresponding point there ({:.2} % of samples \
             have none). Columns marked “inner” exclude pixels near silhouettes.",
            report.against,
            report.unmatched * 100.0
        ),
        columns,
        rows: report.methods.iter().filter_map(row).collect(),
    }
}

fn figure_cells(summary: Option<&Summary>) -> [Cell; 4] {
    match summary.map(figures) {
        Some(numbers) => numbers.map(|figure| Cell::number(figure, 2)),
        None => std::array::from_fn(|_| Cell::Number { value: None, digits: 2 }),
    }
}

fn histogram(report: &Document) -> Section {
    let series = report.methods.iter().filter_map(|method| {
        let counts = method.error.as_ref()?.histogram.clone();
        Some(Series { label: method.method.clone(), counts })
    });
    Section::Histogram {
        title: "Histograms of angular error".into(),
        note: format!("Number of pixels by angle to {}; one bin per degree.", report.against),
        unit: "°".into(),
        bin_width: 1.0,
        last_is_open: true,
        series: series.collect(),
    }
}

/// Returns the table comparing pictures under one shading model with those of the surface all are measured against.
fn picture_table(report: &Document, i: usize) -> Section {
    let row = |method: &MethodReport| {
        let difference = method.pictures[i].difference.as_ref()?;
        Some([vec![Cell::text(method.method.clone())], picture_cells(difference)].concat())
    };
    Section::Table {
        title: format!("Shaded pictures, {}", report.methods[0].pictures[i].shading),
        note: format!(
            "Compared with {}, over the pixels that show either, not the background.",
            report.against
        ),
        columns: [vec![Column::words("method")], picture_columns()].concat(),
        rows: report.methods.iter().filter_map(row).collect(),
    }
}

/// Returns the table comparing the shading models with the baseline; `None` without a baseline.
fn model_table(report: &Document) -> Option<Section> {
    let baseline = &report.methods[0].models.first()?.baseline;
    let names = |method: &MethodReport, model: &ModelReport| {
        vec![Cell::text(method.method.clone()), Cell::text(model.shading.clone())]
    };
    let row = |method: &MethodReport, model: &ModelReport| {
        [names(method, model), picture_cells(&model.difference)].concat()
    };
    let rows = report.methods.iter().flat_map(|method| method.models.iter().map(move |m| row(method, m)));
    Some(Section::Table {
        title: format!("Shading models against {baseline}"),
        note: format!(
            "Each surface's picture compared with its picture under {baseline}, over the pixels that show the surface, \
             not the background."
        ),
        columns: [vec![Column::words("method"), Column::words("shading")], picture_columns()].concat(),
        rows: rows.collect(),
    })
}

fn picture_columns() -> Vec<Column> {
    let flip =
        ["FLIP mean", "FLIP median", "FLIP 95 %", "FLIP max"].map(|figure| Column::numbers(figure, ""));
    let others = [("RMSE", ""), ("PSNR", "dB"), ("SSIM", "")];
    others.into_iter().map(|(figure, unit)| Column::numbers(figure, unit)).chain(flip).collect()
}

fn picture_cells(difference: &PictureFigures) -> Vec<Cell> {
    let mut cells = vec![
        Cell::number(difference.rmse, 4),
        Cell::Number { value: difference.psnr, digits: 2 },
        Cell::number(difference.ssim, 4),
    ];
    cells.extend(match difference.flip.as_ref().map(figures) {
        Some(flip) => flip.map(|figure| Cell::number(figure, 4)),
        None => std::array::from_fn(|_| Cell::Number { value: None, digits: 4 }),
    });
    cells
}

/// Table 2 of Guo and Wang 2025 for this model.
fn normals_table(report: &Document) -> Section {
    let mut columns = point_columns();
    for method in &report.methods {
        columns.extend(["x", "y", "z"].map(|axis| Column::numbers(format!("{} {axis}", method.method), "")));
    }
    let rows = report.points.iter().enumerate().map(|(i, point)| {
        let mut cells = point_cells(i, point.pixel);
        for normal in &point.normals {
            let component = |axis: usize| normal.normal.map(|n| f64::from(n[axis]));
            cells.extend([0, 1, 2].map(|axis| Cell::Number { value: component(axis), digits: 4 }));
        }
        cells
    });
    Section::Table {
        title: "Normals at sample points".into(),
        note: "Unit normals in world space, in the form of Table 2 of Guo and Wang 2025.".into(),
        columns,
        rows: rows.collect(),
    }
}

/// Table 3 of Guo and Wang 2025 for this model.
fn angles_table(report: &Document) -> Section {
    let first = &report.methods[0].method;
    let mut columns = point_columns();
    let others = || report.methods.iter().skip(1).enumerate();
    columns.extend(others().map(|(i, m)| Column::numbers(format!("θ{} {}", i + 1, m.method), "°")));
    let rows = report.points.iter().enumerate().map(|(i, point)| {
        let mut cells = point_cells(i, point.pixel);
        let angles = point.normals.iter().skip(1);
        cells.extend(angles.map(|normal| Cell::Number { value: normal.angle_to_first, digits: 2 }));
        cells
    });
    Section::Table {
        title: format!("Angles to {first} at sample points"),
        note: format!(
            "Between each normal and that of {first}, in the form of Table 3 of Guo and Wang 2025."
        ),
        columns,
        rows: rows.collect(),
    }
}

fn point_columns() -> Vec<Column> {
    vec![Column::numbers("point", ""), Column::numbers("x", "px"), Column::numbers("y", "px")]
}

fn point_cells(index: usize, [x, y]: [u32; 2]) -> Vec<Cell> {
    [index as f64 + 1.0, x.into(), y.into()].map(|value| Cell::number(value, 0)).into()
}

fn remarks(report: &Document) -> Section {
    let mut paragraphs = report.rules.in_words();
    paragraphs.extend(report.notes.iter().cloned());
    let skipped = report.skipped.iter();
    paragraphs.extend(
        skipped.map(|skipped| format!("{} could not be rendered: {}.", skipped.method, skipped.reason)),
    );
    Section::Text { title: "How it was measured".into(), paragraphs }
}
