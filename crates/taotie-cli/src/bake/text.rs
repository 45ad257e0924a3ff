//! A bake in plain words.

use std::fmt::Write;
use taotie::asset::{Figures, Met, Report, ViewFigures};
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
        table.row(["visual difference".into(), visual_difference(&figures.views)]);
        table.row(["bytes".into(), format!("{} in, {} out", figures.bytes_in, figures.bytes_out)]);
    }
    report.required.iter().for_each(|met| table.row(["required".into(), requirement(met)]));
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
        let [floor, _] = figures.floor_8_bit;
        table.row(["normal error".into(), summary::text(angles, 3, "°")]);
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

fn visual_difference(views: &[ViewFigures]) -> String {
    let mean = |of: fn(&ViewFigures) -> f64| views.iter().map(of).sum::<f64>() / views.len().max(1) as f64;
    let (flip, ssim) = (mean(|view| view.flip), mean(|view| view.ssim));
    format!("FLIP {flip:.4}, SSIM {ssim:.4}, mean of {} views", views.len())
}

fn requirement(met: &Met) -> String {
    let verdict = if met.met { "met" } else { "NOT met" };
    let value = met.value.map_or("could not be measured".into(), |value| format!("is {value:.4}"));
    format!("{verdict}: {} {value}, at most {}", met.figure.name(), met.most)
}
