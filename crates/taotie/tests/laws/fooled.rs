//! Pairs of a scan and an asset that may fool a proof: each bad one has to miss `standard`, each sound twin to meet it.

use std::sync::Arc;
use taotie::Progress;
use taotie::asset::{
    AUTO_SIZE, Asset, BakeOptions, Baker, MeshSource, Packing, Proof, Requirement, Scan, VerifyOptions,
    verify,
};
use taotie::bake::{MapKind, SimplifyOptions, simplify};
use taotie::image::{Bitmap, Encoding, Sampler, Texels, Texture};
use taotie::math::{Mat4, Vec2, Vec3};
use taotie::mesh::{Mesh, MeshData};
use taotie::scene::{Instance, Material, Scene, SceneData, TextureRef, UvTransform};

/// A grid of quadrilaterals, `closed` around if its last column is its first: positions of (u, v) in [0, 1]².
fn grid([columns, rows]: [usize; 2], closed: bool, at: impl Fn(f64, f64) -> Vec3<f64>) -> MeshData {
    let across = if closed { columns } else { columns + 1 };
    let mut data = MeshData::default();
    for row in 0..=rows {
        for column in 0..across {
            let (u, v) = (column as f64 / columns as f64, row as f64 / rows as f64);
            data.positions.push(at(u, v).to_f32());
        }
    }
    let vertex = |column: usize, row: usize| (row * across + column % across) as u32;
    for row in 0..rows {
        for column in 0..columns {
            let [a, b] = [vertex(column, row), vertex(column + 1, row)];
            let [c, d] = [vertex(column + 1, row + 1), vertex(column, row + 1)];
            data.triangles.extend([[a, d, c], [a, c, b]]);
        }
    }
    let MeshData { positions, triangles, .. } = &mut data;
    triangles.retain(|[a, b, c]| {
        let [a, b, c] = [a, b, c].map(|v| positions[*v as usize]);
        (b - a).cross(c - a).length() > 0.0
    });
    data
}

fn direction(u: f64, v: f64) -> Vec3<f64> {
    let (around, down) = (u * std::f64::consts::TAU, v * std::f64::consts::PI);
    Vec3::new(libm::sin(down) * libm::cos(around), libm::cos(down), -libm::sin(down) * libm::sin(around))
}

/// A ball whose radius is 1 plus `height` at (u, v).
fn ball(size: [usize; 2], height: impl Fn(f64, f64) -> f64) -> MeshData {
    // Exactly one point at either pole.
    grid(size, true, |u, v| {
        let pole = if v == 0.0 || v == 1.0 { 0.0 } else { u };
        direction(pole, v) * (1.0 + height(pole, v))
    })
}

/// Letters of a hundredth of the radius, as soft as `edge`, in a band around the middle.
fn lettering(u: f64, v: f64) -> f64 {
    if (v - 0.5).abs() > 0.15 {
        return 0.0;
    }
    let wave = |x: f64| libm::sin(x * std::f64::consts::TAU);
    let soft = |x: f64| 0.5 + 0.5 * libm::tanh(x * 3.0);
    let x = ((v - 0.5) / 0.15) * ((v - 0.5) / 0.15);
    let fade = 1.0 - x * x;
    0.02 * soft(wave(u * 12.0) * wave(v * 9.0) * 2.0) * fade
}

const FINE: [usize; 2] = [240, 120];

fn lettered() -> MeshData {
    ball(FINE, lettering)
}

fn joined(parts: impl IntoIterator<Item = MeshData>) -> MeshData {
    let mut all = MeshData::default();
    for part in parts {
        let first = all.positions.len() as u32;
        all.positions.extend(part.positions);
        all.triangles.extend(part.triangles.into_iter().map(|t| t.map(|v| v + first)));
    }
    all
}

fn moved(data: MeshData, change: impl Fn(Vec3) -> Vec3) -> MeshData {
    MeshData { positions: data.positions.into_iter().map(change).collect(), ..data }
}

