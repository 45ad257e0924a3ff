//! Folders of photographs in a collection, next to scans.

use crate::collection::{Collection, QUICK, assert_nothing_twice, number, text};
use crate::files::{all_files_below, files_below};
use crate::schemas;
use serde_json::Value;

fn json(bytes: Vec<u8>) -> Value {
    serde_json::from_slice(&bytes).expect("it is JSON")
}

#[test]
fn photographs_are_done_once_next_to_scans() {
    let collection = Collection::of_photographs();
    let (code, report) = collection.report("");
    assert_eq!((code, number(&report, "/states/done")), (Some(0), 3.0), "{report}");
    let last = collection.last();
    assert_eq!(last.keys().collect::<Vec<_>>(), ["ball0.obj", "coins/a", "coins/b"]);
    let [a, b] = [&last["coins/a"], &last["coins/b"]];
    assert_eq!((number(a, "/estimated/photographs"), number(b, "/estimated/photographs")), (12.0, 11.0));
    let sigma = number(a, "/estimated/sigma_median");
    assert!(sigma > 0.0 && sigma < 5.0 && a["figures"].is_null(), "{a}");
    assert_eq!(
        (text(a, "/photographs"), text(a, "/estimated/layout")),
        ("scans/coins/a".into(), "lp".into())
    );
    let inputs = a["input"].as_array().unwrap();
    assert_eq!(inputs.len(), 13, "the photographs and dome.lp: {a}");
    assert!(inputs.iter().all(|file| text(file, "/sha256").len() == 64), "{a}");
    let parts = a["parts"].as_array().unwrap();
    assert_eq!(
        parts.iter().map(|part| text(part, "/kind")).collect::<Vec<_>>(),
        ["photographs", "thumbnail"]
    );
    assert!(last["ball0.obj"].get("photographs").is_none() && !last["ball0.obj"]["figures"].is_null());
    if cfg!(target_os = "linux") {
        let [peak, forecast] = ["/peak_bytes", "/forecast_bytes"].map(|path| number(a, path));
        assert!(peak > 1e6 && peak <= forecast, "{peak} {forecast}");
    }
    #[cfg(unix)]
    {
        let read =
            |name: &str| std::fs::read(collection.path(&format!("out/assets/coins/a/{name}"))).unwrap();
        assert!(read("relief.glb").starts_with(b"glTF") && read("a.webp").starts_with(b"RIFF"));
        let report = json(read("report.json"));
        schemas::check("photometric", &report);
        assert_eq!((&report["input"], &report["lights_from"]), (&"a".into(), &"dome.lp".into()));
        assert_eq!(&report["sigma"]["median"], &a["estimated"]["sigma_median"]);
        assert!(String::from_utf8_lossy(&read("report.html")).contains("<title>a</title>"));
    }
    let page = json(std::fs::read(collection.path("out/collection.json")).unwrap());
    schemas::check("batch-collection", &page);
    let entry = page["assets"].as_array().unwrap().iter().find(|entry| entry["id"] == "coins/a").unwrap();
    assert_eq!((&entry["photographs"], &entry["sigma"]), (&12.into(), &a["estimated"]["sigma_median"]));
    for key in ["model", "report", "thumbnail"] {
        assert!(collection.path("out").join(text(entry, &format!("/{key}"))).is_file(), "{key}");
    }
    let before = (collection.records().len(), collection.objects());
    let (code, report) = collection.report("");
    assert_eq!((code, number(&report, "/attempts"), number(&report, "/known")), (Some(0), 0.0, 3.0));
    assert_eq!((collection.records().len(), collection.objects()), before, "nothing was touched");
}

#[test]
fn files_of_photographs_are_the_same_everywhere_and_name_no_folder() {
    let collection = Collection::of_photographs();
    collection.configure(&format!("{QUICK}\n[photometric]\nrelight = [\"ptm\", \"openlime\"]\n"));
    assert_eq!(collection.report("--jobs 1").0, Some(0));
    let folder = collection.path("").to_string_lossy().trim_end_matches('/').to_owned();
    for (path, bytes) in collection.objects() {
        let names_it = [folder.as_bytes(), b"scans/coins"]
            .iter()
            .any(|name| bytes.windows(name.len()).any(|window| window == *name));
        assert!(!names_it, "{} names a folder", path.display());
    }
    let other = Collection::of_photographs();
    std::fs::rename(other.path("scans/coins"), other.path("scans/other")).unwrap();
    other.configure(&format!("{QUICK}\n[photometric]\nrelight = [\"ptm\", \"openlime\"]\n"));
    assert_eq!(other.report("--jobs 2").0, Some(0));
    let [one, two] = [collection.objects(), other.objects()];
    assert!(one.keys().eq(two.keys()) && one == two, "other bytes elsewhere");
    assert!(one.keys().any(|path| path.ends_with("openlime/info.json")), "{:?}", one.keys());
}

