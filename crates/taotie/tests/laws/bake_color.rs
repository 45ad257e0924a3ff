//! Colour and material in a proof: a known difference is reported as it is, what is preserved has none, and grey is
//! grey whatever the colours.

use crate::pairs::first_texture;
use std::sync::Arc;
use taotie::asset::{
    BakeOptions, Baker, LevelFigures, MeshSource, Packing, Proof, Requirement, Scan, VerifyOptions, verify,
};
use taotie_engine::Progress;
use taotie_engine::bake::{self, Cage, MapKind, MaterialError, TexelChecks, TexturedMesh, Verifier};
use taotie_engine::compare::{Field, color_difference};
use taotie_engine::image::{Bitmap, Encoding, Texels, Texture};
use taotie_engine::math::{Mat4, Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{AlphaMode, Instance, Material, Scene, SceneData};

/// The numbers of points measured by a proof in these tests.
const POINTS: VerifyOptions =
    VerifyOptions { points: 5_000, map: 32, view: 96, patch_view: 0, requirements: Vec::new() };

fn ball(material: Material) -> Scene {
    Scene::of_mesh(Mesh::sphere(1.0, 32, 16), material).unwrap()
}

/// Returns the error of a ball that shows `asset` where its scan shows `scan`, and the map of its colours.
fn errors(scan: Material, asset: Material) -> (MaterialError, Field) {
    let scan = bake::Scan::new(ball(scan)).unwrap();
    let shown = TexturedMesh::new(ball(asset)).unwrap();
    let cage = Cage::automatic(shown.mesh(), &scan);
    let verifier = Verifier { mesh: shown.mesh(), shown: None, cage: &cage, scan: &scan };
    let error = verifier.material_error(&shown, 500).unwrap();
    let checks = TexelChecks { colors: Some(&shown), coarser: None };
    (error, verifier.error_maps([16, 8], checks).unwrap().unwrap().colors.unwrap())
}

fn is_everywhere(field: &Field, value: f64) {
    let summary = field.summary().unwrap();
    assert_eq!(summary.count, field.values().len(), "every point of a ball on itself finds its scan");
    let off = (summary.mean - value).abs().max((summary.max - value).abs());
    assert!(off < 1e-5, "{summary:?} against {value}");
}

#[test]
fn a_difference_of_materials_is_told_as_it_is() {
    let gold = Material { base_color: [1.0, 0.7, 0.3, 1.0], metallic: 1.0, ..Material::default() };
    let clay = Material {
        base_color: [0.6, 0.3, 0.2, 1.0],
        roughness: 0.9,
        emissive: [0.0, 2.0, 0.5],
        ..Material::default()
    };
    let (error, map) = errors(gold.clone(), clay.clone());
    is_everywhere(&error.color, color_difference([1.0, 0.7, 0.3], [0.6, 0.3, 0.2]));
    is_everywhere(&error.metallic, 1.0);
    is_everywhere(&error.roughness, f64::from(0.9f32 - 0.6));
    is_everywhere(&error.emission, 2.0);
    is_everywhere(&error.alpha, 0.0);
    let covered = map.summary().expect("the ball's uvs cover the map");
    assert!((covered.mean - error.color.summary().unwrap().mean).abs() < 1e-4, "{covered:?}");
    let (same, _) = errors(gold.clone(), gold);
    for field in [same.color, same.metallic, same.roughness, same.emission, same.alpha] {
        is_everywhere(&field, 0.0);
    }
}

#[test]
fn alpha_counts_as_it_is_seen() {
    let glass = |alpha: AlphaMode, value: f32| Material {
        base_color: [0.5, 0.5, 0.5, value],
        alpha,
        ..Material::default()
    };
    let opaque = || glass(AlphaMode::Opaque, 0.25);
    let alpha = |scan: Material, asset: Material| errors(scan, asset).0.alpha;
    is_everywhere(&alpha(glass(AlphaMode::Blend, 0.25), opaque()), 0.75);
    is_everywhere(&alpha(glass(AlphaMode::Mask(0.5), 0.4), opaque()), 1.0);
    is_everywhere(&alpha(glass(AlphaMode::Mask(0.3), 0.4), opaque()), 0.0);
}

/// One of eight columns of the scan's colours is NaN, and bilinear lookups reach it from both sides.
#[test]
fn colours_that_are_not_finite_are_told() {
    let column = |i: usize| [if i == 3 { f32::NAN } else { 0.5 }, 0.5, 0.5, 1.0];
    let bitmap = Bitmap::new(8, 1, 3, Texels::F32((0..8).map(column).collect())).unwrap();
    let texture = first_texture();
    let material = Material { base_color_texture: Some(texture), ..Material::default() };
    let plain = ball(Material::default()).into_data();
    let textures = vec![Texture::new(bitmap, Encoding::Linear)];
    let scene = Scene::new(SceneData { materials: vec![material], textures, ..plain }).unwrap();
    let scan = bake::Scan::new(scene).unwrap();
    let shown = TexturedMesh::new(ball(Material::default())).unwrap();
    let cage = Cage::automatic(shown.mesh(), &scan);
    let verifier = Verifier { mesh: shown.mesh(), shown: None, cage: &cage, scan: &scan };
    let error = verifier.material_error(&shown, 2000).unwrap();
    assert!((error.not_finite - 0.25).abs() < 0.03, "{}", error.not_finite);
    let finite = error.color.values().iter().filter(|v| v.is_finite()).count();
    assert_eq!(2000 - finite, (error.not_finite * 2000.0).round() as usize);
    assert!(
        error.color.values().iter().all(|v| *v != 0.0),
        "half of the default's colour differs, and so does NaN"
    );
}

#[test]
fn another_mesh_is_refused() {
    let scan = bake::Scan::new(ball(Material::default())).unwrap();
    let shown = TexturedMesh::new(ball(Material::default())).unwrap();
    let low = Mesh::sphere(1.0, 12, 6);
    let cage = Cage::automatic(&low, &scan);
    let verifier = Verifier { mesh: &low, shown: None, cage: &cage, scan: &scan };
    let why = verifier.material_error(&shown, 10).unwrap_err().to_string();
    assert!(why.contains("triangles"), "{why}");
}

/// A ball whose vertices have colours that change slowly, or none.
fn scan(is_colored: bool) -> Scan {
    let data = Mesh::sphere(1.0, 96, 48).into_data();
    let color = |i: usize| {
        let p = data.positions[i];
        [0.5 + 0.4 * p.x, 0.5 + 0.4 * p.y, 0.5 + 0.4 * p.z, 1.0]
    };
    let count = if is_colored { data.positions.len() } else { 0 };
    let colors = (0..count).map(color).collect();
    Scan::from_mesh(Mesh::new(MeshData { colors, ..data }).unwrap(), Progress::SILENT).unwrap()
}

fn finest(proof: &Proof) -> &LevelFigures {
    proof.figures.finest().unwrap()
}

fn proof(scan: &Scan, maps: Vec<MapKind>) -> Proof {
    let low = Some(MeshSource::Mesh(Arc::new(Mesh::sphere(1.0, 64, 32))));
    proof_of(scan, BakeOptions { low, maps, carry: false, size: 128, ..BakeOptions::default() })
}

fn proof_of(scan: &Scan, options: BakeOptions) -> Proof {
    let asset = Baker::new(options).bake(scan, Progress::SILENT).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ball.glb");
    let written = asset.write(path, &Packing::default(), Progress::SILENT).unwrap();
    written.verify(scan, &POINTS, Progress::SILENT).unwrap()
}

#[test]
fn colors_are_kept_or_the_proof_says_so() {
    let colored = scan(true);
    let wanted = [Requirement::mean_color(1.5)];
    let kept = proof(&colored, vec![MapKind::Normal, MapKind::Albedo]);
    let color = finest(&kept).material.color.unwrap();
    assert!(color.mean < 1.5 && color.p95 < 3.0, "{color:?}");
    assert!(kept.evaluate(&wanted)[0].met);
    assert!(kept.color_map.as_ref().is_some_and(|map| map.width() == 32));
    assert_eq!(finest(&kept).full_views.len(), 8);

    let lost = proof(&colored, vec![MapKind::Normal]);
    let color = finest(&lost).material.color.unwrap();
    assert!(color.mean > 10.0, "{color:?}");
    assert!(!lost.evaluate(&wanted)[0].met);
    let flip = |proof: &Proof| finest(proof).full_views.iter().map(|view| view.flip).sum::<f64>() / 8.0;
    assert!(flip(&lost) > 2.0 * flip(&kept), "{} without colours, {} with them", flip(&lost), flip(&kept));
}

/// FLIP counts missing parts of the low-poly mesh, but not missing colours.
#[test]
fn grey_views_are_grey_whatever_the_colors() {
    let [plain, colored] = [false, true].map(|is_colored| proof(&scan(is_colored), vec![MapKind::Normal]));
    assert_eq!(finest(&plain).views, finest(&colored).views);
    for (a, b) in plain.views.scan.iter().zip(&colored.views.scan) {
        assert!(a.pixels() == b.pixels(), "colours are visible");
    }
    assert!(finest(&colored).views.iter().all(|view| view.flip < 0.06), "{:?}", finest(&colored).views);
}

#[test]
fn a_scan_without_material_is_not_compared_and_the_proof_says_so() {
    let plain = proof(&scan(false), vec![MapKind::Normal, MapKind::Height]);
    assert_eq!(finest(&plain).material.color, None);
    assert!(plain.full_views.is_none() && plain.color_map.is_none());
    assert!(!plain.evaluate(&[Requirement::mean_color(100.0)])[0].met, "nothing was measured");
    assert!(plain.figures.unseen.iter().any(|what| what.contains("colour and material")));
}

/// Returns the proof of a ball without a material, as OBJ, against a scan with this one.
fn proof_without_material(material: Material) -> Proof {
    let ball = Mesh::sphere(1.0, 32, 16);
    let vertices = ball.positions().iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z));
    let faces = ball.triangles().iter().map(|t| t.map(|v| v + 1)).map(|[a, b, c]| format!("f {a} {b} {c}\n"));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ball.obj");
    std::fs::write(&path, vertices.chain(faces).collect::<String>()).unwrap();
    let scan = Scan::from_scene(self::ball(material), Progress::SILENT).unwrap();
    verify(&path, scan, &POINTS, Progress::SILENT).unwrap()
}

