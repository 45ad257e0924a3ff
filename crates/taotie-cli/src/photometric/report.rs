//! The report of `taotie photometric`: as JSON, and as text.

use super::args::{ANCHORED, OUTPUTS};
use super::order::Order;
use super::relight::RelightReport;
use crate::console::name_of;
use serde::Serialize;
use std::fmt::Write;
use taotie::Warning;
use taotie::asset::StageTime;
use taotie_engine::compare::{Summary, angular_error};
use taotie_engine::length::Unit;
use taotie_engine::math::Vec3;
use taotie_engine::names::Named;
use taotie_photometric::{Anchoring, Coverage, Estimate, Estimator, Outline, RegionFinish, Samples};
use taotie_report::table::summary_text;

/// Version of the JSON.
const SCHEMA: u32 = 2;

/// The lights that the text lists.
const WORST: usize = 3;

/// The report on photographs.
#[derive(Serialize)]
pub struct Report {
    pub schema: u32,
    /// Version of the program.
    pub version: &'static str,
    /// The folder or `.lp` file, as given; in a collection, names of files are without folders.
    pub input: String,
    /// The folder of the written files; `.` in a collection.
    pub output: String,
    /// The file that states the lights.
    pub lights_from: String,
    /// The source of the lights: `lp`, `diligent`, `balls` or `relightable`.
    pub layout: &'static str,
    /// Chrome balls: x and y of the centre from the top left corner, radius, and root mean square distance of the edge
    /// from the circle, pixels.
    pub balls: Vec<[f64; 4]>,
    /// Root mean square angle between the directions that several chrome balls show and the lights, degrees.
    pub ball_residual: Option<f64>,
    /// The exponent between fitted and measured brightness: near 1 if the photographs are linear.
    pub exponent: Option<f64>,
    /// The side of a pixel, which is the unit of depth; `None` if depth is in pixels.
    pub pixel_size: Option<f64>,
    /// The unit of `pixel_size`; models are then in metres.
    pub unit: Option<Unit>,
    /// The mask that was used.
    pub mask: Option<String>,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Bits per channel of the photographs.
    pub bits: u8,
    /// The assumed encoding of the photographs: `linear` or `srgb`.
    pub encoding: &'static str,
    /// Pixels with a normal.
    pub pixels: usize,
    /// Degrees within which 68 % of the true normals are expected, over all pixels.
    pub sigma: Option<Summary>,
    /// Degrees between the normals by least squares and the robust ones.
    pub rejection: Option<Summary>,
    /// Degrees between the robust normals and those without indirect light.
    pub indirect: Option<Summary>,
    /// Degrees between the normals without indirect light and the written ones, for which the pixel program is fitted.
    pub fit: Option<Summary>,
    /// Regions with one highlight, the darkest first: pixels, and roughness and F0, or null if matt.
    pub regions: Vec<RegionFinish>,
    /// The albedo of bright pixels that indirect light implies.
    pub albedo: f64,
    /// The samples in shadow that the albedo was measured in; 0 if it is assumed.
    pub shadow_samples: usize,
    /// Light in shadows that the estimated relief does not explain, relative to all light there, in [0, 1].
    pub unexplained: f64,
    /// The photographs, in order.
    pub photographs: Vec<PhotographReport>,
    /// The relightable images that were written.
    pub relight: Vec<RelightReport>,
    /// How the depth follows the scan.
    pub scan: Option<Anchoring>,
    /// Degrees between the estimates and the true normals.
    pub truth: Option<Errors>,
    /// The duration of each stage.
    pub stages: Vec<StageTime>,
    /// Problems and corrections.
    pub warnings: Vec<Warning>,
}

/// A photograph and how well the estimate explains it.
#[derive(Serialize)]
pub struct PhotographReport {
    /// The name of its file.
    pub name: String,
    /// Unit vector towards the light, from the picture's centre.
    pub direction: [f64; 3],
    /// The place of a near lamp, pixels from the picture's centre.
    pub position: Option<[f64; 3]>,
    /// Brightness of the light relative to the others.
    pub brightness: f64,
    /// Root mean square of the residuals of lit samples, relative to the albedo.
    pub residual: f64,
    /// Fraction of the samples that are in shadow, in [0, 1].
    pub shadowed: f64,
    /// Fraction of the samples without weight in the fit, in [0, 1].
    pub rejected: f64,
    /// How far it is shifted from the others, in pixels to the right and down; absent if the surface does not show it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shift: Option<[f64; 2]>,
}

