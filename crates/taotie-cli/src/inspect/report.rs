//! The report: counts, extent, and what meshes, materials and warnings have to tell.

use super::material::{MaterialReport, Materials};
use super::mesh::MeshReport;
use super::{hints, mesh};
use serde::Serialize;
use std::path::Path;
use taotie::Warnings;
use taotie::io::Loaded;
use taotie::render::{Prepared, SurfaceSettings};
use taotie::scene::animation::Animation;
use taotie::scene::{Camera, Light, LightKind, Projection, Scene};

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 3;

/// What is in a model and what is wrong with it.
#[derive(Debug, Serialize)]
pub struct Report {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Of the program.
    pub version: &'static str,
    /// The path asked for.
    pub model: String,
    /// `glTF`, `GLB`, `OBJ`, `PLY` or `STL`.
    pub format: &'static str,
    /// The program that wrote the file.
    pub generator: Option<String>,
    /// The rights notice.
    pub copyright: Option<String>,
    /// How many of each.
    pub counts: Counts,
    /// World space; `None` where nothing is drawn.
    pub bounds: Option<Extent>,
    /// In the order of the file.
    pub meshes: Vec<MeshReport>,
    /// In the order of the file.
    pub materials: Vec<MaterialReport>,
    /// The file's lights.
    pub lights: Vec<Named>,
    /// The file's cameras.
    pub cameras: Vec<Named>,
    /// The file's animations.
    pub animations: Vec<AnimationReport>,
    /// Names of the sets of materials that the file offers.
    pub variants: Vec<String>,
    /// Files that the model names and that are not there.
    pub missing_files: Vec<String>,
    /// glTF extensions that the file uses.
    pub extensions_used: Vec<String>,
    /// glTF extensions that the file requires.
    pub extensions_required: Vec<String>,
    /// What would be ignored or put right when the model is rendered.
    pub warnings: Vec<Counted>,
    /// What to try.
    pub hints: Vec<String>,
}

/// How many of each there are.
#[derive(Debug, Serialize)]
pub struct Counts {
    /// Meshes; each primitive of glTF and each material of an OBJ file counts as one.
    pub meshes: usize,
    /// Meshes placed in the world.
    pub instances: usize,
    /// Triangles of the meshes.
    pub triangles: usize,
    /// Triangles of the instances.
    pub triangles_drawn: usize,
    /// Vertices of the meshes.
    pub vertices: usize,
    /// Materials.
    pub materials: usize,
    /// Textures that could be read.
    pub textures: usize,
    /// Lights.
    pub lights: usize,
    /// Cameras.
    pub cameras: usize,
    /// Animations.
    pub animations: usize,
}

/// An axis-aligned box in world space, model units.
#[derive(Debug, Serialize)]
pub struct Extent {
    /// The corner of least coordinates.
    pub min: [f64; 3],
    /// The corner of greatest coordinates.
    pub max: [f64; 3],
    /// `max` − `min`.
    pub size: [f64; 3],
}

/// A light or camera.
#[derive(Debug, Serialize)]
pub struct Named {
    /// As in the file; may be empty.
    pub name: String,
    /// Its form, such as `spot` or `perspective`.
    pub kind: &'static str,
}

/// An animation.
#[derive(Debug, Serialize)]
pub struct AnimationReport {
    /// As in the file; may be empty.
    pub name: String,
    /// The time of its last keyframe.
    pub seconds: f64,
    /// What it moves: channels that can be used.
    pub channels: usize,
    /// The keyframes of all channels.
    pub keyframes: usize,
}

/// A warning.
#[derive(Debug, Serialize)]
pub struct Counted {
    /// What was wrong.
    pub what: String,
    /// How often.
    pub count: usize,
}

impl Report {
    /// The report about a model that was read from `path`.
    pub fn new(path: &Path, loaded: &Loaded) -> Self {
        let scene = &loaded.scene;
        let mut report = Self {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            model: path.display().to_string(),
            format: loaded.format,
            generator: loaded.generator.clone(),
            copyright: loaded.copyright.clone(),
            counts: Counts::new(loaded),
            bounds: Extent::of(scene),
            meshes: mesh::reports(loaded),
            materials: Materials::new(loaded).reports(),
            lights: scene.lights().iter().map(named_light).collect(),
            cameras: scene.cameras().iter().map(named_camera).collect(),
            animations: animations(loaded).iter().map(AnimationReport::new).collect(),
            variants: loaded.variants.names().to_vec(),
            missing_files: loaded.missing_files.clone(),
            extensions_used: loaded.extensions_used.clone(),
            extensions_required: loaded.extensions_required.clone(),
            warnings: warnings(loaded),
            hints: Vec::new(),
        };
        report.hints = hints::of(&report);
        report
    }
}

impl Counts {
    fn new(loaded: &Loaded) -> Self {
        let scene = &loaded.scene;
        Self {
            meshes: scene.meshes().len(),
            instances: scene.instances().len(),
            triangles: scene.meshes().iter().map(|mesh| mesh.triangles().len()).sum(),
            triangles_drawn: scene.triangle_count(),
            vertices: scene.meshes().iter().map(|mesh| mesh.positions().len()).sum(),
            materials: scene.materials().len(),
            textures: scene.textures().len(),
            lights: scene.lights().len(),
            cameras: scene.cameras().len(),
            animations: animations(loaded).len(),
        }
    }
}

fn animations(loaded: &Loaded) -> &[Animation] {
    loaded.rig.as_ref().map_or(&[], |rig| rig.animations())
}

impl AnimationReport {
    fn new(animation: &Animation) -> Self {
        let keyframes = animation.channels.iter().map(|c| animation.samplers[c.sampler].times().len());
        Self {
            name: animation.name.clone(),
            seconds: animation.seconds(),
            channels: animation.channels.len(),
            keyframes: keyframes.sum(),
        }
    }
}

impl Extent {
    fn of(scene: &Scene) -> Option<Self> {
        let bounds = scene.bounds()?;
        let size = (bounds.max - bounds.min).to_array();
        Some(Self { min: bounds.min.to_array(), max: bounds.max.to_array(), size })
    }
}

fn named_light(light: &Light) -> Named {
    let kind = match light.kind {
        LightKind::Point { .. } => "point",
        LightKind::Directional { .. } => "directional",
        LightKind::Spot { .. } => "spot",
    };
    Named { name: light.name.clone(), kind }
}

fn named_camera(camera: &Camera) -> Named {
    let kind = match camera.projection {
        Projection::Perspective { .. } => "perspective",
        Projection::Orthographic { .. } => "orthographic",
    };
    Named { name: camera.name.clone(), kind }
}

/// What reading noted, and what rendering would note.
fn warnings(loaded: &Loaded) -> Vec<Counted> {
    let mut all: Warnings = loaded.warnings.clone();
    match Prepared::new(&loaded.scene, &SurfaceSettings::default()) {
        Ok(prepared) => all.absorb(prepared.warnings().clone()),
        Err(error) => all.note(format!("it cannot be rendered: {error}"), 1),
    }
    all.iter().map(|(what, count)| Counted { what: what.to_owned(), count }).collect()
}