#[test]
fn what_the_scan_states_decides_whether_colours_are_compared() {
    let says = |proof: &Proof| proof.warnings.iter().any(|(what, _)| what.contains("has no colours"));
    // White metal is glTF's default.
    let unstated = proof_without_material(Material::default_of_gltf());
    assert!(finest(&unstated).overview.color.is_none() && unstated.full_views.is_none() && !says(&unstated));
    assert!(unstated.figures.unseen.iter().any(|what| what.contains("colour and material")));
    let is_of_color = |met: &taotie::asset::RequirementOutcome| met.name().ends_with("color");
    assert!(!unstated.evaluate(&Requirement::standard()).iter().any(is_of_color));
    // A colour that the asset lost is compared, and fails.
    let red = Material { base_color: [0.6, 0.1, 0.1, 1.0], ..Material::default_of_gltf() };
    let lost = proof_without_material(red);
    assert!(says(&lost));
    let met = lost.evaluate(&Requirement::standard());
    assert!(met.iter().any(is_of_color) && met.iter().filter(|met| is_of_color(met)).all(|met| !met.met));
}

/// Three units along x per ball of a row.
fn center(i: usize) -> Vec3<f64> {
    Vec3::new(3.0 * i as f64, 0.0, 0.0)
}

/// Three balls in a row as one mesh, each with a third of the map and space between them.
fn row() -> Mesh {
    let ball = Mesh::sphere(1.0, 48, 24);
    let mut all = MeshData { uvs: vec![Vec::new()], ..MeshData::default() };
    for i in 0..3 {
        let first = all.positions.len() as u32;
        all.positions.extend(ball.positions().iter().map(|p| *p + center(i).to_f32()));
        all.normals.extend(ball.normals());
        let third = |uv: &Vec2| Vec2::new((i as f32 + 0.03 + 0.94 * uv.x) / 3.0, uv.y);
        all.uvs[0].extend(ball.uvs()[0].iter().map(third));
        all.triangles.extend(ball.triangles().iter().map(|t| t.map(|v| v + first)));
    }
    Mesh::new(all).unwrap()
}

