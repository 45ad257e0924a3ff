//! Writes a comparison as files: its pictures, the contact sheet, normals and errors as numbers, and tables as CSV.

use super::document::Document;
use crate::heat_map::HeatMap;
use crate::sheet::{Cell, Sheet};
use crate::table::{Csv, figures, number};
use std::path::{Path, PathBuf};
use taotie::comparison::{
    Comparison, ComparisonOptions, MethodReport, PictureFigures, PointNormal, RenderedSurface,
};
use taotie_engine::Result;
use taotie_engine::compare::{Field, Summary};
use taotie_engine::film::Development;
use taotie_engine::image::Image;
use taotie_engine::names::Named;
use taotie_engine::shade::Shading;
use taotie_io::{FileSet, ImageFormat};

/// The longest side of a picture on the contact sheet, pixels.
const CELL: usize = 320;

/// Returns all files that a comparison may write.
pub fn possible_files(options: &ComparisonOptions, folder: &Path) -> Vec<PathBuf> {
    let stems = options.methods.iter().map(|method| method.file_stem()).chain(["reference".into()]);
    let of_shading = |shading: &Shading| [shading.name().to_owned(), format!("{}.flip", shading.name())];
    let of_models = |baseline: &Shading| {
        let name = move |shading: &Shading| format!("{}-{}.flip", shading.name(), baseline.name());
        options.shadings.iter().map(name).collect::<Vec<_>>()
    };
    let kinds: Vec<String> = ["normals", "error"]
        .map(String::from)
        .into_iter()
        .chain(options.shadings.iter().flat_map(of_shading))
        .chain(options.baseline.iter().flat_map(of_models))
        .collect();
    let pictures = stems.flat_map(|stem| {
        let exact = ["normals", "error"].map(|kind| format!("{stem}.{kind}.exr"));
        let name = move |kind: &String| format!("{stem}.{kind}.png");
        kinds.iter().map(name).chain(exact).collect::<Vec<_>>()
    });
    let others = ["sheet.png", "report.json", "report.html", "angles.csv", "pictures.csv", "points.csv"];
    let others = others.map(String::from);
    pictures.chain(others).map(|name| folder.join(name)).collect()
}

/// The output folder.
pub struct Files<'a> {
    set: &'a FileSet,
    folder: PathBuf,
    /// The angle at the top of the heat maps' scale, degrees.
    pub heat_top: f32,
    /// The files written, in order.
    pub written: Vec<PathBuf>,
}

impl<'a> Files<'a> {
    /// Creates the folder if necessary.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Io`] if it cannot be created.
    pub fn new(set: &'a FileSet, folder: &Path, heat_top: f32) -> Result<Self> {
        set.claim_folder(folder)?;
        Ok(Self { set, folder: folder.to_path_buf(), heat_top, written: Vec::new() })
    }

    /// Writes every picture and the contact sheet.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Io`] if a file cannot be written.
    pub fn write(&mut self, comparison: &Comparison) -> Result<()> {
        for surface in &comparison.surfaces {
            for (shading, picture) in &surface.pictures {
                self.write_png(&surface.picture_name(*shading), &Sheet::developed(picture))?;
            }
            self.write_png(&surface.file_name("normals"), &Sheet::of_normals(&surface.normals))?;
            for model in &surface.model_differences {
                let flip = HeatMap::of_flip(&model.picture.flip).with_scale();
                self.write_png(&surface.model_flip_name(model), &flip)?;
            }
            let Some(difference) = &surface.difference else { continue };
            let heat = HeatMap::of_angles(&difference.angles, self.heat_top).with_scale();
            self.write_png(&surface.file_name("error"), &heat)?;
            for ((shading, _), difference) in surface.pictures.iter().zip(&difference.pictures) {
                let flip = HeatMap::of_flip(&difference.flip).with_scale();
                self.write_png(&surface.flip_name(*shading), &flip)?;
            }
        }
        self.write_png("sheet.png", &self.sheet(comparison))
    }

    /// Writes the normals and angular errors of all surfaces as numbers.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Io`] if a file cannot be written.
    pub fn write_exact(&mut self, comparison: &Comparison) -> Result<()> {
        for surface in &comparison.surfaces {
            self.write_exr(&surface.exact_name("normals"), &surface.normals)?;
            if let Some(difference) = &surface.difference {
                self.write_exr(&surface.exact_name("error"), &degrees(&difference.angles)?)?;
            }
        }
        Ok(())
    }

    fn write_exr(&mut self, name: &str, image: &Image) -> Result<()> {
        let path = self.folder.join(name);
        self.set.write_image(&path, image, &Development::default(), ImageFormat::Exr)?;
        self.written.push(path);
        Ok(())
    }

    /// Writes text into the folder.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Io`] if it cannot be written.
    pub fn write_text(&mut self, name: &str, text: &str) -> Result<()> {
        let path = self.folder.join(name);
        self.set.write_text(&path, text)?;
        self.written.push(path);
        Ok(())
    }

