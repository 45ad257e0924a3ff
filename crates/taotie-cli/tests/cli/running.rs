//! Concurrent and successive runs, and closed pipes.

use super::models::TRIANGLE;
use super::place::Place;
use super::schemas;
use std::process::{Command, Stdio};

/// Runs with a closed stdout; returns the exit code and stderr.
fn unread(mut process: Command) -> (Option<i32>, String) {
    let (reader, writer) = std::io::pipe().expect("pipes can be made");
    drop(reader);
    let child = process.stdout(writer).stderr(Stdio::piped()).spawn().expect("the command starts");
    let output = child.wait_with_output().expect("the command ends");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn a_closed_pipe_is_no_error() {
    let place = Place::with("a.obj", TRIANGLE);
    let lines: [&[&str]; 5] = [
        &["inspect", "a.obj"],
        &["inspect", "a.obj", "--json"],
        &["render", "a.obj", "-o", "b.png", "--size", "8x8"],
        &["render", "a.obj", "-o", "b.png", "--size", "8x8", "--json"],
        &["--help"],
    ];
    for line in lines {
        assert_eq!(unread(place.process(line)), (Some(0), String::new()), "{line:?}");
    }
    assert_eq!(place.files(), ["a.obj", "b.png"]);
}

#[test]
fn a_closed_pipe_does_not_hide_a_difference() {
    let place = Place::with("a.obj", TRIANGLE);
    place.taotie("render a.obj -o a.png --size 8x8").assert().success();
    place.taotie("render a.obj -o b.png --size 8x8 --background white").assert().success();
    for (limit, code) in [("2", 0), ("0.01", 1)] {
        let line = ["diff", "a.png", "b.png", "--metric", "rmse", "--threshold", limit];
        assert_eq!(unread(place.process(&line)), (Some(code), String::new()), "{limit}");
    }
}

#[test]
fn runs_side_by_side_leave_whole_files_only() {
    let place = Place::with("a.obj", TRIANGLE);
    let line = ["render", "a.obj", "-o", "b.png", "--size", "64x64"];
    let start = || place.process(&line).stdout(Stdio::null()).spawn().expect("the command starts");
    let children = [start(), start(), start()];
    for mut child in children {
        assert!(child.wait().expect("the command ends").success());
    }
    assert_eq!(place.files(), ["a.obj", "b.png"]);
    let together = place.read("b.png");
    assert!(place.process(&line).output().expect("the command runs").status.success());
    assert!(together == place.read("b.png"), "a file was not whole");
}

#[test]
fn a_failed_run_keeps_the_old_picture() {
    let place = Place::with("a.obj", "v 0 0 0\n");
    place.write("b.png", "old");
    place.taotie("render a.obj -o b.png").assert().code(2);
    assert_eq!(place.read("b.png"), b"old");
    assert_eq!(place.files(), ["a.obj", "b.png"]);
}

#[test]
fn quiet_leaves_errors_alone() {
    let place = Place::with("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\n");
    let said = |line: &str| {
        let assert = place.taotie(line).assert();
        String::from_utf8_lossy(&assert.get_output().stderr).into_owned()
    };
    assert!(said("render a.obj -o a.png --size 8").contains("taotie: warning: triangles without area"));
    for line in ["render a.obj -o a.png --size 8 --quiet", "-q render a.obj -o a.png --size 8"] {
        place.taotie(line).assert().success().stderr_eq("");
    }
    assert!(said("render none.obj -o a.png -q").starts_with("taotie: error: none.obj: "));
}

#[test]
fn programs_read_progress_as_lines() {
    let solid = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    let place = Place::with("a.obj", solid);
    let assert = place.taotie("bake a.obj -o a.glb --triangles 4 --size 32 --progress").assert().success();
    let lines = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    let progress: Vec<serde_json::Value> = lines
        .lines()
        .filter(|line| line.starts_with('{'))
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    progress.iter().for_each(|line| schemas::check("progress", line));
    assert!(progress.iter().any(|line| line["stage"] == "bake"), "{lines}");
    assert!(progress.iter().all(|line| (0.0..=1.0).contains(&line["done"].as_f64().unwrap())), "{lines}");
    let quiet =
        place.taotie("bake a.obj -o b.glb --triangles 4 --size 32 --progress --quiet").assert().success();
    let lines = String::from_utf8_lossy(&quiet.get_output().stderr).into_owned();
    assert!(!lines.is_empty() && lines.lines().all(|line| line.starts_with('{')), "{lines}");
}
