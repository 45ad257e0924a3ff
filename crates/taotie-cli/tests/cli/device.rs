//! The choice of the device that renders or casts the rays of bakes.

use super::balls::{LOW, SCAN};
use super::models::TRIANGLE;
use super::place::Place;
use serde_json::{Value, json};

/// Runs a line; returns whether it succeeded, its stdout and its stderr.
fn run(place: &Place, line: &str) -> (bool, String, String) {
    let output = place.taotie(line).output().expect("the command runs");
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    (output.status.success(), out, err)
}

/// Returns true if a GPU is required.
fn is_required() -> bool {
    std::env::var("CI").is_ok_and(|ci| ci == "true")
}

#[test]
fn a_graphics_processor_draws_or_is_asked_for() {
    let place = Place::with("a.obj", TRIANGLE);
    let (done, out, err) = run(&place, "render a.obj -o b.png --size 40x30 --device gpu --shadows --json");
    if !done && !is_required() {
        assert!(err.contains("no GPU was found") && err.contains("install"), "{err}");
        assert_eq!(place.files(), ["a.obj"]);
        return;
    }
    let report: Value = serde_json::from_str(&out).unwrap_or_else(|why| panic!("{why}: {out} {err}"));
    assert_eq!((&report["device"]["name"], &report["device"]["requested"]), (&json!("gpu"), &json!("gpu")));
    let adapter = &report["device"]["adapter"];
    assert!(["name", "kind", "backend"].iter().all(|fact| adapter[fact].is_string()), "{report}");
    assert_eq!(report["device"]["shadows"], "shader-rays");
    assert!(
        err.contains("taotie: rendered on ") && err.contains("; shadows by rays in the shader\n"),
        "{err}"
    );
    let is_software = adapter["kind"] == "software";
    assert_eq!(err.contains("a software GPU: --device cpu is faster"), is_software, "{err} {report}");
    assert_eq!(place.files(), ["a.obj", "b.png"]);
}

#[test]
fn drivers_are_quiet_too() {
    let place = Place::with("a.obj", TRIANGLE);
    for device in ["gpu", "auto"] {
        let (done, _, err) =
            run(&place, &format!("render a.obj -o {device}.png --size 40x30 --device {device} -q"));
        assert!((done && err.is_empty()) || (!is_required() && err.contains("no GPU was found")), "{err}");
    }
}

/// Without a display, Mesa reports an error that is none. Only messages of the program appear.
#[test]
fn drivers_that_work_say_nothing() {
    let place = Place::with("a.obj", TRIANGLE);
    for device in ["gpu", "auto"] {
        let line = format!("render a.obj -o {device}.png --size 40x30 --device {device}");
        let command = place.taotie(&line).env_remove("XDG_RUNTIME_DIR").env_remove("WAYLAND_DISPLAY");
        let output = command.output().expect("the command runs");
        let err = String::from_utf8_lossy(&output.stderr).into_owned();
        let is_own = err.lines().all(|line| line.starts_with("taotie: rendered on "));
        assert!(
            (output.status.success() && is_own) || (!is_required() && err.contains("no GPU was found")),
            "{err}"
        );
    }
}

#[test]
fn a_software_gpu_is_only_used_if_named() {
    let place = Place::with("a.obj", TRIANGLE);
    let device = |asked: &str| {
        let line = format!("render a.obj -o b.png --size 40x30 --device {asked} --json");
        let (done, out, err) = run(&place, &line);
        let report: Value = serde_json::from_str(&out).unwrap_or_default();
        (done, report["device"].clone(), err)
    };
    let (found, gpu, _) = device("gpu");
    let (done, auto, err) = device("auto");
    assert!(done && auto["requested"] == "auto", "{auto}");
    let adapter = &gpu["adapter"];
    if adapter["kind"] == "software" {
        let reason = auto["reason"].as_str().unwrap_or_default();
        let name = adapter["name"].as_str().expect("it has a name");
        assert!(auto["name"] == "cpu" && reason.contains("software") && reason.contains(name), "{auto}");
        assert!(err.contains(reason), "{err}");
    } else if found {
        assert_eq!((&auto["name"], &auto["adapter"]), (&json!("gpu"), adapter));
    }
}

#[test]
fn who_leaves_the_choice_gets_all_that_is_asked_for() {
    let place = Place::with("a.obj", TRIANGLE);
    let reason = "taotie: rendered on the CPU: output variables and the reference integrator need it\n";
    let because = reason.trim_end().trim_start_matches("taotie: rendered on the CPU: ");
    for (device, reason, because) in [("cpu", "", Value::Null), ("auto", reason, json!(because))] {
        let line = format!("render a.obj -o {device}.png --size 40x30 --aov depth --device {device} --json");
        let (done, out, err) = run(&place, &line);
        assert!(done && err == reason, "{err}");
        let report: Value = serde_json::from_str(&out).unwrap();
        let expected = json!({ "name": "cpu", "requested": device, "reason": because, "shadows": null });
        assert_eq!(report["device"], expected);
    }
    assert_eq!(place.read("cpu.png"), place.read("auto.png"));
}

#[test]
fn what_graphics_processors_do_not_draw_is_refused() {
    let place = Place::with("a.obj", TRIANGLE);
    for (options, why) in
        [("--integrator reference", "leave out --integrator reference"), ("--aov depth", "leave out --aov")]
    {
        let (done, _, err) = run(&place, &format!("render a.obj -o b.png --device gpu {options}"));
        assert!(!done && err.contains("--device gpu: ") && err.contains(why), "{err}");
    }
    assert_eq!(place.files(), ["a.obj"]);
}

#[test]
fn a_graphics_processor_casts_the_rays_of_bakes() {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", LOW.obj());
    let line = "bake scan.obj --low low.obj --size 64 --maps normal,ao --ao-rays 16 --json";
    let report = place.json(&format!("{line} -o cpu.glb"));
    assert_eq!(report["device"], Value::Null, "the CPU is not mentioned unless the user left the choice");
    let (done, out, err) = run(&place, &format!("{line} -o gpu.glb --device gpu"));
    if !done && !is_required() {
        assert!(err.contains("no GPU was found") && err.contains("install"), "{err}");
        return;
    }
    let by_gpu: Value = serde_json::from_str(&out).unwrap_or_else(|why| panic!("{why}: {out} {err}"));
    let device = &by_gpu["device"];
    assert_eq!((&device["name"], &device["requested"]), (&json!("gpu"), &json!("gpu")));
    let name = device["adapter"]["name"].as_str().expect("it has a name");
    assert!(err.contains(&format!("taotie: cast rays on {name} via ")), "{err}");
    let written: Value = serde_json::from_slice(&place.read("gpu.report.json")).unwrap();
    assert_eq!(&written["device"], device);
    assert_eq!(by_gpu["bake"]["missed_samples"], report["bake"]["missed_samples"]);
    let mean =
        |report: &Value| report["certificate"]["figures"][0]["value"].as_f64().expect("it is measured");
    assert!((mean(&by_gpu) - mean(&report)).abs() < 1e-3, "{} {}", mean(&by_gpu), mean(&report));
    let auto = place.json(&format!("{line} -o auto.glb --device auto"));
    assert_eq!(auto["device"]["requested"], "auto");
    if device["adapter"]["kind"] == "software" {
        assert_eq!(auto["device"]["name"], "cpu");
        assert_eq!(place.read("auto.glb"), place.read("cpu.glb"));
    }
}
