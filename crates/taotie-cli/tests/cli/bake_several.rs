//! Several files as one scan, and several scans on one layout.

use super::bake::document;
use super::bake_maps::{picture, together};
use super::balls::{Ball, LOW, SCAN};
use super::glb::Glb;
use super::models::moving_square;
use super::pictures::write_square;
use super::place::Place;
use serde_json::{Value, json};
use taotie_engine::image::Encoding;
use taotie_io::{Bytes, PngSamples};

const BODY: Ball = Ball { rings: 24, meridians: 48, ..SCAN };
/// A ball that reaches into the body.
const LID: Ball = Ball { radius: 0.7, center: [0.0, 1.2, 0.0], ..BODY };

/// Returns a low-poly mesh on the left or the right half of the map.
fn low(ball: Ball, uv: fn(f64, f64) -> [f64; 2]) -> Ball {
    Ball { rings: 12, meridians: 24, waves: 0.0, uv: Some(uv), ..ball }
}

/// Returns a folder with the low-poly meshes of body and lid, in the unit `scale`.
fn place(scale: f64) -> Place {
    let large = |ball: Ball| sized(ball, scale);
    let (body, lid) = (low(large(BODY), |u, v| [u / 2.0, v]), low(large(LID), |u, v| [0.5 + u / 2.0, v]));
    Place::with("low.obj", together(&[("body_low", body), ("lid_low", lid)]))
}

/// Returns a ball in another unit.
fn sized(ball: Ball, scale: f64) -> Ball {
    Ball { radius: ball.radius * scale, center: ball.center.map(|v| v * scale), ..ball }
}

/// Returns the figures of a proof except for the bytes of files, which differ.
fn figures(report: &Value) -> Value {
    let mut proof = report["proof"].clone();
    for name in ["bytes_in", "bytes_out"] {
        proof.as_object_mut().unwrap().remove(name).unwrap();
    }
    proof
}

fn names(files: &Value) -> Vec<&str> {
    files.as_array().unwrap().iter().map(|file| file["name"].as_str().unwrap()).collect()
}

fn error(place: &Place, line: &str) -> String {
    let before = place.files();
    let assert = place.taotie(line).assert().code(2);
    assert_eq!(place.files(), before, "{line}");
    String::from_utf8_lossy(&assert.get_output().stderr).into_owned()
}

#[test]
fn several_files_are_baked_and_proved_as_one_with_all_their_objects() {
    let place = place(1.0);
    place.write("both.obj", together(&[("body_high", BODY), ("lid_high", LID)]));
    place.write("body_high.obj", BODY.obj());
    // Its own object has no mark.
    place.write("Lid_high.obj", format!("o Sphere\n{}", LID.obj()));
    let line = "--low low.obj --size 64 --json";
    let report = place.json(&format!("bake body_high.obj Lid_high.obj -o out.glb {line}"));
    let one = place.json(&format!("bake both.obj -o one.glb {line}"));
    assert_eq!(report["origin"]["groups"], json!(["body", "lid"]));
    assert_eq!(figures(&report), figures(&one));
    let [out, of_one] = ["out.glb", "one.glb"].map(|name| Glb::read(&place.read(name)));
    assert!(out.bytes == of_one.bytes, "vertices and texels are the same");

    let certificate = &report["certificate"];
    assert_eq!(certificate["scan_models"], 2);
    assert_eq!(names(&certificate["scan"]), ["body_high.obj", "Lid_high.obj"]);
    assert_eq!(
        (&report["high"], names(&report["high_others"])),
        (&json!("body_high.obj"), vec!["Lid_high.obj"])
    );
    assert_eq!(report["high_others"][0]["sha256"], certificate["scan"][1]["sha256"]);
    let sources = out.json["extensions"]["KHR_xmp_json_ld"]["packets"][0]["dc:source"].to_string();
    assert!(
        sources.contains("body_high.obj (sha256:") && sources.contains("Lid_high.obj (sha256:"),
        "{sources}"
    );

    let command = certificate["command"].as_str().unwrap();
    assert!(
        command.starts_with("taotie verify out.glb --scan body_high.obj --scan Lid_high.obj"),
        "{command}"
    );
    let words: Vec<&str> = command.split(' ').skip(1).chain(["--json"]).collect();
    let printed = place.taotie_with(&words).assert().success();
    let verified: Value = serde_json::from_slice(&printed.get_output().stdout).unwrap();
    for section in ["certificate", "proof"] {
        assert_eq!(verified[section].to_string(), report[section].to_string());
    }
    let part = place.taotie("verify out.glb --scan body_high.obj --require missed=1%").assert().code(1);
    assert!(String::from_utf8_lossy(&part.get_output().stdout).contains("NOT met: missed"));

    let page = String::from_utf8(place.read("out.report.html")).unwrap();
    let files = &page[page.find("SHA-256").unwrap()..];
    let hash = |file: &Value| files.find(file["sha256"].as_str().unwrap()).expect("it is listed");
    let scan = certificate["scan"].as_array().unwrap();
    assert!(hash(&scan[0]) < hash(&scan[1]) && hash(&scan[1]) < hash(&certificate["asset"][0]));

    let shown =
        place.json("view out.glb --scan body_high.obj --scan Lid_high.obj --publish-scan -o v.html --json");
    assert_eq!(shown["scan"], json!(["body_high.obj", "Lid_high.obj"]));
}

