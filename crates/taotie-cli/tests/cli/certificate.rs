//! The certificate: identical from `bake` and from the command that it states, on any machine.

use super::balls::{Ball, LOW, SCAN};
use super::glb::Glb;
use super::place::Place;
use serde_json::Value;
use std::path::{Path, PathBuf};
use taotie_engine::Warnings;
use taotie_engine::image::{Bitmap, Encoding, Sampler, Texels, Texture};
use taotie_engine::math::integration;
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{Material, Scene, TextureRef, UvTransform};
use taotie_io::{GltfFormat, ImageCodec, encode_scene_as};

/// A folder with a scan whose vertices have colours, and a low-poly mesh.
fn pair() -> Place {
    let colored = |(i, line): (usize, &str)| match line.strip_prefix("v ") {
        Some(place) => format!("v {place} 0.{} 0.3 0.1\n", i % 7 + 2),
        None => format!("{line}\n"),
    };
    let place = Place::with("scan.obj", SCAN.obj().lines().enumerate().map(colored).collect::<String>());
    place.write("low.obj", LOW.obj());
    place
}

const BAKE: &str = "bake scan.obj --low low.obj -o out.glb --size 64 --maps normal,albedo,height --green down \
                    --crease-angle 40 --require standard,bytes=1MB --date 2026-05-01 --operator Curator";

/// Runs a command that proves an asset, good or bad.
fn prove(place: &Place, line: &str) {
    let assert = place.taotie(line).assert();
    let output = assert.get_output();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{line}: {said}");
}

fn report(place: &Place, name: &str) -> Value {
    serde_json::from_slice(&place.read(name)).expect("it is JSON")
}

/// The data of a report's page.
fn page(place: &Place) -> Value {
    let html = String::from_utf8(place.read("out.report.html")).expect("it is text");
    let (_, rest) = html.split_once("id=\"data\">").expect("it has data");
    let (json, _) = rest.split_once("</script>").expect("they end");
    serde_json::from_str(json).expect("they are JSON")
}

#[test]
fn the_command_of_a_certificate_recomputes_it_byte_for_byte() {
    let place = pair();
    prove(&place, &format!("{BAKE} --threads 1"));
    let baked = report(&place, "out.report.json");
    let command = baked["certificate"]["command"].as_str().expect("there is a command");
    let (program, line) = command.split_once(' ').expect("it has arguments");
    assert_eq!(program, "taotie");
    let buyer = Place::new();
    for name in ["scan.obj", "out.glb", "out.height.png", "out.normal.png"] {
        buyer.write(name, place.read(name));
    }
    prove(&buyer, &format!("{line} --threads 3"));
    let verified = report(&buyer, "out.report.json");
    for section in ["certificate", "proof"] {
        assert_eq!(baked[section].to_string(), verified[section].to_string(), "{section}: {line}");
    }
    let (seller, buyer) = (page(&place), page(&buyer));
    assert_eq!(seller["statement"], buyer["statement"]);
    assert_eq!(seller["features"], buyer["features"], "pictures of the worst patches");
}

/// A section of a report, to the byte.
fn section<'a>(report: &'a str, name: &str) -> &'a str {
    let start = report.find(&format!("\n  \"{name}\": {{")).expect("it has the section") + 1;
    let length = report[start..].find("\n  }").expect("the section ends") + 4;
    &report[start..start + length]
}

/// `make bless` accepts the current certificate: other machines must then find the same bytes.
#[test]
fn it_has_the_bytes_that_another_machine_found() {
    let place = pair();
    prove(&place, BAKE);
    let report = String::from_utf8(place.read("out.report.json")).expect("it is text");
    let stated: String =
        ["certificate", "proof"].map(|name| format!("{}\n", section(&report, name))).concat();
    snapbox::assert_data_eq!(stated, snapbox::file!["certificate.txt": Text].raw());
}

