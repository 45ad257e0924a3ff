//! Which parts of a scan's material `taotie bake` carries into the asset, and what it reports about the rest.

use super::balls::{Ball, LOW, SCAN};
use super::place::Place;
use serde_json::{Value, json};
use taotie_engine::image::{Bitmap, Encoding, Sampler, Texels, Texture};
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{
    AlphaMode, Clearcoat, Instance, Material, Scene, SceneData, TextureRef, UvTransform,
};
use taotie_io::{GltfFormat, encode_png_bitmap, load_model, write_scene};

/// Returns a ball with vertex colours, red on one side and green on the other.
pub fn colored(ball: Ball) -> String {
    let color = |line: &str| match line.split(' ').collect::<Vec<_>>()[..] {
        ["v", x, _, _] => format!("{line} {}\n", if x.starts_with('-') { "1 0 0" } else { "0 1 0" }),
        _ => format!("{line}\n"),
    };
    ball.obj().lines().map(color).collect()
}

/// Returns the stderr of a bake with these words, without a proof.
fn said(place: &Place, line: &str) -> String {
    proved(place, &format!("{line} --no-verify"))
}

/// Returns the stderr of a bake with these words, with its proof and reports.
fn proved(place: &Place, line: &str) -> String {
    let assert = place.taotie(&format!("bake {line} -o out.glb --size 64")).assert().success();
    String::from_utf8_lossy(&assert.get_output().stderr).into_owned()
}

/// Returns the only mesh of a file.
fn mesh(place: &Place, name: &str) -> Mesh {
    load_model(place.path(name)).unwrap().scene.meshes()[0].clone()
}

/// Writes a scan of one ball for each material, side by side.
pub fn write_scan(place: &Place, materials: Vec<Material>) {
    place.write("ball.obj", SCAN.obj());
    let placed = |material: usize| {
        let world_from_object = Mat4::translation(Vec3::new(3.0 * material as f64, 0.0, 0.0));
        Instance { mesh: 0, material, world_from_object }
    };
    let instances = (0..materials.len()).map(placed).collect();
    let meshes = vec![mesh(place, "ball.obj")];
    let scene = Scene::new(SceneData { meshes, materials, instances, ..SceneData::default() }).unwrap();
    write_scene(&place.path("scan.glb"), &scene, &GltfFormat::default()).unwrap();
}

fn coated() -> Material {
    let (factor_texture, roughness_texture, normal) = (None, None, None);
    let coat = Clearcoat { factor: 1.0, factor_texture, roughness: 0.25, roughness_texture, normal };
    Material { clearcoat: Some(coat), ..Material::default() }
}

/// Returns the stored texels of a texture.
fn texels(scene: &Scene, texture: usize) -> impl Iterator<Item = [f32; 4]> {
    let bitmap = scene.textures()[texture].bitmap();
    (0..(bitmap.width() * bitmap.height()) as usize).map(move |i| bitmap.stored(i))
}

fn words(value: &Value) -> Vec<&str> {
    value.as_array().unwrap().iter().filter_map(Value::as_str).collect()
}

#[test]
fn colours_are_kept_by_default() {
    let place = Place::with("scan.obj", colored(SCAN));
    let assert = place.taotie("bake scan.obj -o out.glb --triangles 500 --size 64").assert().success();
    let text = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    assert!(text.contains("\ncarried                             base colour\n"), "{text}");
    let report: Value = serde_json::from_slice(&place.read("out.report.json")).unwrap();
    assert_eq!(words(&report["parameters"]["maps"]), ["normal", "albedo"]);
    assert_eq!((&report["carried"], &report["left"]), (&json!(["base colour"]), &json!([])));
    let scene = load_model(place.path("out.glb")).unwrap().scene;
    assert!(scene.materials()[0].base_color_texture.is_some());
}