    fn write_png(&mut self, name: &str, picture: &Sheet) -> Result<()> {
        let path = self.folder.join(name);
        self.set.write_png(&path, &picture.png())?;
        self.written.push(path);
        Ok(())
    }

    /// A column for each surface: its pictures, its normals, its error.
    fn sheet(&self, comparison: &Comparison) -> Sheet {
        let surfaces = &comparison.surfaces;
        let mut cells = Vec::new();
        for i in 0..surfaces[0].pictures.len() {
            cells.extend(surfaces.iter().map(|surface| {
                let (shading, picture) = &surface.pictures[i];
                cell(surface.id(), shading.name().into(), &Sheet::developed(picture))
            }));
        }
        cells.extend(
            surfaces.iter().map(|surface| {
                cell("normals".into(), surface.describe(), &Sheet::of_normals(&surface.normals))
            }),
        );
        cells.extend(surfaces.iter().map(|surface| self.error_cell(surface)));
        let small = Sheet::developed(&surfaces[0].pictures[0].1).shrunk(CELL);
        let sheet = Sheet::new(&cells, [small.width, small.height], surfaces.len());
        match surfaces.iter().find_map(|surface| surface.difference.as_ref()) {
            Some(difference) => HeatMap::of_angles(&difference.angles, self.heat_top).above_scale(&sheet),
            None => sheet,
        }
    }

    fn error_cell(&self, surface: &RenderedSurface) -> Cell {
        let Some(difference) = &surface.difference else {
            let blank = Sheet::blank(surface.normals.width() as usize, surface.normals.height() as usize);
            return cell("error".into(), "the reference for the others".into(), &blank);
        };
        let note = match difference.inner_angles.summary() {
            Some(summary) => format!("mean {:.2}°, 95 % below {:.1}°", summary.mean, summary.p95),
            None => "no pixels away from silhouettes".into(),
        };
        cell("error".into(), note, &HeatMap::of_angles(&difference.angles, self.heat_top).plain())
    }
}

/// Returns an image with a field's numbers in the first three channels; the fourth is 1 where there is a number.
fn degrees(angles: &Field) -> Result<Image> {
    let mut image = Image::new(angles.width(), angles.height(), [0.0; 4])?;
    for (pixel, angle) in image.pixels_mut().iter_mut().zip(angles.values()) {
        if !angle.is_nan() {
            *pixel = [*angle, *angle, *angle, 1.0];
        }
    }
    Ok(image)
}

fn cell(title: String, note: String, picture: &Sheet) -> Cell {
    Cell { title, note, pixels: picture.shrunk(CELL).pixels }
}

/// Returns the tables as CSV, with their file names.
pub(super) fn tables(report: &Document) -> [(&'static str, String); 3] {
    [
        ("angles.csv", angles_csv(report).text().to_owned()),
        ("pictures.csv", pictures_csv(report).text().to_owned()),
        ("points.csv", points_csv(report).text().to_owned()),
    ]
}

/// Returns two rows for each method: over all pixels, and over those away from silhouettes.
fn angles_csv(report: &Document) -> Csv<8> {
    let columns = ["method", "against", "pixels", "count", "mean_deg", "median_deg", "p95_deg", "max_deg"];
    let mut csv = Csv::new(columns);
    for method in &report.methods {
        let Some(error) = &method.error else { continue };
        for (pixels, summary) in [("all", &error.all), ("inner", &error.inner)] {
            let [mean, median, p95, max] = texts_of_figures(summary.as_ref());
            let count = summary.as_ref().map_or(0, |summary| summary.count).to_string();
            let names = [method.method.clone(), report.against.clone(), pixels.into()];
            let [name, against, pixels] = names;
            csv.row([name, against, pixels, count, mean, median, p95, max]);
        }
    }
    csv
}

fn texts_of_figures(summary: Option<&Summary>) -> [String; 4] {
    let figures = summary.map(figures);
    std::array::from_fn(|i| number(figures.map(|figures| figures[i])))
}

/// Returns a row for each comparison of a picture: with another surface under the same shading model, and with the
/// same surface under the baseline.
fn pictures_csv(report: &Document) -> Csv<12> {
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
        "pixels",
    ]);
    for method in &report.methods {
        for (names, figures) in compared(report, method) {
            csv.row(picture_row(names, figures));
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
fn picture_row(names: [&str; 4], figures: &PictureFigures) -> [String; 12] {
    let [method, shading, against_method, against_shading] = names.map(str::to_owned);
    let [mean, median, p95, max] = texts_of_figures(figures.flip.as_ref());
    let [rmse, psnr, ssim] = [Some(figures.rmse), figures.psnr, Some(figures.ssim)].map(number);
    let pixels = figures.pixels.to_string();
    [method, shading, against_method, against_shading, rmse, psnr, ssim, mean, median, p95, max, pixels]
}

/// Returns a row for each sample point and method.
fn points_csv(report: &Document) -> Csv<9> {
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
