//! `report.html`: the page about an estimate, which opens from disk.

use super::report::{Errors, PhotographReport, Report};
use crate::inspect::words::thousands;
use anyhow::Result;
use std::path::Path;
use taotie::studio::{CameraOptions, LightOptions};
use taotie_engine::Warnings;
use taotie_engine::compare::{ColorMap, Field, Summary, angular_error};
use taotie_engine::image::Image;
use taotie_io::Limits;
use taotie_photometric::{Coverage, Estimate, Estimator};
use taotie_report::heat_map::HeatMap;
use taotie_report::sheet::Sheet;
use taotie_report::viewer::{AssetSubject, Bookmark, MeasuredErrors, Staging};
use taotie_report::{Cell, Column, Fact, Legend, Notice, Page, Picture, Section, Series, Tone, View, html};

/// The longest side of pictures, pixels.
const SIDE: usize = 1024;
/// The rows of the table of the worst pixels.
const WORST: usize = 10;
/// The bins of the histogram.
const BINS: usize = 40;
/// Radiance of a white surface that faces the first light, relative to the display's white.
const BRIGHT: f64 = 1.2;

/// The estimators, as the page names them.
const ESTIMATORS: [(Estimator, &str); 4] = [
    (Estimator::Best, "written"),
    (Estimator::Direct, "without indirect light"),
    (Estimator::Robust, "robust"),
    (Estimator::LeastSquares, "least squares"),
];

/// The content of the page.
pub struct PhotometricPage<'a> {
    /// All figures.
    pub report: &'a Report,
    /// The normals.
    pub estimate: &'a Estimate,
    /// The albedo in sRGB, relative to white.
    pub albedo: &'a [[u8; 3]],
    /// True normals at the size of the photographs.
    pub truth: Option<&'a Image>,
}