#[test]
fn what_a_list_of_maps_leaves_out_is_told_with_its_share() {
    let place = Place::with("scan.obj", colored(SCAN));
    place.write("low.obj", LOW.obj());
    let left = "left out: the scan's base colour, on 100.0 % of its surface; bake albedo to keep it\n";
    for low in ["--triangles 500", "--low low.obj"] {
        let said = proved(&place, &format!("scan.obj {low} --maps normal"));
        assert!(said.contains(left), "{low}: {said}");
        let report: Value = serde_json::from_slice(&place.read("out.report.json")).unwrap();
        assert_eq!(report["left"], json!([{ "what": "base colour", "part": 1.0 }]));
    }
    assert_eq!(said(&place, "scan.obj --low low.obj --maps auto,height").matches("left out").count(), 0);
}

#[test]
fn every_part_of_a_scan_counts() {
    let place = Place::new();
    let lamp = Material { emissive: [2.0, 1.0, 0.5], ..Material::default() };
    write_scan(&place, vec![Material::default(), lamp, coated(), coated()]);
    let said = proved(&place, "scan.glb --triangles 500");
    assert!(said.contains("left out: the scan's clearcoat, on 50.0 % of its surface\n"), "{said}");
    let report: Value = serde_json::from_slice(&place.read("out.report.json")).unwrap();
    assert_eq!(words(&report["parameters"]["maps"]), ["normal", "emission"]);
    assert_eq!(words(&report["carried"]), ["emission"]);
    let scene = load_model(place.path("out.glb")).unwrap().scene;
    let material = &scene.materials()[0];
    assert!(material.emissive.iter().all(|v| (v - 2.0).abs() < 1e-3), "{:?}", material.emissive);
    let glow = material.emissive_texture.expect("the lamp glows");
    let greens: Vec<f32> = texels(&scene, glow.texture).map(|[_, green, ..]| green).collect();
    // Half of the strength in sRGB; nothing elsewhere.
    assert!(greens.iter().any(|v| (v - 0.735).abs() < 0.02) && greens.iter().any(|v| *v < 0.02));
}

#[test]
fn metals_and_others_share_a_map() {
    let place = Place::new();
    let gold = Material { metallic: 1.0, roughness: 0.2, ..Material::default() };
    write_scan(&place, vec![gold, Material::default()]);
    let said = said(&place, "scan.glb --triangles 500");
    assert!(!said.contains("left out"), "{said}");
    let scene = load_model(place.path("out.glb")).unwrap().scene;
    let map = scene.materials()[0].metallic_roughness_texture.expect("they differ");
    for [roughness, metallic] in [[0.2, 1.0], [0.6, 0.0]] {
        let is_near = |[_, g, b, _]: [f32; 4]| (g - roughness).abs() < 0.02 && (b - metallic).abs() < 0.02;
        assert!(texels(&scene, map.texture).any(is_near), "roughness {roughness}, metallic {metallic}");
    }
}

#[test]
fn masks_stay_masks_and_ktx2_leaves_their_alpha_to_png() {
    let place = Place::with("ball.obj", Ball { uv: LOW.uv, ..SCAN }.obj());
    place.write("low.obj", LOW.obj());
    // The left half of the map is opaque, the right half is cut out.
    let texels_of_mask = (0..256).map(|i| [255, 255, 255, if i % 16 < 8 { 255 } else { 10 }]).collect();
    let bitmap = Bitmap::new(16, 16, 4, Texels::U8(texels_of_mask)).unwrap();
    let (sampler, transform) = (Sampler::default(), UvTransform::default());
    let used = TextureRef { texture: 0, uv_set: 0, sampler, transform };
    let material = Material {
        alpha: AlphaMode::Mask(0.25),
        base_color_texture: Some(used),
        base_color: [1.0; 4],
        ..Material::default()
    };
    let mut data = Scene::of_mesh(mesh(&place, "ball.obj"), Material::default()).unwrap().into_data();
    (data.materials, data.textures) = (vec![material], vec![Texture::new(bitmap, Encoding::Srgb)]);
    let scene = Scene::new(data).unwrap();
    write_scene(&place.path("scan.glb"), &scene, &GltfFormat::default()).unwrap();
    let said = said(&place, "scan.glb --low low.obj --images ktx2");
    assert!(
        said.contains("the base colour's texture has alpha, which KTX2 does not support: it is PNG"),
        "{said}"
    );
    let scene = load_model(place.path("out.glb")).unwrap().scene;
    let material = &scene.materials()[0];
    assert_eq!(material.alpha, AlphaMode::Mask(0.25));
    let color = material.base_color_texture.expect("it holds alpha");
    let there = texels(&scene, color.texture).filter(|[.., alpha]| *alpha >= 0.25).count();
    assert!((0.4..0.6).contains(&(there as f64 / (64.0 * 64.0))), "{there} of 64² texels");
}

