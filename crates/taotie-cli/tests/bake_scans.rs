//! `taotie bake` on real scans: pairs of heavy and light meshes, and scans alone. What is written is proved by the
//! command itself and once more here, against meshes read anew.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

#[allow(dead_code)]
#[path = "../../taotie/tests/common/mod.rs"]
mod common;
#[path = "../../taotie/tests/common/validator.rs"]
mod validator;

/// Bakes and gives back the report.
fn bake(args: &[&str], folder: &Path) -> Value {
    let run = Command::new(env!("CARGO_BIN_EXE_taotie"))
        .arg("bake")
        .args(args)
        .arg("--json")
        .current_dir(folder)
        .output()
        .expect("the command runs");
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{args:?}: {said}");
    serde_json::from_slice(&run.stdout).expect("stdout is one JSON document")
}

fn number(report: &Value, path: &str) -> f64 {
    report.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} in {report}"))
}

/// Folders of the data with their OBJ files: the heavy ones first.
fn objects() -> Vec<Vec<PathBuf>> {
    let Some(folder) = common::data_folder("odedstein-meshes") else { return Vec::new() };
    let mut folders: Vec<PathBuf> = common::files_below(&folder, &["obj"])
        .iter()
        .filter_map(|file| file.parent().map(Path::to_path_buf))
        .collect();
    folders.dedup();
    let size = |path: &PathBuf| std::fs::metadata(path).map_or(0, |data| data.len());
    folders
        .iter()
        .map(|folder| {
            let mut files = common::files_below(folder, &["obj"]);
            files.sort_by_key(|file| std::cmp::Reverse(size(file)));
            files
        })
        .collect()
}

#[test]
fn pairs_are_baked_within_two_degrees_and_nearly_without_a_miss() {
    let objects = objects();
    for pair in objects.iter().filter(|files| files.len() == 2) {
        let folder = tempfile::tempdir().unwrap();
        let [high, low] = [&pair[0], &pair[1]].map(|path| path.to_str().expect("a path of text"));
        let report = bake(&[high, "--low", low, "-o", "out.glb", "--size", "1024"], folder.path());
        assert!(number(&report, "/proof/angles/mean") < 2.0, "{high}: {report}");
        assert!(number(&report, "/proof/missed_texels") < 0.001, "{high}");
        assert!(number(&report, "/proof/angles/mean") < number(&report, "/proof/without_map/mean") / 4.0);
        // That a scan came in facets is worth telling, and no fault of the pair.
        let is_fault = |warning: &&Value| !warning["what"].as_str().unwrap_or_default().contains("smoothed");
        let faults: Vec<&Value> = report["warnings"].as_array().unwrap().iter().filter(is_fault).collect();
        assert!(faults.is_empty(), "{high}: {faults:?}");
        validator::assert_valid(&folder.path().join("out.glb"));
        // Packing sorts vertices anew and rounds directions by 0.05°; the proof must not take that for more.
        let packed = ["--low", low, "-o", "packed.glb", "--size", "1024", "--meshopt"];
        let packed = bake(&[&[high][..], &packed].concat(), folder.path());
        let [plain, packed] = [&report, &packed].map(|report| number(report, "/proof/angles/mean"));
        assert!((packed - plain).abs() < 0.1, "{high}: {packed}° packed, {plain}° plain");
        let low = taotie::io::load_model(low.as_ref()).unwrap().scene;
        let out = taotie::io::load_model(&folder.path().join("out.glb")).unwrap().scene;
        assert!(same_triangles(&low.meshes()[0], &out.meshes()[0]), "the light mesh stays as it is");
    }
}

#[test]
fn scans_alone_are_made_light_unwrapped_and_baked() {
    for files in objects().iter().filter(|files| files.len() == 1) {
        let folder = tempfile::tempdir().unwrap();
        let high = files[0].to_str().expect("a path of text");
        let report = bake(&[high, "-o", "out.glb", "--triangles", "4000", "--size", "1024"], folder.path());
        assert!(number(&report, "/proof/angles/mean") < 2.0, "{high}: {report}");
        assert!(number(&report, "/proof/missed_texels") < 0.001, "{high}");
        assert!(number(&report, "/proof/hausdorff_of_diagonal") < 0.02, "{high}");
        assert!(number(&report, "/proof/uv_use") > 0.4, "{high}");
        let triangles = number(&report, "/triangles/0");
        assert!((3800.0..=4000.0).contains(&triangles), "{high}: {triangles}");
        validator::assert_valid(&folder.path().join("out.glb"));
        for file in report["files"].as_array().unwrap() {
            assert!(folder.path().join(file.as_str().unwrap()).is_file(), "{file}");
        }
    }
}

/// Corner by corner, wherever vertices were split.
fn same_triangles(a: &taotie::mesh::Mesh, b: &taotie::mesh::Mesh) -> bool {
    a.triangles().len() == b.triangles().len()
        && (0..a.triangles().len()).all(|t| a.corners(t) == b.corners(t))
}
