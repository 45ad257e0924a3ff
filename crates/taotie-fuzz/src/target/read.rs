//! The readers.

use super::promises::{Held, either, limits, load};
use super::subject::Subject;
use std::path::Path;
use taotie::asset::{BakeOptions, Packing};
use taotie::inspection::Inspection;
use taotie::studio::{LightSpec, MaterialFile};
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{Material, Scene};
use taotie_engine::shade::environment::Environment;
use taotie_io::{Loaded, decode_environment_within, read_bitmap_within};

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