#[test]
fn what_is_the_same_everywhere_is_a_factor() {
    let place = Place::new();
    let glowing = Material { emissive: [2.0, 1.0, 0.5], base_color: [0.5, 0.25, 0.125, 1.0], ..coated() };
    write_scan(&place, vec![glowing.clone(), glowing.clone()]);
    let said = said(&place, "scan.glb --triangles 500");
    assert!(!said.contains("left out"), "{said}");
    let scene = load_model(place.path("out.glb")).unwrap().scene;
    let material = &scene.materials()[0];
    assert_eq!((material.emissive, material.base_color), (glowing.emissive, glowing.base_color));
    assert_eq!(material.clearcoat, glowing.clearcoat);
    assert_eq!(scene.textures().len(), 1, "only the normal map is needed");
}

#[test]
fn a_low_poly_mesh_keeps_its_own_material() {
    let place = Place::with("scan.obj", colored(SCAN));
    place.write("low.obj", format!("mtllib low.mtl\nusemtl red\n{}", LOW.obj()));
    place.write("low.mtl", "newmtl red\nKd 1 0 0\n");
    let said = said(&place, "scan.obj --low low.obj");
    assert!(
        said.contains("base colour, on 100.0 % of its surface; the low-poly mesh's own is kept\n"),
        "{said}"
    );
    let scene = load_model(place.path("out.glb")).unwrap().scene;
    assert_eq!(scene.materials()[0].base_color, [1.0, 0.0, 0.0, 1.0]);
    assert!(scene.materials()[0].base_color_texture.is_none());
}

#[test]
fn baked_colours_take_the_place_of_those_of_vertices() {
    let place = Place::with("scan.obj", colored(SCAN));
    place.write("low.obj", colored(LOW));
    let said = said(&place, "scan.obj --low low.obj --maps normal,albedo");
    assert!(said.contains("vertex colours are left out: baked albedo replaces them"), "{said}");
    assert!(mesh(&place, "out.glb").colors().is_empty());
}

#[test]
fn an_asset_larger_than_its_scan_is_told() {
    let place = Place::with("scan.obj", LOW.obj());
    let line = "bake scan.obj -o out.glb --triangles 100 --size 512 --no-verify";
    let assert = place.taotie(line).assert().success();
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    let (scan, asset) = (place.read("scan.obj").len(), place.read("out.glb").len());
    assert!(asset > scan, "the case does not show it: {asset} of {scan} bytes");
    let what = format!("the asset is larger than its scan: {asset} bytes instead of {scan}");
    assert!(said.contains(&what), "{said}");
}

#[test]
fn every_file_of_the_scan_counts() {
    let place = Place::with("scan.obj", format!("mtllib scan.mtl\nusemtl a\n{}", SCAN.obj()));
    place.write("scan.mtl", "newmtl a\nmap_Kd color.png\n");
    let color = Bitmap::new(2, 2, 3, Texels::U8(vec![[9, 99, 199, 255]; 4])).unwrap();
    place.write("color.png", encode_png_bitmap(&color, Encoding::Srgb).unwrap());
    let report = place.json("bake scan.obj -o out.glb --triangles 500 --size 64 --json");
    let bytes: usize = ["scan.obj", "scan.mtl", "color.png"].map(|name| place.read(name).len()).iter().sum();
    assert_eq!(report["proof"]["bytes_in"], json!(bytes));
}
