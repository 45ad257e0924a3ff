//! `taotie bake` on third-party models whose materials have maps: the asset shows what the scan shows.

use crate::command::{SMALL_VIEWS, json, number};
use crate::files::data_files;

/// The largest mean angles, degrees, between an asset's normals and those of its scan: close to the measured ones.
struct Most {
    /// Over the surface, by the proof.
    proved: f64,
    /// In pictures, away from silhouettes.
    seen: f64,
}

/// Texels along a side of the map, and pixels along a side of the pictures.
struct Sides {
    map: &'static str,
    picture: &'static str,
}

const USUAL: Sides = Sides { map: "1024", picture: "640" };

/// Bakes every scan of a folder and compares the proved angles with those in pictures.
fn relief_is_kept(model: &str, sides: &Sides, most: &Most) {
    for scan in data_files(model, &["gltf"]) {
        let folder = tempfile::tempdir().unwrap();
        let scan = scan.to_str().expect("a path of text");
        let bake = ["bake", scan, "-o", "out.glb", "--size", sides.map];
        let baked = json(&[&bake[..], &SMALL_VIEWS].concat(), folder.path());
        let line = ["compare", "out.glb", "--reference", scan, "--method", "smooth,tangent-normal"];
        let line =
            [&line[..], &["--shading", "ggx", "--match", "pixel", "--size", sides.picture, "-o", "compared"]]
                .concat();
        let compared = json(&line, folder.path());
        let [smooth, mapped] = [0, 1].map(|i| number(&compared, &format!("/methods/{i}/error/inner/mean")));
        let proved = number(&baked, "/proof/levels/0/surface_angles/mean");
        println!("{model}: proved {proved:.3}°, seen {mapped:.3}°, without the map {smooth:.3}°");
        assert!(mapped <= most.seen && proved <= most.proved, "{model}: proved {proved}°, seen {mapped}°");
        assert!(mapped < smooth / 2.0, "{model}: the map helps, {smooth}° without it");
    }
}

#[test]
fn relief_of_a_bottle_is_kept() {
    relief_is_kept("khronos-gltf-sample-assets/WaterBottle", &USUAL, &Most { proved: 1.5, seen: 1.0 });
}

#[test]
#[ignore = "takes half a minute"]
fn relief_of_cups_is_kept() {
    relief_is_kept("polyhaven-models/tea_set_01", &USUAL, &Most { proved: 1.5, seen: 1.0 });
}

/// Its map has more than three times as many texels as the asset's.
#[test]
#[ignore = "takes half a minute"]
fn relief_of_a_camera_is_kept() {
    relief_is_kept("polyhaven-models/Camera_01", &USUAL, &Most { proved: 3.3, seen: 2.3 });
}

/// With as many texels as its map, and pixels that do not blur them, the asset is within a degree.
#[test]
#[ignore = "bakes a map of 4096² texels"]
fn relief_of_a_camera_is_within_a_degree_where_the_map_is_large_enough() {
    let sides = Sides { map: "4096", picture: "1024" };
    relief_is_kept("polyhaven-models/Camera_01", &sides, &Most { proved: 0.7, seen: 1.0 });
}
