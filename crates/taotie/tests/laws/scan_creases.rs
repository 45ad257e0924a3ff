//! The normals of scans whose files have none: modelled shapes keep their hard edges, scans stay smooth.

use crate::bake_scan::shown;
use crate::files::data_files;
use crate::modelled::{Facet, askew, chamfered_box, cylinder, gear, gridded_cube, loose, nut, welded};
use crate::random::Random;
use taotie::asset::{BakeOptions, Baker, Scan, ScanFile, ScanOptions};
use taotie_engine::Progress;
use taotie_engine::bake::{self, Cage, Verifier};
use taotie_engine::image::{Encoding, Sampler, Texture};
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{Material, NormalSpace, Scene};
use taotie_engine::surface::vertex_normals;

fn read(mesh: Mesh, crease_angle_deg: Option<f64>) -> Scan {
    let scene = Scene::of_mesh(mesh, Material::default()).unwrap();
    let options = ScanOptions { crease_angle_deg, ..ScanOptions::default() };
    ScanFile::from_scene(scene).unwrap().with_options(options).into_scan(Progress::SILENT).unwrap()
}

fn warned(scan: &Scan) -> String {
    scan.warnings().iter().map(|(what, _)| format!("{what}\n")).collect()
}

/// Returns the mean angle between a scan's normals and the intended ones, over all corners weighted by area, in
/// degrees.
fn mean_error(scan: &Scan, facets: &[Facet]) -> f64 {
    let (mut sum, mut all) = (0.0, 0.0);
    for (triangle, facet) in scan.mesh().triangles().iter().zip(facets) {
        let [a, b, c] = facet.corners;
        let area = (b - a).cross(c - a).length();
        for (vertex, meant) in triangle.iter().zip(facet.normals) {
            let normal = scan.mesh().normals()[*vertex as usize].to_f64();
            sum += area * scalar::atan2(normal.cross(meant).length(), normal.dot(meant)).to_degrees();
            all += area;
        }
    }
    sum / all
}

fn shapes() -> Vec<(&'static str, Vec<Facet>)> {
    let shapes = vec![
        ("nut", nut(24)),
        ("fine nut", nut(96)),
        ("chamfered box", chamfered_box()),
        ("cylinder of 16", cylinder(16)),
        ("cylinder of 32", cylinder(32)),
        ("cylinder of 64", cylinder(64)),
        ("gear", gear(20)),
    ];
    let askew = |(name, facets)| (name, askew(facets));
    shapes.into_iter().map(askew).collect()
}

#[test]
fn modelled_shapes_keep_their_hard_edges() {
    for (name, facets) in shapes() {
        for mesh in [welded(&facets), loose(&facets)] {
            let [smooth, kept] =
                [Some(180.0), None].map(|angle| mean_error(&read(mesh.clone(), angle), &facets));
            println!("{name}: {kept:.3}° automatically, {smooth:.1}° smooth");
            assert!(kept < 0.1, "{name}: {kept}°");
            assert!(smooth > 10.0, "{name}: {smooth}°, else nothing is tested");
            let text = warned(&read(mesh, None));
            assert!(text.contains("hard edges kept") && text.contains("smoothed below 26°"), "{text}");
        }
    }
}

/// For large meshes a sample is examined first.
#[test]
fn a_large_modelled_shape_keeps_its_edges_and_a_large_scan_none() {
    let facets = askew(gridded_cube(150));
    assert!(facets.len() > 200_000);
    let kept = mean_error(&read(welded(&facets), None), &facets);
    assert!(kept < 0.1, "{kept}°");
    for noise in [0.0, 0.05, 1.0] {
        assert_smooth(&format!("large, noise of {noise}"), noisy(noise, 300));
    }
}

/// No other crease angle is better for all of the shapes: below 22.5° cylinders become prisms.
#[test]
fn the_crease_angle_is_the_best_for_all_shapes() {
    let mean = |angle: Option<f64>| -> f64 {
        let shapes = shapes();
        let errors = shapes.iter().map(|(_, facets)| mean_error(&read(welded(facets), angle), facets));
        errors.sum::<f64>() / shapes.len() as f64
    };
    let own = mean(None);
    for angle in [1.0, 5.0, 10.0, 15.0, 20.0, 30.0, 40.0, 44.0, 50.0, 60.0, 70.0, 90.0] {
        let other = mean(Some(angle));
        println!("{angle}°: {other:.3}°, automatic {own:.3}°");
        assert!(own <= other + 1e-9, "{angle}°: {other}° against {own}°");
    }
    assert!(mean(Some(20.0)) > own + 0.5 && mean(Some(50.0)) > own + 0.5, "else the angle does not matter");
}

