//! `taotie bake` onto a glTF file of several meshes and materials, or one that moves: everything except the maps
//! stays.

use super::balls::{Ball, LOW, SCAN};
use super::glb::{Glb, assert_same};
use super::place::Place;
use super::validator::assert_valid;
use serde_json::{Value, json};
use taotie_engine::math::Vec3;
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::surface::with_frames;
use taotie_io::{GltfAsset, GltfDraft, GltfFormat, Json, load_model, read_bitmap};

/// Returns a folder with the scan, and the low-poly mesh that fits it.
pub fn start() -> (Place, Mesh) {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", LOW.obj());
    let low = load_model(place.path("low.obj")).unwrap().scene.meshes()[0].clone();
    (place, with_frames(&low, 0, None).unwrap().0.into_owned())
}

/// Returns a document with only that mesh, to which a test adds what it needs.
fn draft(low: &Mesh) -> GltfDraft {
    let levels = [low];
    GltfDraft::new(&GltfAsset { levels: &levels, ..GltfAsset::default() }, &GltfFormat::default()).unwrap()
}

pub fn put(draft: &mut GltfDraft, name: &str, value: &Value) {
    draft.put("", name, Json::of(value).unwrap()).unwrap();
}

/// Adds every third part of the triangles as a primitive, each corner a vertex, moved by `x` units.
fn primitive(draft: &mut GltfDraft, low: &Mesh, material: usize, x: f32) -> Value {
    let count = low.triangles().len().div_ceil(3);
    let corners: Vec<usize> = low
        .triangles()
        .chunks(count)
        .nth(material)
        .unwrap()
        .as_flattened()
        .iter()
        .map(|v| *v as usize)
        .collect();
    let place = |v: &usize| {
        let p = low.positions()[*v].to_array();
        [p[0] + x, p[1], p[2]]
    };
    let positions: Vec<[f32; 3]> = corners.iter().map(place).collect();
    let normals: Vec<[f32; 3]> = corners.iter().map(|v| low.normals()[*v].to_array()).collect();
    let tangents: Vec<[f32; 4]> = corners.iter().map(|v| low.tangents()[*v]).collect();
    let uvs: Vec<[f32; 2]> = corners.iter().map(|v| low.uvs()[0][*v]).map(|uv| [uv.x, uv.y]).collect();
    let mut attributes = json!({
        "POSITION": draft.bounded_floats(&positions), "NORMAL": draft.floats(&normals),
        "TEXCOORD_0": draft.floats(&uvs),
    });
    if material != BARE {
        attributes["TANGENT"] = draft.floats(&tangents).into();
    }
    attributes.as_object().unwrap().values().for_each(|a| draft.mark_vertices(a.as_u64().unwrap() as usize));
    json!({ "attributes": attributes, "material": material })
}

/// The material whose triangles have no tangents.
const BARE: usize = 1;

/// Returns a ship of three materials on two nodes, and a camera: the ball cut into three.
pub fn ship(low: &Mesh) -> Vec<u8> {
    ship_draft(low).encode_glb().unwrap()
}

