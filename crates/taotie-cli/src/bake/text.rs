//! A bake in plain words.

use std::fmt::Write;
use taotie::asset::{Figures, Report, ViewFigures};
use taotie::names::Named;
use taotie_report::spread::Spread;

/// The report for people.
pub fn of(report: &Report) -> String {
    let triangles: Vec<String> = report.triangles.iter().map(ToString::to_string).collect();
    let mut text = format!(
        "{} triangles onto {}, maps of {}×{}",
        report.high_triangles,
        triangles.join(", "),
        report.size[0],
        report.size[1]
    );
    if let Some(proof) = &report.proof {
        let _ = write!(text, "\n{}", figures(proof));
    }
    for met in &report.required {
        let verdict = if met.met { "met" } else { "NOT met" };
        let value = met.value.map_or("could not be measured".into(), |value| format!("is {value:.4}"));
        let _ = write!(
            text,
            "\n{:<12} {verdict}: {} {value}, at most {}",
            "required",
            met.figure.name(),
            met.most
        );
    }
    for file in &report.files {
        let _ = write!(text, "\nwrote {}", file.display());
    }
    text
}

fn figures(figures: &Figures) -> String {
    let percent = |part: f64| format!("{:.3} %", part * 100.0);
    let mut text = String::new();
    if let Some(angles) = figures.angles {
        let _ = writeln!(text, "{:<12} {}", "normals off", Spread::from(angles).text(3, "°"));
        let [mean, _] = figures.floor_8_bit;
        let _ = writeln!(text, "{:<12} {mean}° is what 8 bits cost at least", "");
    }
    if let Some(plain) = &figures.without_map {
        let _ = writeln!(text, "{:<12} mean {:.3}° by vertex normals alone", "without map", plain.mean);
    }
    let _ = writeln!(
        text,
        "{:<12} {} of the texels, {} of the samples; {} found nothing",
        "missed",
        percent(figures.missed_texels),
        percent(figures.fallback),
        percent(figures.lost)
    );
    let _ = writeln!(
        text,
        "{:<12} at most {:.4} ({} of the diagonal), RMS {:.5} ({})",
        "shape off",
        figures.hausdorff,
        percent(figures.hausdorff_of_diagonal),
        figures.rms,
        percent(figures.rms_of_diagonal)
    );
    if let Some(density) = &figures.density {
        let _ = writeln!(
            text,
            "{:<12} {:.1} a model unit (median), {} of the map used",
            "texels",
            density.median,
            percent(figures.uv_use)
        );
    }
    let mean = |of: fn(&ViewFigures) -> f64| {
        figures.views.iter().map(of).sum::<f64>() / figures.views.len().max(1) as f64
    };
    let _ = writeln!(
        text,
        "{:<12} FLIP {:.4}, SSIM {:.4}, mean of {} views",
        "seen",
        mean(|v| v.flip),
        mean(|v| v.ssim),
        figures.views.len()
    );
    let _ = write!(text, "{:<12} {} in, {} out", "bytes", figures.bytes_in, figures.bytes_out);
    text
}
