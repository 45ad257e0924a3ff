//! Which work is done, and which is not repeated.

use crate::collection::{Collection, QUICK, assert_nothing_twice, ball, number, text};
use crate::schemas;
use serde_json::Value;

fn states(report: &Value) -> [f64; 4] {
    ["done", "required-not-met", "refused", "failed"].map(|state| number(report, &format!("/states/{state}")))
}

#[test]
fn good_ones_are_done_once_and_each_bad_one_has_its_sentence() {
    let collection = Collection::of_balls(3);
    collection.write("scans/cut.obj", &ball(0.01)[..1000]);
    collection.write("scans/empty.glb", "");
    let claims = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n\
                  property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    collection.write("scans/huge.ply", claims);
    let (code, report) = collection.report("");
    assert_eq!((code, states(&report)), (Some(2), [3.0, 0.0, 0.0, 3.0]), "{report}");
    let last = collection.last();
    for (id, why) in [("cut.obj", "line "), ("empty.glb", "empty.glb"), ("huge.ply", "4000000000")] {
        assert!(text(&last[id], "/error").contains(why), "{}", last[id]);
        assert_eq!(last[id]["state"], "failed");
    }
    let done = &last["ball0.obj"];
    assert!(number(done, "/figures/mean_angle") > 0.0 && number(done, "/figures/triangles/0") <= 100.0);
    assert_eq!(text(done, "/input/0/sha256").len(), 64);
    assert!(done["stages"].as_array().unwrap().iter().any(|stage| stage["stage"] == "bake"), "{done}");
    if cfg!(target_os = "linux") {
        let [peak, forecast] = ["/peak_bytes", "/forecast_bytes"].map(|path| number(done, path));
        assert!(peak > 1e6 && peak <= forecast, "{peak} {forecast}");
    }
    #[cfg(unix)]
    {
        let link = collection.path("out/assets/ball0.obj/ball0.glb");
        assert!(std::fs::read(link).unwrap().starts_with(b"glTF"), "a readable name");
    }
    let before = (collection.records().len(), collection.objects());
    let (code, report) = collection.report("");
    assert_eq!((code, number(&report, "/attempts"), number(&report, "/known")), (Some(2), 0.0, 6.0));
    assert_eq!((collection.records().len(), collection.objects()), before, "nothing was touched");
    let (_, report) = collection.report("--retry-failed");
    assert_eq!(number(&report, "/attempts"), 3.0);
    assert_eq!(collection.last()["cut.obj"]["attempt"], 2);
    assert_nothing_twice(&collection.records());
}

#[test]
fn a_changed_option_redoes_what_it_touches_and_no_more() {
    let collection = Collection::of_balls(2);
    assert_eq!(collection.report("").0, Some(0));
    let reused = |id: &str| {
        let record = collection.last()[id].clone();
        let parts = record["parts"].as_array().unwrap();
        parts.iter().map(|part| (text(part, "/kind"), part["reused"] == true)).collect::<Vec<_>>()
    };
    assert_eq!(reused("ball0.obj"), [("asset".into(), false), ("thumbnail".into(), false)]);
    collection.configure(&QUICK.replace("size = 32", "size = 48"));
    assert_eq!(number(&collection.report("").1, "/attempts"), 2.0);
    assert_eq!(reused("ball1.obj"), [("asset".into(), true), ("thumbnail".into(), false)]);
    let over = "\n[[override]]\nid = \"*1.obj\"\nbake = { triangles = 80 }\n";
    collection.configure(&format!("{QUICK}{over}").replace("size = 32", "size = 48"));
    assert_eq!(number(&collection.report("").1, "/attempts"), 1.0, "one asset has other options");
    assert_eq!(reused("ball1.obj"), [("asset".into(), false), ("thumbnail".into(), false)]);
    // Back to the first options: everything exists.
    collection.configure(QUICK);
    assert_eq!(number(&collection.report("").1, "/attempts"), 2.0);
    assert!(["ball0.obj", "ball1.obj"].iter().all(|id| reused(id).iter().all(|(_, reused)| *reused)));
    assert_nothing_twice(&collection.records());
}

