//! A bake in plain words.

use std::fmt::Write;
use taotie::asset::{Figures, LevelFigures, MaterialFigures, Met, PartFigures, Report, ViewFigures};
use taotie::compare::Summary;
use taotie::names::Named;
use taotie_report::summary;
use taotie_report::table::Table;

/// Returns the report as aligned lines for people.
pub fn of(report: &Report) -> String {
    let triangles: Vec<String> = report.triangles.iter().map(ToString::to_string).collect();
    let mut text = format!(
        "{} triangles onto {}, maps of {}×{}\n",
        report.high_triangles,
        triangles.join(", "),
        report.size[0],
        report.size[1]
    );
    let mut table = Table::untitled(&["", ""]);
    if !report.carried.is_empty() {
        table.row(["carried".into(), report.carried.join(", ")]);
    }
    if let Some(figures) = &report.proof {
        normals(figures, &mut table);
        shape(figures, &mut table);
        material(&figures.material, &mut table);
        table.row(["visual difference".into(), visual_difference(&figures.views)]);
        if !figures.full_views.is_empty() {
            table.row(["in full material".into(), visual_difference(&figures.full_views)]);
        }
        levels(figures, &mut table);
        figures.parts.iter().for_each(|part| table.row([part.material.clone(), of_part(part)]));
        if !figures.unseen.is_empty() {
            table.row(["not looked at".into(), figures.unseen.join("; ")]);
        }
        table.row(["bytes".into(), format!("{} in, {} out", figures.bytes_in, figures.bytes_out)]);
    }
    let required = report.required.iter().map(|met| requirement(met, &report.triangles));
    required.for_each(|line| table.row(["required".into(), line]));
    text += &table.lines(0);
    for file in &report.files {
        let _ = writeln!(text, "wrote {}", file.display());
    }
    text.trim_end().to_owned()
}

fn percent(part: f64) -> String {
    format!("{:.3} %", part * 100.0)
}

fn normals(figures: &Figures, table: &mut Table) {
    if let Some(angles) = &figures.angles {
        table.row(["normal error".into(), summary::text(angles, 3, "°")]);
    }
    if let Some([floor, _]) = figures.floor_8_bit {
        table.row([String::new(), format!("storing normals in 8 bits alone costs {floor}° on average")]);
    }
    if let Some(plain) = &figures.without_map {
        let mean = format!("mean {:.3}°, by vertex normals alone", plain.mean);
        table.row(["error without normal map".into(), mean]);
    }
    let rays = format!(
        "{} of the texels, {} of the samples (closest point used); no hit: {} of the samples",
        percent(figures.missed_texels),
        percent(figures.fallback),
        percent(figures.lost)
    );
    table.row(["ray missed".into(), rays]);
}

fn shape(figures: &Figures, table: &mut Table) {
    let distances = format!(
        "at most {:.4} ({} of the diagonal), RMS {:.5} ({})",
        figures.hausdorff,
        percent(figures.hausdorff_of_diagonal),
        figures.rms,
        percent(figures.rms_of_diagonal)
    );
    table.row(["shape error".into(), distances]);
    if let Some(density) = &figures.density {
        let digits = if density.median < 100.0 { 1 } else { 0 };
        let (median, used) = (density.median, percent(figures.uv_use));
        let text = format!("{median:.digits$} texels per unit (median), {used} of the map used");
        table.row(["texel density".into(), text]);
    }
}

fn material(figures: &MaterialFigures, table: &mut Table) {
    if figures.not_finite > 0.0 {
        let part = percent(figures.not_finite);
        table.row([
            "material not finite".into(),
            format!("at {part} of the points, which have no difference"),
        ]);
    }
    let Some(color) = &figures.color else { return };
    table.row(["colour error (ΔE00)".into(), summary::text(color, 2, "")]);
    let mean = |(name, of): (&str, Option<Summary>)| Some(format!("{name} {:.4}", of?.mean));
    let means: Vec<String> = figures.numbers().into_iter().filter_map(mean).collect();
    table.row(["material error".into(), format!("means: {}", means.join(", "))]);
}

fn visual_difference(views: &[ViewFigures]) -> String {
    let mean = |of: fn(&ViewFigures) -> f64| views.iter().map(of).sum::<f64>() / views.len().max(1) as f64;
    let (flip, ssim) = (mean(|view| view.flip), mean(|view| view.ssim));
    format!("FLIP {flip:.4}, SSIM {ssim:.4}, mean of {} views", views.len())
}

/// Adds a row for each coarser level of detail.
fn levels(figures: &Figures, table: &mut Table) {
    for (level, figures) in figures.levels.iter().enumerate().skip(1) {
        table.row([format!("level {level}"), of_level(figures)]);
    }
}

/// Tells of the triangles of one material.
fn of_part(figures: &PartFigures) -> String {
    let (angles, missed) = (mean_and_p95(figures.angles.as_ref()), percent(figures.missed));
    format!(
        "{} triangles: normal error mean {angles}; ray missed at {missed} of the points",
        figures.triangles
    )
}

fn mean_and_p95(angles: Option<&Summary>) -> String {
    match angles {
        Some(angles) => format!("{:.3}°, p95 {:.3}°", angles.mean, angles.p95),
        None => "could not be measured".into(),
    }
}

fn of_level(figures: &LevelFigures) -> String {
    let angles = mean_and_p95(figures.angles.as_ref());
    let no_hit = || format!("no hit at {} of the points; ", percent(figures.lost));
    let lost = if figures.lost > 0.0 { no_hit() } else { String::new() };
    format!(
        "{} triangles: normal error mean {angles}; {lost}shape error at most {} of the diagonal; {}",
        figures.triangles,
        percent(figures.hausdorff_of_diagonal),
        visual_difference(&figures.views)
    )
}

/// Tells a requirement's outcome, and at which level where there are several.
fn requirement(met: &Met, triangles: &[usize]) -> String {
    let verdict = if met.met { "met" } else { "NOT met" };
    let level = match (met.level, triangles.len()) {
        (None, _) | (_, 0..=1) => String::new(),
        (Some(level), _) => match triangles.get(level) {
            Some(count) => format!(" of level {level} ({count} triangles)"),
            None => format!(" of level {level}, which is not there,"),
        },
    };
    format!("{verdict}: {}{level} {}", met.figure.name(), met.text())
}
