//! Shows why the relief of moving surfaces is stored in tangent space: the pouring vessel, drawn with either kind of
//! map and measured against its relief as geometry under the same skin.

use super::stage::{self, Stage};
use super::{Output, Vessel};
use crate::jue::pour::{Eye, POURED, Pouring, RULE, TIP_DEG, Truth, angular_errors};
use crate::jue::with_relief;
use serde::Serialize;
use std::path::PathBuf;
use taotie_engine::Result;
use taotie_engine::compare::Summary;
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::Scene;
use taotie_report::sheet::{Cell, Sheet};

/// The side of the pictures in which errors are measured, pixels.
const SIDE: u32 = 640;
/// Pictures per row: object space, tangent space, the ground truth.
const COLUMNS: usize = 3;

/// The figures of both kinds of map, and their meaning.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Report {
    /// The angle by which the cup is tipped, degrees.
    pub tip_deg: f64,
    /// The measurement rule in words.
    pub rule: &'static str,
    /// Object space, then tangent space.
    pub methods: Vec<MethodReport>,
}

/// The angular error of one kind of map, degrees.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct MethodReport {
    /// The name of its surface method.
    pub method: &'static str,
    /// The error at rest.
    pub at_rest: Summary,
    /// The error of the poured vessel.
    pub poured: Summary,
}

/// The kinds of map, with the reasons for their figures.
const METHODS: [(&str, &str); 2] = [
    ("object-normal", "its normals stay as baked while the surface turns"),
    (
        "tangent-normal",
        "its normals are relative to the moved normal and tangent, so they turn with the surface",
    ),
];

/// Draws and measures both kinds of map at rest and poured, and writes `moving.png`. `displaced` is the vessel with
/// its relief as geometry; `progress` is called with the fraction done.
///
/// # Errors
/// Those of rendering and writing.
pub fn write(
    vessel: &Vessel,
    displaced: &Mesh,
    output: &Output<'_>,
    progress: &dyn Fn(f64),
) -> Result<(Report, PathBuf)> {
    let truths = [Truth::at(displaced, 0.0)?, Truth::at(displaced, POURED)?];
    progress(0.3);
    let scene = vessel.scene();
    let scenes = [vessel.object_scene().clone(), scene.clone()];
    let mut vessels = scenes.into_iter().map(Pouring::new).collect::<Result<Vec<_>>>()?;
    let methods = measured(&mut vessels, &truths, scene)?;
    progress(0.6);
    let (rest, poured) = (shape_of(&mut vessels[0], 0.0)?, shape_of(&mut vessels[0], POURED)?);
    let artist = Artist { side: output.side, stage: Stage::whole_in(&[&rest, &poured])? };
    let mut cells = Vec::new();
    for (seconds, truth) in [0.0, POURED].into_iter().zip(&truths) {
        for (vessel, method) in vessels.iter_mut().zip(&methods) {
            cells.push(artist.cell(method.labels(seconds), vessel.at(seconds)?)?);
        }
        let labels = (format!("displaced mesh, {}", pose(seconds)), "the truth".into());
        cells.push(artist.cell(labels, &with_relief(scene, truth.mesh().clone()))?);
        progress(0.8);
    }
    let report = Report { tip_deg: TIP_DEG, rule: RULE, methods };
    Ok((report, write_sheet(output, &cells)?))
}

fn measured(vessels: &mut [Pouring], truths: &[Truth; 2], scene: &Scene) -> Result<Vec<MethodReport>> {
    // The same camera as for comparing the methods at rest.
    let eye = Eye { camera: Stage::cup(scene)?.camera, side: SIDE };
    let measure = |(vessel, (method, _)): (&mut Pouring, (&'static str, &str))| {
        let [at_rest, poured] = angular_errors(vessel, truths, &eye)?;
        Ok(MethodReport { method, at_rest, poured })
    };
    vessels.iter_mut().zip(METHODS).map(measure).collect()
}

fn pose(seconds: f64) -> &'static str {
    if seconds == 0.0 { "at rest" } else { "poured" }
}

impl MethodReport {
    /// Returns the title and the note of a picture.
    fn labels(&self, seconds: f64) -> (String, String) {
        let error = if seconds == 0.0 { &self.at_rest } else { &self.poured };
        (format!("{}, {}", self.method, pose(seconds)), format!("mean angular error {:.1}°", error.mean))
    }
}

/// Renders the pictures.
struct Artist {
    side: u32,
    stage: Stage,
}

impl Artist {
    fn cell(&self, (title, note): (String, String), scene: &Scene) -> Result<Cell> {
        let image = self.stage.take(scene, &Stage::settings(self.side, 16))?;
        Ok(Cell { title, note, pixels: stage::pixels(&image)? })
    }
}

/// Returns the posed scene, for framing.
fn shape_of(vessel: &mut Pouring, seconds: f64) -> Result<Scene> {
    let posed = vessel.at(seconds)?;
    Ok(posed.clone())
}

fn write_sheet(output: &Output<'_>, cells: &[Cell]) -> Result<PathBuf> {
    let path = output.folder.join("moving.png");
    let sheet = Sheet::new(cells, [output.side as usize; 2], COLUMNS);
    output.files.write_png(&path, &sheet.png())?;
    Ok(path)
}

impl Report {
    /// Returns the figures as lines of text, with the reasons for them.
    pub fn lines(&self) -> Vec<String> {
        let head = format!(
            "mean angular error on the moving part, at rest and with the vessel tipped by {}°:",
            self.tip_deg
        );
        let line = |(method, (_, why)): (&MethodReport, &(&str, &str))| {
            let MethodReport { method, at_rest, poured } = method;
            format!("  {method:<15} {:>6.2}° {:>6.2}°  {why}", at_rest.mean, poured.mean)
        };
        std::iter::once(head).chain(self.methods.iter().zip(&METHODS).map(line)).collect()
    }
}