/// Both files, and their textures, have the same names.
#[test]
fn every_file_has_its_own_materials_and_textures() {
    let place = place(1.0);
    let textured = |ball: Ball| Ball { uv: LOW.uv, ..ball };
    for (folder, ball, color) in [("a", BODY, [200, 0, 0]), ("b", LID, [0, 0, 200])] {
        std::fs::create_dir(place.path(folder)).unwrap();
        place.write(
            &format!("{folder}/scan.obj"),
            format!("mtllib s.mtl\nusemtl skin\n{}", textured(ball).obj()),
        );
        place.write(&format!("{folder}/s.mtl"), "newmtl skin\nKd 1 1 1\nmap_Kd skin.png\n");
        let samples = color.repeat(16);
        write_square(&place.path(&format!("{folder}/skin.png")), PngSamples::U8(&samples), Encoding::Srgb);
    }
    // A third file without colours.
    place.write("foot.obj", Ball { center: [0.0, -1.5, 0.0], radius: 0.5, ..BODY }.obj());
    let low = [low(BODY, |u, v| [u / 2.0, v]), low(LID, |u, v| [0.5 + u / 2.0, v])];
    place.write("low.obj", together(&[("x", low[0]), ("x", low[1])]));
    let line =
        "bake a/scan.obj b/scan.obj foot.obj --low low.obj -o out.png --size 64 --maps albedo,object-id";
    let report = place.json(&format!("{line} --json"));
    let color = picture(&place, "out.png");
    let at = |x: usize| color.stored(32 * 64 + x).map(|code| (code * 255.0).round() as u8);
    assert_eq!([at(16), at(48)].map(|[r, g, b, _]| [r, g, b]), [[200, 0, 0], [0, 0, 200]]);
    let certificate = &report["certificate"];
    assert_eq!(certificate["scan_models"], 3);
    let mut scan = names(&certificate["scan"]);
    assert_eq!(scan[..3], ["scan.obj", "scan.obj", "foot.obj"], "model files first");
    scan.drain(..3);
    scan.sort_unstable();
    assert_eq!(scan, ["s.mtl", "s.mtl", "skin.png", "skin.png"]);
    let legend = report["maps"].as_array().unwrap().iter().find_map(|map| map["legend"].as_object()).unwrap();
    assert!(legend.contains_key("scan"), "objects have the names of their files: {legend:?}");

    let report = place.json(&format!("{} --json", line.replace("out.png", "out.glb")));
    assert!(report["certificate"]["command"].is_null(), "one folder cannot hold two files of a name");
    place
        .taotie("verify out.glb --scan a/scan.obj --scan b/scan.obj --scan foot.obj -o out.html")
        .assert()
        .success();
    let page = String::from_utf8(place.read("out.html")).unwrap();
    assert!(
        page.contains("scan.obj and 2 more files") && page.contains("files of the scan have the same name")
    );
}

#[test]
fn units_are_joined_only_if_they_are_certain() {
    let place = place(40.0);
    let (body, lid) = (sized(BODY, 40.0), sized(LID, 40.0));
    place.write("body_high.obj", body.obj());
    place.write("lid_high.obj", lid.obj());
    let line = "--low low.obj --size 64 --json";
    let in_mm = place.json(&format!("bake body_high.obj lid_high.obj -o out.glb --unit mm {line}"));
    assert_eq!(in_mm["proof"]["unit"], "mm");
    // The lid as glTF, in metres and with its unit unknown, which is 40 m.
    let made = "--triangles 2000 --size 64 --no-verify";
    place.taotie(&format!("bake lid_high.obj -o lid_high.glb --unit mm {made}")).assert().success();
    place.taotie(&format!("bake lid_high.obj -o wrong.glb {made}")).assert().success();
    let mixed = place.json(&format!("bake body_high.obj lid_high.glb -o out.glb --unit mm {line}"));
    assert_eq!(mixed["proof"]["unit"], "mm");
    assert_eq!(mixed["origin"]["groups"], json!(["body", "lid"]));
    let diagonal = |report: &Value| report["proof"]["diagonal"].as_f64().unwrap();
    assert!((diagonal(&mixed) / diagonal(&in_mm) - 1.0).abs() < 0.01, "{}", diagonal(&mixed));
    assert!(mixed["bake"]["missed_texels"].as_f64().unwrap() < 0.01);
    let verified = place.json("verify out.glb --scan body_high.obj --scan lid_high.glb --json");
    assert_eq!(verified["proof"], mixed["proof"], "the asset records the unit");

    let line = "-o new.glb --triangles 100 --size 64 --no-verify";
    let said = error(&place, &format!("bake body_high.obj lid_high.glb {line}"));
    assert!(said.contains("body_high.obj: its unit is unknown, but lid_high.glb is in metres"), "{said}");
    assert!(said.contains("--unit mm"), "{said}");
    let said = error(&place, &format!("bake body_high.obj wrong.glb --unit mm {line}"));
    assert!(said.contains("wrong.glb: its format is in metres, but its size suggests mm"), "{said}");
}

