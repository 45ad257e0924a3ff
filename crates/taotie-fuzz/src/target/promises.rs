//! The promises of every reader, for any file content.

use std::path::Path;
use taotie_io::{Bytes, Limits, Loaded, load_model_within};

/// `Ok` if all promises were kept; otherwise the broken one.
pub type Held = std::result::Result<(), String>;

/// The memory limit for readers and bakes. The limit of a run (`--memory`) is larger, by what the files and the
/// harness itself take.
const MEMORY: Bytes = Bytes(256 << 20);

/// The triangle limit for readers and bakes: a few hundred bytes may reference one mesh thousands of times, and
/// baking half a million triangles takes about as long as a run may take.
const TRIANGLES: u64 = 1 << 18;

/// Returns the limits for readers and bakes.
pub fn limits() -> Limits {
    Limits { memory: Some(MEMORY), triangles: TRIANGLES, ..Limits::default() }
}

/// Checks that an error is a single line.
pub fn error_is_told_well(error: &taotie_engine::Error) -> Held {
    let text = error.to_string();
    if text.contains('\n') { Err(format!("an error with several lines: {text:?}")) } else { Ok(()) }
}

/// Checks that a model accepted by a reader is consistent.
pub fn is_consistent(loaded: &Loaded) -> Held {
    let scene = &loaded.scene;
    let (meshes, materials) = (scene.meshes().len(), scene.materials().len());
    let promises = [
        (scene.instances().iter().all(|i| i.mesh < meshes), "an instance without a mesh"),
        (scene.instances().iter().all(|i| i.material < materials), "an instance without a material"),
        (loaded.texture_names.len() == scene.textures().len(), "textures without names"),
        (scene.meshes().iter().all(has_finite_places), "a vertex that is not finite"),
        (loaded.warnings.iter().all(|(what, _)| !what.contains('\n')), "a warning with several lines"),
    ];
    promises.iter().find(|(kept, _)| !kept).map_or(Ok(()), |(_, what)| Err((*what).to_owned()))
}

fn has_finite_places(mesh: &taotie_engine::mesh::Mesh) -> bool {
    mesh.positions().iter().all(|p| p.to_array().iter().all(|v| v.is_finite()))
}

/// Loads a model; `None` if the reader refuses it.
///
/// # Errors
/// The broken promise.
pub fn load(path: &Path) -> Result<Option<Loaded>, String> {
    match load_model_within(path, &limits()) {
        Ok(loaded) => is_consistent(&loaded).map(|()| Some(loaded)),
        Err(error) => error_is_told_well(&error).map(|()| None),
    }
}

/// Drops a successful result; checks the form of an error.
pub fn either<T>(result: taotie_engine::Result<T>) -> Held {
    result.map_or_else(|error| error_is_told_well(&error), |_| Ok(()))
}
