//! Scenes of several models, and models written to files.

use crate::model::{Model, smooth};
use crate::work::{self, Listed};
use pyo3::prelude::*;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use taotie::asset::ScanOptions;
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::scene::{Instance, Light, LightKind, Scene, SceneData, rigid};
use taotie_engine::{Result, Warnings};
use taotie_io::{FileSet, GltfFormat, Loaded};

/// A model, and the columns of the transform that places it in the scene.
type Part = (Py<Model>, [[f64; 4]; 4]);

/// Returns a model of several ones, each placed by a transform, with their lights and cameras.
#[pyfunction]
pub fn join(py: Python<'_>, parts: Vec<Part>) -> PyResult<Model> {
    work::detached(py, || {
        let mut joined = Joined::default();
        parts.iter().for_each(|(model, columns)| joined.add(model, &Mat4 { columns: *columns }));
        let options = joined.common_options(parts.iter().map(|(model, _)| model.get().reading_options()));
        let mut loaded = Loaded::new(Scene::new(joined.data)?, joined.warnings, "arrays");
        loaded.mesh_names = joined.mesh_names;
        Ok(Model::in_memory(loaded).read_as(options))
    })
}

/// The parts of a scene that have been joined.
#[derive(Default)]
struct Joined {
    data: SceneData,
    mesh_names: Vec<String>,
    warnings: Warnings,
    /// The first mesh and the first material of each model: one that is placed several times is stored once.
    starts: HashMap<usize, [usize; 2]>,
}

impl Joined {
    fn add(&mut self, model: &Py<Model>, world: &Mat4) {
        let loaded = &model.get().loaded;
        let start = match self.starts.get(&model.as_ptr().addr()) {
            Some(start) => *start,
            None => {
                let start = self.store(loaded);
                self.starts.insert(model.as_ptr().addr(), start);
                start
            }
        };
        self.place(&loaded.scene, start, world);
    }

    /// Returns the options for reading the models as one scan: those that they have in common.
    fn common_options(&mut self, all: impl Iterator<Item = ScanOptions>) -> ScanOptions {
        let mut all: Vec<ScanOptions> = all.collect();
        // Arrays have no unit: they are in that of the others.
        let unit = all.iter().find_map(|options| options.unit);
        all.iter_mut().for_each(|options| options.unit = options.unit.or(unit));
        let first = all.first().copied().unwrap_or_default();
        let differs = all.iter().any(|options| *options != first);
        let what =
            "the models were loaded with different units or options: their numbers are taken as they are";
        self.warnings.note(what, usize::from(differs));
        if differs { ScanOptions::default() } else { first }
    }

    /// Adds meshes, materials and textures; returns the first mesh and the first material.
    fn store(&mut self, loaded: &Loaded) -> [usize; 2] {
        let all = &mut self.data;
        let start = [all.meshes.len(), all.materials.len()];
        let (instances, lights, cameras) = (Vec::new(), Vec::new(), Vec::new());
        all.append(SceneData { instances, lights, cameras, ..loaded.scene.clone().into_data() });
        self.mesh_names.extend(loaded.mesh_names.iter().cloned());
        self.mesh_names.resize(all.meshes.len(), String::new());
        self.warnings.absorb(loaded.warnings.clone());
        start
    }

    /// Adds instances, lights and cameras.
    fn place(&mut self, scene: &Scene, [mesh, material]: [usize; 2], world: &Mat4) {
        self.data.instances.extend(scene.instances().iter().map(|instance| Instance {
            mesh: instance.mesh + mesh,
            material: instance.material + material,
            world_from_object: *world * instance.world_from_object,
        }));
        self.data.lights.extend(scene.lights().iter().map(|light| placed_light(light, world)));
        self.data.cameras.extend(scene.cameras().iter().cloned().map(|mut camera| {
            camera.world_from_view = rigid(&(*world * camera.world_from_view));
            camera
        }));
    }
}

fn placed_light(light: &Light, world: &Mat4) -> Light {
    let at = |point: &Vec3| world.transform_point(point.to_f64()).to_f32();
    let along = |axis: &Vec3| world.transform_vector(axis.to_f64()).normalize_or(axis.to_f64()).to_f32();
    let mut light = light.clone();
    match &mut light.kind {
        LightKind::Point { position } => *position = at(position),
        LightKind::Directional { direction } => *direction = along(direction),
        LightKind::Spot { position, direction, .. } => {
            (*position, *direction) = (at(position), along(direction))
        }
    }
    light
}

/// Writes a model as glTF, and returns warnings about everything that glTF cannot express.
#[pyfunction]
pub fn save_model(py: Python<'_>, model: &Model, path: PathBuf) -> PyResult<Listed> {
    work::detached(py, || write(model, &path)).map(|warnings| work::listed(&warnings))
}

fn write(model: &Model, path: &Path) -> Result<Warnings> {
    let Loaded { scene, mesh_names, files, .. } = &model.loaded;
    let scene = smooth(scene)?;
    let sources = FileSet::new();
    sources.protect(model.path.iter().chain(files))?;
    sources.claim(path)?;
    let is_glb = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("glb"));
    if !is_glb {
        return Ok(taotie_io::write_scene(path, &scene, &GltfFormat::default())?.warnings);
    }
    let mut warnings = Warnings::default();
    let bytes = taotie_io::encode_scene(&scene, mesh_names, &mut warnings)?;
    FileSet::one(|files| files.write_bytes(path, &bytes))?;
    Ok(warnings)
}
