//! A bake that is stopped by Ctrl-C.
#![cfg(unix)]

use super::balls::{Ball, SCAN};
use super::place::Place;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStderr, Command, Stdio};
use std::time::Duration;

/// Large enough that each stage takes a while.
const LARGE: Ball = Ball { rings: 400, meridians: 800, ..SCAN };

/// Begins to bake; comes back when the scan has been read, with what is said.
fn begin(place: &Place) -> (Child, BufReader<ChildStderr>) {
    let line = ["bake", "scan.obj", "-o", "out.glb", "--triangles", "4000", "--size", "512"];
    let mut child = place
        .process(&line)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command starts");
    let mut said = BufReader::new(child.stderr.take().expect("it is a pipe"));
    let mut first = String::new();
    said.read_line(&mut first).expect("it is text");
    assert!(first.starts_with("baking 638400 triangles"), "{first}");
    (child, said)
}

fn stop((mut child, mut said): (Child, BufReader<ChildStderr>)) {
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.expect("the system has kill").success());
    let mut rest = String::new();
    said.read_to_string(&mut rest).expect("it is text");
    assert!(rest.ends_with("taotie: interrupted; no file is left\n"), "{rest}");
    assert_eq!(child.wait().expect("the command ends").code(), Some(130));
}

#[test]
fn while_it_bakes() {
    let place = Place::with("scan.obj", LARGE.obj());
    stop(begin(&place));
    assert_eq!(place.files(), ["scan.obj"]);
}

#[test]
fn while_it_proves() {
    let place = Place::with("scan.obj", LARGE.obj());
    let mut run = begin(&place);
    while !place.path("out.glb").exists() {
        assert_eq!(run.0.try_wait().expect("it can be asked"), None, "it ended before anything was written");
        std::thread::sleep(Duration::from_millis(2));
    }
    stop(run);
    assert_eq!(place.files(), ["scan.obj"], "what nobody proved does not stay");
}
