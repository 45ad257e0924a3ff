//! Rights and history in assets, as `taotie inspect` and other programs read them.

use super::balls::{LOW, SCAN};
use super::place::Place;
use super::validator;
use serde_json::json;

/// A title with a language, rights and a creator with a comma in the name.
const RIGHTS: &str = r#"{
    "dc:title": { "@type": "rdf:Alt", "rdf:_1": { "@language": "en", "@value": "A ball" } },
    "dc:rights": { "@type": "rdf:Alt", "rdf:_1": { "@language": "en", "@value": "CC0 1.0" } },
    "dc:creator": { "@list": ["The museum, Ltd"] },
    "xmpRights:WebStatement": "https://museum.example/rights"
}"#;

/// Returns a folder with a scan that was baked with [`RIGHTS`], and its asset, which was baked again.
fn baked_twice() -> Place {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", LOW.obj());
    place.write("rights.json", RIGHTS);
    let bake = |line: &str| {
        let all = format!("bake {line} --low low.obj --ray-distance 0.2 --size 32 --no-verify");
        place.taotie(&all).assert().success();
    };
    bake("scan.obj -o once.glb --provenance rights.json");
    bake("once.glb -o twice.glb");
    place
}

#[test]
fn rights_and_history_go_on_and_are_shown() {
    let place = baked_twice();
    let report = place.json("inspect twice.glb --json");
    assert_eq!((&report["copyright"], &report["rights"]), (&json!("CC0 1.0"), &json!("CC0 1.0")));
    let sources: Vec<&str> =
        report["sources"].as_array().unwrap().iter().filter_map(|s| s.as_str()).collect();
    assert!(
        matches!(sources.as_slice(), [a, b] if a.starts_with("scan.obj (sha256:") && b.starts_with("once.glb (sha256:")),
        "{sources:?}"
    );
    let history = report["history"].as_array().unwrap();
    assert_eq!(history.len(), 2);
    for event in history {
        assert_eq!(event["action"], "converted");
        assert_eq!(event["agent"], concat!("taotie ", env!("CARGO_PKG_VERSION")));
        assert!(event["parameters"].as_str().is_some_and(|said| said.contains("\"size\":32")), "{event}");
    }
    let assert = place.taotie("inspect twice.glb").assert().success();
    let text = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    for line in [
        "copyright  CC0 1.0\n",
        "rights     CC0 1.0\n",
        "source     once.glb (sha256:",
        "History\n  #  action",
    ] {
        assert!(text.contains(line), "{line}: {text}");
    }
}

#[test]
fn gltf_transform_shows_the_metadata() {
    let place = baked_twice();
    for name in ["once.glb", "twice.glb"] {
        let Some(said) = validator::inspected(&place.path(name)) else { return };
        for part in
            ["dc:title,A ball", "dc:rights,CC0 1.0", "\"The museum, Ltd\"", "xmpMM:History", "dc:source"]
        {
            assert!(said.contains(part), "{part}: {said}");
        }
    }
}

#[test]
fn properties_are_checked_before_the_work() {
    let place = Place::with("list.json", "[]");
    place.write("broken.json", "{\"dc:title\": }");
    place.write("prefix.json", r#"{"dcx:title": "a"}"#);
    place.write("bare.json", r#"{"title": "a"}"#);
    let before = place.files();
    let cases = [
        ("list.json", "list.json: expected a JSON object of XMP properties"),
        ("broken.json", "broken.json: line 1, column 14"),
        ("prefix.json", "prefix.json: dcx:title: unknown prefix `dcx`; add its namespace to @context"),
        ("bare.json", "bare.json: title: `title` has no prefix; use a name such as dc:title"),
        ("gone.json", "gone.json: "),
    ];
    for (file, why) in cases {
        // There is no scan, so reading it first would be an error.
        let line = format!("bake scan.obj -o out.glb --provenance {file}");
        let assert = place.taotie(&line).assert().code(2).stdout_eq("");
        let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(said.contains(why), "{file}: {said}");
        assert_eq!(place.files(), before, "{file}");
    }
}