/// Returns the same, to be modified.
pub fn ship_draft(low: &Mesh) -> GltfDraft {
    let mut draft = draft(low);
    let [wood, iron, cloth] = [0, 1, 2].map(|material| {
        let x = if material == 2 { -2.0 } else { 0.0 };
        primitive(&mut draft, low, material, x)
    });
    put(
        &mut draft,
        "meshes",
        &json!([
            { "name": "hull mesh", "primitives": [wood, iron] },
            { "name": "sail mesh", "primitives": [cloth] },
        ]),
    );
    put(
        &mut draft,
        "nodes",
        &json!([
            { "name": "ship", "children": [1, 2, 3], "extras": { "inventory": 7 } },
            { "name": "hull", "mesh": 0 },
            { "name": "sail", "mesh": 1, "translation": [2.0, 0.0, 0.0] },
            { "name": "view", "camera": 0, "translation": [0.0, 0.0, 9.0] },
        ]),
    );
    put(
        &mut draft,
        "cameras",
        &json!([{ "type": "perspective", "perspective": { "yfov": 0.8, "znear": 0.1 } }]),
    );
    put(
        &mut draft,
        "materials",
        &json!([
            { "name": "wood", "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.25, 0.125, 1.0], "roughnessFactor": 0.75 } },
            { "name": "iron", "pbrMetallicRoughness": { "metallicFactor": 0.5 } },
            { "name": "cloth", "doubleSided": true, "extras": { "weave": "twill" } },
        ]),
    );
    draft
}

/// Returns the stderr of a bake of the scan onto a file, and its report.
fn baked(place: &Place, line: &str) -> (String, Value) {
    let assert =
        place.taotie(&format!("bake scan.obj --low low.glb --size 64 --json {line}")).assert().success();
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    (said, serde_json::from_slice(&assert.get_output().stdout).unwrap())
}

fn refused(place: &Place, line: &str) -> String {
    let before = place.files();
    let assert =
        place.taotie(&format!("bake scan.obj --low low.glb -o out.glb --size 64 {line}")).assert().code(2);
    assert_eq!(place.files(), before);
    String::from_utf8_lossy(&assert.get_output().stderr).into_owned()
}

#[test]
fn three_materials_on_two_nodes_stay() {
    let (place, low) = start();
    place.write("low.glb", ship(&low));
    let (said, report) = baked(&place, "-o out.glb --maps normal,height");
    assert!(!said.contains("merged the ") && said.contains("without tangents"), "{said}");
    let [before, mut after] = ["low.glb", "out.glb"].map(|name| Glb::read(&place.read(name)));
    let attributes = &mut after.json["meshes"][0]["primitives"][BARE]["attributes"];
    let given = attributes.as_object_mut().unwrap().remove("TANGENT");
    assert!(given.is_some(), "no vertex has to be split for tangents");
    assert_same(&before, &after, &["nodes", "meshes", "cameras", "scenes", "scene"]);

    let scene = load_model(place.path("out.glb")).unwrap().scene;
    let names: Vec<&str> = scene.materials().iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["wood", "iron", "cloth"]);
    let mut maps: Vec<usize> = scene.materials().iter().map(|m| m.normal.unwrap().texture.texture).collect();
    maps.dedup();
    assert_eq!((maps.len(), scene.textures().len()), (3, 3), "one texture set a material");
    let materials = &after.json["materials"];
    let wood = json!({ "baseColorFactor": [0.5, 0.25, 0.125, 1.0], "roughnessFactor": 0.75 });
    assert_eq!(materials[0]["pbrMetallicRoughness"], wood, "properties that are not baked are not changed");
    assert_eq!(
        (&materials[2]["doubleSided"], &materials[2]["extras"]),
        (&json!(true), &json!({ "weave": "twill" }))
    );

    let parts = report["proof"]["parts"].as_array().unwrap();
    let named: Vec<&str> = parts.iter().map(|part| part["material"].as_str().unwrap()).collect();
    assert_eq!(named, ["wood", "iron", "cloth"]);
    let mean = |of: &Value| of["mean"].as_f64().unwrap();
    for part in parts {
        assert_eq!(part["triangles"], 176);
        assert!(mean(&part["angles"]) * 2.0 < mean(&part["without_map"]), "{part}");
    }
    let all = &report["proof"];
    let least = parts.iter().map(|part| mean(&part["angles"])).fold(f64::INFINITY, f64::min);
    let most = parts.iter().map(|part| mean(&part["angles"])).fold(0.0, f64::max);
    assert!((least..=most).contains(&mean(&all["levels"][0]["surface_angles"])), "{all}");
    assert_eq!(report["triangles"], json!([528]));
    let far = all["levels"][0]["hausdorff_of_diagonal"]["upper"].as_f64().unwrap();
    assert!(far < 0.02, "the parts are measured as one surface");
    let files: Vec<&str> = report["files"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    for name in ["out.wood.height.png", "out.iron.height.png", "out.cloth.height.png"] {
        assert!(files.contains(&name), "{files:?}");
        assert!(after.json["asset"]["extras"]["maps"].to_string().contains(name));
    }
    assert_valid(&place.path("out.glb"));
}

#[test]
fn files_beside_a_gltf_are_named_after_their_materials() {
    let (place, low) = start();
    place.write("low.glb", ship(&low));
    baked(&place, "-o out.gltf --no-verify");
    let images = ["wood", "iron", "cloth"].map(|name| format!("out_{name}_normal.png"));
    let files = place.files();
    assert!(
        images.iter().all(|image| files.contains(image)) && files.contains(&"out.bin".into()),
        "{files:?}"
    );
    let loaded = load_model(place.path("out.gltf")).unwrap();
    assert_eq!((loaded.scene.textures().len(), loaded.scene.instances().len()), (3, 3));
    assert!(loaded.missing_files.is_empty());
    assert_valid(&place.path("out.gltf"));
}

#[test]
fn images_of_the_file_that_stay_go_along() {
    let (place, low) = start();
    place.write("low.glb", ship(&low));
    baked(&place, "-o first.gltf --no-verify");
    // Bakes onto that: its own normal maps are replaced by new ones, and stay if other maps are baked.
    std::fs::create_dir(place.path("sub")).unwrap();
    let again = |maps: &str, out: &str| {
        let line = format!("bake scan.obj --low first.gltf --size 64 --maps {maps} -o {out} --json");
        (place.json(&line), load_model(place.path(out)).unwrap())
    };
    let (report, kept) = again("ao", "sub/kept.gltf");
    let unseen = report["proof"]["unseen"].to_string();
    assert!(unseen.contains("ambient occlusion"), "{unseen}");
    assert_eq!(
        (kept.scene.textures().len(), kept.missing_files.len()),
        (6, 0),
        "normals stay, occlusion is new"
    );
    let own = load_model(place.path("first.gltf")).unwrap().scene;
    for (a, b) in own.materials().iter().zip(kept.scene.materials()) {
        let map = |scene: &taotie_engine::scene::Scene, material: &taotie_engine::scene::Material| {
            scene.textures()[material.normal.unwrap().texture.texture].bitmap().clone()
        };
        assert_eq!(map(&own, a), map(&kept.scene, b), "{}", a.name);
    }
    let (report, replaced) = again("normal", "replaced.glb");
    assert!(!report["proof"]["unseen"].to_string().contains("ambient occlusion"), "only normals are baked");
    assert_eq!(replaced.scene.textures().len(), 3);
    let json = Glb::read(&place.read("replaced.glb")).json;
    assert_eq!(json["images"].as_array().unwrap().len(), 3, "unreferenced images are left out");
}

#[test]
fn files_of_the_file_that_stays_are_not_written_over() {
    let (place, low) = start();
    place.write("low.glb", ship(&low));
    baked(&place, "-o first.gltf --no-verify");
    std::fs::rename(place.path("first.gltf"), place.path("other.gltf")).unwrap();
    let before = ["first.bin", "first_wood_normal.png"].map(|name| place.read(name));
    let line = "bake scan.obj --low other.gltf -o first.gltf --size 64 --no-verify";
    let assert = place.taotie(line).assert().code(2);
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(said.contains("first.bin"), "{said}");
    assert_eq!(["first.bin", "first_wood_normal.png"].map(|name| place.read(name)), before);
    assert!(!place.path("first.gltf").exists());
}

#[test]
fn what_cannot_be_kept_is_refused_before_the_bake() {
    let (place, low) = start();
    place.write("low.glb", ship(&low));
    place.write("other.obj", Ball { rings: 4, ..LOW }.obj());
    let why = "low.glb: a low-poly mesh with 3 materials is not supported: ";
    let said = refused(&place, "--lods 100");
    assert!(said.contains(&format!("{why}its file is kept as is, and levels of detail")), "{said}");
    let said = refused(&place, "--cage other.obj");
    assert!(said.contains("other.obj: the cage: it has"), "{said}");
    let cage = Ball { radius: 1.2, ..LOW };
    place.write("cage.obj", cage.obj_of(&cage.faces().into_iter().rev().collect::<Vec<_>>()));
    let said = refused(&place, "--cage cage.obj");
    assert!(said.contains("error: cage.obj: the cage: "), "{said}");
    let assert = place.taotie("bake scan.obj --low low.obj -o out.glb --cage cage.obj").assert().code(2);
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(said.contains("triangles are in another order"), "{said}");
    let (said, _) = baked(&place, "-o out.glb --meshopt --no-verify");
    assert!(said.contains("meshes are not compressed: the low-poly mesh's file is kept as is"), "{said}");
}

#[test]
fn a_cage_holds_all_materials() {
    let (place, low) = start();
    place.write("low.glb", ship(&low));
    place.write("cage.obj", Ball { radius: 1.2, ..LOW }.obj());
    let (said, report) = baked(&place, "-o out.glb --cage cage.obj");
    assert!(!said.contains("missed"), "{said}");
    assert_eq!(report["bake"]["missed_texels"], 0.0);
    let parts = report["proof"]["parts"].as_array().map_or(0, Vec::len);
    let mean = |report: &Value| report["proof"]["levels"][0]["surface_angles"]["mean"].as_f64().unwrap();
    let (own, auto) = (mean(&report), mean(&baked(&place, "-o auto.glb").1));
    assert!(parts == 3 && own < 2.0, "{parts} materials, {own} degrees");
    assert!((own - auto).abs() < 0.1, "{own} and {auto} degrees");
}

#[test]
fn materials_of_an_obj_stay() {
    let (place, _) = start();
    let text = LOW.obj();
    let (faces, rest): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| line.starts_with("f "));
    let group =
        |(name, faces): (&str, &[&str])| format!("o {name}_part\nusemtl {name}\n{}\n", faces.join("\n"));
    let groups: String = ["wood", "iron", "cloth"].into_iter().zip(faces.chunks(176)).map(group).collect();
    place.write("low.obj", format!("mtllib low.mtl\n{}\n{groups}", rest.join("\n")));
    place.write("low.mtl", "newmtl wood\nKd 0.5 0.25 0.125\nnewmtl iron\nKd 1 1 1\nnewmtl cloth\nKd 0 0 1\n");
    let line = "bake scan.obj --low low.obj -o out.glb --size 64 --json";
    let assert = place.taotie(line).assert().success();
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(!said.contains("merged the "), "{said}");
    let loaded = load_model(place.path("out.glb")).unwrap();
    assert_eq!(loaded.mesh_names, ["wood_part", "iron_part", "cloth_part"]);
    let materials = loaded.scene.materials();
    assert_eq!(materials.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(), ["wood", "iron", "cloth"]);
    assert_eq!(
        materials[0].base_color,
        load_model(place.path("low.obj")).unwrap().scene.materials()[0].base_color
    );
    assert_eq!((loaded.scene.textures().len(), loaded.scene.triangle_count()), (3, 528));
    let report: Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    assert_eq!(report["proof"]["parts"].as_array().unwrap().len(), 3);
    // As before if one mesh is needed.
    let assert = place.taotie(&format!("{line} --lods 200 --no-verify")).assert().success();
    assert!(
        String::from_utf8_lossy(&assert.get_output().stderr)
            .contains("merged the materials of the low-poly mesh into the first")
    );
}

