//! Sound pairs of every kind of scan, which must meet `standard`, with bad ones next to them if they are short.

use crate::pairs::{
    Fate, ball, copy_of, direction, grid, is_bad, is_sound, joined, lettered_pair, lettering, made, mesh,
    moved, onto, proof, remade, scan_of, turned, with_fates, with_part,
};
use taotie::asset::{BakeOptions, Baker, Figure, Requirement, Scan};
use taotie_engine::Progress;
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::scene::{Instance, Material, Scene, SceneData};

#[test]
fn an_open_vessel_a_sheet_and_a_thin_wall() {
    // A bowl: outside, rim, inside.
    let bowl = |rows: usize, columns: usize| {
        grid([columns, rows], true, |u, v| {
            let (down, radius) = if v < 0.5 { (1.0 - v, 1.0) } else { (v, 0.93) };
            let pole = if v == 0.0 || v == 1.0 { 0.0 } else { u };
            direction(pole, down) * (radius + 0.3 * lettering(pole, 0.45 + 0.1 * v))
        })
    };
    let scan = scan_of(turned(bowl(120, 160), |_| true));
    is_sound(&made(&scan, 4_000, 1024), &scan);
    let sheet = |n: usize| {
        grid([n, n], false, |u, v| Vec3::new(u, 0.05 * libm::sin(u * 9.0) * libm::sin(v * 7.0), v))
    };
    let scan = scan_of(sheet(160));
    is_sound(&made(&scan, 2_000, 512), &scan);
    let wall = |y: f64| moved(sheet(96), move |p| Vec3::new(p.x, p.y + y as f32, p.z));
    let scan = scan_of(joined([wall(0.0), turned(wall(-0.004), |_| true)]));
    is_sound(&made(&scan, 3_000, 1024), &scan);
}

#[test]
fn parts_that_are_instances() {
    let at = |x: f64| Instance {
        mesh: 0,
        material: 0,
        world_from_object: Mat4::translation(Vec3::new(x, 0.0, 0.0)),
    };
    let scene = SceneData {
        meshes: vec![mesh(ball([160, 80], lettering))],
        materials: vec![Material::default()],
        instances: vec![at(0.0), at(2.5), at(5.0)],
        ..SceneData::default()
    };
    let scan = Scan::from_scene(Scene::new(scene).unwrap(), Progress::SILENT).unwrap();
    is_sound(&made(&scan, 9_000, 1024), &scan);
}

#[test]
fn a_closed_room_is_seen_from_within() {
    let room = || turned(ball([160, 80], |u, v| 0.4 * lettering(u, v)), |_| true);
    let scan = scan_of(room());
    let asset = made(&scan, 4_000, 1024);
    let proof = is_sound(&asset, &scan);
    assert!(proof.figures.levels[0].coverage.is_interior);
    assert!(proof.figures.levels[0].overview.pixels > 1_000);
    // Without its relief.
    let bare = onto(
        &scan_of(turned(ball([64, 32], |_, _| 0.0), |_| true)),
        turned(ball([64, 32], |_, _| 0.0), |_| true),
        64,
    );
    is_bad(&bare, &scan, (&["mean-angle"], "normals are off"));
}

#[test]
fn hidden_walls_take_no_triangles() {
    let ball = || ball([96, 48], lettering);
    let inside = moved(ball(), |p| p * 0.6);
    let budget = 400;
    let scan = scan_of(joined([ball(), inside]));
    let asset = made(&scan, budget, 256);
    let low = asset.levels().next().unwrap();
    assert!(low.triangles().len() > 350, "{}", low.triangles().len());
    assert!(low.positions().iter().all(|p| p.length() > 0.9), "all triangles are on the outer wall");
    let said: Vec<&str> = asset.warnings().iter().map(|(what, _)| what).collect();
    assert!(said.iter().any(|what| what.starts_with("26.") && what.contains("cannot be seen")), "{said:?}");
    assert!(!said.iter().any(|what| what.contains("lacks parts")), "{said:?}");
    // A part next to it is visible, and kept.
    let second = moved(ball(), |p| Vec3::new(p.x * 0.6 + 2.0, p.y * 0.6, p.z * 0.6));
    let asset = made(&scan_of(joined([ball(), second])), budget, 256);
    assert!(asset.levels().next().unwrap().positions().iter().any(|p| p.x > 2.2));
}