#[test]
fn a_damaged_folder_fails_by_name_while_the_others_go_on() {
    let collection = Collection::of_photographs();
    collection.photograph("scans/coins/c");
    collection.write("scans/coins/c/dome.lp", "3\np0.exr 0 0 1\n");
    collection.photograph("scans/coins/d");
    collection.write("scans/coins/d/p3.exr", "not an image");
    let output = collection.run("");
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("coins/c: failed: scans/coins/c/dome.lp: line 1: 3 lights stated"), "{stderr}");
    assert!(stderr.contains("coins/d: failed: ") && stderr.contains("p3.exr"), "{stderr}");
    assert_eq!(number(&collection.report("").1, "/states/done"), 3.0);
    collection.objects();
    // A folder that was repaired is done without --retry-failed.
    std::fs::copy(collection.path("scans/coins/a/dome.lp"), collection.path("scans/coins/c/dome.lp"))
        .unwrap();
    let (code, report) = collection.report("");
    assert_eq!((code, number(&report, "/attempts"), number(&report, "/states/done")), (Some(2), 1.0, 4.0));
    let [a, c] = ["coins/a", "coins/c"].map(|id| collection.last()[id].clone());
    assert_eq!(c["estimated"]["sigma_median"], a["estimated"]["sigma_median"]);
    assert_ne!(c["parts"][0]["address"], a["parts"][0]["address"], "its report has its own name");
}

#[test]
fn photographs_that_changed_are_done_anew() {
    let collection = Collection::of_photographs();
    assert_eq!(collection.report("").0, Some(0));
    let [a, b] = ["coins/a", "coins/b"].map(|id| collection.last()[id].clone());
    let redone = |what: &str| {
        let (code, report) = collection.report("");
        assert_eq!((code, number(&report, "/attempts")), (Some(0), 1.0), "{what}: {report}");
        collection.last()["coins/a"].clone()
    };
    std::fs::copy(collection.path("scans/coins/a/p1.exr"), collection.path("scans/coins/a/p0.exr")).unwrap();
    let changed = redone("another photograph");
    assert_ne!(changed["parts"][0]["address"], a["parts"][0]["address"]);
    // New files next to the photographs count, others do not.
    std::fs::copy(collection.path("scans/coins/a/p1.exr"), collection.path("scans/coins/a/more.exr"))
        .unwrap();
    let more = redone("a photograph without a light");
    let warnings = more["warnings"].to_string();
    assert!(warnings.contains("a photograph in the folder has no light"), "{warnings}");
    std::fs::remove_file(collection.path("scans/coins/a/more.exr")).unwrap();
    assert_eq!(redone("one less")["parts"][0]["reused"], true, "as it was before");
    collection.write("scans/coins/a/notes.txt", "from the archive");
    assert_eq!(number(&collection.report("").1, "/attempts"), 0.0);
    // Options that touch only photographs.
    collection.configure(&format!("{QUICK}\n[photometric]\npixel_size = 0.05\n"));
    assert_eq!(number(&collection.report("").1, "/attempts"), 2.0);
    assert_ne!(collection.last()["coins/b"]["parts"][0]["address"], b["parts"][0]["address"]);
    std::fs::remove_file(collection.path("scans/coins/a/p2.exr")).unwrap();
    assert_eq!(collection.report("").0, Some(2));
    let error = text(&collection.last()["coins/a"], "/error");
    assert!(error.contains("dome.lp: line 4") && error.contains("P2.EXR"), "{error}");
    assert_nothing_twice(&collection.records());
}