#[test]
fn requirements_are_judged_anew_without_a_bake() {
    let collection = Collection::of_balls(1);
    assert_eq!(collection.report("").0, Some(0));
    let before = collection.objects();
    collection.configure(&format!("require = [\"mean-angle=0.0001\"]\n{QUICK}"));
    let output = collection.run("");
    assert_eq!(output.status.code(), Some(1));
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(stderr.contains("ball0.obj: required-not-met: mean-angle is "), "{stderr}");
    let last = &collection.last()["ball0.obj"];
    assert_eq!((&last["state"], last["stages"].as_array().unwrap().len()), (&"required-not-met".into(), 0));
    assert_eq!(collection.objects(), before);
    assert_eq!(collection.report("").0, Some(1), "the record is known, and still not met");
    collection.configure(QUICK);
    assert_eq!(collection.report("").0, Some(0));
}

#[test]
fn a_length_fails_an_asset_without_a_unit_whether_or_not_it_exists() {
    let failure = |collection: &Collection| {
        collection.configure(&format!("require = [\"hausdorff=0.14mm\"]\n{QUICK}"));
        assert_eq!(collection.report("").0, Some(2));
        let last = &collection.last()["ball0.obj"];
        (text(last, "/state"), text(last, "/error"))
    };
    let collection = Collection::of_balls(1);
    assert_eq!(collection.report("").0, Some(0));
    let later = failure(&collection);
    assert!(later.0 == "failed" && later.1.contains("the unit of its coordinates"), "{later:?}");
    assert_eq!(later, failure(&Collection::of_balls(1)), "an asset that does not exist");
    assert_eq!(number(&collection.report("").1, "/attempts"), 0.0, "reading rounds 0.14 mm in metres");
    assert_eq!(collection.report("--check").0, Some(0));
    collection.configure(QUICK);
    assert_eq!(collection.report("").0, Some(0), "without the requirement, it is attempted again");
    assert_nothing_twice(&collection.records());
}

