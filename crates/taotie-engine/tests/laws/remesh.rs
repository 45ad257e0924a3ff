//! Watertight outer surfaces of polygon soups: closed manifolds that face outward, close to what can be seen of the
//! scan.

use taotie_engine::Error;
use taotie_engine::bake::{Faults, Remesh, Remeshed, Scan, remesh};
use taotie_engine::groups::Groups;
use taotie_engine::math::Vec3;
use taotie_engine::mesh::{Mesh, MeshData, Point};
use taotie_engine::parallel;
use taotie_engine::progress::Progress;
use taotie_engine::scene::{Material, Scene};
use taotie_engine::surface::{by_position, facet_normal};
use taotie_engine::trace::Bvh;

/// The maximum distance between scan and remesh, as a fraction of the diagonal.
const NEAR: f64 = 0.005;

fn scan(mesh: &Mesh) -> Scan {
    Scan::new(Scene::of_mesh(mesh.clone(), Material::default()).unwrap()).unwrap()
}

fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap()
}

fn joined(parts: &[Mesh]) -> Mesh {
    let all = Mesh::joined(parts).unwrap().into_data();
    mesh(all.positions, all.triangles)
}

/// Returns a closed ball without a seam.
fn ball(radius: f64, center: Vec3, columns: usize) -> Mesh {
    let rows = columns / 2;
    let data = Mesh::sphere(radius, columns, rows).into_data();
    let welded = |v: u32| {
        let (row, column) = (v as usize / (columns + 1), v as usize % (columns + 1));
        let column = if row == 0 || row == rows { 0 } else { column % columns };
        (row * (columns + 1) + column) as u32
    };
    let positions = data.positions.iter().map(|p| *p + center).collect();
    mesh(positions, data.triangles.iter().map(|t| t.map(welded)).collect())
}

/// Returns the triangles of a mesh that `keeps`, by their corners.
fn only(all: &Mesh, keeps: impl Fn([Vec3; 3]) -> bool) -> Mesh {
    let kept = (0..all.triangles().len()).filter(|t| keeps(all.corners(*t)));
    mesh(all.positions().to_vec(), kept.map(|t| all.triangles()[t]).collect())
}

/// Returns numbers in [0, 1).
fn numbers() -> impl FnMut() -> f32 {
    let mut state = 7u32;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    }
}

/// Remeshes a scan and checks that the result is a closed manifold that faces outward.
fn remeshed(scan: &Scan) -> Remeshed {
    let found = remesh(scan, Progress::SILENT).unwrap();
    let mesh = &found.mesh;
    let faults = Faults::of(mesh);
    assert_eq!((faults.open_edges, faults.crowded_edges, faults.duplicates), (0, 0, 0));
    assert_eq!(by_position(mesh.positions()).firsts.len(), mesh.positions().len());
    assert_eq!(mesh.triangles().len(), found.facts.triangles);
    assert!(found.facts.volume > 0.0, "{:?}", found.facts);
    check_fans(mesh);
    found
}

/// Checks that the triangles around each vertex are one ring, in which each edge is used once in each direction.
fn check_fans(mesh: &Mesh) {
    let ends = |[a, b, c]: &[u32; 3]| [(*a, [*b, *c]), (*b, [*c, *a]), (*c, [*a, *b])];
    let sides = || mesh.triangles().iter().flat_map(ends).map(|(v, ends)| (v as usize, ends));
    let fans = Groups::new(mesh.positions().len(), sides);
    for v in 0..fans.count() {
        let fan = fans.of(v);
        let (mut at, mut steps) = (fan[0][1], 1);
        while at != fan[0][0] {
            let next: Vec<&[u32; 2]> = fan.iter().filter(|ends| ends[0] == at).collect();
            assert_eq!(next.len(), 1, "an edge of vertex {v}");
            (at, steps) = (next[0][1], steps + 1);
        }
        assert_eq!(steps, fan.len(), "rings of vertex {v}");
    }
}

/// Returns points on a mesh, all its corners among them, at most `step` apart.
fn points(mesh: &Mesh, step: f32) -> Vec<Point> {
    let cuts = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        ((longest / step).ceil() as u32).max(1)
    };
    let of_triangle = |t: usize| {
        let cuts = cuts(t);
        let at = move |u: u32, v: u32| {
            let [u, v] = [u, v].map(|i| i as f32 / cuts as f32);
            Point { triangle: t as u32, weights: [1.0 - u - v, u, v] }
        };
        (0..=cuts).flat_map(move |u| (0..=cuts - u).map(move |v| at(u, v)))
    };
    (0..mesh.triangles().len()).flat_map(of_triangle).collect()
}

