//! `taotie batch --check`: finds changed files.

use crate::collection::{Collection, ball, number};
use crate::files::files_below;

#[test]
fn an_audit_finds_what_was_changed() {
    let collection = Collection::of_balls(2);
    collection.report("");
    let (code, report) = collection.report("--check --proofs 1");
    assert_eq!(
        (code, number(&report, "/assets"), number(&report, "/proofs")),
        (Some(0), 2.0, 1.0),
        "{report}"
    );
    assert_eq!(number(&report, "/files"), 8.0, "a model, a report of two, and a picture each");
    let models = files_below(&collection.path("out/objects"), &["glb"]);
    let mut bytes = std::fs::read(&models[0]).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    std::fs::write(&models[0], bytes).unwrap();
    std::fs::remove_file(&models[1]).unwrap();
    let (code, report) = collection.report("--check --proofs 0");
    let faults = report["faults"].to_string();
    assert_eq!((code, report["faults"].as_array().unwrap().len()), (Some(1), 2), "{faults}");
    assert!(faults.contains("contents differ from what was written"), "{faults}");
    assert_eq!(number(&collection.report("").1, "/attempts"), 1.0, "missing files are made again");
    let (_, report) = collection.report("--check --proofs 0");
    assert_eq!(report["faults"].as_array().unwrap().len(), 1, "{report}");
}

#[test]
fn a_proof_anew_finds_an_asset_that_is_another() {
    let collection = Collection::of_balls(1);
    collection.report("");
    let models = files_below(&collection.path("out/objects"), &["glb"]);
    // As if another program had written it, and its hash.
    let path = collection.path("out/manifest.jsonl");
    let hash = taotie_io::sha256(&models[0]).unwrap();
    let mut bytes = std::fs::read(&models[0]).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    std::fs::write(&models[0], bytes).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text.replace(&hash, &taotie_io::sha256(&models[0]).unwrap())).unwrap();
    assert_eq!(collection.report("--check --proofs 0").0, Some(0), "hashes do not reveal it");
    let (code, report) = collection.report("--check");
    assert!(
        code == Some(1) && report["faults"].to_string().contains("the re-baked bytes differ"),
        "{report}"
    );
    collection.write("scans/ball0.obj", ball(0.05));
    let (_, report) = collection.report("--check");
    assert!(report["faults"].to_string().contains("the scan has changed since"), "{report}");
}
