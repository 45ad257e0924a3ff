//! The choice of the machine that draws.

use super::models::TRIANGLE;
use super::place::Place;
use serde_json::Value;

/// What a run said on stdout and stderr, and whether it succeeded.
fn run(place: &Place, line: &str) -> (bool, String, String) {
    let output = place.taotie(line).output().expect("the command runs");
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    (output.status.success(), out, err)
}

/// Says whether a graphics processor must be there.
fn is_required() -> bool {
    std::env::var("CI").is_ok_and(|ci| ci == "true")
}

#[test]
fn a_graphics_processor_draws_or_is_asked_for() {
    let place = Place::with("a.obj", TRIANGLE);
    let (done, out, err) = run(&place, "render a.obj -o b.png --size 40x30 --device gpu --shadows --json");
    if !done && !is_required() {
        assert!(err.contains("no graphics processor was found") && err.contains("install"), "{err}");
        assert_eq!(place.files(), ["a.obj"]);
        return;
    }
    let report: Value = serde_json::from_str(&out).unwrap_or_else(|why| panic!("{why}: {out} {err}"));
    assert_eq!(report["device"]["name"], "gpu");
    assert!(report["device"]["adapter"]["name"].is_string(), "{report}");
    assert_eq!(report["device"]["shadows"], "shader-rays");
    assert!(err.contains("taotie: drawn by ") && err.contains("; shadows by rays in the shader\n"), "{err}");
    assert_eq!(place.files(), ["a.obj", "b.png"]);
}

#[test]
fn who_leaves_the_choice_gets_all_that_is_asked_for() {
    let place = Place::with("a.obj", TRIANGLE);
    let told = "taotie: drawn by the processor: output variables and the reference integrator are its work\n";
    for (device, told) in [("cpu", ""), ("auto", told)] {
        let line = format!("render a.obj -o {device}.png --size 40x30 --aov depth --device {device} --json");
        let (done, out, err) = run(&place, &line);
        assert!(done && err == told, "{err}");
        let report: Value = serde_json::from_str(&out).unwrap();
        assert_eq!(report["device"], serde_json::json!({ "name": "cpu", "shadows": null }));
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
