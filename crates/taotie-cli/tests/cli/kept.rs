//! Inputs are never overwritten, and an incomplete write leaves all files as they were.

use super::balls::{Ball, LOW, SCAN};
use super::models::{Green, write_relief};
use super::pictures::write_square;
use super::place::Place;
use std::collections::BTreeMap;
use taotie_engine::image::Encoding;
use taotie_io::{GltfAsset, GltfFormat, PngSamples, load_model, write_gltf};

/// A scan with a colour texture.
const TEXTURED: Ball = Ball { uv: Some(|u, v| [u, v]), ..SCAN };

/// Returns every file of the place with its content.
fn content(place: &Place) -> BTreeMap<String, Vec<u8>> {
    place.files().into_iter().map(|name| (name.clone(), place.read(&name))).collect()
}

/// Runs a command that must be refused and change nothing; returns its stderr.
fn refused(place: &Place, line: &str) -> String {
    let before = content(place);
    let assert = place.taotie(line).assert().code(2);
    let said = String::from_utf8(assert.get_output().stderr.clone()).expect("it is text");
    assert!(content(place) == before, "{line}: files changed; {said}");
    said
}

/// Runs a command that would overwrite `read` with `written`.
fn over(place: &Place, line: &str, [written, read]: [&str; 2]) {
    let said = refused(place, line);
    let wanted = format!("error: {written}: it would overwrite the input {read}; choose another name");
    assert!(said.contains(&wanted), "{line}: {said}");
}

fn write_picture(place: &Place, name: &str, level: u8) {
    let samples = [level; 3 * 16 * 16];
    write_square(&place.path(name), PngSamples::U8(&samples), Encoding::Srgb);
}

/// Returns a vase with a material library and a texture.
fn vase() -> Place {
    let place = Place::with("vase.obj", format!("mtllib vase.mtl\nusemtl clay\n{}", TEXTURED.obj()));
    place.write("vase.mtl", "newmtl clay\nKd 1 1 1\nmap_Kd vase_color.png\n");
    write_picture(&place, "vase_color.png", 120);
    place
}

#[test]
fn a_bake_keeps_the_buffer_of_its_scan() {
    let place = Place::with("ball.obj", SCAN.obj());
    let scene = load_model(place.path("ball.obj")).unwrap().scene;
    let levels = [&scene.meshes()[0]];
    let asset = GltfAsset { levels: &levels, ..GltfAsset::default() };
    write_gltf(&place.path("Box0.gltf"), &asset, &GltfFormat::default()).unwrap();
    std::fs::rename(place.path("Box0.gltf"), place.path("Box.gltf")).unwrap();
    over(&place, "bake Box.gltf -o Box0.gltf --size 64", ["Box0.bin"; 2]);
    over(&place, "bake Box.gltf -o Box.gltf --size 64", ["Box.gltf"; 2]);
    // Also those of the low-poly mesh and of the cage, which are read later.
    over(&place, "bake ball.obj --low Box.gltf -o Box0.gltf --size 64", ["Box0.bin"; 2]);
    over(&place, "bake ball.obj --low ball.obj --cage Box.gltf -o Box0.gltf --size 64", ["Box0.bin"; 2]);
}

#[test]
fn a_bake_keeps_textures_libraries_and_provenance() {
    let place = vase();
    over(&place, "bake vase.obj -o vase.gltf --size 64 --triangles 500", ["vase_color.png"; 2]);
    place.write("a.report.json", r#"{"dc:title": "A vase"}"#);
    let line = "bake vase.obj -o a.glb --provenance a.report.json --size 64";
    over(&place, line, ["a.report.json"; 2]);
    place.taotie("bake vase.obj -o vase.glb --size 64 --triangles 500 --no-verify").assert().success();
}

#[test]
fn a_render_keeps_what_it_shows() {
    let place = vase();
    write_relief(&place.path("n.png"), Green::Up);
    place.write("clay.toml", "roughness = 0.5\n[maps]\nocclusion = 'ao.png'\n");
    write_picture(&place, "ao.png", 200);
    std::fs::hard_link(place.path("n.png"), place.path("link.png")).unwrap();
    over(&place, "render vase.obj --normal-map n.png -o n.png", ["n.png"; 2]);
    over(&place, "render vase.obj --normal-map n.png -o link.png", ["link.png", "n.png"]);
    over(&place, "render vase.obj --normal-map n.png -o ./n.png", ["./n.png", "n.png"]);
    over(&place, "render vase.obj -o vase_color.png", ["vase_color.png"; 2]);
    over(&place, "render vase.obj --material clay.toml -o ao.png", ["ao.png"; 2]);
    std::fs::copy(place.path("n.png"), place.path("n.000.png")).unwrap();
    std::fs::hard_link(place.path("n.000.png"), place.path("t.png")).unwrap();
    over(&place, "render vase.obj --turntable 2 --normal-map t.png -o n.png", ["n.000.png", "t.png"]);
}

#[cfg(unix)]
#[test]
fn nor_is_a_file_written_that_a_link_leads_to() {
    let place = vase();
    write_relief(&place.path("n.png"), Green::Up);
    std::os::unix::fs::symlink("n.png", place.path("link.png")).unwrap();
    over(&place, "render vase.obj --normal-map link.png -o n.png", ["n.png", "link.png"]);
    over(&place, "render vase.obj --normal-map n.png -o link.png", ["link.png", "n.png"]);
}

#[test]
fn diff_normals_and_compare_keep_what_they_read() {
    let place = vase();
    write_relief(&place.path("n.png"), Green::Up);
    write_relief(&place.path("x.png"), Green::Up);
    over(&place, "diff n.png x.png --heat n.png", ["n.png"; 2]);
    over(&place, "diff n.png x.png --heat x.png", ["x.png"; 2]);
    over(&place, "normals n.png -o n.png --bits 8", ["n.png"; 2]);
    write_picture(&place, "sheet.png", 90);
    place.write("vase.mtl", "newmtl clay\nKd 1 1 1\nmap_Kd sheet.png\n");
    let line = "compare vase.obj --method facet,smooth --size 32 -o .";
    over(&place, line, ["./sheet.png", "sheet.png"]);
}

#[test]
fn a_name_too_long_for_the_report_is_told_before_the_work() {
    let place = Place::with("scan.obj", SCAN.obj());
    // The asset's name is short enough, that of its report is not.
    let name = format!("{}.glb", "n".repeat(246));
    let said = refused(&place, &format!("bake scan.obj -o {name} --size 64 --triangles 500"));
    assert!(said.contains(".report.html: "), "{said}");
}

/// With a limit on file sizes, writing fails as on a full disk.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_all_as_it_was() {
    let place = Place::with("scan.obj", LOW.obj());
    let names = ["out.glb", "out.report.html", "out.report.json", "picture.png", "picture.depth.exr"];
    names.iter().for_each(|name| place.write(name, "before"));
    let program = env!("CARGO_BIN_EXE_taotie");
    let lines = [
        "bake scan.obj -o out.glb --size 64 --triangles 200",
        "render scan.obj -o picture.png --size 128 --aov depth",
        "render scan.obj -o turn.png --size 128 --turntable 3",
        "compare scan.obj --method facet,smooth --size 128 -o made",
    ];
    for line in lines {
        let before = content(&place);
        let limited = format!("ulimit -f 2 && exec '{program}' {line}");
        let mut process = std::process::Command::new("sh");
        let ended = process.args(["-c", &limited]).current_dir(place.path("")).output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert_eq!(ended.status.code(), Some(2), "{line}: {said}");
        assert!(said.contains("File too large"), "{line}: {said}");
        assert!(content(&place) == before, "{line}: {said}");
    }
}