#[test]
fn files_that_cannot_be_one_scan_are_refused() {
    let place = Place::with("a.obj", BODY.obj());
    place.write("b.obj", LID.obj());
    let bake = |files: &str| {
        error(&place, &format!("bake {files} -o out.glb --triangles 100 --size 64 --no-verify"))
    };
    assert!(bake("a.obj ./a.obj").contains("./a.obj: it is the same file as a.obj"));
    assert!(bake("a.obj gone.obj b.obj").contains("gone.obj: No such file"));
    assert!(bake("a.obj .").contains(".: not a regular file"));
    place.write("c.glb", "");
    let over = error(&place, "bake a.obj c.glb -o c.glb");
    assert!(over.contains("it would overwrite the input c.glb"), "{over}");
    let twice = error(&place, "verify b.obj --scan a.obj --scan a.obj");
    assert!(twice.contains("the same file as"), "{twice}");
    // Each file can be read by itself.
    let size = place.read("a.obj").len();
    let said = bake(&format!("b.obj a.obj --memory-limit {}", 4 * size + 20_000));
    assert!(said.contains("a.obj is too large"), "{said}");
    let limit =
        format!("the limit is {}, of which the files before it use", Bytes((4 * size + 20_000) as u64));
    assert!(said.contains(&limit), "{said}");
    let said = bake(&format!("a.obj --memory-limit {}", 4 * size + 20_000));
    assert!(said.contains("a bake of"), "{said}");
}

#[test]
fn contents_that_only_one_file_can_keep_are_counted() {
    let place = Place::new();
    for (name, rights) in [("a.gltf", "A museum"), ("b.gltf", "B museum"), ("c.gltf", "A museum")] {
        let mut model: Value = serde_json::from_str(&moving_square()).unwrap();
        model["asset"]["copyright"] = json!(rights);
        model["asset"]["extensions"] = json!({ "KHR_xmp_json_ld": { "packet": 0 } });
        model["extensions"]["KHR_xmp_json_ld"] = json!({ "packets": [{ "dc:title": name }] });
        place.write(name, model.to_string());
    }
    let report = place.json("bake a.gltf b.gltf c.gltf -o out.glb --error 2 --json");
    let said = report["warnings"].to_string();
    for what in [
        "a.gltf: animations of the scan",
        "b.gltf: animations of the scan",
        "a.gltf: skipped image",
        "c.gltf: skipped image",
    ] {
        assert!(said.contains(what), "{what}: {said}");
    }
    let xmp = report["warnings"].as_array().unwrap().iter();
    let xmp: Vec<&Value> =
        xmp.filter(|warning| warning["what"].to_string().contains("XMP metadata")).collect();
    assert_eq!(xmp.len(), 1, "{said}");
    assert_eq!(xmp[0]["count"], 2, "{said}");
    let asset = document(&place, "out.glb");
    assert_eq!(asset["asset"]["copyright"], "A museum; B museum");
    assert!(asset["animations"].is_null());
}