#[test]
fn it_holds_what_was_required_the_hashes_and_who_signed() {
    let place = pair();
    prove(&place, BAKE);
    let certificate = &report(&place, "out.report.json")["certificate"];
    assert_eq!(certificate["required"].as_array().expect("a list").len(), 11);
    assert_eq!((&certificate["date"], &certificate["operator"]), (&"2026-05-01".into(), &"Curator".into()));
    assert_eq!(certificate["options"]["scan"]["crease_angle_deg"], 40.0);
    let hash = |name: &str| Value::from(taotie_io::sha256(&place.path(name)).expect("it is there"));
    assert_eq!(certificate["scan"][0]["sha256"], hash("scan.obj"));
    assert_eq!(
        (&certificate["asset"][0]["name"], &certificate["asset"][0]["sha256"]),
        (&"out.glb".into(), &hash("out.glb"))
    );
    // Maps next to the asset are hashed as files, embedded ones as stored.
    let maps = certificate["maps"].as_array().expect("a list");
    let of = |file: &str| {
        maps.iter().find(|map| map["file"] == file).unwrap_or_else(|| panic!("{file}: {maps:?}"))
    };
    for file in ["out.height.png", "out.normal.png"] {
        assert_eq!(of(file)["sha256"], hash(file));
    }
    let glb = Glb::read(&place.read("out.glb"));
    let images = glb.json["images"].as_array().expect("a list");
    assert_eq!(maps.len(), images.len() + 2);
    for (image, map) in images.iter().zip(maps) {
        let view = &glb.json["bufferViews"][image["bufferView"].as_u64().expect("it is embedded") as usize];
        let [start, length] =
            ["byteOffset", "byteLength"].map(|name| view[name].as_u64().unwrap_or(0) as usize);
        assert_eq!(map["sha256"], taotie_io::sha256_of(&glb.bytes[start..start + length]));
        assert!(map["file"].is_null() && map["uses"] != "");
    }
}

#[test]
fn the_page_opens_with_the_certificate_and_the_worst_patches() {
    let place = pair();
    prove(&place, BAKE);
    let page = page(&place);
    let statement = &page["statement"];
    assert_eq!(statement["title"], "Certificate");
    let titles: Vec<_> =
        statement["tables"].as_array().expect("a list").iter().map(|table| &table["title"]).collect();
    assert_eq!(titles, ["Requirements", "Further figures", "Files"]);
    assert!(statement["command"].as_str().is_some_and(|command| command.contains("--crease-angle 40")));
    let features: Vec<_> =
        page["features"].as_array().expect("a list").iter().map(|view| &view["name"]).collect();
    let worst = ["normals", "colours", "metallic, roughness or occlusion"];
    let names = worst.map(|what| Value::from(format!("Worst patch: {what}")));
    assert_eq!(features, names.iter().collect::<Vec<_>>());
    let pictures = page["features"][0]["pictures"].as_array().expect("a list");
    assert_eq!(
        pictures.iter().map(|picture| &picture["label"]).collect::<Vec<_>>(),
        ["scan", "asset", "difference"]
    );
    assert_eq!(pictures[0]["width"], 384);
}

#[test]
fn without_a_model_there_is_no_command() {
    let place = pair();
    place.taotie("bake scan.obj --low low.obj -o normal.png --size 64").assert().success();
    let certificate = &report(&place, "normal.report.json")["certificate"];
    assert!(certificate["command"].is_null());
    assert_eq!(
        certificate["maps"][0]["sha256"],
        taotie_io::sha256(&place.path("normal.png")).expect("it is there")
    );
}

#[test]
fn a_signature_is_one_line() {
    let place = pair();
    let arguments = ["bake", "scan.obj", "-o", "out.glb", "--operator", " "];
    let assert = place.taotie_with(&arguments).assert().code(2);
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(said.contains("operator ` `: expected one line"), "{said}");
}

/// Runs a command on files given by their full paths; no file and no result may contain the folder.
fn assert_names_no_folder(place: &Place, arguments: &[&str]) {
    let full = |argument: &&str| match place.path(argument).extension() {
        Some(_) if !argument.contains('=') => place.path(argument).to_string_lossy().into_owned(),
        _ => (*argument).to_owned(),
    };
    let arguments: Vec<String> = arguments.iter().map(full).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let assert = place.taotie_with(&words).assert();
    let folder = place.path("").to_string_lossy().trim_end_matches('/').to_owned();
    let is_clean = |bytes: &[u8]| !bytes.windows(folder.len()).any(|window| window == folder.as_bytes());
    let output = assert.get_output();
    assert!(is_clean(&output.stdout), "{}", String::from_utf8_lossy(&output.stdout));
    for file in files_below(&place.path("")) {
        let bytes = std::fs::read(&file).expect("it can be read");
        assert!(is_clean(&bytes), "{} of {words:?} names {folder}", file.display());
    }
}

