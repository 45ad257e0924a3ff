//! Third-party models and broken files: a picture, or one line that names the file.

use crate::common::data_folder;
use crate::files::{all_files_below, data_files};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use taotie_engine::bake::Faults;
use taotie_engine::image::Texels;
use taotie_io::read_bitmap;
use tempfile::TempDir;

/// How a run ended: the exit code, `None` if it crashed, and stderr.
struct Ending {
    code: Option<i32>,
    stderr: String,
}

/// Runs the command in `folder`.
fn run(folder: &Path, arguments: &[&Path]) -> Ending {
    let run = Command::new(env!("CARGO_BIN_EXE_taotie"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .expect("the command starts");
    Ending { code: run.status.code(), stderr: String::from_utf8_lossy(&run.stderr).into_owned() }
}

const SMALL: [&str; 6] = ["--size", "64x64", "--samples", "1", "--background", "transparent"];

fn render(folder: &Path, model: &Path, more: &[&Path]) -> Ending {
    let picture = folder.join("out.png");
    let _ = std::fs::remove_file(&picture);
    let fixed = ["render".as_ref(), model, "-o".as_ref(), &picture];
    let arguments: Vec<&Path> =
        fixed.into_iter().chain(SMALL.iter().map(Path::new)).chain(more.iter().copied()).collect();
    run(folder, &arguments)
}

/// Returns true if anything is visible in the transparent picture.
fn shows_something(picture: &Path) -> bool {
    let bitmap = read_bitmap(picture).expect("the picture can be read");
    matches!(bitmap.texels(), Texels::U8(texels) if texels.iter().any(|texel| texel[3] > 0))
}

/// Returns true if the only line is an error that names the file.
fn is_one_line_about(stderr: &str, file: &Path) -> bool {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    stderr.lines().count() == 1 && stderr.starts_with("taotie: error: ") && stderr.contains(&*name)
}

/// Returns the fault of a rendered model.
fn fault(folder: &Path, model: &Path, ending: &Ending) -> Option<String> {
    let right = match ending.code {
        Some(0) => shows_something(&folder.join("out.png")),
        Some(2) => is_one_line_about(&ending.stderr, model) && !folder.join("out.png").exists(),
        _ => false,
    };
    let name = model.display();
    (!right).then(|| format!("{name}: exit code {:?}\n{}", ending.code, ending.stderr))
}

/// Returns the fault of a run that crashed, which no file may cause.
fn crash(file: &Path, ending: &Ending) -> Option<String> {
    let right = matches!(ending.code, Some(0 | 2)) && !ending.stderr.contains("panicked");
    (!right).then(|| format!("{}: exit code {:?}\n{}", file.display(), ending.code, ending.stderr))
}

fn none(faults: &[String]) {
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

fn temporary() -> TempDir {
    tempfile::tempdir().expect("temporary folders can be made")
}

#[test]
fn every_sample_asset_renders_or_says_why_not() {
    let folder = temporary();
    let models = data_files("khronos-gltf-sample-assets", &["gltf", "glb", "obj"]);
    let check = |model: &PathBuf| fault(folder.path(), model, &render(folder.path(), model, &[]));
    none(&models.iter().filter_map(check).collect::<Vec<_>>());
}

#[test]
fn every_broken_model_ends_in_a_picture_or_one_line() {
    let folder = temporary();
    let mut faults = Vec::new();
    for model in data_files("malformed-and-odd-inputs", &["gltf", "glb", "obj", "ply", "stl"]) {
        let ending = render(folder.path(), &model, &[]);
        let lines = ending.code == Some(2) && !is_one_line_about(&ending.stderr, &model);
        faults.extend(lines.then(|| format!("{}: not one line:\n{}", model.display(), ending.stderr)));
        faults.extend(crash(&model, &ending));
        faults.extend(crash(&model, &run(folder.path(), &["inspect".as_ref(), &model])));
    }
    none(&faults);
}

#[test]
fn every_broken_file_can_be_given_as_a_model_or_a_texture() {
    let Some(data) = data_folder("malformed-and-odd-inputs") else { return };
    let folder = temporary();
    let model = folder.path().join("a.obj");
    std::fs::write(&model, "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n")
        .expect("the folder can be written to");
    let mut faults = Vec::new();
    for file in all_files_below(&data) {
        let as_texture = render(folder.path(), &model, &["--normal-map".as_ref(), &file]);
        faults.extend(crash(&file, &as_texture));
        let lines = as_texture.code == Some(2) && !is_one_line_about(&as_texture.stderr, &file);
        faults.extend(lines.then(|| format!("{}: not one line:\n{}", file.display(), as_texture.stderr)));
        faults.extend(crash(&file, &render(folder.path(), &file, &[])));
    }
    none(&faults);
}

#[test]
fn the_smallest_mesh_by_others_is_remeshed_watertight() {
    let models = data_files("odedstein-meshes", &["obj"]);
    let size = |model: &PathBuf| std::fs::metadata(model).map_or(u64::MAX, |about| about.len());
    let Some(model) = models.into_iter().min_by_key(|model| (size(model), model.clone())) else { return };
    let folder = temporary();
    let made = folder.path().join("out.glb");
    let options = ["--remesh", "--triangles", "3000", "--size", "64", "--no-verify"].map(Path::new);
    let ending = run(
        folder.path(),
        &[&["bake".as_ref(), model.as_path(), "-o".as_ref(), &made], &options[..]].concat(),
    );
    assert_eq!(ending.code, Some(0), "{}", ending.stderr);
    let scene = taotie::load_model(&made).expect("it was written").scene;
    let [mesh] = scene.meshes() else { panic!("{} meshes", scene.meshes().len()) };
    let Faults { open_edges, crowded_edges, duplicates, .. } = Faults::of(mesh);
    assert_eq!((open_edges, crowded_edges, duplicates), (0, 0, 0), "{}", model.display());
}
