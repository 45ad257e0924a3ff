//! What a comparison prints.

use super::report::{MethodReport, Report, SummaryReport};
use crate::console;
use anyhow::Result;

/// Prints the angular errors, and each shading's picture errors.
///
/// # Errors
/// Where stdout is closed.
pub fn print(report: &Report) -> Result<()> {
    let against = &report.against;
    console::result(&format!(
        "{:<18} {:>7} {:>7} {:>7} {:>7}   {:>7} {:>7}   angular error against {against}, degrees",
        "method", "mean", "median", "95 %", "max", "mean*", "95 %*"
    ))?;
    for method in &report.methods {
        let Some(error) = &method.error else { continue };
        let all = figures(error.all.as_ref());
        let inner = figures(error.inner.as_ref());
        let [mean, median, p95, max] = &all;
        let [inner_mean, _, inner_p95, _] = &inner;
        let line = format!("{mean:>7} {median:>7} {p95:>7} {max:>7}   {inner_mean:>7} {inner_p95:>7}");
        console::result(&format!("{:<18} {line}", method.method))?;
    }
    console::result("* away from silhouettes")?;
    for i in 0..report.methods[0].pictures.len() {
        print_pictures(report, i)?;
    }
    for skipped in &report.skipped {
        console::result(&format!("{} was not drawn: {}", skipped.method, skipped.reason))?;
    }
    for note in &report.notes {
        console::result(note)?;
    }
    console::result("")
}

fn print_pictures(report: &Report, i: usize) -> Result<()> {
    let shading = report.methods[0].pictures[i].shading;
    console::result(&format!(
        "\n{:<18} {:>7} {:>7} {:>7} {:>7}   pictures under {shading}",
        "method", "RMSE", "PSNR", "SSIM", "FLIP"
    ))?;
    for method in &report.methods {
        let Some(line) = picture_line(method, i) else { continue };
        console::result(&format!("{:<18} {line}", method.method))?;
    }
    Ok(())
}

fn picture_line(method: &MethodReport, i: usize) -> Option<String> {
    let figures = method.pictures[i].difference.as_ref()?;
    let psnr = figures.psnr.map_or_else(|| "equal".into(), |psnr| format!("{psnr:.2}"));
    let flip = figures.flip.as_ref().map_or(0.0, |flip| flip.figures()[0]);
    Some(format!("{:>7.4} {psnr:>7} {:>7.4} {flip:>7.4}", figures.rmse, figures.ssim))
}

fn figures(summary: Option<&SummaryReport>) -> [String; 4] {
    match summary {
        Some(summary) => summary.figures().map(|figure| format!("{figure:.2}")),
        None => std::array::from_fn(|_| "-".into()),
    }
}