#[cfg(unix)]
#[test]
fn links_of_an_earlier_bake_are_removed_and_other_files_stay() {
    let collection = Collection::of_balls(1);
    let folder = collection.path("out/assets/ball0.obj");
    let names = || {
        let entries = std::fs::read_dir(&folder).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    collection.configure(&QUICK.replace("size = 64", "size = 64\nmaps = [\"normal\", \"height\"]"));
    assert_eq!(collection.report("").0, Some(0));
    let first = ["ball0.glb", "ball0.height.png", "ball0.report.html", "ball0.report.json", "ball0.webp"];
    assert_eq!(names(), first);
    std::fs::write(folder.join("notes.txt"), "").unwrap();
    std::os::unix::fs::symlink("../../../scans/ball0.obj", folder.join("scan.obj")).unwrap();
    collection.configure(&format!("report = false\n{QUICK}"));
    assert_eq!(collection.report("").0, Some(0));
    assert_eq!(names(), ["ball0.glb", "ball0.webp", "notes.txt", "scan.obj"]);
    // Deleted links are made again, and nothing else.
    std::fs::remove_file(folder.join("ball0.glb")).unwrap();
    assert_eq!(number(&collection.report("").1, "/attempts"), 0.0);
    assert_eq!(names(), ["ball0.glb", "ball0.webp", "notes.txt", "scan.obj"]);
}

#[test]
fn without_a_size_the_smallest_asset_is_searched_for() {
    let collection = Collection::of_balls(1);
    let quick = "[verify]\npoints = 1000\nmap = 64\nview = 32\n";
    let searched = |options: &str| {
        collection.configure(&format!("{options}{quick}"));
        assert_eq!(collection.report("").0, Some(0));
        collection.last()["ball0.obj"]["stages"].to_string().contains("search")
    };
    assert!(searched("") && searched("[bake]\nimages = [\"png\"]\n"));
    assert!(!searched("[bake]\nsize = 64\n") && !searched("[packing]\nmeshopt = true\n"));
    assert!(!searched("[bake]\nmaps = [\"normal\", \"ao\"]\nao_rays = 1\n"), "no search judges occlusion");
}

/// A limit between the mean and the bounds that 1,000 points leave: more points decide it.
#[test]
fn requirements_that_known_figures_leave_undecided_are_proved_again() {
    let collection = Collection::of_balls(1);
    collection.report("");
    let address = text(&collection.last()["ball0.obj"], "/parts/0/address");
    let path = format!("out/objects/{}/{address}/object.json", &address[..2]);
    let object: Value = serde_json::from_slice(&std::fs::read(collection.path(&path)).unwrap()).unwrap();
    let angles = "/figures/levels/0/overview/angles";
    let [mean, high] =
        ["summary/mean", "mean_interval/1"].map(|name| number(&object, &format!("{angles}/{name}")));
    let limit = mean + 0.6 * (high - mean);
    collection.configure(&format!("require = [\"mean-angle={limit}\"]\n{QUICK}"));
    let (code, _) = collection.report("--memory-limit 1M");
    let last = &collection.last()["ball0.obj"];
    assert_eq!((code, text(last, "/state")), (Some(1), "required-not-met".into()), "{last}");
    assert!(last["warnings"].to_string().contains("points, so a requirement is undecided: "), "{last}");
    assert!(number(last, "/figures/mean_angle") > 0.0 && !last["parts"].as_array().unwrap().is_empty());
    collection.report("");
    let last = &collection.last()["ball0.obj"];
    let bounds = [0, 1].map(|i| number(last, &format!("/required/0/interval/{i}")));
    assert!(limit < bounds[0] || bounds[1] <= limit, "{limit} is undecided: {bounds:?}");
    assert!(number(last, "/points") > 1000.0, "{last}");
    assert_eq!(number(&collection.report("").1, "/attempts"), 0.0, "and it stays so");
    let (code, report) = collection.report("--check --proofs 1");
    assert!(report["faults"].as_array().is_some_and(Vec::is_empty) && code != Some(2), "{report}");
}

/// Rewrites all records as an earlier version of the program wrote them.
fn age(collection: &Collection) {
    let path = collection.path("out/manifest.jsonl");
    let text = std::fs::read_to_string(&path).unwrap();
    assert_ne!(aged(&text), text);
    std::fs::write(&path, aged(&text)).unwrap();
}

/// Returns a document with the number of an earlier version.
fn aged(document: &str) -> String {
    let current = schemas::number("batch-manifest");
    document.replace(&format!("\"schema\":{current}"), "\"schema\":1")
}

#[test]
fn records_of_an_earlier_version_are_judged_again() {
    let collection = Collection::of_balls(1);
    collection.report("");
    age(&collection);
    let (code, report) = collection.report("--check --proofs 0");
    assert!(
        code == Some(1) && report["faults"].to_string().contains("another version's figures"),
        "{report}"
    );
    let (_, report) = collection.report("");
    let record = &collection.last()["ball0.obj"];
    let seconds = number(record, "/seconds");
    assert_eq!(
        (number(&report, "/attempts"), number(record, "/schema"), seconds),
        (1.0, schemas::number("batch-manifest") as f64, 0.0),
        "{record}"
    );
    assert_eq!(number(&collection.report("").1, "/attempts"), 0.0);
    // If the figures themselves are from an earlier version, the asset is made again.
    age(&collection);
    for (path, bytes) in collection.objects() {
        if path.ends_with("object.json") {
            let text = aged(&String::from_utf8(bytes).unwrap());
            std::fs::write(collection.path("out").join(path), text).unwrap();
        }
    }
    collection.report("");
    let record = &collection.last()["ball0.obj"];
    let is_current = number(record, "/schema") == schemas::number("batch-manifest") as f64;
    assert!(is_current && number(record, "/seconds") > 0.0, "{record}");
}

#[test]
fn a_scan_that_changed_is_done_anew_and_the_same_one_elsewhere_is_not() {
    let collection = Collection::of_balls(1);
    collection.report("");
    collection.write("scans/ball0.obj", ball(0.03));
    assert_eq!(number(&collection.report("").1, "/attempts"), 1.0);
    std::fs::create_dir(collection.path("scans/copy")).unwrap();
    std::fs::copy(collection.path("scans/ball0.obj"), collection.path("scans/copy/ball0.obj")).unwrap();
    assert_eq!(number(&collection.report("").1, "/attempts"), 1.0);
    let copy = &collection.last()["copy/ball0.obj"];
    assert_eq!((&copy["parts"][0]["reused"], &copy["state"]), (&true.into(), &"done".into()), "{copy}");
    assert_nothing_twice(&collection.records());
}

#[test]
fn a_file_that_was_missing_is_noticed_when_it_appears() {
    let collection = Collection::of_balls(1);
    collection.write("scans/ball0.obj", format!("mtllib skin.mtl\nusemtl skin\n{}", ball(0.01)));
    let attempts = || number(&collection.report("").1, "/attempts");
    assert_eq!([attempts(), attempts()], [1.0, 0.0]);
    let missing = collection.last()["ball0.obj"]["input"][1].clone();
    assert_eq!((text(&missing, "/path"), &missing["is_missing"]), ("scans/skin.mtl".into(), &true.into()));
    collection.write("scans/skin.mtl", "newmtl skin\nKd 0.8 0.1 0.1\n");
    assert_eq!([attempts(), attempts()], [1.0, 0.0]);
    assert_eq!(collection.report("--check").0, Some(0));
    std::fs::remove_file(collection.path("scans/skin.mtl")).unwrap();
    assert_eq!([attempts(), attempts()], [1.0, 0.0]);
}

#[test]
fn what_does_not_fit_the_memory_is_refused_and_done_where_there_is_more() {
    let collection = Collection::of_balls(2);
    let (code, report) = collection.report("--memory-limit 40M");
    assert_eq!((code, states(&report)), (Some(2), [0.0, 0.0, 2.0, 0.0]), "{report}");
    assert!(text(&collection.last()["ball0.obj"], "/error").contains("the limit is 40 MiB"));
    assert_eq!(collection.report("--memory-limit 300M --retry-failed").0, Some(0));
}

#[test]
fn a_time_limit_costs_one_record() {
    let collection = Collection::of_balls(2);
    let slow = "\n[[override]]\nid = \"ball1.obj\"\nbake = { size = 8192, side = 8, ao_rays = 4096, maps = [\"normal\", \"ao\"] }\n";
    collection.configure(&format!("{QUICK}{slow}"));
    let (code, report) = collection.report("--time-limit 8s");
    assert_eq!((code, states(&report)), (Some(2), [1.0, 0.0, 0.0, 1.0]), "{report}");
    let error = text(&collection.last()["ball1.obj"], "/error");
    assert!(error.starts_with("took longer than ") && error.contains("--time-limit"), "{error}");
    assert!(number(&collection.last()["ball1.obj"], "/seconds") < 30.0);
    collection.configure(QUICK);
    assert_eq!(collection.report("").0, Some(0), "other options make it a different job");
}

#[test]
fn shards_share_the_work_and_a_call_without_them_knows_all() {
    let collection = Collection::of_balls(5);
    let attempts: f64 =
        (1..=2).map(|shard| number(&collection.report(&format!("--shard {shard}/2")).1, "/attempts")).sum();
    assert_eq!(attempts, 5.0);
    assert!(!collection.path("out/manifest.jsonl").exists());
    let (code, report) = collection.report("");
    assert_eq!((code, number(&report, "/attempts"), states(&report)[0]), (Some(0), 0.0, 5.0));
}

#[test]
fn two_drivers_do_not_write_to_one_manifest() {
    let collection = Collection::of_balls(1);
    collection.report("");
    let file = std::fs::File::open(collection.path("out/manifest.jsonl")).unwrap();
    file.lock().unwrap();
    let output = collection.run("");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && stderr.contains("another `taotie batch`"), "{stderr}");
}

#[test]
fn turntables_and_pages_are_made_where_they_are_asked_for() {
    let collection = Collection::of_balls(1);
    collection.configure(&format!("viewer = true\n{QUICK}\n[turntable]\nsize = 16\nframes = 3\n"));
    assert_eq!(collection.report("").0, Some(0));
    let read = |name: &str| std::fs::read(collection.path(&format!("out/assets/ball0.obj/{name}"))).unwrap();
    assert!(read("ball0.turn.png").windows(4).any(|chunk| chunk == b"acTL"), "an animated PNG");
    assert!(String::from_utf8_lossy(&read("ball0.html")).starts_with("<!doctype html>"));
    let report = String::from_utf8_lossy(&read("ball0.report.html")).into_owned();
    assert!(report.contains("Normal error") && report.contains("The collection page lists the requirements"));
    assert!(read("ball0.webp").starts_with(b"RIFF"));
}
