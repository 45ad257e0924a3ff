//! The findings of the demo: the order of the methods, and the effect of motion on each kind of map.

use crate::schemas;
use serde_json::Value;
use std::path::Path;

/// Returns the demo's report, and the folder it wrote to.
fn demo() -> (tempfile::TempDir, Value) {
    let folder = tempfile::tempdir().expect("temporary folders can be made");
    let demo = std::process::Command::new(env!("CARGO_BIN_EXE_taotie"))
        .args(["demo", "--json", "--size", "64", "--out", "out"])
        .current_dir(folder.path())
        .output()
        .expect("the command runs");
    assert!(demo.status.success(), "{}", String::from_utf8_lossy(&demo.stderr));
    let report = serde_json::from_slice(&demo.stdout).expect("stdout is one JSON document");
    schemas::check("demo", &report);
    (folder, report)
}

/// Returns the mean angular error of a method away from silhouettes, degrees.
fn inner_mean(comparison: &Value, name: &str) -> f64 {
    let methods = comparison["methods"].as_array().expect("a list of methods");
    let method = methods.iter().find(|method| method["method"] == name).expect("it was drawn");
    method["error"]["inner"]["mean"].as_f64().expect("a number")
}

#[test]
#[ignore = "measures the whole demo, which takes most of a minute without optimisation"]
fn the_nearer_a_method_is_to_the_truth_the_less_it_errs_and_moving_spoils_object_space() {
    let (folder, report) = demo();
    assert_eq!(report["schema"], 2);
    let comparison = &report["comparison"];
    assert!(comparison["subject"]["reference_triangles"].as_u64().unwrap() > 1_000_000);
    let [smooth, bump, tangent] =
        ["smooth", "bump", "tangent-normal"].map(|name| inner_mean(comparison, name));
    assert!(smooth > 2.0 * bump && bump > 2.0 * tangent, "{smooth}° {bump}° {tangent}°");
    assert!(tangent < 3.0, "{tangent}°");
    assert_eq!(comparison["skipped"], Value::Array(Vec::new()));

    let moving = report["moving"]["methods"].as_array().expect("both kinds of map");
    let mean = |name: &str, pose: &str| {
        let method = moving.iter().find(|method| method["method"] == name).expect("it was drawn");
        method[pose]["mean"].as_f64().expect("a number")
    };
    let grown = |name: &str| mean(name, "poured") - mean(name, "at_rest");
    assert!(grown("tangent-normal").abs() < 1.0, "tangent space: {}°", grown("tangent-normal"));
    assert!(grown("object-normal") > 10.0, "object space: {}°", grown("object-normal"));

    for file in report["files"].as_array().expect("a list of files") {
        let path = folder.path().join(file.as_str().expect("a path"));
        assert!(std::fs::metadata(&path).is_ok_and(|data| data.len() > 0), "{}", path.display());
    }
    assert!(Path::new(&folder.path().join("out/comparison/report.html")).is_file());
}