/// Returns the distances of points of a mesh from another one, as fractions of `diagonal`, in ascending order.
fn distances(from: &Mesh, to: &Mesh, diagonal: f64) -> Vec<f64> {
    let bvh = Bvh::of(to.triangles().len(), |t| to.corners(t));
    let points = points(from, 0.005 * diagonal as f32);
    let away = |i: usize| bvh.closest(points[i].position(from), f32::INFINITY).unwrap().distance;
    let mut found = parallel::collect(points.len(), |i| f64::from(away(i)) / diagonal);
    found.sort_unstable_by(f64::total_cmp);
    found
}

/// Returns the maximum of [`distances`].
fn farthest(from: &Mesh, to: &Mesh, diagonal: f64) -> f64 {
    *distances(from, to, diagonal).last().unwrap()
}

#[test]
fn overlapping_balls_with_another_inside_become_one_shell() {
    let centers = [Vec3::splat(0.0), Vec3::new(1.2, 0.1, 0.0)];
    let balls = joined(&centers.map(|center| ball(1.0, center, 96)));
    let soup = joined(&[balls.clone(), ball(0.5, Vec3::new(0.3, 0.0, 0.0), 32)]);
    let found = remeshed(&scan(&soup));
    let Remesh { scan_shells, open_borders, shells, volume, closing, .. } = found.facts;
    assert_eq!((scan_shells, open_borders, shells), (3, 0, 1));
    let diagonal = soup.diagonal();
    assert!((closing / diagonal - 0.02).abs() < 1e-9);
    // Two balls less their lens.
    let (ball, apart) = (4.0 / 3.0 * std::f64::consts::PI, 1.45f64.sqrt());
    let lens = std::f64::consts::PI * (4.0 + apart) * (2.0 - apart) * (2.0 - apart) / 12.0;
    assert!((volume / (2.0 * ball - lens) - 1.0).abs() < 0.005, "{volume}");
    let is_out = |p: &Vec3| centers.iter().all(|center| (*p - *center).length() > 0.998);
    let touching = only(&balls, |corners| corners.iter().any(is_out));
    let outer = only(&balls, |corners| corners.iter().all(is_out));
    let [there, back] = [farthest(&found.mesh, &touching, diagonal), farthest(&outer, &found.mesh, diagonal)];
    assert!(there < NEAR && back < NEAR, "{there} {back}");
}

#[test]
fn a_small_hole_is_closed_and_a_wide_mouth_is_not() {
    let whole = ball(1.0, Vec3::splat(0.0), 256);
    let opened = |radius: f32| {
        let is_near = |p: &Vec3| (*p - Vec3::new(0.0, 0.0, 1.0)).length() < radius;
        only(&whole, |corners| !corners.iter().all(is_near))
    };
    let diagonal = whole.diagonal();
    let closed = remeshed(&scan(&opened(0.033)));
    assert_eq!((closed.facts.open_borders, closed.facts.shells), (1, 1));
    assert!((closed.facts.volume / 4.1888 - 1.0).abs() < 0.005, "{:?}", closed.facts);
    let there = farthest(&closed.mesh, &whole, diagonal);
    let back = farthest(&opened(0.033), &closed.mesh, diagonal);
    assert!(there < NEAR && back < NEAR, "{there} {back}");

    let vessel = opened(0.6);
    let kept = remeshed(&scan(&vessel));
    assert_eq!((kept.facts.open_borders, kept.facts.shells), (1, 1));
    assert!(kept.facts.volume < 0.05, "a thin shell: {:?}", kept.facts);
    let there = farthest(&kept.mesh, &vessel, diagonal);
    let back = farthest(&vessel, &kept.mesh, diagonal);
    assert!(there < NEAR && back < NEAR, "{there} {back}");
}

