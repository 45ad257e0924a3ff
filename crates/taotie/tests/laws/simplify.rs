//! Laws of simplified surfaces: triangle count, position and border; and the number of threads does not matter.

use crate::distance::deviation;
use crate::files::data_files;
use crate::hostile;
use taotie_engine::bake::{Simplified, SimplifyMethod, SimplifyOptions, simplify};
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::{Error, Progress};
use taotie_io::load_model;

fn to(mesh: &Mesh, triangles: usize) -> Simplified {
    let options = SimplifyOptions { triangles, ..SimplifyOptions::default() };
    simplify(mesh, &options, Progress::SILENT).unwrap()
}

fn in_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

fn area(mesh: &Mesh) -> f64 {
    let of = |t: usize| {
        let [a, b, c] = mesh.corners(t).map(Vec3::to_f64);
        (b - a).cross(c - a).length() * 0.5
    };
    (0..mesh.triangles().len()).map(of).sum()
}

#[test]
fn an_embossed_ball_keeps_its_shape() {
    let ball = hostile::embossed_ball(100_000);
    for (wanted, mean, most) in [(10_000, 1e-4, 6e-4), (2_000, 4e-4, 2.5e-3), (200, 2e-3, 2e-2)] {
        let low = to(&ball, wanted);
        let [found_mean, found_most] = deviation(&ball, &low.mesh, 20);
        println!(
            "{wanted}: {} triangles, mean {found_mean:.1e}, most {found_most:.1e}",
            low.mesh.triangles().len()
        );
        assert!(low.reached && low.method == SimplifyMethod::Collapsed, "{low:?}");
        assert!(low.mesh.triangles().len().abs_diff(wanted) * 50 <= wanted);
        assert!(found_mean < mean && found_most < most, "{wanted}: {found_mean} {found_most}");
        assert!(low.error > 0.0 && low.error < 0.2, "{}", low.error);
        for (p, n) in low.mesh.positions().iter().zip(low.mesh.normals()) {
            assert!((n.length() - 1.0).abs() < 1e-6 && n.dot(p.normalize()) > 0.5);
        }
    }
}

#[test]
fn corners_of_their_own_change_nothing() {
    let ball = hostile::embossed_ball(20_000);
    let [welded, unwelded] = [&ball, &hostile::unwelded(&ball)].map(|mesh| to(mesh, 3_000));
    let same: Vec<_> = welded.mesh.positions().to_vec();
    assert_eq!(unwelded.mesh.positions(), same);
    assert_eq!(unwelded.mesh.triangles(), welded.mesh.triangles());
}

#[test]
fn large_surfaces_go_in_blocks_and_threads_do_not_matter() {
    let ball = hostile::embossed_ball(800_000);
    let [one, three] = [1, 3].map(|threads| in_threads(threads, || to(&ball, 5_000)));
    assert!(one.reached);
    assert_eq!(one.mesh.positions(), three.mesh.positions());
    assert_eq!(one.mesh.normals(), three.mesh.normals());
    assert_eq!(one.mesh.triangles(), three.mesh.triangles());
    assert_eq!(one.error.to_bits(), three.error.to_bits());
    let [mean, most] = deviation(&ball, &one.mesh, 100);
    println!("mean {mean:.1e}, most {most:.1e}");
    assert!(mean < 4e-4 && most < 4e-3, "{mean} {most}");
    // A crack at a border of blocks would be an open edge.
    assert_eq!(open_edges(&one.mesh), 0);
}

/// Returns the number of edges with only one triangle.
fn open_edges(mesh: &Mesh) -> usize {
    let edges = mesh.triangles().iter().flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)]);
    let edges: std::collections::HashSet<(u32, u32)> = edges.map(|(a, b)| (*a, *b)).collect();
    edges.iter().filter(|(a, b)| !edges.contains(&(*b, *a))).count()
}

#[test]
fn borders_stay() {
    let wavy =
        hostile::sheet(120, 120, |u, v| Vec3::new(u, v, 0.02 * scalar::sin(9.0 * u) * scalar::sin(7.0 * v)));
    let low = to(&wavy, 400);
    for corner in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        assert!(low.mesh.positions().iter().any(|p| (p.x, p.y) == corner), "{corner:?}");
    }
    let (before, after) = (area(&wavy), area(&low.mesh));
    assert!((before - after).abs() < 0.01 * before, "{before} {after}");
}

