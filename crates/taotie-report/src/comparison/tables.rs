//! The tables of a comparison as CSV: `angles.csv`, `pictures.csv` and `points.csv`.

use super::Document;
use crate::csv::{Csv, number};
use taotie::comparison::{MethodReport, PictureFigures, PointNormal};
use taotie_engine::compare::Summary;

/// Returns the tables with their file names.
pub(super) fn files(report: &Document) -> [(&'static str, String); 3] {
    [
        ("angles.csv", angles(report).text().to_owned()),
        ("pictures.csv", pictures(report).text().to_owned()),
        ("points.csv", points(report).text().to_owned()),
    ]
}

/// Returns two rows for each method: over all pixels, and over those away from silhouettes.
fn angles(report: &Document) -> Csv<8> {
    let columns = ["method", "against", "pixels", "count", "mean_deg", "median_deg", "p95_deg", "max_deg"];
    let mut csv = Csv::new(columns);
    for method in &report.methods {
        let Some(error) = &method.error else { continue };
        for (pixels, summary) in [("all", &error.all), ("inner", &error.inner)] {
            let [mean, median, p95, max] = texts(summary.as_ref());
            let count = summary.as_ref().map_or(0, |summary| summary.count).to_string();
            let names = [method.method.clone(), report.against.clone(), pixels.into()];
            let [name, against, pixels] = names;
            csv.row([name, against, pixels, count, mean, median, p95, max]);
        }
    }
    csv
}

fn texts(summary: Option<&Summary>) -> [String; 4] {
    let figures = summary.map(crate::summary::figures);
    std::array::from_fn(|i| number(figures.map(|figures| figures[i])))
}

/// Returns a row for each comparison of a picture: with another surface under the same shading model, and with the
/// same surface under the baseline.
fn pictures(report: &Document) -> Csv<11> {
    let mut csv = Csv::new([
        "method",
        "shading",
        "against_method",
        "against_shading",
        "rmse",
        "psnr_db",
        "ssim",
        "flip_mean",
        "flip_median",
        "flip_p95",
        "flip_max",
    ]);
    for method in &report.methods {
        for (names, figures) in compared(report, method) {
            csv.row(row(names, figures));
        }
    }
    csv
}

/// Returns the comparisons of a method's pictures: method and shading of both sides, and the figures.
fn compared<'a>(
    report: &'a Document,
    method: &'a MethodReport,
) -> impl Iterator<Item = ([&'a str; 4], &'a PictureFigures)> {
    let name = method.method.as_str();
    let surfaces = method.pictures.iter().filter_map(move |picture| {
        let shading = picture.shading.as_str();
        Some(([name, shading, report.against.as_str(), shading], picture.difference.as_ref()?))
    });
    let models = method.models.iter();
    let models = models.map(move |m| ([name, m.shading.as_str(), name, m.baseline.as_str()], &m.difference));
    surfaces.chain(models)
}

/// Returns the cells of a comparison; equal pictures have no PSNR because it is infinite.
fn row(names: [&str; 4], figures: &PictureFigures) -> [String; 11] {
    let [method, shading, against_method, against_shading] = names.map(str::to_owned);
    let [mean, median, p95, max] = texts(figures.flip.as_ref());
    let [rmse, psnr, ssim] = [Some(figures.rmse), figures.psnr, Some(figures.ssim)].map(number);
    [method, shading, against_method, against_shading, rmse, psnr, ssim, mean, median, p95, max]
}

/// Returns a row for each sample point and method.
fn points(report: &Document) -> Csv<9> {
    let columns = [
        "point",
        "x_px",
        "y_px",
        "method",
        "normal_x",
        "normal_y",
        "normal_z",
        "angle_to_first_deg",
        "error_deg",
    ];
    let mut csv = Csv::new(columns);
    for (i, point) in report.points.iter().enumerate() {
        for normal in &point.normals {
            csv.row(point_row(i + 1, point.pixel, normal));
        }
    }
    csv
}

fn point_row(number_of: usize, [x, y]: [u32; 2], normal: &PointNormal) -> [String; 9] {
    // As `f32`, for the shortest text that reads back equal.
    let component = |axis: usize| normal.normal.map_or_else(String::new, |n| n[axis].to_string());
    let [nx, ny, nz] = [0, 1, 2].map(component);
    let (angle, error) = (number(normal.angle_to_first), number(normal.error));
    let place = [number_of.to_string(), x.to_string(), y.to_string()];
    let [point, x, y] = place;
    [point, x, y, normal.method.clone(), nx, ny, nz, angle, error]
}
