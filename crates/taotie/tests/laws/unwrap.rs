//! Laws of unwrapped meshes: nothing overlaps, UV islands keep their distance, areas keep their size, and unwrapping
//! terminates for every mesh.

use crate::files::data_files;
use crate::hostile;
use taotie_engine::bake::{
    Coverage, SimplifyOptions, TexelGrid, UnwrapOptions, Unwrapped, UvLookup, levels, simplify, unwrap,
};
use taotie_engine::math::{Mat4, Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{Instance, Material, Scene, SceneData};
use taotie_engine::surface::vertex_normals;
use taotie_engine::{Error, Progress};
use taotie_io::load_model;

fn unwrapped(mesh: &Mesh, size: u32, padding: u32) -> Unwrapped {
    unwrap(mesh, &UnwrapOptions { size, padding }, Progress::SILENT).unwrap()
}

fn coverage(mesh: &Mesh, size: u32) -> Coverage {
    Coverage::new(mesh, &TexelGrid { width: size, height: size, uv_set: 0, padding: 0 }).unwrap()
}

/// Checks everything that holds for every result.
fn check(name: &str, mesh: &Mesh, result: &Unwrapped, options: UnwrapOptions) {
    let after = &result.mesh;
    assert_eq!(after.triangles().len(), mesh.triangles().len(), "{name}");
    for t in 0..mesh.triangles().len() {
        assert_eq!(after.corners(t), mesh.corners(t), "{name}: triangle {t} differs");
    }
    assert_eq!(after.normals().len(), if mesh.normals().is_empty() { 0 } else { after.positions().len() });
    assert_eq!(after.uvs().len(), 1);
    assert!(
        after.uvs()[0].iter().all(|uv| (0.0..=1.0).contains(&uv.x) && (0.0..=1.0).contains(&uv.y)),
        "{name}"
    );
    let coverage = coverage(after, options.size);
    assert_eq!(coverage.shared(), 0, "{name}: triangles overlap");
    let part = coverage.covered() as f64 / (f64::from(options.size) * f64::from(options.size));
    assert!(result.utilisation <= 1.0 && (part - result.utilisation).abs() < 0.05, "{name}: {part}");
    check_distances(name, result, &coverage, options);
}

/// Checks that texels of two UV islands, or of one and of the border, are at least the padding apart.
fn check_distances(name: &str, result: &Unwrapped, coverage: &Coverage, options: UnwrapOptions) {
    let UnwrapOptions { size, padding } = options;
    let (size, padding) = (i64::from(size), i64::from(padding));
    let island = |x: i64, y: i64| {
        let inside = (0..size).contains(&x) && (0..size).contains(&y);
        inside.then(|| coverage.triangle(x as u32, y as u32)).flatten().map(|t| result.island_of[t as usize])
    };
    // Texels that are padding + 1 to the right or below have the padding between them.
    for y in 0..size {
        for x in 0..size {
            let Some(own) = island(x, y) else { continue };
            let inside = (padding..size - padding).contains(&x) && (padding..size - padding).contains(&y);
            assert!(inside, "{name}: ({x}, {y}) is near the border");
            for step in 1..=padding {
                for (dx, dy) in [(step, 0), (0, step)] {
                    if let Some(other) = island(x + dx, y + dy) {
                        assert_eq!(own, other, "{name}: UV islands are near at ({x}, {y})");
                    }
                }
            }
        }
    }
}

/// Returns for each triangle with an area its fraction of the surface, and its area on the map relative to the
/// average, below 0 if it is mirrored.
fn stretches(result: &Unwrapped, size: u32) -> Vec<(f64, f64)> {
    let mesh = &result.mesh;
    let wide = |uv: Vec2| Vec3::new(f64::from(uv.x), f64::from(uv.y), 0.0) * f64::from(size);
    let areas = (0..mesh.triangles().len()).map(|t| {
        let [a, b, c] = mesh.corners(t).map(Vec3::to_f64);
        let [p, q, r] = mesh.triangles()[t].map(|v| wide(mesh.uvs()[0][v as usize]));
        // Rows run down, so triangles seen from outside run clockwise in numbers.
        ((b - a).cross(c - a).length() * 0.5, -(q - p).cross(r - p).z * 0.5)
    });
    let areas: Vec<(f64, f64)> = areas.filter(|(area, _)| *area > 0.0).collect();
    let total: f64 = areas.iter().map(|(area, _)| area).sum();
    let density = result.texels_per_unit * result.texels_per_unit;
    areas.into_iter().map(|(area, texels)| (area / total, texels / (area * density))).collect()
}

fn in_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

#[test]
fn a_ball_is_unwrapped_into_few_islands_of_little_stretch() {
    let ball = hostile::embossed_ball(10_000);
    let options = UnwrapOptions { size: 1024, padding: 4 };
    let result = unwrapped(&ball, options.size, options.padding);
    check("ball", &ball, &result, options);
    let stretches = stretches(&result, options.size);
    let far: f64 = stretches.iter().filter(|(_, s)| !(0.5..2.0).contains(s)).map(|(part, _)| part).sum();
    println!(
        "{} UV islands, {:.3} covered, {far:.4} of the area beyond 2",
        result.islands, result.utilisation
    );
    assert!(result.islands <= 16 && result.utilisation > 0.57, "{} {}", result.islands, result.utilisation);
    assert!(far < 0.02 && stretches.iter().all(|(_, s)| *s > 0.0), "mirrored, or {far} is stretched");
}

#[test]
fn threads_do_not_matter() {
    let ball = hostile::embossed_ball(6_000);
    let [one, three] = [1, 3].map(|threads| in_threads(threads, || unwrapped(&ball, 512, 2)));
    assert_eq!(one.mesh.uvs(), three.mesh.uvs());
    assert_eq!(one.mesh.triangles(), three.mesh.triangles());
    assert_eq!(one.island_of, three.island_of);
}

#[test]
fn a_flat_sheet_is_one_island_that_fills_the_map() {
    let sheet = hostile::sheet(20, 20, |u, v| Vec3::new(u, 5.0, -v));
    let options = UnwrapOptions { size: 256, padding: 3 };
    let result = unwrapped(&sheet, options.size, options.padding);
    check("sheet", &sheet, &result, options);
    assert_eq!(result.islands, 1);
    let whole = f64::from(options.size - 2 * options.padding) / f64::from(options.size);
    assert!(result.utilisation > 0.95 * whole * whole, "{}", result.utilisation);
    assert!(stretches(&result, options.size).iter().all(|(_, s)| (s - 1.0).abs() < 1e-3));
}

#[test]
fn what_lies_over_itself_is_cut() {
    // Three turns of a ramp: seen from above every turn overlaps the one below.
    let ramp = hostile::sheet(240, 6, |u, v| {
        let (angle, out) = (u * 3.0 * std::f64::consts::TAU, 0.5 + 0.5 * v);
        let [s, c] = [taotie_engine::math::scalar::sin(angle), taotie_engine::math::scalar::cos(angle)];
        Vec3::new(out * s, u, out * c)
    });
    let options = UnwrapOptions { size: 512, padding: 2 };
    let result = unwrapped(&ramp, options.size, options.padding);
    check("ramp", &ramp, &result, options);
    assert!((2..=8).contains(&result.islands), "{}", result.islands);
}

#[test]
fn attributes_are_kept_and_split() {
    let ball = Mesh::sphere(1.0, 24, 12);
    let colors = (0..ball.positions().len()).map(|i| [i as f32, 0.5, 0.25, 1.0]).collect();
    let tangents = vec![[1.0, 0.0, 0.0, 1.0]; ball.positions().len()];
    let ball = Mesh::new(MeshData { colors, tangents, ..ball.into_data() }).unwrap();
    let result = unwrapped(&ball, 256, 2);
    check("sphere", &ball, &result, UnwrapOptions { size: 256, padding: 2 });
    assert!(result.mesh.tangents().is_empty());
    for (before, after) in ball.triangles().iter().zip(result.mesh.triangles()) {
        for (v, w) in before.iter().zip(after) {
            assert_eq!(ball.colors()[*v as usize], result.mesh.colors()[*w as usize]);
            assert_eq!(ball.normals()[*v as usize], result.mesh.normals()[*w as usize]);
        }
    }
}

#[test]
fn hostile_meshes_end() {
    for (name, mesh) in hostile::all() {
        let options = UnwrapOptions { size: 1024, padding: 2 };
        match unwrap(&mesh, &options, Progress::SILENT) {
            Ok(result) => {
                println!("{name}: {} UV islands, {:.2}", result.islands, result.utilisation);
                check(name, &mesh, &result, options);
            }
            Err(error) => {
                println!("{name}: {error}");
                assert!(["line", "far away"].contains(&name), "{name}: {error}");
            }
        }
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let refused = |mesh: &Mesh, size, padding| {
        unwrap(mesh, &UnwrapOptions { size, padding }, Progress::SILENT).unwrap_err().to_string()
    };
    let ball = hostile::embossed_ball(500);
    assert!(refused(&ball, 0, 0).contains("0x0"));
    assert!(refused(&ball, 16, 8).contains("padding of 8"));
    assert!(refused(&Mesh::default(), 64, 1).contains("no triangle has an area"));
    let text = refused(&hostile::soup(3000), 64, 4);
    assert!(text.contains("larger map or less padding"), "{text}");
}

#[test]
fn it_can_be_stopped() {
    let ball = hostile::embossed_ball(2_000);
    for limit in [0.05, 0.25, 0.45, 0.6, 0.99] {
        let until = |_: &str, done: f64| done < limit;
        let stopped = unwrap(&ball, &UnwrapOptions::default(), Progress::new(&until));
        assert!(matches!(stopped, Err(Error::Cancelled)), "{limit}");
    }
}

#[test]
fn scans_by_others_are_unwrapped() {
    unwrap_scans(&[2_000]);
}

#[test]
#[ignore = "takes ten seconds"]
fn large_scans_by_others_are_unwrapped() {
    unwrap_scans(&[10_000]);
}

/// Simplifies scans to this number of triangles and unwraps them.
fn unwrap_scans(counts: &[usize]) {
    for path in data_files("odedstein-meshes", &["obj"]) {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let scan = load_model(&path).unwrap().scene.meshes()[0].clone();
        for triangles in counts.iter().copied() {
            let options = SimplifyOptions { triangles, ..SimplifyOptions::default() };
            let light = simplify(&scan, &options, Progress::SILENT).unwrap().mesh;
            let options = UnwrapOptions { size: 1024, padding: 3 };
            let result = unwrapped(&light, options.size, options.padding);
            check(&name, &light, &result, options);
            let stretches = stretches(&result, options.size);
            let far: f64 =
                stretches.iter().filter(|(_, s)| !(0.5..2.0).contains(s)).map(|(part, _)| part).sum();
            println!(
                "{name} {triangles}: {} UV islands, {:.3} covered, {far:.4} beyond 2",
                result.islands, result.utilisation
            );
            assert!(result.islands < 200 && result.utilisation > 0.5 && far < 0.03, "{name}");
        }
    }
}

#[test]
fn levels_share_the_map_and_have_no_crack() {
    let ball = hostile::embossed_ball(20_000);
    let ball = taotie_engine::surface::with_normals(&ball).unwrap().into_owned();
    let options = UnwrapOptions { size: 1024, padding: 4 };
    let base = unwrapped(&ball, options.size, options.padding).mesh;
    let made = levels(&base, &[30_000, 5_000, 1_000], Progress::SILENT).unwrap();
    assert_eq!(made[0].mesh.positions(), base.positions());
    let grid = TexelGrid { width: 1024, height: 1024, uv_set: 0, padding: options.padding };
    let drawn = Coverage::new(&base, &grid).unwrap();
    for (level, (wanted, outside, moved)) in
        made[1..].iter().zip([(5_000, 0.001, 0.006), (1_000, 0.008, 0.04)])
    {
        let mesh = &level.mesh;
        assert!(
            level.reached && mesh.triangles().len().abs_diff(wanted) * 50 <= wanted,
            "{}",
            mesh.triangles().len()
        );
        assert_eq!(mesh.normals().len(), mesh.positions().len());
        let own = coverage(mesh, 1024);
        let stray = |x: u32, y: u32| own.is_covered(x, y) && drawn.triangle(x, y).is_none();
        let strays =
            (0..1024).flat_map(|y| (0..1024).map(move |x| (x, y))).filter(|(x, y)| stray(*x, *y)).count();
        let strays = strays as f64 / own.covered() as f64;
        let shared = own.shared() as f64 / own.covered() as f64;
        let most = farthest_move(&base, mesh);
        println!("{wanted}: {strays:.5} outside UV islands, {shared:.5} shared, moved by {most:.4}");
        assert!(strays < outside && shared < outside, "{wanted}: {strays} {shared}");
        assert!(most < moved, "{wanted}: the map's content is moved by {most}");
        assert_eq!(open_edges(mesh), 0, "a seam is torn");
    }
}

/// Returns the maximum distance between the positions of a map's texel on the two meshes.
fn farthest_move(base: &Mesh, level: &Mesh) -> f64 {
    let scene = |mesh: &Mesh| {
        let data = SceneData {
            meshes: vec![mesh.clone()],
            materials: vec![Material::default()],
            instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
            ..SceneData::default()
        };
        Scene::new(data).unwrap()
    };
    let [base, level] = [base, level].map(|mesh| UvLookup::new(&scene(mesh)).unwrap());
    let texel = |i: u32| {
        Vec2::new((f64::from(i % 200) as f32 + 0.5) / 200.0, (f64::from(i / 200) as f32 + 0.5) / 200.0)
    };
    let apart = (0..40_000).filter_map(|i| Some((base.at(texel(i))?.0 - level.at(texel(i))?.0).length()));
    let mut apart: Vec<f64> = apart.map(f64::from).collect();
    apart.sort_by(f64::total_cmp);
    // A few texels at the UV islands' borders may be on a triangle that has become a neighbour's.
    apart[apart.len() * 998 / 1000]
}

/// Returns the edges, by position, with only one triangle.
fn open_edges(mesh: &Mesh) -> usize {
    let bits = |v: u32| mesh.positions()[v as usize].to_array().map(|v| (v + 0.0).to_bits());
    let edges = mesh.triangles().iter().flat_map(|[a, b, c]| [(*a, *b), (*b, *c), (*c, *a)]);
    let edges: std::collections::HashSet<_> = edges.map(|(a, b)| (bits(a), bits(b))).collect();
    edges.iter().filter(|(a, b)| !edges.contains(&(*b, *a))).count()
}

#[test]
fn levels_of_what_has_no_map_have_no_crack() {
    let ball = hostile::embossed_ball(500);
    let bare = Mesh::new(MeshData { normals: vertex_normals(&ball), ..ball.clone().into_data() }).unwrap();
    let found = levels(&bare, &[300], Progress::SILENT).unwrap();
    let level = &found[0];
    assert!(level.reached && level.mesh.triangles().len() <= 306, "{}", level.mesh.triangles().len());
    assert_eq!((open_edges(&level.mesh), level.mesh.normals().is_empty()), (open_edges(&bare), false));
    let refused = levels(&Mesh::sphere(1.0, 9, 9), &[10, 0], Progress::SILENT).unwrap_err().to_string();
    assert!(refused.contains("0 triangles"), "{refused}");
    let stopped = levels(&Mesh::sphere(1.0, 9, 9), &[10], Progress::new(&|_, _| false));
    assert!(matches!(stopped, Err(Error::Cancelled)));
}
