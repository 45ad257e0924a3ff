//! Schemas describe documents completely: any other field, missing field or other type is refused.

#[allow(dead_code)]
#[path = "../../../../tests/common/schemas.rs"]
mod common;
#[allow(dead_code)]
#[path = "../../../../tests/common/mod.rs"]
mod data;

use super::balls::SCAN;
use super::models::{Green, coated_square, square, write_relief};
use super::place::Place;
use common::faults;
pub use common::{check, check_printed};
use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;
use std::process::Stdio;

/// Returns the places of all values inside a document.
fn places(document: &Value, at: &str, all: &mut Vec<String>) {
    let step = |key: &str| format!("{at}/{}", key.replace('~', "~0").replace('/', "~1"));
    let inside: Vec<(String, &Value)> = match document {
        Value::Object(fields) => fields.iter().map(|(key, value)| (step(key), value)).collect(),
        Value::Array(items) => {
            items.iter().enumerate().map(|(i, value)| (step(&i.to_string()), value)).collect()
        }
        _ => Vec::new(),
    };
    for (place, value) in inside {
        places(value, &place, all);
        all.push(place);
    }
}

/// Damages every value of a document in turn; each must be refused.
fn assert_closed(name: &str, document: &Value) {
    check(name, document);
    let mut all = vec![String::new()];
    places(document, "", &mut all);
    let validator = common::validator(name);
    let accepts = |change: &dyn Fn(&mut Value)| {
        let mut damaged = document.clone();
        change(&mut damaged);
        validator.is_valid(&damaged)
    };
    for place in &all {
        let is_accepted = accepts(&|document| {
            *document.pointer_mut(place).unwrap() = json!({ "unexpected": true });
        });
        assert!(!is_accepted, "{name}: {place} of any type");
        let Some(fields) = document.pointer(place).and_then(Value::as_object) else { continue };
        // A text is not a time of the stages.
        let is_added = accepts(&|document| document.pointer_mut(place).unwrap()["unexpected"] = "x".into());
        assert!(!is_added, "{name}: another field in {place}");
        for field in fields.keys().filter(|_| !place.ends_with("/seconds")) {
            let is_removed = accepts(&|document| {
                document.pointer_mut(place).unwrap().as_object_mut().unwrap().remove(field);
            });
            assert!(!is_removed, "{name}: {place} without {field}");
        }
    }
}

#[test]
fn no_schema_accepts_a_damaged_document() {
    let place = Place::with("a.gltf", square());
    place.write("coated.gltf", coated_square());
    write_relief(&place.path("normals.png"), Green::Up);
    for line in [
        "materials --json",
        "inspect a.gltf --json",
        "inspect coated.gltf --json",
        "diff normals.png normals.png --metric angle --threshold 1 --json",
        "normals normals.png -o object.png --json",
        "render a.gltf -o b.png --size 8x6 --samples 1 --json",
        "view a.gltf -o page.html --json",
    ] {
        let document = place.json(line);
        assert_closed(line.split(' ').next().unwrap(), &document);
    }
}

#[test]
fn another_version_is_refused() {
    let place = Place::with("a.gltf", square());
    let mut document = place.json("inspect a.gltf --json");
    document["schema"] = (document["schema"].as_u64().unwrap() + 1).into();
    assert_eq!(faults("inspect", &document).len(), 1);
}

/// Runs jq with a filter of the page, quoted as in a shell, on a document; `None` without jq.
fn filtered(filter: &str, document: &Value) -> Option<String> {
    let (options, filter) = filter.split_once('\'').expect("the filter is quoted");
    let mut command = std::process::Command::new("jq");
    command.args(options.split_whitespace()).arg(filter.trim_end_matches('\''));
    command.stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut jq = command.spawn().ok()?;
    jq.stdin.take()?.write_all(document.to_string().as_bytes()).ok()?;
    let output = jq.wait_with_output().expect("jq ends");
    assert!(output.status.success(), "{filter}");
    Some(String::from_utf8(output.stdout).expect("it prints text"))
}

#[test]
fn filters_on_the_page_find_what_it_shows() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/json.md");
    let page = std::fs::read_to_string(page).expect("the page is readable").replace('\r', "");
    let place = Place::with("scan.obj", SCAN.obj());
    let mut count = 0;
    for after in page.split("```sh\n").skip(1) {
        let (lines, rest) = after.split_once("```\n").expect("the block ends");
        let shown = rest.trim_start().strip_prefix("```text\n").and_then(|text| text.split("```").next());
        for (command, filter) in lines.lines().filter_map(|line| line.split_once(" | jq ")) {
            count += 1;
            let document = place.json(command.strip_prefix("taotie ").expect("a command of taotie"));
            let Some(found) = filtered(filter, &document) else { return data::absent("jq is not installed") };
            match shown {
                Some(shown) => assert_eq!(found, shown, "{filter}"),
                None => assert!(!found.trim().is_empty() && !found.contains("null"), "{filter}: {found}"),
            }
        }
    }
    assert!(count >= 3, "only {count} filters were found in docs/json.md");
}

#[test]
fn every_schema_is_listed_on_the_page() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let page = std::fs::read_to_string(docs.join("json.md")).expect("the page is readable");
    for entry in std::fs::read_dir(docs.join("schemas")).expect("the folder is readable") {
        let name = entry.expect("it is readable").file_name().to_string_lossy().into_owned();
        assert!(page.contains(&format!("(schemas/{name})")), "docs/json.md does not list {name}");
    }
}
