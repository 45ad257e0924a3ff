//! Laws of meshes made from scans of thin and disjoint parts: nothing is lost, joined, torn or turned.

use crate::cart::{cart, count, joined, parts};
use crate::distance::{Surface, deviation};
use crate::files::data_files;
use crate::hostile::{book, embossed_ball, moebius, sheet, unwelded};
use std::collections::BTreeMap;
use taotie::asset::{BakeOptions, Baker, Scan};
use taotie_engine::Progress;
use taotie_engine::bake::{
    Simplified, SimplifyMethod, SimplifyOptions, UnwrapOptions, levels, low_poly_mesh, simplify, unwrap,
};
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::mesh::Mesh;
use taotie_engine::surface::{facet_normal, vertex_normals};
use taotie_io::load_model;

fn to(mesh: &Mesh, triangles: usize) -> Simplified {
    let options = SimplifyOptions { triangles, ..SimplifyOptions::default() };
    simplify(mesh, &options, Progress::SILENT).unwrap()
}

/// Panics if more than this fraction of the facets face away from a normal at their corners: narrow ones that
/// simplification folded over.
fn check_normals(mesh: &Mesh, most: f64) {
    let is_turned = |t: &usize| {
        let facet = facet_normal(mesh.corners(*t));
        let normal = |v: u32| mesh.normals()[v as usize];
        facet.is_some_and(|facet| mesh.triangles()[*t].iter().any(|v| facet.dot(normal(*v)) <= 0.09))
    };
    let (turned, all) = ((0..mesh.triangles().len()).filter(is_turned).count(), mesh.triangles().len());
    println!("{turned} of {all} facets are turned");
    assert!(turned as f64 <= most * all as f64, "{turned} of {all} facets are turned");
}

/// Panics if a connected part is not near any single part of the scan as a whole; returns the number of the scan's
/// parts.
fn check_joints(scan: &Mesh, low: &Mesh) -> usize {
    /// The distance to the nearest vertex, which has moved at most slightly, as a fraction of the diagonal.
    const MOST: f64 = 0.02;
    let point = |bits: &[u32; 3]| Vec3::from_array(bits.map(f32::from_bits)).to_f64();
    let by_part = |mesh: &Mesh| {
        let mut found: BTreeMap<u32, Vec<Vec3<f64>>> = BTreeMap::new();
        parts(mesh).iter().for_each(|(place, part)| found.entry(*part).or_default().push(point(place)));
        found.into_values().collect::<Vec<_>>()
    };
    let nearest = |p: &Vec3<f64>, of: &[Vec3<f64>]| {
        of.iter().map(|q| (*p - *q).dot(*p - *q)).fold(f64::INFINITY, f64::min)
    };
    let (before, after) = (by_part(scan), by_part(low));
    let most = MOST * scan.diagonal() * (MOST * scan.diagonal());
    for part in &after {
        let is_near = |own: &&Vec<Vec3<f64>>| part.iter().all(|p| nearest(p, own) <= most);
        assert!(
            before.iter().any(|own| is_near(&own)),
            "a part of {} vertices joins several of the scan",
            part.len()
        );
    }
    before.len()
}

/// Panics if a triangle has corners of two parts of the scan, or a part is lost or in pieces.
fn check_parts(scan: &Mesh, low: &Mesh) {
    let before = check_joints(scan, low);
    assert_eq!(count(&parts(low)), before, "parts after and before");
}

/// Returns the maximum distance of centroids of triangles and midpoints of edges from a scan, as a fraction of its
/// diagonal.
fn farthest_middle(scan: &Mesh, low: &Mesh) -> f64 {
    let surface = Surface::new(scan);
    let middles = |t: usize| {
        let [a, b, c] = low.corners(t);
        [(a + b + c) * (1.0 / 3.0), (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5]
    };
    let far = (0..low.triangles().len()).flat_map(middles).map(|p| surface.distance(p));
    far.fold(0.0, f64::max) / scan.diagonal()
}

fn thinnest(mesh: &Mesh) -> usize {
    let is_sliver = |t: &usize| {
        let [a, b, c] = mesh.corners(*t).map(Vec3::to_f64);
        let longest = [b - a, c - b, a - c].map(|edge| edge.dot(edge)).into_iter().fold(0.0, f64::max);
        (b - a).cross(c - a).length() < 1e-3 * longest
    };
    (0..mesh.triangles().len()).filter(is_sliver).count()
}

#[test]
fn a_cart_of_thin_parts_stays_whole() {
    let cart = cart();
    let all = cart.triangles().len();
    assert_eq!(count(&parts(&cart)), 15);
    for (part, far) in [(4, 0.01), (10, 0.02), (20, 0.04)] {
        let low = to(&cart, all / part);
        let [mean, most] = deviation(&cart, &low.mesh, 7);
        let middle = farthest_middle(&cart, &low.mesh);
        println!(
            "{all} to {}: {} {:?}, mean {mean:.1e}, most {most:.1e}, middles {middle:.1e}, {} slivers, {:?}",
            all / part,
            low.mesh.triangles().len(),
            low.method,
            thinnest(&low.mesh),
            low.notes
        );
        check_parts(&cart, &low.mesh);
        check_normals(&low.mesh, 0.008);
        assert!(low.method < SimplifyMethod::Clustered && low.reached, "{:?}", low.method);
        assert!(low.notes.iter().all(|(what, _)| what.contains("equal corners")), "{:?}", low.notes);
        assert!(most < far && middle < far, "a panel is torn or a bar remains: {most} {middle}");
    }
}

#[test]
fn a_cart_is_the_same_however_it_is_made() {
    let cart = cart();
    let wanted = cart.triangles().len() / 20;
    let [one, three] = [1, 3].map(|threads| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| to(&cart, wanted))
    });
    let loose = to(&unwelded(&cart), wanted);
    for other in [three, loose] {
        assert_eq!(one.mesh.positions(), other.mesh.positions());
        assert_eq!(one.mesh.normals(), other.mesh.normals());
        assert_eq!(one.mesh.triangles(), other.mesh.triangles());
    }
}