impl PhotometricPage<'_> {
    /// Writes the page with the relief in the file `relief` as its first view. If it cannot be shown, the page omits it and
    /// a warning gives the reason.
    ///
    /// # Errors
    /// Those of building pictures, none of which can occur.
    pub fn html(&self, relief: &Path) -> Result<(String, Warnings)> {
        let page = self.page()?;
        let sigma = self.estimate.sigma()?;
        let summary = self.report.sigma.as_ref();
        // From the left, low; dark objects are lit more.
        let strength = BRIGHT * std::f64::consts::PI / self.report.albedo.clamp(0.02, 1.0);
        let raking = format!("directional from=-65,20 strength={strength:.2}");
        let light = LightOptions { lights: vec![raking.parse()?], ..LightOptions::default() };
        let camera = CameraOptions { azimuth: 0.0, elevation: 0.0, ..CameraOptions::default() };
        let bookmark = |title: &str, link: &str| Bookmark {
            title: title.into(),
            link: link.into(),
            ..Bookmark::default()
        };
        let bookmarks = [
            bookmark("Raking light from the right", "light=raking&from=70,12"),
            bookmark("Uncertainty of the normals", "mode=error"),
        ];
        let subject = AssetSubject {
            path: relief,
            title: &self.report.input,
            limits: &Limits::default(),
            rays: None,
            errors: summary
                .map(|summary| MeasuredErrors::of_uncertainty(&sigma, summary.mean, scale_top(summary))),
            staging: Staging { camera: Some(&camera), light: Some(&light), bookmarks: &bookmarks },
        };
        Ok(match subject.page(&|viewer| viewer.within(&page)) {
            Ok(written) => written,
            Err(error) => {
                let mut warnings = Warnings::default();
                warnings.note(format!("the page has no 3D view of the relief: {error}"), 1);
                (html(&page), warnings)
            }
        })
    }

    fn page(&self) -> Result<Page> {
        let report = self.report;
        let count = report.photographs.len();
        let warning = |warning: &taotie::Warning| Notice::new(warning.to_string(), Tone::Changed);
        Ok(Page {
            title: report.input.clone(),
            subtitle: match report.layout {
                "relightable" => format!("Normals from a relightable image, relit by {count} lights"),
                _ => format!("Normals from {count} photographs, with their uncertainty"),
            },
            notices: self.verdict().into_iter().chain(report.warnings.iter().map(warning)).collect(),
            facts: self.facts(),
            views: self.views()?,
            model_note: "relief.glb, lit from the left. Drag to rotate it or move the light; \u{201c}Show\u{201d} has the \
                         uncertainty of its normals."
                .into(),
            sections: self.sections()?,
            footer: format!("Made by taotie {}. All figures are in report.json.", report.version),
            ..Page::default()
        })
    }

    /// Returns the main result.
    fn verdict(&self) -> Option<Notice> {
        let sigma = self.report.sigma.as_ref()?;
        let expected =
            format!("68 % of the normals are expected within {:.2}° of the truth on average", sigma.mean);
        let text = match &self.report.truth {
            Some(Errors { best, .. }) => format!("{expected}; their mean error is {:.2}°.", best.mean),
            None => format!("{expected}."),
        };
        Some(Notice::new(text, Tone::Good))
    }

    fn facts(&self) -> Vec<Fact> {
        let report = self.report;
        let [width, height] = report.size;
        let encoding = if report.encoding == "srgb" { "sRGB" } else { "linear" };
        let mut facts = vec![
            Fact::new("Photographs", format!("{} of {width} × {height}", report.photographs.len())),
            Fact::new("Encoding", format!("{} bits, {encoding}", report.bits)),
            Fact::new("Lights from", report.lights_from.clone()),
            Fact::new("Pixels with a normal", thousands(report.pixels)),
        ];
        if let Some(sigma) = &report.sigma {
            facts.push(Fact::new("Median sigma", format!("{:.2}°", sigma.median)));
        }
        if let Some(exponent) = report.exponent {
            facts.push(Fact::new("Brightness grows like the power", format!("{exponent:.2} of the light")));
        }
        facts
    }

    fn views(&self) -> Result<Vec<View>> {
        let normals = ESTIMATORS.iter().map(|(estimator, name)| {
            picture(name, "", &Sheet::of_normals(&self.estimate.normals(*estimator)))
        });
        let truth = self.truth.map(|truth| picture("truth", "", &Sheet::of_normals(&self.masked(truth))));
        let normals = View {
            name: "normals".into(),
            note: "Colours are (n + 1) / 2: red to the right, green up, blue towards the camera.".into(),
            pictures: normals.chain(truth).collect::<Result<_>>()?,
            legend: None,
        };
        let sigma = self.estimate.sigma()?;
        let note = "Radius within which 68 % of the true normals are expected. Grey: without a normal.";
        let mut views = vec![normals, heat_view(("sigma", note), "°", &[("sigma", sigma)])?];
        views.extend(self.error_view()?);
        let residual = self.field(|best| 100.0 * best.residual)?;
        let note = "Standard deviation of a pixel's residuals relative to its albedo: noise, and light that the surface does \
                    not reflect as a matt one would.";
        views.push(heat_view(("residuals", note), "%", &[("residual", residual)])?);
        let [width, height] = self.report.size.map(|side| side as usize);
        let pixels = self.albedo.to_vec();
        views.push(View {
            name: "albedo".into(),
            note: "Colour without shading, relative to the 99th percentile.".into(),
            pictures: vec![picture("albedo", "", &Sheet { width, height, pixels })?],
            legend: None,
        });
        Ok(views)
    }

    /// Returns the errors of all estimators, on one scale.
    fn error_view(&self) -> Result<Option<View>> {
        let Some(truth) = self.truth else { return Ok(None) };
        let fields = ESTIMATORS.iter().map(|(estimator, name)| -> Result<_> {
            Ok((*name, angular_error(&self.estimate.normals(*estimator), truth)?))
        });
        let fields: Vec<(&str, Field)> = fields.collect::<Result<_>>()?;
        let note = "Angle between the estimated and the true normals. Grey: without either.";
        heat_view(("error", note), "°", &fields).map(Some)
    }

    fn sections(&self) -> Result<Vec<Section>> {
        let mut sections = vec![self.estimators()];
        sections.extend(self.report.truth.as_ref().and_then(|errors| errors.coverage.map(coverage)));
        sections.extend(self.histogram()?);
        sections.push(self.lights());
        sections.push(self.worst_pixels()?);
        Ok(sections)
    }

    /// Returns the errors of the estimators, or without truth their differences.
    fn estimators(&self) -> Section {
        let row = |name: &str, Summary { mean, median, p95, max, .. }: &Summary| {
            let numbers = [mean, median, p95, max].map(|value| Cell::number(*value, 2));
            std::iter::once(Cell::text(name)).chain(numbers).collect::<Vec<_>>()
        };
        let numbers = ["mean", "median", "p95", "max"].map(|name| Column::numbers(name, "°"));
        let table = |title: &str, note: &str, first: &str, rows: Vec<Vec<Cell>>| Section::Table {
            title: title.into(),
            note: note.into(),
            columns: std::iter::once(Column::words(first)).chain(numbers.clone()).collect(),
            rows,
        };
        let report = self.report;
        match &report.truth {
            Some(Errors { least_squares, robust, direct, best, .. }) => table(
                "Estimators",
                "Angle between the estimated and the true normals.",
                "estimator",
                vec![
                    row("least squares", least_squares),
                    row("robust", robust),
                    row("without indirect light", direct),
                    row("written", best),
                ],
            ),
            None => table(
                "Estimators",
                "Angle between the normals of two estimators, and the uncertainty of those written.",
                "quantity",
                [
                    ("shadows and highlights: least squares to robust", &report.rejection),
                    ("indirect light: robust to without it", &report.indirect),
                    ("reflection fitted: without indirect light to written", &report.fit),
                    ("sigma", &report.sigma),
                ]
                .into_iter()
                .filter_map(|(name, summary)| Some(row(name, summary.as_ref()?)))
                .collect(),
            ),
        }
    }

    /// Returns the distribution of sigma, and of the errors if the truth is known.
    fn histogram(&self) -> Result<Option<Section>> {
        let Some(sigma) = &self.report.sigma else { return Ok(None) };
        let error = match self.truth {
            Some(truth) => Some(angular_error(&self.estimate.normals(Estimator::Best), truth)?),
            None => None,
        };
        let most = error.as_ref().and_then(Field::summary).map_or(0.0, |summary| summary.p95);
        let top = most.max(sigma.p95).max(1e-3) as f32 * 1.25;
        let series =
            |label: &str, field: &Field| Series { label: label.into(), counts: field.histogram(BINS, top) };
        Ok(Some(Section::Histogram {
            title: "Distribution".into(),
            note: "Pixels by sigma, and by error where the true normals are known.".into(),
            unit: "°".into(),
            bin_width: f64::from(top) / BINS as f64,
            last_is_open: true,
            series: std::iter::once(series("sigma", &self.estimate.sigma()?))
                .chain(error.iter().map(|error| series("error", error)))
                .collect(),
        }))
    }

    /// Returns all lights, the worst first.
    fn lights(&self) -> Section {
        let mut photographs: Vec<&PhotographReport> = self.report.photographs.iter().collect();
        photographs.sort_by(|a, b| b.residual.total_cmp(&a.residual));
        let row = |photograph: &&PhotographReport| {
            let [x, y, z] = photograph.direction;
            let percent = |v: f64| Cell::number(100.0 * v, 1);
            vec![
                Cell::text(photograph.name.clone()),
                Cell::number(x, 2),
                Cell::number(y, 2),
                Cell::number(z, 2),
                percent(photograph.residual),
                percent(photograph.shadowed),
                percent(photograph.rejected),
            ]
        };
        Section::Table {
            title: "Lights".into(),
            note: "Residuals of lit samples relative to the albedo, and the shares of a photograph's samples that are in \
                   shadow, and that have no weight in the fit. A light with far larger residuals than its neighbours may have \
                   a wrong direction or brightness."
                .into(),
            columns: vec![
                Column::words("photograph"),
                Column::numbers("x", ""),
                Column::numbers("y", ""),
                Column::numbers("z", ""),
                Column::numbers("residual", "%"),
                Column::numbers("in shadow", "%"),
                Column::numbers("rejected", "%"),
            ],
            rows: photographs.iter().map(row).collect(),
        }
    }

    /// Returns the pixels with the largest sigma, one for each part of the picture.
    fn worst_pixels(&self) -> Result<Section> {
        let error = match self.truth {
            Some(truth) => Some(angular_error(&self.estimate.normals(Estimator::Best), truth)?),
            None => None,
        };
        let width = self.estimate.width();
        let apart = (width.max(self.estimate.height()) / 20).max(1);
        let all = self.estimate.pixels.iter().zip(&self.estimate.best);
        let mut found: Vec<_> = all.filter_map(|(pixel, best)| Some((*pixel, (*best)?))).collect();
        found.sort_by(|(a, one), (b, other)| other.sigma_deg.total_cmp(&one.sigma_deg).then(a.cmp(b)));
        let place = |pixel: u32| [pixel % width, pixel / width];
        let mut listed: Vec<u32> = Vec::new();
        let mut rows = Vec::new();
        for (pixel, best) in found {
            let near =
                |other: &u32| (0..2).all(|axis| place(*other)[axis].abs_diff(place(pixel)[axis]) < apart);
            if listed.iter().any(near) {
                continue;
            }
            listed.push(pixel);
            let [x, y] = place(pixel).map(|v| Cell::number(f64::from(v), 0));
            let mut row = vec![x, y, Cell::number(best.sigma_deg, 2), Cell::number(100.0 * best.residual, 1)];
            row.extend(
                error.as_ref().map(|error| Cell::number(f64::from(error.values()[pixel as usize]), 2)),
            );
            rows.push(row);
            if rows.len() == WORST {
                break;
            }
        }
        let mut columns = vec![
            Column::numbers("column", ""),
            Column::numbers("row", ""),
            Column::numbers("sigma", "°"),
            Column::numbers("residual", "%"),
        ];
        columns.extend(error.map(|_| Column::numbers("error", "°")));
        Ok(Section::Table {
            title: "Worst pixels".into(),
            note: "The largest sigma, each at least a twentieth of the picture from the others; from the top left corner.".into(),
            columns,
            rows,
        })
    }

    /// Returns a number of each pixel; NaN without a normal.
    fn field(&self, value: impl Fn(&taotie_photometric::PixelEstimate) -> f64) -> Result<Field> {
        let image = self.estimate.image(|_, best| [value(best); 3]);
        let numbers = image.pixels().iter().map(|pixel| if pixel[3] > 0.0 { pixel[0] } else { f32::NAN });
        Ok(Field::new(image.width(), image.height(), numbers.collect())?)
    }

    /// Returns true normals where there are estimated ones.
    fn masked(&self, truth: &Image) -> Image {
        let mut masked = truth.clone();
        let own = self.estimate.normals(Estimator::Best);
        let pairs = masked.pixels_mut().iter_mut().zip(own.pixels());
        pairs.filter(|(_, own)| own[3] == 0.0).for_each(|(pixel, _)| *pixel = [0.0; 4]);
        masked
    }
}

