//! `taotie bake` on models by others whose materials have maps: what the scan shows is what its asset shows.

use crate::command::{json, number};
use crate::files::data_files;

/// Scans by others, and the largest mean angles to be told and to be seen, degrees: near what was measured, but for the
/// camera, whose map has more than three times as many texels as the asset's.
const SCANS: [(&str, f64, f64); 3] = [
    ("khronos-gltf-sample-assets/WaterBottle", 1.5, 1.0),
    ("polyhaven-models/tea_set_01", 1.5, 1.0),
    ("polyhaven-models/Camera_01", 3.3, 2.3),
];

#[test]
fn relief_that_is_a_normal_map_of_the_scan_is_kept() {
    for (model, most_told, most_seen) in SCANS {
        for scan in data_files(model, &["gltf"]) {
            let folder = tempfile::tempdir().unwrap();
            let scan = scan.to_str().expect("a path of text");
            let baked = json(&["bake", scan, "-o", "out.glb", "--size", "1024"], folder.path());
            let line = ["compare", "out.glb", "--reference", scan, "--method", "smooth,tangent-normal"];
            let line = [&line[..], &["--match", "pixel", "-o", "compared"]].concat();
            let compared = json(&line, folder.path());
            let [smooth, mapped] =
                [0, 1].map(|i| number(&compared, &format!("/methods/{i}/error/inner/mean")));
            let told = number(&baked, "/proof/angles/mean");
            println!("{model}: told {told:.3}°, seen {mapped:.3}°, without the map {smooth:.3}°");
            // What is told of the surface is what is seen of it, away from silhouettes.
            assert!(mapped <= most_seen && told <= most_told, "{model}: told {told}°, seen {mapped}°");
            assert!(mapped < smooth / 2.0, "{model}: the map gains, {smooth}° without it");
        }
    }
}