#[test]
fn few_triangles_are_kept_and_nothing_is_refused() {
    let ball = hostile::embossed_ball(1_000);
    let low = to(&ball, 5_000);
    assert_eq!((low.method, low.reached, low.error), (SimplifyMethod::Kept, true, 0.0));
    assert_eq!(low.mesh.triangles().len(), ball.triangles().len());
    let refused = |mesh: &Mesh, options: SimplifyOptions| {
        simplify(mesh, &options, Progress::SILENT).unwrap_err().to_string()
    };
    let standard = SimplifyOptions::default();
    assert!(refused(&ball, SimplifyOptions { triangles: 0, ..standard }).contains("0 triangles"));
    assert!(
        refused(&ball, SimplifyOptions { normal_weight: f32::NAN, ..standard }).contains("normal weight")
    );
    assert!(refused(&Mesh::default(), standard).contains("no triangle"));
    let point =
        MeshData { positions: vec![Vec3::default()], triangles: vec![[0; 3]; 4], ..MeshData::default() };
    assert!(refused(&Mesh::new(point).unwrap(), standard).contains("no triangle"));
}

#[test]
fn it_can_be_stopped_and_says_how_far_it_is() {
    let ball = hostile::embossed_ball(700_000);
    let options = SimplifyOptions { triangles: 1_000, ..SimplifyOptions::default() };
    for limit in [0.05, 0.3, 0.65, 0.99] {
        let until = |_: &str, done: f64| done < limit;
        let stopped = simplify(&ball, &options, Progress::new(&until));
        assert!(matches!(stopped, Err(Error::Cancelled)), "{limit}");
    }
    let reported = std::sync::Mutex::new(Vec::new());
    let report = |_: &str, done: f64| {
        reported.lock().unwrap().push(done);
        true
    };
    simplify(&ball, &options, Progress::new(&report)).unwrap();
    let reported = reported.into_inner().unwrap();
    assert!(reported.len() >= 5 && reported.iter().all(|done| (0.0..=1.0).contains(done)), "{reported:?}");
    assert_eq!(reported.last(), Some(&1.0));
}

#[test]
fn hostile_surfaces_end_near_the_number_or_say_so() {
    for (name, mesh) in hostile::all() {
        let before = mesh.triangles().len();
        for wanted in [before / 2, before / 10, 1] {
            let wanted = wanted.max(1);
            let Ok(low) =
                simplify(&mesh, &SimplifyOptions { triangles: wanted, normal_weight: 0.1 }, Progress::SILENT)
            else {
                continue;
            };
            let found = low.mesh.triangles().len();
            println!("{name}: {before} to {wanted}: {found}, {:?}, {:?}", low.method, low.notes);
            assert!(found <= before);
            assert!(low.error.is_finite());
            let near = found.abs_diff(wanted) as f64 <= (0.02 * wanted as f64).max(1.0);
            assert_eq!(low.reached, near || low.method == SimplifyMethod::Kept, "{name}");
        }
    }
}

#[test]
fn normals_as_attributes_draw_triangles_to_creases() {
    // A flat sheet with one gentle fold: with normals the fold keeps its vertices.
    let folded = hostile::sheet(60, 60, |u, v| Vec3::new(u, v, 0.02 * (u - 0.5).abs()));
    let options = SimplifyOptions { triangles: 60, normal_weight: 1.0 };
    let low = simplify(&folded, &options, Progress::SILENT).unwrap();
    let [_, most] = deviation(&folded, &low.mesh, 1);
    assert!(most < 1e-6, "{most}");
}

#[test]
fn scans_by_others_keep_their_shape() {
    for path in data_files("odedstein-meshes", &["obj"]) {
        let mesh = load_model(&path).unwrap().scene.into_data().meshes.swap_remove(0);
        for (wanted, mean, most) in [(2_000, 1.5e-3, 1.5e-2), (10_000, 4e-4, 5e-3)] {
            let low = to(&mesh, wanted);
            let [found_mean, found_most] = deviation(&mesh, &low.mesh, mesh.positions().len() / 5_000);
            let found = low.mesh.triangles().len();
            let name = path.file_name().expect("a name").to_string_lossy();
            println!(
                "{name} {} to {wanted}: {found} {:?}, mean {found_mean:.1e}, most {found_most:.1e}, {:?}",
                mesh.triangles().len(),
                low.method,
                low.notes
            );
            assert!(low.reached && found <= wanted + wanted / 50, "{name}");
            assert!(found_mean < mean && found_most < most, "{name} to {wanted}: {found_mean} {found_most}");
        }
    }
}