/// A closed surface keeps what it had before creases, parts and slivers were handled.
#[test]
fn a_smooth_closed_scan_is_made_as_before() {
    let low = to(&embossed_ball(60_000), 4_000);
    assert_eq!(low.method, SimplifyMethod::Collapsed);
    assert_eq!(low.mesh.normals(), vertex_normals(&low.mesh), "one normal per position");
    assert!(low.notes.iter().all(|(what, _)| what.contains("equal corners")), "{:?}", low.notes);
}

#[test]
fn double_walls_and_edges_of_many_leaves_are_not_turned() {
    let wall = |height: f64| {
        move |u: f64, v: f64| Vec3::new(u, v, 0.1 * scalar::sin(3.0 * u) * scalar::cos(2.0 * v) + height)
    };
    let inner = wall(0.0);
    let walls = joined(&[sheet(50, 50, wall(2e-3)), sheet(50, 50, move |u, v| inner(v, u))]);
    for (name, scan) in [("walls", walls), ("book", book(24)), ("moebius", moebius(80, 12))] {
        for divided in [4, 12] {
            let low = to(&scan, scan.triangles().len() / divided);
            let found = low.mesh.triangles().len();
            println!("{name} to a part of {divided}: {found} {:?} {:?}", low.method, low.notes);
            check_normals(&low.mesh, 0.0);
            check_parts(&scan, &low.mesh);
            assert!(low.method < SimplifyMethod::Clustered, "{name}");
        }
    }
}

/// Models of many thin parts, at a tenth: hardly any facet is turned, nothing joins parts, and no large one is lost.
#[test]
fn models_by_others_stay_whole() {
    let named = |path: &std::path::PathBuf| {
        ["tea_set_01", "Camera_01"].iter().any(|name| path.to_string_lossy().contains(name))
    };
    for path in data_files("polyhaven-models", &["gltf"]).into_iter().filter(named) {
        let scan = low_poly_mesh(load_model(&path).unwrap().scene).unwrap();
        let low = to(&scan, scan.triangles().len() / 10);
        println!(
            "{}: {} to {} {:?}, {} slivers, {:?}",
            path.display(),
            scan.triangles().len(),
            low.mesh.triangles().len(),
            low.method,
            thinnest(&low.mesh),
            low.notes
        );
        check_normals(&low.mesh, 0.02);
        check_joints(&scan, &low.mesh);
        assert!(low.method < SimplifyMethod::Clustered);
        assert!(low.notes.iter().all(|(what, _)| !what.contains("lost because")), "{:?}", low.notes);
    }
}

#[test]
#[ignore = "takes ten seconds"]
fn levels_of_a_cart_are_hardly_turned_either() {
    let low = to(&cart(), 3_000).mesh;
    let base = unwrap(&low, &UnwrapOptions { size: 1024, padding: 2 }, Progress::SILENT).unwrap().mesh;
    check_normals(&base, 0.001);
    for level in levels(&base, &[1_500, 700], Progress::SILENT).unwrap() {
        println!("{} triangles", level.mesh.triangles().len());
        check_normals(&level.mesh, 0.016);
        assert_eq!(level.mesh.uvs()[0].len(), level.mesh.positions().len());
    }
}

/// Faults made by the program are not blamed on the user's meshes.
#[test]
fn a_bake_of_a_cart_blames_nobody() {
    let scan = Scan::from_mesh(cart(), Progress::SILENT).unwrap();
    let options = BakeOptions { triangles: 3_000, size: 512, ..BakeOptions::default() };
    let asset = Baker::new(options).bake(scan, Progress::SILENT).unwrap();
    let said: Vec<&str> = asset.warnings().iter().map(|(what, _)| what).collect();
    println!("{said:#?}");
    for blame in ["face away", "reverse its triangles", "moved, scaled", "folded over"] {
        assert!(said.iter().all(|what| !what.contains(blame)), "{said:?}");
    }
}
