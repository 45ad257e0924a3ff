//! The text that a comparison prints.

use taotie::comparison::{MethodReport, PictureFigures};
use taotie_engine::compare::Summary;
use taotie_report::comparison::Document;
use taotie_report::summary::figures;
use taotie_report::table::Table;

/// Returns the angular errors, the picture errors of each shading, and the skipped methods.
pub fn of(report: &Document) -> String {
    let mut text = if report.is_compared() { surfaces(report) } else { String::new() };
    if let Some(model) = report.methods[0].models.first() {
        let gap = if text.is_empty() { "" } else { "\n" };
        text +=
            &format!("{gap}Pictures of each surface compared with its picture under {}\n", model.baseline);
        text += &models(report).lines(0);
    }
    if !report.skipped.is_empty() || !report.notes.is_empty() {
        text += "\n";
    }
    for skipped in &report.skipped {
        text += &format!("{} could not be rendered: {}\n", skipped.method, skipped.reason);
    }
    for note in &report.notes {
        text += &format!("{note}\n");
    }
    text
}

/// Returns the figures that compare surfaces with one another.
fn surfaces(report: &Document) -> String {
    let mut text = format!("Angular error against {}, degrees\n", report.against);
    text += &angles(report).lines(0);
    text += "* only pixels away from silhouettes\n";
    for (i, picture) in report.methods[0].pictures.iter().enumerate() {
        text += &format!("\nPictures under {} against {}\n", picture.shading, report.against);
        text += &pictures(report, i).lines(0);
    }
    text
}

fn angles(report: &Document) -> Table {
    let titles = ["method", ">mean", ">median", ">95 %", ">max", ">mean*", ">median*", ">95 %*", ">max*"];
    let mut table = Table::new(&titles);
    for method in &report.methods {
        let Some(error) = &method.error else { continue };
        let [a, b, c, d] = texts(error.all.as_ref());
        let [e, f, g, h] = texts(error.inner.as_ref());
        table.row([method.method.clone(), a, b, c, d, e, f, g, h]);
    }
    table
}

fn texts(summary: Option<&Summary>) -> [String; 4] {
    match summary {
        Some(summary) => figures(summary).map(|figure| format!("{figure:.2}")),
        None => std::array::from_fn(|_| "-".into()),
    }
}

fn pictures(report: &Document, i: usize) -> Table {
    let mut table = Table::new(&["method", ">RMSE", ">PSNR dB", ">SSIM", ">FLIP"]);
    report.methods.iter().filter_map(|method| picture_row(method, i)).for_each(|row| table.row(row));
    table
}

fn picture_row(method: &MethodReport, i: usize) -> Option<[String; 5]> {
    let [rmse, psnr, ssim, flip] = picture_figures(method.pictures[i].difference.as_ref()?);
    Some([method.method.clone(), rmse, psnr, ssim, flip])
}

fn models(report: &Document) -> Table {
    let mut table = Table::new(&["method", "shading", ">RMSE", ">PSNR dB", ">SSIM", ">FLIP"]);
    for method in &report.methods {
        for model in &method.models {
            let [rmse, psnr, ssim, flip] = picture_figures(&model.difference);
            table.row([method.method.clone(), model.shading.clone(), rmse, psnr, ssim, flip]);
        }
    }
    table
}

fn picture_figures(figures: &PictureFigures) -> [String; 4] {
    let psnr = figures.psnr.map_or_else(|| "equal".into(), |psnr| format!("{psnr:.2}"));
    let flip = figures.flip.as_ref().map_or_else(|| "-".into(), |flip| format!("{:.4}", flip.mean));
    let [rmse, ssim] = [figures.rmse, figures.ssim].map(|figure| format!("{figure:.4}"));
    [rmse, psnr, ssim, flip]
}
