//! `report.json`: every parameter and every figure.

use super::comparison::{Comparison, Plan, Taken};
use super::{look, points};
use crate::console;
use crate::spread::Spread;
use serde::Serialize;
use serde_json::{Value, json};
use std::path::PathBuf;
use taotie::compare::{self, Field, PIXELS_PER_DEGREE};
use taotie::image::Image;
use taotie::math::Vec3;
use taotie::names::Named;
use taotie::scene::{Falloff, Light, LightKind, Projection};

/// Version of `report.json`.
pub const SCHEMA: u32 = 1;

/// Bins of the histogram of angular error, one a degree; the last one holds everything from there on.
pub const BINS: usize = 60;

/// The file as a whole.
#[derive(Serialize)]
pub struct Report {
    /// Version of this layout.
    pub schema: u32,
    /// What kind of report this is.
    pub kind: &'static str,
    /// Version of the program.
    pub version: &'static str,
    /// What was compared.
    pub subject: SubjectReport,
    /// What the errors are measured against: `reference`, or the first method.
    pub against: String,
    /// Camera, light, film and whatever else the pictures depend on.
    pub parameters: Value,
    /// Of the covered samples, the part whose place was not found on the reference, [0, 1].
    pub unmatched: f64,
    /// How pixels and places are chosen and what the figures mean.
    pub rules: Rules,
    /// The methods in their order, then the reference.
    pub methods: Vec<MethodReport>,
    /// Methods that could not be drawn.
    pub skipped: Vec<Skipped>,
    /// Normals at places.
    pub points: Vec<PointReport>,
    /// What was derived from other maps.
    pub notes: Vec<String>,
    /// What could not be drawn as asked.
    pub warnings: Value,
}

/// What was compared.
#[derive(Serialize, Clone)]
pub struct SubjectReport {
    /// The model's file or name.
    pub model: String,
    /// Its triangles.
    pub triangles: usize,
    /// The reference's file or name.
    pub reference: Option<String>,
    /// Its triangles.
    pub reference_triangles: Option<usize>,
}

/// The rules behind the figures, in words.
#[derive(Serialize)]
pub struct Rules {
    angles: &'static str,
    places: &'static str,
    silhouettes: &'static str,
    points: String,
    pictures: String,
}

/// One method's figures.
#[derive(Serialize)]
pub struct MethodReport {
    /// As on the command line, or `reference`.
    pub method: String,
    /// What it does.
    pub what: String,
    /// Time for all its pictures.
    pub milliseconds: f64,
    /// Its normals as a picture.
    pub normals: PathBuf,
    /// Angular error; absent for what the others are compared with.
    pub error: Option<ErrorReport>,
    /// The shaded pictures.
    pub pictures: Vec<PictureReport>,
}

/// Angular error, degrees.
#[derive(Serialize)]
pub struct ErrorReport {
    /// The heat map.
    pub heat: PathBuf,
    /// Over all matched pixels.
    pub all: Option<Spread>,
    /// Over those away from silhouettes.
    pub inner: Option<Spread>,
    /// Pixels per degree, all that are matched; the last bin is open.
    pub histogram: Vec<u64>,
}

/// A shaded picture, and its difference where there is one.
#[derive(Serialize)]
pub struct PictureReport {
    /// The reflectance model.
    pub shading: &'static str,
    /// The picture.
    pub file: PathBuf,
    /// Absent for what the others are compared with.
    pub difference: Option<PictureFigures>,
}

/// How two developed pictures differ.
#[derive(Serialize)]
pub struct PictureFigures {
    /// In [0, 1] of encoded values.
    pub rmse: f64,
    /// Decibels; absent for equal pictures, where it is infinite.
    pub psnr: Option<f64>,
    /// At most 1.
    pub ssim: f64,
    /// In [0, 1].
    pub flip: Option<Spread>,
    /// Its map.
    pub flip_map: PathBuf,
}

/// A method that could not be drawn.
#[derive(Serialize)]
pub struct Skipped {
    /// As on the command line.
    pub method: String,
    /// Why.
    pub reason: String,
}

/// The normals at one place.
#[derive(Serialize)]
pub struct PointReport {
    /// From the top left.
    pub pixel: [u32; 2],
    /// For each of the methods in their order.
    pub normals: Vec<PointNormal>,
}

