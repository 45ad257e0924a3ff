//! The page of a bake: it opens with the verdict, and shows scan and asset in grey and in full material.

use super::balls::{LOW, SCAN};
use super::place::Place;
use serde_json::Value;
use std::collections::HashSet;

/// Returns a folder with a scan whose vertices have one colour, and a low-poly mesh.
fn colored() -> Place {
    let line = |line: &str| match line.starts_with("v ") {
        true => format!("{line} 0.8 0.3 0.1\n"),
        false => format!("{line}\n"),
    };
    let place = Place::with("scan.obj", SCAN.obj().lines().map(line).collect::<String>());
    place.write("low.obj", LOW.obj());
    place
}

/// Returns the data of the page `out.report.html`.
fn page(place: &Place) -> Value {
    let html = String::from_utf8(place.read("out.report.html")).expect("it is text");
    let (_, rest) = html.split_once("id=\"data\">").expect("it has data");
    let (json, _) = rest.split_once("</script>").expect("they end");
    serde_json::from_str(json).expect("they are JSON")
}

fn names<'a>(of: &'a Value, key: &str) -> Vec<&'a str> {
    of.as_array().expect("it is a list").iter().filter_map(|entry| entry[key].as_str()).collect()
}

#[test]
fn colors_are_proved_and_shown() {
    let place = colored();
    let line = "bake scan.obj --low low.obj -o out.glb --size 64 --maps normal,albedo --require mean-color=2";
    let assert = place.taotie(line).assert().success();
    let text = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    for part in ["colour error as seen (ΔE00)", "material error", "in full material", "met: mean-color is "]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(!text.contains("not compared"), "{text}");
    let page = page(&place);
    let verdict = &page["statement"]["verdict"];
    assert_eq!(
        (verdict["tone"].as_str(), verdict["text"].as_str()),
        (Some("good"), Some("All requirements are met."))
    );
    let views = names(&page["views"], "name");
    assert!(
        ["grey 0°", "full 0°", "maps", "colour error"].iter().all(|name| views.contains(name)),
        "{views:?}"
    );
    assert_eq!(views.iter().collect::<HashSet<_>>().len(), views.len(), "no two views share a name");
    let sections = page["sections"].to_string();
    assert!(sections.contains("Colour and material error"), "{sections}");
}

#[test]
fn colors_that_are_lost_fail_and_the_page_says_so_first() {
    let place = colored();
    let line =
        "bake scan.obj --low low.obj -o out.glb --size 64 --maps normal --require mean-color=2,missed=1";
    let assert = place.taotie(line).assert().code(1);
    let text = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    assert!(text.contains("NOT met: mean-color is "), "{text}");
    let page = page(&place);
    let verdict = &page["statement"]["verdict"];
    assert_eq!(
        (verdict["tone"].as_str(), verdict["text"].as_str()),
        (Some("bad"), Some("Not met: 1 of 2 requirements."))
    );
}

#[test]
fn a_scan_without_colors_says_that_none_were_looked_at() {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", LOW.obj());
    place.taotie("bake scan.obj --low low.obj -o out.glb --size 64").assert().success();
    let page = page(&place);
    let statement = &page["statement"];
    assert_eq!(statement["verdict"]["text"], "Measured; no requirements were set. The figures are below.");
    let note = "Not compared: colour and material, which the scan does not specify.";
    assert_eq!(statement["tables"][0]["note"], note);
    assert!(!names(&page["views"], "name").iter().any(|name| name.starts_with("full")));
}