#[test]
fn a_cube_of_loose_triangles_wound_at_random_becomes_one_shell() {
    let corner = |i: u32| Vec3::from_array(std::array::from_fn(|axis| (i >> axis & 1) as f32));
    let faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let corners = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let mut number = numbers();
    let turned = corners.map(|[a, b, c]| if number() < 0.5 { [a, b, c] } else { [a, c, b] });
    let positions: Vec<Vec3> = turned.flatten().map(corner).collect();
    let triangles = (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let soup = mesh(positions, triangles);
    let found = remeshed(&scan(&soup));
    assert_eq!(found.facts.shells, 1);
    assert!((found.facts.volume - 1.0).abs() < 0.005, "{:?}", found.facts);
    let diagonal = soup.diagonal();
    let [there, back] = [farthest(&found.mesh, &soup, diagonal), farthest(&soup, &found.mesh, diagonal)];
    assert!(there < NEAR && back < NEAR, "{there} {back}");
}

#[test]
fn two_hundred_overlapping_shells_have_a_closed_outer_surface() {
    let mut number = numbers();
    let balls: Vec<(Vec3, f32)> =
        (0..200).map(|_| (Vec3::new(number(), number(), number()), 0.05 + 0.1 * number())).collect();
    let soup = joined(&balls.iter().map(|(c, r)| ball(f64::from(*r), *c, 24)).collect::<Vec<Mesh>>());
    let scan = scan(&soup);
    let found = remeshed(&scan);
    assert_eq!(found.facts.scan_shells, 200);
    assert!(found.facts.shells < 10, "{:?}", found.facts);
    let diagonal = soup.diagonal();
    // The chords of the shells are up to 1 % inside their balls.
    let depth = |p: &Vec3| balls.iter().map(|(c, r)| 0.99 * r - (*p - *c).length()).fold(f32::MIN, f32::max);
    let inside = found.mesh.positions().iter().map(depth).fold(f32::MIN, f32::max);
    assert!(f64::from(inside) < NEAR * diagonal, "{inside}");
    // Only the parts that close gaps are farther away, at most half their width.
    let there = distances(&found.mesh, &soup, diagonal);
    let far = there.partition_point(|away| *away < NEAR) as f64 / there.len() as f64;
    assert!(far > 0.99 && there[there.len() - 1] < 0.0125, "{far} {:?}", there.last());
    // All that a ball slightly wider than the closing reaches straight from outside is kept.
    let radius = 0.65 * found.facts.closing as f32;
    let remeshed = Bvh::of(found.mesh.triangles().len(), |t| found.mesh.corners(t));
    let points = points(scan.mesh(), 0.05);
    let aways = parallel::collect(points.len(), |i| {
        let p = points[i].position(scan.mesh());
        let normal = facet_normal(scan.mesh().corners(points[i].triangle as usize)).unwrap();
        let steps = (2.0 * diagonal as f32 / radius) as u32;
        let is_free = |step: u32| {
            let center = p + normal * (radius * (1.0 + 0.5 * step as f32));
            scan.bvh().closest(center, radius * 0.99).is_none()
        };
        let away = || f64::from(remeshed.closest(p, f32::INFINITY).unwrap().distance) / diagonal;
        (0..steps).all(is_free).then(away)
    });
    let aways: Vec<f64> = aways.into_iter().flatten().collect();
    let back = aways.iter().copied().fold(0.0, f64::max);
    assert!(aways.len() > 1000 && back < NEAR, "{} {back}", aways.len());
}

#[test]
fn the_same_bits_with_any_number_of_threads() {
    let soup = joined(&[ball(1.0, Vec3::splat(0.0), 32), ball(0.3, Vec3::new(1.0, 0.0, 0.1), 16)]);
    let of_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        pool.install(|| remesh(&scan(&soup), Progress::SILENT).unwrap())
    };
    let [one, three] = [1, 3].map(of_threads);
    assert!(one.mesh.positions() == three.mesh.positions() && one.mesh.triangles() == three.mesh.triangles());
    assert_eq!(one.facts, three.facts);
}

#[test]
fn work_is_cancelled_and_coarse_coordinates_are_refused() {
    let scan_of = |center: f32| scan(&ball(1.0, Vec3::splat(center), 16));
    let stop = |_: &'static str, done: f64| done < 0.5;
    let stopped = remesh(&scan_of(0.0), Progress::new(&stop));
    assert!(matches!(stopped, Err(Error::Cancelled)));
    let refused = remesh(&scan_of(1e5), Progress::SILENT).unwrap_err().to_string();
    assert!(refused.contains("move it to the origin"), "{refused}");
}