/// Returns the mean angle between an asset's normals and the facets of the shape that was scanned, in degrees.
fn error_of_asset(facets: &[Facet], crease_angle_deg: Option<f64>) -> f64 {
    let scan = read(welded(facets), crease_angle_deg);
    let baker = Baker::new(BakeOptions { size: 512, ..BakeOptions::default() });
    let asset = baker.bake(scan, Progress::SILENT).unwrap();
    let low = asset.levels().next().unwrap();
    let truth = bake::Scan::new(Scene::of_mesh(loose(facets), Material::default()).unwrap()).unwrap();
    let texture = Texture::new(asset.textures().normal.clone().unwrap(), Encoding::Normal);
    let shown = shown(low, &texture, (NormalSpace::Tangent, Sampler::BILINEAR));
    let cage = Cage::automatic(low, &truth);
    let verifier = Verifier { mesh: low, shown: Some(&shown), cage: &cage, scan: &truth };
    verifier.normal_error(20_000).unwrap().angles.summary().unwrap().mean
}

#[test]
fn a_nut_is_baked_with_its_edges() {
    let facets = askew(nut(96));
    let [kept, smooth] = [None, Some(180.0)].map(|angle| error_of_asset(&facets, angle));
    println!("a nut against its facets: {kept:.2}° with its edges, {smooth:.2}° smooth");
    assert!(kept < 1.0, "{kept}°");
    assert!(smooth > 10.0, "{smooth}°, else nothing is tested");
}

#[test]
fn a_crease_angle_of_zero_keeps_all_facets() {
    let facets = askew(cylinder(16));
    for mesh in [welded(&facets), loose(&facets)] {
        let scan = read(mesh, Some(0.0));
        assert!(!warned(&scan).contains("smooth"), "{}", warned(&scan));
        for (triangle, facet) in scan.mesh().triangles().iter().zip(&facets) {
            let [a, b, c] = facet.corners;
            let flat = (b - a).cross(c - a).normalize();
            for vertex in triangle {
                assert!(scan.mesh().normals()[*vertex as usize].to_f64().dot(flat) > 1.0 - 1e-6);
            }
        }
    }
}

#[test]
fn a_crease_angle_on_a_scan_with_normals_is_noted() {
    let ball = read(Mesh::sphere(1.0, 24, 12), Some(30.0));
    assert_eq!(ball.mesh().normals(), Mesh::sphere(1.0, 24, 12).normals());
    assert!(warned(&ball).contains("the crease angle has no effect"), "{}", warned(&ball));
    assert!(!warned(&read(Mesh::sphere(1.0, 24, 12), None)).contains("crease"));
}

/// Waves with noise, like the surfaces of scanners: smooth though some of its edges are sharp.
fn noisy(noise: f64, side: usize) -> Mesh {
    let mut random = Random(1);
    let jitters: Vec<f64> = (0..side * side).map(|_| random.next() - 0.5).collect();
    let at = |i: usize| {
        let (x, y) = ((i % side) as f64, (i / side) as f64);
        let jitter = jitters[i];
        Vec3::new(x, y, 3.0 * scalar::sin(x * 0.1) + noise * jitter).to_f32()
    };
    let quad = |i: usize| {
        let first = (i / (side - 1) * side + i % (side - 1)) as u32;
        let above = first + side as u32;
        [[first, first + 1, above], [first + 1, above + 1, above]]
    };
    let data = MeshData {
        positions: (0..side * side).map(at).collect(),
        triangles: (0..(side - 1) * (side - 1)).flat_map(quad).collect(),
        ..MeshData::default()
    };
    Mesh::new(data).unwrap()
}

fn assert_smooth(name: &str, bare: Mesh) {
    let scan = read(bare.clone(), None);
    assert!(!warned(&scan).contains("hard edges"), "{name}: {}", warned(&scan));
    let is_same =
        scan.mesh().positions() == bare.positions() && scan.mesh().normals() == vertex_normals(&bare);
    assert!(is_same, "{name}: {}", warned(&scan));
}

#[test]
fn noise_stays_smooth_to_the_bit() {
    for noise in [0.0, 0.05, 0.3, 1.0, 2.0] {
        assert_smooth(&format!("noise of {noise}"), noisy(noise, 120));
    }
}

#[test]
fn shared_scans_stay_smooth_to_the_bit() {
    for path in ["odedstein-meshes", "threedscans-keijiro"].iter().flat_map(|sub| data_files(sub, &["obj"])) {
        let scene = taotie_io::load_model(&path).unwrap().scene;
        for mesh in scene.meshes() {
            let data = mesh.clone().into_data();
            let bare =
                MeshData { positions: data.positions, triangles: data.triangles, ..MeshData::default() };
            let bare = Mesh::new(bare).unwrap();
            // A scan with reversed triangles would be corrected first; none of these has any.
            assert_smooth(&path.display().to_string(), bare);
        }
    }
}
