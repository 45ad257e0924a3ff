//! Commands that are ended by signals: all files are as they were. `benches/faults` does the same hundreds of times.
#![cfg(unix)]

use super::balls::{Ball, SCAN};
use super::models::{Green, write_relief};
use super::place::Place;
use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Large enough to keep each command busy for a while.
const LARGE: Ball = Ball { rings: 400, meridians: 800, ..SCAN };

/// Maximum time from a signal to the end. A machine that is busy with other tests may take longer than the promised
/// 200 ms, which `benches/faults` checks.
const MOST: Duration = Duration::from_millis(500);

/// A command and some of the files that it writes.
struct Job {
    line: &'static str,
    files: &'static [&'static str],
}

const JOBS: [Job; 4] = [
    Job {
        line: "bake scan.obj -o out.glb --triangles 4000 --size 512",
        files: &["out.glb", "out.report.html", "out.report.json"],
    },
    Job {
        line: "render scan.obj -o picture.png --size 2048 --samples 16 --shadows --aov depth",
        files: &["picture.png", "picture.depth.exr"],
    },
    Job {
        line: "render scan.obj -o turn.png --size 512 --turntable 300",
        files: &["turn.png", "turn.000.png", "turn.299.png"],
    },
    Job {
        line: "compare scan.obj --method facet,smooth --size 1536 --samples 16 -o .",
        files: &["sheet.png", "report.json", "report.html"],
    },
];

/// Returns a folder with a scan and files of an earlier run.
fn place() -> Place {
    let place = Place::with("scan.obj", LARGE.obj());
    write_relief(&place.path("relief.png"), Green::Up);
    JOBS.iter().flat_map(|job| job.files).for_each(|name| place.write(name, "before"));
    place
}

/// Returns every name in the place, after checking that the files of the earlier run are unchanged.
fn names_of_kept(place: &Place) -> Vec<String> {
    let mut files = JOBS.iter().flat_map(|job| job.files);
    assert!(files.all(|name| place.read(name) == b"before"), "{:?}", place.files());
    place.files()
}

fn is_hidden(name: &str) -> bool {
    name.starts_with(".taotie")
}

/// Starts a command; returns when it has started to write.
fn begin(place: &Place, job: &Job) -> Child {
    let line: Vec<&str> = job.line.split_whitespace().collect();
    let mut process = place.process(&line);
    let mut child = process.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the command starts");
    while !place.files().iter().any(|name| is_hidden(name)) {
        assert_eq!(child.try_wait().expect("it can be polled"), None, "{} ended early", job.line);
        std::thread::sleep(Duration::from_millis(1));
    }
    child
}

fn send(signal: &str, child: &Child) {
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(sent.expect("the system has kill").success());
}

#[test]
fn a_signal_ends_every_command_and_leaves_files_as_they_were() {
    let place = place();
    let before = names_of_kept(&place);
    for (signal, code) in [("-INT", 130), ("-TERM", 143)] {
        for job in &JOBS {
            for delay in [0, 250] {
                let mut child = begin(&place, job);
                std::thread::sleep(Duration::from_millis(delay));
                let start = Instant::now();
                send(signal, &child);
                let ended = child.wait().expect("the command ends");
                let took = start.elapsed();
                let mut said = String::new();
                let mut stderr = child.stderr.take().expect("it is a pipe");
                stderr.read_to_string(&mut said).expect("it is text");
                assert_eq!(ended.code(), Some(code), "{} {signal}: {said}", job.line);
                assert!(said.ends_with("taotie: interrupted; no file is half-written\n"), "{said}");
                assert!(took < MOST, "{} {signal}: {took:?}", job.line);
                assert_eq!(names_of_kept(&place), before, "{} {signal}", job.line);
            }
        }
    }
}

/// During the proof the asset is already written, but not yet in its place.
#[test]
fn a_signal_during_the_proof_keeps_the_asset_of_before() {
    let place = place();
    let before = names_of_kept(&place);
    let mut child = begin(&place, &JOBS[0]);
    let hidden = place.files().into_iter().find(|name| is_hidden(name)).expect("it has started");
    let asset = place.path(&hidden).join("new/out.glb");
    while !std::fs::metadata(&asset).is_ok_and(|about| about.len() > 0) {
        assert_eq!(child.try_wait().expect("it can be polled"), None, "it ended early");
        std::thread::sleep(Duration::from_millis(1));
    }
    send("-INT", &child);
    assert_eq!(child.wait().expect("the command ends").code(), Some(130));
    assert_eq!(names_of_kept(&place), before);
}

#[test]
fn the_next_run_sweeps_what_a_killed_one_left_and_no_more() {
    let place = place();
    let before = names_of_kept(&place);
    let next = "normals relief.png -o next.png --bits 8";
    for job in &JOBS {
        let mut child = begin(&place, job);
        place.taotie(next).assert().success();
        let left = place.files();
        assert_eq!(left.iter().filter(|name| is_hidden(name)).count(), 1, "that of a live process stays");
        send("-KILL", &child);
        assert_eq!(child.wait().expect("the command ends").code(), None);
        assert!(names_of_kept(&place).iter().any(|name| is_hidden(name)), "{}: nobody tidied up", job.line);
        place.taotie(next).assert().success();
        std::fs::remove_file(place.path("next.png")).unwrap();
        assert_eq!(names_of_kept(&place), before, "{}", job.line);
    }
}