/// A room with an opening through which it is seen.
fn cave(size: [usize; 2], height: impl Fn(f64, f64) -> f64) -> taotie_engine::mesh::MeshData {
    let mut room = turned(ball(size, height), |_| true);
    let positions = room.positions.clone();
    room.triangles.retain(|t| !t.iter().all(|v| positions[*v as usize].z > 0.85));
    room
}

#[test]
fn a_cave() {
    let scan = scan_of(cave([160, 80], |u, v| 0.4 * lettering(u, v)));
    is_sound(&made(&scan, 4_000, 1024), &scan);
    // Its mouth is closed by a wall.
    let closed = scan_of(turned(ball([160, 80], |u, v| 0.4 * lettering(u, v)), |_| true));
    is_bad(&copy_of(&closed), &scan, (&["missed", "hausdorff"], "no counterpart on the scan"));
}

/// Cavities hide more than half of its surface, but it is still seen from outside.
#[test]
fn a_hollow_statue() {
    let shell = |radius: f64| ball([96, 48], |_, _| radius - 1.0);
    let inner = || joined([turned(shell(0.9), |_| true), shell(0.6), turned(shell(0.5), |_| true)]);
    let statue = |outer| scan_of(joined([outer, inner()]));
    let scan = statue(ball([160, 80], lettering));
    let proof = is_sound(&copy_of(&scan), &scan);
    assert!(!proof.figures.levels[0].coverage.is_interior);
    let bare = statue(ball([160, 80], |_, _| 0.0));
    is_bad(&copy_of(&bare), &scan, (&["mean-angle", "p95-angle"], "normals are off"));
}

#[test]
fn a_net_and_an_asset_with_a_hidden_wall() {
    let (_, asset) = lettered_pair();
    let sheet = scan_of(grid([120, 120], false, |u, v| Vec3::new(u, 0.05 * libm::sin(u * 9.0), v)));
    let net = with_fates(&copy_of(&sheet), |t, _| if t % 5 == 0 { Fate::Removed } else { Fate::Kept });
    let aside = |scene: &Scene| {
        remade(&scene.meshes()[0], |data| data.positions.iter_mut().for_each(|p| p.x += 1e-3))
    };
    let scan = Scan::from_scene(net.clone(), Progress::SILENT).unwrap();
    is_sound(&Scene::of_mesh(aside(&net), Material::default()).unwrap(), &scan);
    let wall = remade(&asset.meshes()[0], |data| data.positions.iter_mut().for_each(|p| *p = *p * 0.97));
    is_sound(&with_part(asset, wall), &lettered_pair().0);
}

/// A search keeps parts that hardly count in pictures, since the distance is limited, and meets every limit that it was
/// given.
#[test]
fn what_a_search_makes_for_standard() {
    let pearl = |i: usize| {
        let at = direction(i as f64 / 5.0, 0.3 + 0.1 * i as f64).to_f32() * 1.3;
        moved(ball([8, 6], |_, _| 0.0), move |p| at + p * 0.01)
    };
    let scan = scan_of(joined([ball([160, 80], lettering)].into_iter().chain((0..5).map(pearl))));
    for more in [Vec::new(), vec![Requirement::of(Figure::P95Angle, 2.5)]] {
        let goal = [Requirement::standard(), more].concat();
        let baker = Baker::new(BakeOptions { goal: Some(goal.clone()), ..BakeOptions::default() });
        let asset = baker.bake(&scan, Progress::SILENT).unwrap();
        proof(&asset, &scan, goal.clone()).require(&goal).unwrap();
    }
}