fn coverage(Coverage { radius, major, minor }: Coverage) -> Section {
    let row = |name: &str, found: f64, expected: f64| {
        vec![Cell::text(name), Cell::number(100.0 * found, 0), Cell::number(expected, 0)]
    };
    Section::Table {
        title: "Errors within the stated uncertainty".into(),
        note:
            "Axes are those of a pixel's covariance. Expected are the shares of normally distributed errors."
                .into(),
        columns: vec![
            Column::words("range"),
            Column::numbers("found", "%"),
            Column::numbers("expected", "%"),
        ],
        rows: vec![
            row("sigma", radius, 68.0),
            row("one standard deviation along the larger axis", major[0], 68.0),
            row("one along the smaller axis", minor[0], 68.0),
            row("two along the larger axis", major[1], 95.0),
            row("two along the smaller axis", minor[1], 95.0),
        ],
    }
}

/// Builds the view of fields on one colour scale, which ends at the largest 95th percentile.
fn heat_view((name, note): (&str, &str), unit: &str, fields: &[(&str, Field)]) -> Result<View> {
    let tops = fields.iter().filter_map(|(_, field)| field.summary()).map(|summary| scale_top(&summary));
    let top = tops.fold(0.0_f32, f32::max).max(1e-3);
    let map = ColorMap::Viridis;
    let pictures = fields.iter().map(|(label, field)| {
        let summary = field.summary();
        let note = summary.map_or(String::new(), |summary| format!("mean {:.2}{unit}", summary.mean));
        picture(label, &note, &HeatMap { field, title: name, unit, map, top }.plain())
    });
    Ok(View {
        name: name.into(),
        note: note.into(),
        pictures: pictures.collect::<Result<_>>()?,
        legend: Some(Legend::new(name, unit, f64::from(top), map)),
    })
}

/// The end of a colour scale: the 95th percentile with one significant digit, rounded up.
fn scale_top(summary: &Summary) -> f32 {
    const STEPS: [f64; 12] = [0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 30.0, 50.0, 100.0];
    STEPS.into_iter().find(|step| *step >= summary.p95).unwrap_or(summary.p95) as f32
}

fn picture(label: &str, note: &str, sheet: &Sheet) -> Result<Picture> {
    Ok(Picture::to_look_at(label, note, &sheet.shrunk(SIDE))?)
}