/// A method's normal at a place.
#[derive(Serialize)]
pub struct PointNormal {
    /// As on the command line, or `reference`.
    pub method: String,
    /// Unit, world space; absent where the method covers no such pixel.
    pub normal: Option<[f32; 3]>,
    /// To the first method's, degrees.
    pub angle_to_first: Option<f64>,
    /// To what the others are compared with, degrees.
    pub error: Option<f64>,
}

impl Report {
    /// Gathers the figures of a comparison.
    ///
    /// # Errors
    /// None but where the masks have another size, which they have not.
    pub fn new(comparison: &Comparison, plan: &Plan, subject: &SubjectReport) -> taotie::Result<Self> {
        let methods = comparison.taken.iter().map(|taken| method_report(taken, comparison));
        let skipped = comparison.skipped.iter();
        Ok(Self {
            schema: SCHEMA,
            kind: "taotie compare",
            version: env!("CARGO_PKG_VERSION"),
            subject: subject.clone(),
            against: comparison.against(),
            unmatched: comparison.unmatched,
            parameters: parameters(plan),
            rules: rules(plan),
            methods: methods.collect::<taotie::Result<_>>()?,
            skipped: skipped
                .map(|(method, reason)| Skipped { method: method.id(), reason: reason.clone() })
                .collect(),
            points: comparison.points.iter().map(|pixel| point_report(*pixel, comparison)).collect(),
            notes: comparison.notes.clone(),
            warnings: console::json_warnings(&comparison.warnings),
        })
    }

    /// The figures of a method by its name.
    pub fn method(&self, name: &str) -> Option<&MethodReport> {
        self.methods.iter().find(|method| method.method == name)
    }
}

impl Rules {
    /// The rules, a sentence each.
    pub fn in_words(&self) -> Vec<String> {
        vec![
            format!("Angles: {}.", self.angles),
            format!("Matching: {}.", self.places),
            format!("Silhouettes: {}.", self.silhouettes),
            format!("Places in the tables: {}.", self.points),
            format!("Pictures: {}.", self.pictures),
        ]
    }
}

impl MethodReport {
    /// The mean angular error away from silhouettes, degrees.
    pub fn inner_mean(&self) -> Option<f64> {
        Some(self.error.as_ref()?.inner.as_ref()?.mean)
    }
}

/// Mean, median, 95th percentile and maximum.
pub fn figures(spread: &Spread) -> [f64; 4] {
    [spread.mean, spread.median, spread.p95, spread.max]
}

fn summary(field: &Field) -> Option<Spread> {
    field.summary().map(Spread::from)
}

fn method_report(taken: &Taken, comparison: &Comparison) -> taotie::Result<MethodReport> {
    let error = match &taken.difference {
        Some(difference) => Some(ErrorReport {
            heat: taken.file_name("error"),
            all: summary(&difference.angles),
            inner: summary(&difference.angles.within(&comparison.inner)?),
            histogram: difference.angles.histogram(BINS, BINS as f32),
        }),
        None => None,
    };
    let pictures = taken.pictures.iter().enumerate().map(|(i, (shading, _))| {
        let difference = taken.difference.as_ref().map(|difference| &difference.pictures[i]);
        PictureReport {
            shading: shading.name(),
            file: taken.file_name(shading.name()),
            difference: difference.map(|difference| PictureFigures {
                rmse: difference.rmse,
                psnr: difference.psnr.is_finite().then_some(difference.psnr),
                ssim: difference.ssim,
                flip: summary(&difference.flip),
                flip_map: taken.file_name(&format!("{}.flip", shading.name())),
            }),
        }
    });
    Ok(MethodReport {
        method: taken.id(),
        what: taken.what(),
        milliseconds: taken.milliseconds,
        normals: taken.file_name("normals"),
        error,
        pictures: pictures.collect(),
    })
}

