//! Why relief of a moving surface is stored in tangent space: the vessel pours, drawn with either kind of map and
//! measured against its relief as geometry under the same skin.

use super::DemoArgs;
use super::stage::{self, Stage};
use super::truth::with_relief;
use crate::jue::pour::{Eye, POURED, Pouring, RULE, TIP_DEG, Truth, angular_errors};
use crate::sheet::{Cell, Sheet};
use crate::spread::Spread;
use anyhow::Result;
use serde::Serialize;
use std::path::PathBuf;
use taotie::film;
use taotie::io;
use taotie::mesh::Mesh;
use taotie::scene::Scene;

/// Pixels along a side of the pictures that errors are measured in.
const SIDE: u32 = 640;
/// Pictures in a row: object space, tangent space, the truth.
const COLUMNS: usize = 3;

/// What came of it.
#[derive(Serialize)]
pub struct Report {
    /// How far the cup is tipped, degrees.
    tip_deg: f64,
    /// What the figures mean.
    rule: &'static str,
    /// Object space, then tangent space.
    methods: Vec<MethodReport>,
}

/// The angular error of one kind of map, degrees.
#[derive(Serialize)]
struct MethodReport {
    method: &'static str,
    at_rest: Spread,
    poured: Spread,
}

/// The kinds of map with the reason for their figures.
const METHODS: [(&str, &str); 2] = [
    ("object-normal", "its normals stay as they were baked while the surface turns away under them"),
    ("tangent-normal", "its normals stand on the moved normal and tangent and go with the surface"),
];

/// Draws and measures both kinds of map at rest and poured; writes `moving.png`. `object_scene` is `scene` with its
/// object-space map.
///
/// # Errors
/// Those of rendering and writing.
pub fn write(
    args: &DemoArgs,
    [object_scene, scene]: [&Scene; 2],
    displaced: &Mesh,
    progress: &dyn Fn(f64),
) -> Result<(Report, Vec<PathBuf>)> {
    let truths = [Truth::at(displaced, 0.0)?, Truth::at(displaced, POURED)?];
    progress(0.3);
    let scenes = [object_scene.clone(), scene.clone()];
    let mut vessels = scenes.into_iter().map(Pouring::new).collect::<taotie::Result<Vec<_>>>()?;
    let methods = measured(&mut vessels, &truths, scene)?;
    progress(0.6);
    let (rest, poured) = (shape_of(&mut vessels[0], 0.0)?, shape_of(&mut vessels[0], POURED)?);
    let artist = Artist { side: args.size, stage: Stage::whole_in(&[&rest, &poured]) };
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
    Ok((report, vec![write_sheet(args, &cells)?]))
}

fn measured(vessels: &mut [Pouring], truths: &[Truth; 2], scene: &Scene) -> Result<Vec<MethodReport>> {
    // From where the methods are compared at rest.
    let eye = Eye { camera: Stage::cup(scene).camera, side: SIDE };
    let measure = |(vessel, (method, _)): (&mut Pouring, (&'static str, &str))| {
        let [at_rest, poured] = angular_errors(vessel, truths, &eye)?.map(Spread::from);
        Ok(MethodReport { method, at_rest, poured })
    };
    vessels.iter_mut().zip(METHODS).map(measure).collect()
}

fn pose(seconds: f64) -> &'static str {
    if seconds == 0.0 { "at rest" } else { "poured" }
}

impl MethodReport {
    /// What a picture is called and what is said of it.
    fn labels(&self, seconds: f64) -> (String, String) {
        let error = if seconds == 0.0 { &self.at_rest } else { &self.poured };
        (format!("{}, {}", self.method, pose(seconds)), format!("mean angular error {:.1}°", error.mean))
    }
}

/// Takes the pictures.
struct Artist {
    side: u32,
    stage: Stage,
}

impl Artist {
    fn cell(&self, (title, note): (String, String), scene: &Scene) -> Result<Cell> {
        let image = self.stage.take(scene, &Stage::settings(self.side, 16))?;
        let pixels = film::develop8(&image, &stage::development())?;
        Ok(Cell { title, note, pixels: pixels.into_iter().map(|[r, g, b, _]| [r, g, b]).collect() })
    }
}

/// The shape alone, to frame it.
fn shape_of(vessel: &mut Pouring, seconds: f64) -> taotie::Result<Scene> {
    let posed = vessel.at(seconds)?;
    Ok(posed.clone())
}

/// The same bronze with this mesh, whose relief is geometry.
fn write_sheet(args: &DemoArgs, cells: &[Cell]) -> Result<PathBuf> {
    let path = args.out.join("moving.png");
    let sheet = Sheet::new(cells, [args.size as usize; 2], COLUMNS);
    io::write_png(&path, &sheet.png())?;
    Ok(path)
}

/// The figures, and why they are so.
pub fn lines(report: &Report) -> Vec<String> {
    let head = format!(
        "mean angular error on the moving part, at rest and when the vessel has poured by {}°:",
        report.tip_deg
    );
    let line = |(method, (_, why)): (&MethodReport, &(&str, &str))| {
        let MethodReport { method, at_rest, poured } = method;
        format!("  {method:<15} {:>6.2}° {:>6.2}°  {why}", at_rest.mean, poured.mean)
    };
    std::iter::once(head).chain(report.methods.iter().zip(&METHODS).map(line)).collect()
}