fn turned(data: MeshData, is: impl Fn(Vec3) -> bool) -> MeshData {
    let turn = |[a, b, c]: [u32; 3]| {
        let middle =
            [a, b, c].iter().fold(Vec3::splat(0.0), |sum, v| sum + data.positions[*v as usize]) * (1.0 / 3.0);
        if is(middle) { [a, c, b] } else { [a, b, c] }
    };
    let triangles = data.triangles.iter().copied().map(turn).collect();
    MeshData { triangles, ..data }
}

fn mesh(data: MeshData) -> Mesh {
    Mesh::new(data).unwrap()
}

fn scan_of(data: MeshData) -> Scan {
    Scan::from_mesh(mesh(data), Progress::SILENT).unwrap()
}

/// An asset of so many triangles and texels, made from a scan.
fn made(scan: &Scan, triangles: u32, size: u32) -> Asset {
    let options = BakeOptions { triangles, size, ..BakeOptions::default() };
    Baker::new(options).bake(scan, Progress::SILENT).unwrap()
}

/// An asset baked onto a mesh.
fn onto(scan: &Scan, low: MeshData, size: u32) -> Asset {
    let low = Some(MeshSource::Mesh(Arc::new(mesh(low))));
    Baker::new(BakeOptions { low, size, ..BakeOptions::default() }).bake(scan, Progress::SILENT).unwrap()
}

/// The shape of a mesh in fewer triangles.
fn simple(data: MeshData, triangles: usize) -> MeshData {
    let options = SimplifyOptions { triangles, ..SimplifyOptions::default() };
    simplify(&mesh(data), &options, Progress::SILENT).unwrap().mesh.into_data()
}

/// Writes an asset and compares it with a scan, by the file alone.
fn proof(asset: &Asset, scan: &Scan) -> Proof {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("asset.glb");
    asset.write(&path, &Packing::default(), Progress::SILENT).unwrap();
    let options = VerifyOptions { map: 16, view: 16, ..VerifyOptions::default() };
    verify(&path, scan, &options, Progress::SILENT).unwrap()
}

fn failures(proof: &Proof) -> Vec<String> {
    let met = proof.require(&Requirement::standard());
    met.iter().filter(|met| !met.met).map(|met| format!("{} {}", met.name(), met.text())).collect()
}

/// Fails if the proof misses a figure; returns the proof.
#[track_caller]
fn is_sound(asset: &Asset, scan: &Scan) -> Proof {
    let proof = proof(asset, scan);
    assert!(failures(&proof).is_empty(), "{:?} {:?}", failures(&proof), proof.figures.levels[0].coverage);
    proof
}

/// Fails unless the proof misses these figures, and says so in a warning that holds `words`; returns the proof.
#[track_caller]
fn is_bad(asset: &Asset, scan: &Scan, (figures, words): (&[&str], &str)) -> Proof {
    let proof = proof(asset, scan);
    let failures = failures(&proof);
    for figure in figures {
        assert!(failures.iter().any(|failure| failure.starts_with(figure)), "{figure} is met: {failures:?}");
    }
    let warnings: Vec<&str> = proof.warnings.iter().map(|(what, _)| what).collect();
    assert!(warnings.iter().any(|what| what.contains(words)), "{warnings:?}");
    proof
}

#[test]
fn a_hidden_wall_below_the_surface() {
    let wall = || ball(FINE, |_, _| -0.01);
    let ghost = scan_of(joined([lettered(), wall()]));
    is_sound(&onto(&ghost, simple(lettered(), 6_000), 512), &ghost);
    // What a bake shows that takes the wall for the surface.
    let bare = onto(&scan_of(wall()), ball([64, 32], |_, _| -0.01), 256);
    is_bad(&bare, &ghost, (&["mean-angle", "p95-angle"], "hidden walls"));
    let proof = proof(&bare, &ghost);
    let hidden = proof.figures.levels[0].coverage.hidden_of_scan;
    assert!((0.4..0.55).contains(&hidden), "{hidden}");
    assert!(proof.warnings.iter().any(|(what, _)| what.contains("hidden walls")));
}

#[test]
fn a_shard() {
    let scan = scan_of(lettered());
    is_bad(&onto(&scan, ball([4, 3], |_, _| 0.0), 512), &scan, (&["hausdorff"], "worst 1 %"));
}

