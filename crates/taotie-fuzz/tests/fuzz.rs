//! A little fuzzing with every test run, and a replay of the kept findings.

use std::path::Path;
use std::process::{Command, Output};

fn fuzz(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_taotie-fuzz")).args(arguments).output().expect("it starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn kept_findings_are_fixed() {
    let output = fuzz(&["replay", "--patience", "60"]);
    assert!(output.status.success(), "{}{}", text(&output.stdout), text(&output.stderr));
}

/// The same runs on every machine: they are numbered from 0.
#[test]
fn some_thousand_runs_find_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let totals = folder.path().join("totals.json");
    let (findings, totals) = (folder.path().display().to_string(), totals.display().to_string());
    let output =
        fuzz(&["run", "--runs", "500", "--patience", "60", "--findings", &findings, "--totals", &totals]);
    let said = text(&output.stdout);
    assert!(output.status.success(), "{said}{}", text(&output.stderr));
    for target in [
        "gltf",
        "obj",
        "mtl",
        "ply",
        "stl",
        "fbx",
        "picture",
        "environment",
        "cache",
        "material",
        "provenance",
    ] {
        assert!(said.contains(&format!("{target:12}       500 runs")), "{target}: {said}");
    }
    for target in ["bake", "render"] {
        assert!(said.contains(&format!("{target:12}        10 runs")), "{target}: {said}");
    }
    let table = text(&fuzz(&["table", "--totals", &totals]).stdout);
    assert!(table.contains("\n| all readers | 6,500 | "), "{table}");
}

/// A limit that every run breaks: its worker dies, and the smallest description with the same effect is kept.
#[test]
fn what_breaks_a_bound_is_found_made_small_and_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    let findings = folder.path().display().to_string();
    let line = ["run", "--runs", "2", "--targets", "obj", "--memory", "16", "--findings", &findings];
    let output = fuzz(&line);
    assert_eq!(output.status.code(), Some(1), "{}{}", text(&output.stdout), text(&output.stderr));
    let kept: Vec<_> = std::fs::read_dir(folder.path()).expect("a folder").flatten().collect();
    assert!(!kept.is_empty());
    for entry in kept {
        rebuilds(&entry.path());
    }
    let again = fuzz(&["replay", "--memory", "16", "--findings", &findings]);
    assert_eq!(again.status.code(), Some(1), "{}", text(&again.stdout));
    let relaxed = fuzz(&["replay", "--findings", &findings]);
    assert!(relaxed.status.success(), "{}{}", text(&relaxed.stdout), text(&relaxed.stderr));
}

/// Checks that a finding has only changes that matter, and that its file can be rebuilt.
fn rebuilds(finding: &Path) {
    let json = std::fs::read_to_string(finding).expect("it is readable");
    assert!(json.contains("\"memory\"") && json.contains("\"mutations\": []"), "{json}");
    let file = finding.with_extension("obj");
    let output = fuzz(&["rebuild", &finding.display().to_string(), "-o", &file.display().to_string()]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(!std::fs::read(file).expect("it was written").is_empty());
}