#[test]
fn an_audit_finds_forged_estimates() {
    let collection = Collection::of_photographs();
    collection.report("");
    let (code, report) = collection.report("--check --proofs 3");
    assert_eq!((code, number(&report, "/proofs")), (Some(0), 3.0), "{report}");
    let path = collection.path("out/manifest.jsonl");
    let truth = std::fs::read_to_string(&path).unwrap();
    let last = collection.last();
    let sigma = format!("\"sigma_median\":{}", last["coins/b"]["estimated"]["sigma_median"]);
    assert!(truth.contains(&sigma));
    std::fs::write(&path, truth.replace(&sigma, "\"sigma_median\":0.01")).unwrap();
    let (code, report) = collection.report("--check --proofs 0");
    let faults = report["faults"].to_string();
    assert!(code == Some(1) && faults.contains("estimated.sigma_median is 0.01 in the manifest"), "{faults}");
    // The same forgery in the description of the estimate is found by estimating again.
    for object in files_below(&collection.path("out/objects"), &["json"]) {
        let described = std::fs::read_to_string(&object).unwrap();
        std::fs::write(&object, described.replace(&sigma, "\"sigma_median\":0.01")).unwrap();
    }
    assert_eq!(collection.report("--check --proofs 0").0, Some(0));
    let (code, report) = collection.report("--check --proofs 3");
    let faults = report["faults"].to_string();
    assert!(code == Some(1) && faults.contains("gives other figures: estimated.sigma_median"), "{faults}");
}

#[test]
fn what_does_not_apply_to_photographs_is_a_warning() {
    let collection = Collection::of_photographs();
    let over = "\n[[override]]\nid = \"coins/*\"\nbake = { triangles = 50 }\nviewer = true\n\
                [[override]]\nid = \"*.obj\"\nphotometric = { pixel_size = 2 }\n[turntable]\nsize = 16\nframes = 2\n";
    collection.configure(&format!("require = [\"mean-angle=30\"]\n{QUICK}{over}"));
    let output = collection.run("");
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    for warning in [
        "require has no effect on photographs (2 times)",
        "turntable has no effect on photographs (2 times)",
        "[bake] of the override for `coins/*` has no effect on photographs (2 times)",
        "[photometric] of the override for `*.obj` has no effect on scans\n",
    ] {
        assert!(stderr.contains(&format!("warning: {warning}")), "{warning}: {stderr}");
    }
    assert_eq!(stderr.matches("has no effect").count(), 4, "{stderr}");
    let record = &collection.last()["coins/a"];
    let kinds: Vec<_> = record["parts"].as_array().unwrap().iter().map(|part| text(part, "/kind")).collect();
    assert_eq!(kinds, ["photographs", "thumbnail", "viewer"]);
}

#[test]
fn sources_find_photographs_and_lists_name_them() {
    let collection = Collection::of_photographs();
    let ids = |sources: &str| {
        collection.write("collection.toml", format!("output = \"out\"\n{sources}{QUICK}"));
        let output = collection.run("--page-only");
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        let data = json(std::fs::read(collection.path("out/collection.json")).unwrap());
        let entries = data["assets"].as_array().unwrap().iter().map(|entry| text(entry, "/id"));
        entries.collect::<Vec<_>>()
    };
    assert_eq!(ids("[[source]]\nglob = \"scans/coins/*\"\n"), ["a", "b"]);
    assert_eq!(ids("[[source]]\nglob = \"scans/**\"\n"), ["ball0.obj", "coins/a", "coins/b"]);
    assert_eq!(ids("[[source]]\nfolder = \"scans/coins/a\"\n"), ["a"], "the folder itself");
    // Images mark an object only below a source of photographs, and only there without a file of lights.
    std::fs::remove_file(collection.path("scans/coins/b/dome.lp")).unwrap();
    assert_eq!(ids("[[source]]\nfolder = \"scans\"\n"), ["ball0.obj", "coins/a"]);
    assert_eq!(ids("[[source]]\nphotographs = \"scans\"\n"), ["coins/a", "coins/b"]);
    collection
        .write("list.csv", "path,id\nscans/coins/a/dome.lp,lp\nscans/coins/a,folder\nscans/ball0.obj,ball\n");
    assert_eq!(ids("[[source]]\nlist = \"list.csv\"\n"), ["ball", "folder", "lp"]);
    assert_eq!(collection.report("").0, Some(0));
    let last = collection.last();
    assert_eq!(text(&last["lp"], "/photographs"), "scans/coins/a/dome.lp");
    assert_eq!(last["lp"]["estimated"]["sigma_median"], last["folder"]["estimated"]["sigma_median"]);
    assert_eq!(number(&collection.report("").1, "/attempts"), 0.0);
    let names: Vec<_> = all_files_below(&collection.path("out/assets"))
        .iter()
        .filter_map(|path| Some(path.file_name()?.to_str()?.to_owned()))
        .filter(|name| name.ends_with(".webp"))
        .collect();
    assert!(names.contains(&"dome.webp".to_owned()) && names.contains(&"a.webp".to_owned()), "{names:?}");
}
