//! The promises of every reader, whatever the file holds.

use std::path::Path;
use taotie::io::{Bytes, Limits, Loaded, load_model_within};

/// `Ok` where all promises were kept; else the one that was not.
pub type Held = std::result::Result<(), String>;

/// The memory that readers and bakes are told to keep to. What a run may allocate (`--memory`) is more by what the files and
/// the harness itself take.
const MEMORY: Bytes = Bytes(256 << 20);

/// The triangles that readers and bakes are told to keep to: a few hundred bytes may name one mesh thousands of times, and
/// to bake half a million triangles takes about the time that a run may take.
const TRIANGLES: u64 = 1 << 18;

/// The limits that readers and bakes are told to keep to.
pub fn limits() -> Limits {
    Limits { memory: Some(MEMORY), triangles: TRIANGLES, ..Limits::default() }
}

/// Holds that an error is one line.
pub fn error_is_told_well(error: &taotie::Error) -> Held {
    let text = error.to_string();
    if text.contains('\n') { Err(format!("an error of several lines: {text:?}")) } else { Ok(()) }
}

/// Holds that a model which a reader lets through is consistent.
pub fn is_consistent(loaded: &Loaded) -> Held {
    let scene = &loaded.scene;
    let (meshes, materials) = (scene.meshes().len(), scene.materials().len());
    let promises = [
        (scene.instances().iter().all(|i| i.mesh < meshes), "an instance of no mesh"),
        (scene.instances().iter().all(|i| i.material < materials), "an instance of no material"),
        (loaded.texture_names.len() == scene.textures().len(), "textures without names"),
        (scene.meshes().iter().all(has_finite_places), "a vertex that is nowhere"),
        (loaded.warnings.iter().all(|(what, _)| !what.contains('\n')), "a warning of several lines"),
    ];
    promises.iter().find(|(kept, _)| !kept).map_or(Ok(()), |(_, what)| Err((*what).to_owned()))
}

fn has_finite_places(mesh: &taotie::mesh::Mesh) -> bool {
    mesh.positions().iter().all(|p| p.to_array().iter().all(|v| v.is_finite()))
}

/// Loads a model; `None` where the reader refuses it.
///
/// # Errors
/// The promise that was not kept.
pub fn load(path: &Path) -> Result<Option<Loaded>, String> {
    match load_model_within(path, &limits()) {
        Ok(loaded) => is_consistent(&loaded).map(|()| Some(loaded)),
        Err(error) => error_is_told_well(&error).map(|()| None),
    }
}

/// Drops what was read; an error has to be told well.
pub fn either<T>(result: taotie::Result<T>) -> Held {
    result.map_or_else(|error| error_is_told_well(&error), |_| Ok(()))
}
