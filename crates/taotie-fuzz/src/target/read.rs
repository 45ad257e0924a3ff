//! The readers, and the promises of each for any file content.

use std::path::Path;
use taotie::asset::{BakeOptions, Packing};
use taotie::inspection::Inspection;
use taotie::studio::{LightSpec, MaterialFile};
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{Material, Scene};
use taotie_engine::shade::environment::Environment;
use taotie_io::{Bytes, Limits, Loaded, decode_environment_within, load_model_within, read_bitmap_within};

/// A damaged file on disk.
#[derive(Debug, Clone, Copy)]
pub struct Subject<'a> {
    /// The file.
    pub path: &'a Path,
    /// Its content.
    pub bytes: &'a [u8],
    /// The seed for the options of later steps.
    pub variant: u64,
}

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

fn has_finite_places(mesh: &Mesh) -> bool {
    mesh.positions().iter().all(|p| p.to_array().iter().all(|v| v.is_finite()))
}

/// Loads a model; `None` if the reader refuses it.
///
/// # Errors
/// The broken promise.
fn load(path: &Path) -> Result<Option<Loaded>, String> {
    match load_model_within(path, &limits()) {
        Ok(loaded) => is_consistent(&loaded).map(|()| Some(loaded)),
        Err(error) => error_is_told_well(&error).map(|()| None),
    }
}

/// Drops a successful result; checks the form of an error.
pub fn either<T>(result: taotie_engine::Result<T>) -> Held {
    result.map_or_else(|error| error_is_told_well(&error), |_| Ok(()))
}

/// A triangle with the material `m` of the file whose name is inserted.
const TRIANGLE: &str = "mtllib {}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";

/// Reads a model, inspects it, and poses its animations.
pub fn model(path: &Path) -> Held {
    let Some(loaded) = load(path)? else { return Ok(()) };
    let _ = Inspection::of(&loaded).hints();
    pose(loaded)
}

/// Poses at several times; each must give a scene or an error.
fn pose(mut loaded: Loaded) -> Held {
    let Some(rig) = loaded.rig else { return Ok(()) };
    for animation in 0..rig.animations().len().min(4) {
        let end = rig.animations()[animation].seconds();
        for seconds in [-1.0, 0.4 * end, end, 1e30] {
            either(rig.pose(&mut loaded.scene, animation, seconds))?;
        }
    }
    Ok(())
}

/// Reads a model with the materials of `path`.
pub fn materials(path: &Path) -> Held {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let obj = path.with_file_name("triangle.obj");
    std::fs::write(&obj, TRIANGLE.replace("{}", &name)).map_err(|error| error.to_string())?;
    load(&obj).map(drop)
}

/// Decodes a picture.
pub fn picture(path: &Path) -> Held {
    either(read_bitmap_within(path, &limits()))
}

/// Decodes a picture as an environment.
pub fn environment(subject: &Subject<'_>) -> Held {
    either(decode_environment_within(subject.bytes, subject.path, &limits()))
}

/// Reads a cached environment; if accepted, it must be written back identically.
pub fn cached(bytes: &[u8]) -> Held {
    match Environment::from_bytes(bytes) {
        Ok(environment) if environment.to_bytes() != bytes => Err("a cached environment changes".into()),
        result => either(result),
    }
}

/// Reads a material and applies it to a ball.
pub fn material(path: &Path) -> Held {
    let material = match MaterialFile::choose(&path.to_string_lossy()) {
        Ok(material) => material,
        refused => return either(refused),
    };
    let ball = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default());
    either(ball.and_then(|mut ball| material.apply(&mut ball)))
}

/// Reads an asset's provenance properties.
pub fn provenance(path: &Path) -> Held {
    either(Packing { provenance: Some(path.to_path_buf()), ..Packing::default() }.check())
}

/// Reads options and checks their ranges.
pub fn options(bytes: &[u8]) -> Held {
    serde_json::from_slice::<BakeOptions>(bytes).map_or(Ok(()), |options| either(options.check()))
}

/// Reads lights, one per line.
pub fn lights(bytes: &[u8]) -> Held {
    String::from_utf8_lossy(bytes).lines().try_for_each(|line| either(line.parse::<LightSpec>()))
}
