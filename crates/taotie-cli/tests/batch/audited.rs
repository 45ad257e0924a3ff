//! `taotie batch --check`: finds changed files.

use crate::collection::{Collection, QUICK, ball, number};
use crate::files::files_below;
use serde_json::Value;

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
fn without_a_manifest_there_is_nothing_to_check() {
    let collection = Collection::of_balls(1);
    for is_there in [false, true] {
        let output = collection.run("--check");
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && output.stdout.is_empty(), "{stderr}");
        assert!(stderr.contains("error: out: no manifest in this folder; run `taotie batch`"), "{stderr}");
        assert_eq!(collection.path("out").exists(), is_there, "a check creates nothing");
        if !is_there {
            std::fs::create_dir(collection.path("out")).unwrap();
        }
    }
}

#[test]
fn an_audit_finds_forged_figures_and_verdicts() {
    let collection = Collection::of_balls(1);
    collection.configure(&format!("require = [\"mean-angle=30\"]\n{QUICK}"));
    collection.report("");
    let path = collection.path("out/manifest.jsonl");
    let truth = std::fs::read_to_string(&path).unwrap();
    let record = &collection.last()["ball0.obj"];
    let forge = |pointer: &str, value: Value| {
        let mut record = record.clone();
        *record.pointer_mut(pointer).expect("it exists") = value;
        std::fs::write(&path, format!("{record}\n")).unwrap();
        let (code, report) = collection.report("--check --proofs 0");
        assert_eq!(code, Some(1), "{pointer}: {report}");
        report["faults"].to_string()
    };
    let faults = forge("/figures/mean_angle", 0.001.into());
    assert!(faults.contains("figures.mean_angle is 0.001 in the manifest instead of"), "{faults}");
    forge("/figures/triangles/0", 7.into());
    forge("/required/0/value", 0.001.into());
    forge("/state", "required-not-met".into());
    forge("/warnings", Value::Array(vec![serde_json::json!({ "count": 1, "what": "none" })]));
    // The same forgery in the description of the asset is found by baking it again.
    let object = files_below(&collection.path("out/objects"), &["glb"])[0].with_file_name("object.json");
    let described = std::fs::read_to_string(&object).unwrap();
    let bytes = format!("\"bytes_in\":{}", record["figures"]["bytes_in"]);
    assert!(described.contains(&bytes) && truth.contains(&bytes));
    for (path, text) in [(&path, &truth), (&object, &described)] {
        std::fs::write(path, text.replace(&bytes, "\"bytes_in\":7")).unwrap();
    }
    assert_eq!(collection.report("--check --proofs 0").0, Some(0));
    let (code, report) = collection.report("--check --proofs 1");
    assert!(code == Some(1) && report["faults"].to_string().contains("figures.bytes_in"), "{report}");
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
    let object = models[0].with_file_name("object.json");
    for path in [&path, &object] {
        let text = std::fs::read_to_string(path).unwrap();
        std::fs::write(path, text.replace(&hash, &taotie_io::sha256(&models[0]).unwrap())).unwrap();
    }
    assert_eq!(collection.report("--check --proofs 0").0, Some(0), "hashes do not reveal it");
    let (code, report) = collection.report("--check");
    assert!(
        code == Some(1) && report["faults"].to_string().contains("the bytes differ when made again"),
        "{report}"
    );
    collection.write("scans/ball0.obj", ball(0.05));
    let (_, report) = collection.report("--check");
    assert!(report["faults"].to_string().contains("the scan or a photograph has changed since"), "{report}");
}