fn files_below(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("the folder is readable");
    let paths = entries.map(|entry| entry.expect("it is readable").path());
    paths.flat_map(|path| if path.is_dir() { files_below(&path) } else { vec![path] }).collect()
}

#[test]
fn no_report_and_no_page_names_a_folder() {
    let place = pair();
    place.write("cage.obj", Ball { radius: 1.1, ..LOW }.obj());
    let bake = ["bake", "scan.obj", "--low", "low.obj", "-o", "out.glb", "--size", "64", "--json"];
    let further = ["--maps", "normal,height", "--cage", "cage.obj"];
    assert_names_no_folder(&place, &[&bake[..], &further].concat());
    assert_names_no_folder(
        &place,
        &["verify", "out.glb", "--scan", "scan.obj", "-o", "proof.html", "--json"],
    );
    let view = ["view", "out.glb", "--scan", "scan.obj", "--publish-scan", "-o", "view.html", "--json"];
    assert_names_no_folder(&place, &view);
    let compare =
        ["compare", "low.obj", "--reference", "scan.obj", "-o", "compared", "--size", "48x32", "--json"];
    assert_names_no_folder(&place, &[&compare[..], &["--method", "smooth,facet"]].concat());
    assert!(place.path("compared/report.html").is_file() && place.path("view.html").is_file());
}

#[test]
fn a_scan_is_published_only_if_that_is_asked_for() {
    let place = pair();
    place.taotie("bake scan.obj --low low.obj -o out.glb --size 64").assert().success();
    let holds = |name: &str, id: &str| {
        let page = String::from_utf8(place.read(name)).expect("it is text");
        page.contains(&format!("id=\"taotie-{id}\""))
    };
    let assert = place.taotie("view out.glb --scan scan.obj -o view.html").assert().success();
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(said.contains("--publish-scan shows it"), "{said}");
    assert_eq!(["asset", "errors", "scan"].map(|id| holds("view.html", id)), [true, true, false]);
    place.taotie("view out.glb --scan scan.obj --publish-scan -o view.html").assert().success();
    assert!(holds("view.html", "scan"));
    assert_eq!(["asset", "scan"].map(|id| holds("out.report.html", id)), [true, false]);
}

#[test]
fn a_scan_elsewhere_is_refused_as_a_bake_does() {
    let place = pair();
    place.write("far.obj", Ball { center: [9.0, 0.0, 0.0], ..SCAN }.obj());
    let assert = place.taotie("view low.obj --scan far.obj -o view.html").assert().code(2);
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(said.contains("the meshes do not overlap: 100.0 %"), "{said}");
    assert!(!place.files().contains(&"view.html".to_owned()));
}

/// Returns a small ball with a noise texture that no lossless packing makes smaller.
fn noisy_ball() -> Vec<u8> {
    const SIDE: u32 = 1536;
    let texel = |i: u32| {
        let [r, g, b, _] = integration::hash(7, i).to_le_bytes();
        [r, g, b, 255]
    };
    let texels = Texels::U8((0..SIDE * SIDE).map(texel).collect());
    let bitmap = Bitmap::new(SIDE, SIDE, 3, texels).expect("it has its size");
    let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 24, 12), Material::default()).expect("it is sound");
    let texture = scene.add_texture(Texture::new(bitmap, Encoding::Srgb));
    let map =
        TextureRef { texture, uv_set: 0, sampler: Sampler::default(), transform: UvTransform::default() };
    scene.edit(|data| data.materials[0].base_color_texture = Some(map)).expect("it is sound");
    let format = GltfFormat { images: ImageCodec::LossyWebP(1).into(), ..GltfFormat::default() };
    encode_scene_as(&scene, &["ball".into()], &format, &mut Warnings::default()).expect("it can be written")
}

#[test]
fn a_page_has_its_asset_in_base64_and_at_most_three_megabytes_more() {
    let place = Place::with("ball.glb", noisy_ball());
    prove(&place, "verify ball.glb --scan ball.glb -o ball.html --proof-points 2000");
    let [page, asset] = ["ball.html", "ball.glb"].map(|name| place.read(name).len());
    assert!(page * 100 <= asset * 134 + 300_000_000, "{page} bytes of an asset of {asset}");
    let html = String::from_utf8(place.read("ball.html")).expect("it is text");
    assert!(html.contains("id=\"taotie-asset\""), "the asset is shown");
}