/// Formats have different defaults, which are not a difference of the surfaces.
#[test]
fn files_without_materials_need_no_maps_of_them() {
    let place = Place::with("body.obj", BODY.obj());
    place.write("lid.obj", LID.obj());
    place.taotie("bake lid.obj -o lid.glb --triangles 2000 --size 64 --no-verify").assert().success();
    let maps = |materials: Option<Value>| {
        let mut glb = Glb::read(&place.read("lid.glb"));
        match materials {
            Some(materials) => glb.json["materials"] = materials,
            None => {
                glb.json.as_object_mut().unwrap().remove("materials");
                glb.json["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("material");
            }
        }
        place.write("plain.glb", glb.file());
        let line =
            "bake body.obj plain.glb --unit m -o out.glb --triangles 1000 --size 64 --no-verify --json";
        let report = place.json(line);
        report["parameters"]["maps"]
            .as_array()
            .unwrap()
            .iter()
            .map(|map| map.as_str().unwrap().to_owned())
            .collect()
    };
    let (none, default): (Vec<String>, Vec<String>) =
        (maps(None), maps(Some(json!([{ "name": "default" }]))));
    assert_eq!((none, default), (vec!["normal".to_owned()], vec!["normal".to_owned()]));
    let rough = json!([{ "pbrMetallicRoughness": { "roughnessFactor": 0.3 } }]);
    assert!(maps(Some(rough)).contains(&"metallic-roughness".to_owned()));
}

/// A search packs them as one model if nothing smaller looks the same.
#[test]
fn a_search_may_pack_several_files() {
    let place = Place::new();
    for (name, ball) in [("a", BODY), ("b", Ball { center: [3.0, 0.0, 0.0], ..BODY })] {
        let obj = Ball { uv: LOW.uv, ..ball }.obj();
        place.write(&format!("{name}.obj"), format!("mtllib {name}.mtl\nusemtl {name}\n{obj}"));
        place.write(&format!("{name}.mtl"), format!("newmtl {name}\nKd 1 1 1\nmap_Kd {name}.png\n"));
        let samples: Vec<u8> = (0..64 * 64 * 3).map(|i| (i * 37 % 251) as u8).collect();
        write_square(&place.path(&format!("{name}.png")), PngSamples::U8(&samples), Encoding::Srgb);
    }
    let report = place.json("bake a.obj b.obj -o out.glb --require visually-lossless --json");
    let trials = report["trials"].as_array().unwrap();
    assert!(trials.iter().any(|trial| trial["is_chosen"] == true && trial["is_scan"] == true), "{trials:?}");
    assert_eq!(report["certificate"]["verdict"], "met");
    assert_eq!(document(&place, "out.glb")["materials"].as_array().map(Vec::len), Some(2));
}

/// The asset of the first variant is the low-poly mesh of the others.
#[test]
fn variants_of_a_scan_share_one_layout() {
    let colors = |text: String, color: [f64; 3]| -> String {
        let [r, g, b] = color;
        let line = |line: &str| match line.starts_with("v ") {
            true => format!("{line} {r} {g} {b}\n"),
            false => format!("{line}\n"),
        };
        text.lines().map(line).collect()
    };
    let place = Place::with("clean.obj", colors(BODY.obj(), [0.9, 0.8, 0.2]));
    place.write("worn.obj", colors(Ball { waves: 0.003, ..BODY }.obj(), [0.2, 0.4, 0.3]));
    let line = "--size 64 --maps normal,albedo --json";
    let clean = place.json(&format!("bake clean.obj -o clean.glb --triangles 400 {line}"));
    let worn = place.json(&format!("bake worn.obj --low clean.glb -o worn.glb {line}"));
    let [of_clean, of_worn] = ["clean.glb", "worn.glb"].map(|name| Glb::read(&place.read(name)));
    let stream = |glb: &Glb, name: &str| {
        let primitive = &glb.json["meshes"][0]["primitives"][0];
        let number = [&primitive[name], &primitive["attributes"][name]].into_iter().find_map(Value::as_u64);
        glb.accessors()[number.unwrap_or_else(|| panic!("no {name}")) as usize].1.clone()
    };
    for name in ["POSITION", "TEXCOORD_0", "TANGENT", "indices"] {
        assert!(stream(&of_clean, name) == stream(&of_worn, name), "{name}");
    }
    let maps = |report: &Value| -> Vec<(String, String)> {
        let text = |of: &Value, name: &str| of[name].as_str().unwrap_or_default().to_owned();
        let maps = report["certificate"]["maps"].as_array().unwrap().iter();
        maps.map(|map| (text(map, "uses"), text(map, "sha256"))).collect()
    };
    let (of_clean, of_worn) = (maps(&clean), maps(&worn));
    assert_eq!(of_clean.len(), 2, "{of_clean:?}");
    for ((a, first), (b, second)) in of_clean.iter().zip(&of_worn) {
        assert!(a == b && first != second, "{a} and {b} differ");
    }
    for report in [&clean, &worn] {
        let level = &report["proof"]["levels"][0]["overview"];
        let mean = |of: &Value| of["summary"]["mean"].as_f64().unwrap();
        assert!(mean(&level["angles"]) < 1.5 && mean(&level["color"]) < 0.5, "{level}");
    }
    place.taotie("verify clean.glb --scan clean.obj --require mean-color=0.5").assert().success();
    place.taotie("verify worn.glb --scan worn.obj --require mean-color=0.5").assert().success();
    place.taotie("verify clean.glb --scan worn.obj --require mean-color=0.5").assert().code(1);
}