#[test]
fn two_bakes_to_one_name_never_mix() {
    let place = Place::with("scan.obj", SCAN.obj());
    for _ in 0..3 {
        let bake = |triangles: &str| {
            let line = ["bake", "scan.obj", "-o", "out.gltf", "--size", "32", "--triangles", triangles];
            let mut process = place.process(&line);
            let silent = std::process::Stdio::null;
            process.stdout(silent()).stderr(silent()).spawn().expect("the command starts")
        };
        let runs = ["300", "700"].map(bake);
        runs.into_iter().for_each(|mut run| assert!(run.wait().expect("it ends").success()));
        let report: serde_json::Value = serde_json::from_slice(&place.read("out.report.json")).unwrap();
        let read = load_model(place.path("out.gltf")).unwrap();
        assert!(read.warnings.is_empty(), "{:?}", read.warnings);
        assert_eq!(report["triangles"][0], read.scene.triangle_count());
        assert!(place.files().iter().all(|name| !name.starts_with('.')), "{:?}", place.files());
    }
}

#[test]
fn a_page_keeps_the_files_that_others_wrote_to_its_folder() {
    let place = Place::with("low.obj", LOW.obj());
    place.write("scan.obj", SCAN.obj());
    let site = place.path("site");
    std::fs::create_dir(&site).unwrap();
    let of_site = || -> BTreeMap<String, Vec<u8>> {
        let names = std::fs::read_dir(&site).unwrap().map(|entry| entry.unwrap().file_name());
        names
            .map(|name| (name.to_string_lossy().into_owned(), std::fs::read(site.join(&name)).unwrap()))
            .collect()
    };
    let refused = |options: &str, name: &str| {
        let before = of_site();
        let assert = place.taotie(&format!("view low.obj --folder site {options}")).assert().code(2);
        let said = String::from_utf8(assert.get_output().stderr.clone()).unwrap();
        assert!(said.contains(&format!("site/{name}: it would be overwritten")), "{name}: {said}");
        assert!(of_site() == before, "{name}");
    };
    let address = "--address https://museum.example/site";
    for (options, name) in
        [("", "index.html"), ("", "asset.glb"), ("", "data.bin"), (address, "manifest.json")]
    {
        std::fs::write(site.join(name), "the user's").unwrap();
        refused(options, name);
        std::fs::remove_file(site.join(name)).unwrap();
    }

    let written = |options: &str| {
        place.taotie(&format!("view low.obj --folder site {options}")).assert().success();
        of_site()
    };
    let published = written(&format!("{address} --scan scan.obj --publish-scan"));
    assert!(published.contains_key("scan.glb") && published.contains_key("manifest-3.json"));
    let measured = written(&format!("{address} --scan scan.obj"));
    let kept = measured.keys().filter(|name| !name.starts_with("scan")).count();
    assert_eq!(kept, measured.len(), "the scan is not published any more: {:?}", measured.keys());
    let manifests = ["manifest.json", "manifest-3.json"].map(|name| String::from_utf8_lossy(&measured[name]));
    assert!(manifests.iter().all(|manifest| !manifest.contains("scan.")));

    std::fs::write(site.join("asset.glb"), "the user's").unwrap();
    refused("", "asset.glb");
}