/// A plate with stripes in one corner, on a texture of this many texels.
fn label(texels: u32) -> Scan {
    let color = |i: usize| {
        let (x, y) = (i as u32 % texels, i as u32 / texels);
        let (u, v) = (f64::from(x) / f64::from(texels), f64::from(y) / f64::from(texels));
        let is_ink = u < 0.2 && v < 0.2 && ((u * 64.0) as u32).is_multiple_of(2);
        if is_ink { [20, 20, 20, 255] } else { [200, 190, 170, 255] }
    };
    let texels_ = (0..(texels * texels) as usize).map(color).collect();
    let bitmap = Bitmap::new(texels, texels, 3, Texels::U8(texels_)).unwrap();
    let uses =
        TextureRef { texture: 0, uv_set: 0, sampler: Sampler::default(), transform: UvTransform::default() };
    let material = Material { base_color_texture: Some(uses), double_sided: true, ..Material::default() };
    let mut plate = grid([48, 48], false, |u, v| Vec3::new(u, 0.02 * libm::sin(u * 6.0), v));
    plate.uvs = vec![plate.positions.iter().map(|p| Vec2::new(p.x, p.z)).collect()];
    let mut scene = Scene::of_mesh(mesh(plate), Material::default()).unwrap();
    let textures = vec![Texture::new(bitmap, Encoding::Srgb)];
    scene.edit(|scene| (scene.textures, scene.materials) = (textures, vec![material])).unwrap();
    Scan::from_scene(scene, Progress::SILENT).unwrap()
}

#[test]
fn a_label_that_cannot_be_read() {
    let scan = label(512);
    let preserved = made(&scan, 400, AUTO_SIZE);
    assert_eq!(preserved.size(), [1024; 2]);
    let fine = is_sound(&preserved, &scan);
    let lossy = is_bad(&made(&scan, 400, 128), &scan, (&["patch-color"], "coarser than the scan's detail"));
    let [fine, lossy] = [fine, lossy].map(|proof| proof.detail_map.unwrap().summary().unwrap().median);
    assert!(fine < 1.0 && lossy > 4.0, "{fine} {lossy}");
}

/// Wedges on two per cent of a ball.
fn wedges(u: f64, v: f64) -> f64 {
    let (du, dv) = ((u - 0.5) / 0.05, (v - 0.5) / 0.1);
    let inside = (1.0 - du * du).max(0.0) * (1.0 - dv * dv).max(0.0);
    let wave = libm::sin(u * std::f64::consts::TAU * 120.0) * libm::sin(v * std::f64::consts::TAU * 60.0);
    0.006 * wave * inside.sqrt()
}

#[test]
fn wedges_on_two_per_cent_of_the_surface() {
    let scan = scan_of(ball([720, 360], wedges));
    is_sound(&onto(&scan, ball([64, 32], |_, _| 0.0), 1024), &scan);
    is_bad(&onto(&scan, ball([64, 32], |_, _| 0.0), 64), &scan, (&["patch-angle"], "worst 1 %"));
}

fn finger() -> MeshData {
    moved(ball([48, 24], |_, _| 0.0), |p| Vec3::new(p.x * 0.1, p.y * 0.1, p.z * 0.5 + 1.2))
}

#[test]
fn a_missing_finger() {
    let scan = scan_of(joined([lettered(), finger()]));
    is_bad(&onto(&scan, ball([64, 32], |_, _| 0.0), 512), &scan, (&["hausdorff"], "nothing in its place"));
}

#[test]
fn triangles_that_are_wound_the_other_way() {
    let scan = scan_of(lettered());
    let low = || simple(lettered(), 6_000);
    is_sound(&onto(&scan, low(), 512), &scan);
    let reversed = turned(low(), |p| p.x > 0.9 && p.y.abs() < 0.3);
    is_bad(&onto(&scan, reversed, 512), &scan, (&["patch-angle"], "worst 1 %"));
}

#[test]
fn relief_that_is_inverted() {
    let (scan, inverted) = (scan_of(lettered()), scan_of(ball(FINE, |u, v| -lettering(u, v))));
    is_bad(&onto(&inverted, ball([64, 32], |_, _| 0.0), 1024), &scan, (&["patch-angle"], "inverted"));
}

