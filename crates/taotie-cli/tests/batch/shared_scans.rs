//! A collection of the scans and models in the shared data.

use crate::collection::{Collection, QUICK, text};
use crate::files::data_files;

/// Bakes every model below a folder of the shared data; asserts that each has a record with its state, and an
/// error message if it is not made. Returns the numbers of models made and not made.
fn bake(folder: &str, extensions: &[&str]) -> Option<[usize; 2]> {
    let files = data_files(folder, extensions);
    let first = files.first()?;
    let root = first.ancestors().find(|path| path.ends_with(folder)).expect("it is below the folder");
    let collection = Collection::new("");
    let source = format!("output = \"out\"\n[[source]]\nfolder = {:?}\n{QUICK}", root.display().to_string());
    collection.write("collection.toml", source);
    collection.report("--time-limit 2m");
    let last = collection.last();
    assert_eq!(last.len(), files.len(), "each has a record");
    let is_made = |state: &str| matches!(state, "done" | "required-not-met");
    let mut counts = [0, 0];
    for (id, record) in &last {
        let made = is_made(&text(record, "/state"));
        assert_eq!(made, record.get("error").is_none(), "{id}: {record}");
        if !made {
            println!("{id}: {}: {}", text(record, "/state"), text(record, "/error"));
            assert!(!text(record, "/error").contains("its process"), "{id} crashed: {record}");
        }
        if let (true, Some(peak), Some(forecast)) =
            (made, record["peak_bytes"].as_f64(), record["forecast_bytes"].as_f64())
        {
            assert!(peak <= forecast, "{id}: {peak} used, {forecast} estimated");
        }
        counts[usize::from(!made)] += 1;
    }
    collection.objects();
    Some(counts)
}

#[test]
fn every_scan_of_a_folder_is_done() {
    let Some([made, other]) = bake("odedstein-meshes", &["obj"]) else { return };
    assert!(made > 0 && other == 0, "{other} of them are not made");
}

#[test]
#[ignore = "takes minutes"]
fn every_scan_and_model_of_the_shared_data_has_a_record() {
    for folder in
        ["threedscans-keijiro", "khronos-gltf-sample-assets", "polyhaven-models", "malformed-and-odd-inputs"]
    {
        let extensions = ["gltf", "glb", "obj", "ply", "stl"];
        let Some([made, other]) = bake(folder, &extensions) else { continue };
        println!("{folder}: {made} made, {other} not");
        assert!(made > 0);
    }
}