#[test]
fn gold_clay_and_a_lamp_look_alike_on_one_map() {
    let material = |base_color: [f32; 3], metallic: f32, roughness: f32| {
        let [r, g, b] = base_color;
        Material { base_color: [r, g, b, 1.0], metallic, roughness, ..Material::default() }
    };
    let lamp = Material { emissive: [4.0, 3.0, 1.0], ..material([0.1, 0.1, 0.1], 0.0, 0.4) };
    let materials = vec![material([1.0, 0.77, 0.34], 1.0, 0.2), material([0.5, 0.25, 0.15], 0.0, 0.9), lamp];
    let world_from_object = |i: usize| Mat4::translation(center(i));
    let instance = |i: usize| Instance { mesh: 0, material: i, world_from_object: world_from_object(i) };
    let scene = SceneData {
        meshes: vec![Mesh::sphere(1.0, 64, 32)],
        materials,
        instances: (0..3).map(instance).collect(),
        ..SceneData::default()
    };
    let scan = Scan::from_scene(Scene::new(scene).unwrap(), Progress::SILENT).unwrap();
    let low = Some(MeshSource::Mesh(Arc::new(row())));
    let proof = proof_of(&scan, BakeOptions { low, carry: true, size: 256, ..BakeOptions::default() });
    let material = &finest(&proof).material;
    let mean = |summary: Option<taotie_engine::compare::Summary>| summary.unwrap().mean;
    println!("gold, clay and a lamp: {material:?}");
    assert!(mean(material.color) < 1.5, "{material:?}");
    assert!(mean(material.metallic) < 0.02 && mean(material.roughness) < 0.02, "{material:?}");
    // Eight bits for values of up to 4.
    assert!(mean(material.emission) < 0.05, "{material:?}");
    assert_eq!(material.alpha.unwrap().max, 0.0);
    let flip = finest(&proof).full_views.iter().map(|view| view.flip).sum::<f64>() / 8.0;
    // The balls cover an eighth of the images.
    assert!(flip < 0.03, "{flip}");
}