#[test]
fn an_asset_beside_its_scan() {
    let scan = scan_of(lettered());
    let inside = |part: f32| moved(simple(lettered(), 6_000), move |p| p * (1.0 - part));
    is_sound(&onto(&scan, inside(0.005), 512), &scan);
    let beside = moved(simple(lettered(), 6_000), |p| Vec3::new(p.x + 0.08, p.y, p.z));
    is_bad(&onto(&scan, beside, 512), &scan, (&["hausdorff"], ""));
}

#[test]
fn a_hole_and_a_part_too_many() {
    let scan = scan_of(lettered());
    let low = ball([64, 32], |_, _| 0.0);
    let keep = |t: &[u32; 3]| !t.iter().all(|v| low.positions[*v as usize].x > 0.93);
    let triangles = low.triangles.iter().copied().filter(keep).collect();
    let hole = MeshData { triangles, ..low.clone() };
    is_bad(&onto(&scan, hole, 256), &scan, (&["missed"], "nothing in its place"));
    let more = joined([low, finger()]);
    is_bad(&onto(&scan, more, 256), &scan, (&["missed", "hausdorff"], "what the scan does not have"));
}

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
    // A part beside it is seen, and kept.
    let beside = moved(ball(), |p| Vec3::new(p.x * 0.6 + 2.0, p.y * 0.6, p.z * 0.6));
    let asset = made(&scan_of(joined([ball(), beside])), budget, 256);
    assert!(asset.levels().next().unwrap().positions().iter().any(|p| p.x > 2.2));
}

#[test]
fn a_closed_room_is_seen_from_within() {
    let room = || turned(ball([160, 80], |u, v| 0.4 * lettering(u, v)), |_| true);
    let scan = scan_of(room());
    let asset = made(&scan, 4_000, 1024);
    is_sound(&asset, &scan);
    let proof_of_room = proof(&asset, &scan);
    assert!(proof_of_room.figures.levels[0].coverage.is_interior);
    assert!(proof_of_room.figures.levels[0].overview.pixels > 1_000);
    // Without its relief.
    let bare = onto(
        &scan_of(turned(ball([64, 32], |_, _| 0.0), |_| true)),
        turned(ball([64, 32], |_, _| 0.0), |_| true),
        64,
    );
    is_bad(&bare, &scan, (&["mean-angle"], "interior"));
}

#[test]
fn colours_of_another_part() {
    let colored = |shift: f32| {
        let data = lettered();
        let colors = data
            .positions
            .iter()
            .map(|p| [0.5 + 0.4 * (p.x + shift).clamp(-1.0, 1.0), 0.4, 0.3, 1.0])
            .collect();
        scan_of(MeshData { colors, ..data })
    };
    let bake = |scan: &Scan| {
        let options = BakeOptions { maps: vec![MapKind::Normal, MapKind::Albedo], ..BakeOptions::default() };
        let low = Some(MeshSource::Mesh(Arc::new(mesh(simple(lettered(), 6_000)))));
        Baker::new(BakeOptions { low, size: 512, ..options }).bake(scan, Progress::SILENT).unwrap()
    };
    let scan = colored(0.0);
    is_sound(&bake(&scan), &scan);
    is_bad(&bake(&colored(0.4)), &scan, (&["mean-color", "patch-color"], "colours are off"));
}

/// The same verdict whatever the number of samples at first.
#[test]
fn the_verdict_does_not_depend_on_the_samples_at_first() {
    let scan = scan_of(lettered());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("asset.glb");
    onto(&scan, ball([64, 32], |_, _| 0.0), 512).write(&path, &Packing::default(), Progress::SILENT).unwrap();
    let verdicts = [2_000, 20_000].map(|points| {
        let requirements: Vec<Requirement> =
            ["mean-angle=2.5", "patch-angle=40", "hausdorff=0.4%"].map(|text| text.parse().unwrap()).to_vec();
        let options =
            VerifyOptions { points, map: 16, view: 16, patch_view: 0, requirements: requirements.clone() };
        let proof = verify(&path, &scan, &options, Progress::SILENT).unwrap();
        proof.require(&requirements).iter().map(|met| met.met).collect::<Vec<_>>()
    });
    assert_eq!(verdicts[0], verdicts[1]);
}