#[test]
fn morph_targets_stay() {
    let (place, low) = start();
    let mut draft = draft(&low);
    let raised: Vec<[f32; 3]> = low.positions().iter().map(|p| [0.0, p.y.max(0.0), 0.0]).collect();
    let target = draft.bounded_floats(&raised);
    draft.mark_vertices(target);
    let mut put_into = |parent: &str, name: &str, value: Value| {
        draft.put(parent, name, Json::of(&value).unwrap()).unwrap();
    };
    put_into("/meshes/0/primitives/0", "targets", json!([{ "POSITION": target }]));
    put_into("/meshes/0", "weights", json!([0.0]));
    place.write("low.glb", draft.encode_glb().unwrap());
    let (said, _) = baked(&place, "-o out.glb");
    assert!(said.contains("the low-poly mesh moves (morph targets)"), "{said}");
    let [before, after] = ["low.glb", "out.glb"].map(|name| Glb::read(&place.read(name)));
    assert_same(&before, &after, &["nodes", "meshes"]);
    assert_valid(&place.path("out.glb"));
}

#[test]
fn an_animation_stays() {
    let (place, low) = start();
    let mut draft = draft(&low);
    let times = draft.bounded_floats(&[[0.0], [1.0]]);
    let places = draft.floats(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    put(
        &mut draft,
        "animations",
        &json!([{
            "name": "drift",
            "samplers": [{ "input": times, "output": places }],
            "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }],
        }]),
    );
    place.write("low.glb", draft.encode_glb().unwrap());
    let (said, report) = baked(&place, "-o out.glb");
    assert!(said.contains("the low-poly mesh moves (animations): baked and measured at rest"), "{said}");
    let [before, after] = ["low.glb", "out.glb"].map(|name| Glb::read(&place.read(name)));
    assert_same(&before, &after, &["nodes", "meshes", "animations"]);
    let unseen = report["proof"]["unseen"].to_string();
    assert!(unseen.contains("poses and variants: only the default ones are compared"), "{unseen}");
    assert_eq!(report["proof"]["parts"], json!([]), "it has one material");
    assert_eq!(load_model(place.path("out.glb")).unwrap().rig.unwrap().animations()[0].name, "drift");
    assert!(refused(&place, "--space object").contains("object-space normals do not follow its motion"));
}

#[test]
fn maps_alone_fit_the_file_as_its_model_does() {
    let (place, low) = start();
    // A ball of half the height, which two nodes stretch, one of them turned around.
    let MeshData { positions, normals, uvs, triangles, .. } = low.into_data();
    let flat = positions.iter().map(|p| Vec3::new(p.x, p.y * 0.5, p.z)).collect();
    let normal = |n: &Vec3| Vec3::new(n.x, n.y * 2.0, n.z).to_f64().normalize_or(n.to_f64()).to_f32();
    let normals = normals.iter().map(normal).collect();
    let data = MeshData { positions: flat, normals, uvs, triangles, ..MeshData::default() };
    let mut draft = draft(&Mesh::new(data).unwrap());
    let stretched =
        |turn: f64| json!({ "mesh": 0, "scale": [1.0, 2.0, 1.0], "rotation": [0.0, turn, 0.0, 1.0 - turn] });
    put(&mut draft, "nodes", &json!([stretched(0.0), stretched(1.0)]));
    put(&mut draft, "scenes", &json!([{ "nodes": [0, 1] }]));
    place.write("low.glb", draft.encode_glb().unwrap());
    baked(&place, "-o out.glb --maps normal --no-verify");
    baked(&place, "-o out.png --maps normal --no-verify");
    let textures = load_model(place.path("out.glb")).unwrap().scene.textures().to_vec();
    assert_eq!(textures.len(), 1);
    assert!(*textures[0].bitmap() == read_bitmap(&place.path("out.png")).unwrap());
}