fn point_report(pixel: [u32; 2], comparison: &Comparison) -> PointReport {
    let first = normal_at(&comparison.taken[0].normals, pixel);
    let truth = normal_at(&comparison.truth, pixel);
    let angle = |a: Option<Vec3>, b: Option<Vec3>| Some(compare::angle_deg(a?.to_f64(), b?.to_f64()));
    let normals = comparison.taken.iter().enumerate().map(|(i, taken)| {
        // The reference's is that of the same place, not of the same pixel.
        let seen = if taken.method.is_some() { &taken.normals } else { &comparison.truth };
        let normal = normal_at(seen, pixel);
        PointNormal {
            method: taken.id(),
            normal: normal.map(Vec3::to_array),
            angle_to_first: angle(first, normal).filter(|_| i != 0),
            error: angle(truth, normal).filter(|_| i != comparison.against),
        }
    });
    PointReport { pixel, normals: normals.collect() }
}

fn normal_at(normals: &Image, [x, y]: [u32; 2]) -> Option<Vec3> {
    let [nx, ny, nz, covered] = normals.pixel(x, y);
    (covered == 1.0).then_some(Vec3::new(nx, ny, nz))
}

fn rules(plan: &Plan) -> Rules {
    Rules {
        angles: "degrees between a method's shading normal and the true one at the same place, each the mean over the \
                 pixel's samples",
        places: plan.matching.rule(),
        silhouettes: look::INNER_RULE,
        points: match &plan.points {
            points::PointChoice::Spread(_) => points::SPREAD_RULE.into(),
            points::PointChoice::Pixels(_) => "pixels as asked for, from the top left".into(),
        },
        pictures: format!(
            "developed sRGB pictures of 8 bits with their background; SSIM with Gaussian windows of 11×11 pixels \
             (Wang et al. 2004), FLIP at {PIXELS_PER_DEGREE:.0} pixels per degree (Andersson et al. 2020). Pixel by pixel, so they \
             count where the light mesh lies beside the heavy one as well as what its normals miss"
        ),
    }
}

fn parameters(plan: &Plan) -> Value {
    let settings = &plan.settings;
    json!({
        "size": [settings.width, settings.height],
        "samples": settings.samples,
        "shadows": settings.shadows,
        "shadings": plan.shadings.iter().map(|shading| shading.name()).collect::<Vec<_>>(),
        "matching": plan.matching.name(),
        "points": plan.points.to_string(),
        "heat_top_deg": plan.heat_top_deg,
        "material": plan.material,
        "tangents": settings.surface.tangents.map(Named::name),
        "bump_scale": settings.surface.bump_scale,
        "energy": settings.energy.name(),
        "specular_aa": settings.specular_aa,
        "grazing_normals": settings.grazing_normals.name(),
        "camera": {
            "world_from_view_columns": plan.camera.world_from_view.columns,
            "projection": projection(&plan.camera.projection),
        },
        "lights": plan.lighting.lights.iter().map(light).collect::<Vec<_>>(),
        "ambient": plan.lighting.ambient.to_array(),
        "environment": plan.environment,
        "exposure_stops": plan.development.exposure_stops,
        "tone": plan.development.tone.name(),
        "background": plan.development.background.map(Vec3::to_array),
        "pixels_per_degree": PIXELS_PER_DEGREE,
    })
}

fn projection(projection: &Projection) -> Value {
    match projection {
        Projection::Perspective { fov_y, aspect, near, far } => {
            json!({ "kind": "perspective", "fov_y_deg": fov_y.to_degrees(), "aspect": aspect, "near": near, "far": far })
        }
        Projection::Orthographic { half_width, half_height, near, far } => {
            json!({ "kind": "orthographic", "half_width": half_width, "half_height": half_height, "near": near, "far": far })
        }
    }
}

fn light(light: &Light) -> Value {
    let mut value = match &light.kind {
        LightKind::Point { position } => json!({ "kind": "point", "position": position.to_array() }),
        LightKind::Directional { direction } => {
            json!({ "kind": "directional", "direction": direction.to_array() })
        }
        LightKind::Spot { position, direction, inner, outer } => json!({
            "kind": "spot",
            "position": position.to_array(),
            "direction": direction.to_array(),
            "inner_deg": (*inner as f32).to_degrees(),
            "outer_deg": (*outer as f32).to_degrees(),
        }),
    };
    let falloff = match light.falloff {
        Falloff::None => json!("none"),
        Falloff::InverseSquare => json!("inverse-square"),
        Falloff::Windowed(range) => json!({ "inverse-square within": range }),
    };
    value["color"] = json!(light.color.to_array());
    value["falloff"] = falloff;
    value
}