/// Degrees between estimates and true normals.
#[derive(Serialize)]
pub struct Errors {
    /// Least squares over all samples.
    pub least_squares: Summary,
    /// Without shadows and highlights.
    pub robust: Summary,
    /// Without shadows, highlights and indirect light.
    pub direct: Summary,
    /// The pixel program fitted to samples without shadows and indirect light: the written normals.
    pub best: Summary,
    /// Fractions of the written normals that are within their uncertainty.
    pub coverage: Option<Coverage>,
}

fn ball(outline: &Outline) -> [f64; 4] {
    let [x, y] = outline.circle.center;
    [x, y, outline.circle.radius, outline.residual]
}

impl Report {
    /// Describes an estimate.
    pub fn new(order: &Order<'_>, samples: &Samples, estimate: &Estimate) -> Self {
        let Order { set, options, .. } = order;
        let between = |a, b| angular_error(&estimate.normals(a), &estimate.normals(b)).ok()?.summary();
        let lights = set.photographs.iter().zip(&estimate.lights);
        let photograph =
            |(photograph, light): (&taotie_photometric::Photograph, &taotie_photometric::LightResiduals)| {
                PhotographReport {
                    name: name_of(&photograph.path),
                    direction: photograph.light.direction.to_array(),
                    position: photograph.light.position.map(Vec3::to_array),
                    brightness: photograph.light.intensity.iter().sum::<f64>() / 3.0,
                    residual: light.relative,
                    shadowed: light.shadowed,
                    rejected: light.rejected,
                    shift: light.shift.map(|shift| shift.pixels),
                }
            };
        Self {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            input: order.input.clone(),
            output: if order.is_portable { ".".into() } else { order.output.display().to_string() },
            lights_from: order.shown(&set.lights),
            layout: set.layout,
            balls: set.chrome.iter().flat_map(|chrome| &chrome.outlines).map(ball).collect(),
            ball_residual: set.chrome.as_ref().and_then(|chrome| chrome.residual_deg),
            exponent: estimate.exponent,
            pixel_size: options.pixel_size,
            unit: options.unit,
            mask: set.mask_or(options.mask.as_deref()).map(|path| order.shown(path)),
            size: [samples.width, samples.height],
            bits: samples.bits,
            encoding: samples.transfer.name(),
            pixels: estimate.best.iter().flatten().count(),
            sigma: estimate.sigma().ok().and_then(|sigma| sigma.summary()),
            rejection: between(Estimator::LeastSquares, Estimator::Robust),
            indirect: between(Estimator::Robust, Estimator::Direct),
            fit: between(Estimator::Direct, Estimator::Best),
            regions: estimate.regions.clone(),
            albedo: estimate.albedo,
            shadow_samples: estimate.shadows,
            unexplained: estimate.unexplained,
            photographs: lights.map(photograph).collect(),
            relight: Vec::new(),
            scan: None,
            truth: None,
            stages: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// Returns the report as text.
    pub fn text(&self) -> String {
        let encoding = if self.encoding == "srgb" { "sRGB" } else { "linear" };
        let (count, [width, height]) = (self.photographs.len(), self.size);
        let mut text = match self.layout {
            "relightable" => {
                format!(
                    "read       {}, {width}x{height}, {encoding}, relit by {count} lights\n",
                    self.lights_from
                )
            }
            _ => format!(
                "read       {count} photographs of {width}x{height}, {} bits, {encoding}; lights from {}\n",
                self.bits, self.lights_from
            ),
        };
        if let Some(mask) = &self.mask {
            let _ = writeln!(text, "mask       {mask}");
        }
        for [x, y, radius, residual] in &self.balls {
            // The mirrored direction turns twice as fast as the normal.
            let angle = (2.0 * residual / radius).to_degrees();
            let fit = match *residual {
                0.0 => ", as given".to_owned(),
                residual => format!(": edge to {residual:.2} pixels, lights to {angle:.2}°"),
            };
            let _ = writeln!(text, "ball       at {x:.1}, {y:.1}, radius {radius:.1}{fit}");
        }
        if let Some(residual) = self.ball_residual {
            let near = self.photographs.iter().filter(|photograph| photograph.position.is_some()).count();
            let _ = writeln!(
                text,
                "lamps      balls agree to {residual:.2}°; {near} of {} lamps are near",
                self.photographs.len()
            );
        }
        if self.balls.len() == 1 {
            let _ = writeln!(text, "lamps      distant: one ball does not show how far away they are");
        }
        if let Some(exponent) = self.exponent {
            let _ = writeln!(text, "linearity  brightness grows like the power {exponent:.2} of the light");
        }
        let _ = writeln!(text, "normals    {} pixels", self.pixels);
        let angles = [
            ("sigma", &self.sigma, "68 % of errors are expected below"),
            ("rejection", &self.rejection, "least squares against the robust estimate"),
            ("indirect", &self.indirect, "turned by removing light between parts of the object"),
            ("fit", &self.fit, "turned by fitting the reflection, with highlights"),
        ];
        for (name, angles, what) in angles {
            if let Some(angles) = angles {
                let _ = writeln!(
                    text,
                    "{name:<10} mean {:.2}°, median {:.2}°, p95 {:.2}°: {what}",
                    angles.mean, angles.median, angles.p95
                );
            }
        }
        let _ = match self.shadow_samples {
            0 => writeln!(
                text,
                "albedo     {:.2} assumed for bright pixels: shadows are too few or too dark to measure it, so that indirect light is not removed",
                self.albedo
            ),
            count => writeln!(
                text,
                "albedo     {:.2} of bright pixels, measured in {count} samples in shadow",
                self.albedo
            ),
        };
        for RegionFinish { pixels, finish } in &self.regions {
            let _ = match finish {
                Some(finish) => writeln!(
                    text,
                    "surface    roughness {:.2}, F0 {:.3}: {pixels} pixels",
                    finish.roughness, finish.f0
                ),
                None => writeln!(text, "surface    matt: {pixels} pixels"),
            };
        }
        let mut worst: Vec<&PhotographReport> = self.photographs.iter().collect();
        worst.sort_by(|a, b| b.residual.total_cmp(&a.residual));
        let worst = worst.iter().take(WORST);
        let worst: Vec<String> =
            worst.map(|light| format!("{} ({:.1} %)", light.name, 100.0 * light.residual)).collect();
        let _ = writeln!(text, "worst      {}: residual relative to the albedo", worst.join(", "));
        if let Some(errors) = &self.truth {
            let all = [
                ("least squares", &errors.least_squares),
                ("robust", &errors.robust),
                ("no indirect", &errors.direct),
                ("written", &errors.best),
            ];
            text.push('\n');
            for (name, angles) in all {
                let _ = writeln!(text, "{name:<14} {}", summary_text(angles, 2, "°"));
            }
            if let Some(Coverage { major, minor, radius }) = errors.coverage {
                let [a, b, c, d, e] = [radius, major[0], minor[0], major[1], minor[1]].map(|v| 100.0 * v);
                let _ = writeln!(
                    text,
                    "{a:.0} % of the written normals are within their sigma (68 % expected); along the axes \
                     {b:.0} and {c:.0} % within one standard deviation (68 %), {d:.0} and {e:.0} % within two (95 %)"
                );
            }
        }
        for RelightReport { file, terms, bytes, exposure, psnr, worst_psnr, worst } in &self.relight {
            let exposed = match (exposure - 1.0).abs() < 0.005 {
                true => String::new(),
                false => format!(", {exposure:.2} times as bright as the photographs"),
            };
            let _ = writeln!(
                text,
                "relight    {file}: {terms} terms, {:.1} MB{exposed}, {psnr:.1} dB; worst {worst} ({worst_psnr:.1} dB)",
                *bytes as f64 / 1e6
            );
        }
        if let Some(Anchoring { scanned, moved, residual, .. }) = &self.scan {
            let _ = writeln!(
                text,
                "scan       {scanned} pixels; moved heights by {moved:.2} pixels rms; {residual:.2} pixels remain (median)"
            );
        }
        let relight = self.relight.iter().map(|relight| relight.file);
        let anchored = self.scan.map(|_| ANCHORED);
        let files: Vec<&str> = OUTPUTS.into_iter().chain(anchored).chain(relight).collect();
        let _ = write!(text, "\nwrote {} to {}", files.join(", "), self.output);
        text
    }
}
