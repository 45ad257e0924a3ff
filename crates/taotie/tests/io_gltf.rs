//! glTF files by others.
#![allow(clippy::print_stderr)]
mod common;
use taotie::io::load_model;

#[test]
fn walk() {
    for sub in [
        "khronos-gltf-sample-assets",
        "gltf-asset-generator",
        "polyhaven-models",
        "materialx",
        "malformed-and-odd-inputs",
        "gltf-validator",
    ] {
        let Some(folder) = common::data_folder(sub) else { continue };
        for path in common::files_below(&folder, &["gltf", "glb"]) {
            let start = std::time::Instant::now();
            let short = path.strip_prefix(&folder).unwrap().display().to_string();
            match load_model(&path) {
                Ok(m) => eprintln!(
                    "OK  {sub} {short} {:?} tris {} mats {} tex {} lights {} cams {}\n      {:?}",
                    start.elapsed(),
                    m.scene.triangle_count(),
                    m.scene.materials.len(),
                    m.scene.textures.len(),
                    m.scene.lights.len(),
                    m.scene.cameras.len(),
                    m.warnings.iter().collect::<Vec<_>>()
                ),
                Err(e) => eprintln!("ERR {sub} {e}"),
            }
        }
    }
}
