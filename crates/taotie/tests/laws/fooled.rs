//! Pairs of a scan and an asset that may fool a proof: each bad one must fail `standard` with a warning that names
//! the cause and the place, each sound twin must meet it. Assets that were damaged after they were made are in
//! `spoiled.rs`.

use crate::modelled::{askew, nut, welded};
use crate::pairs::{
    FINE, Fate, ball, copy_of, first_texture, grid, is_bad, is_sound, joined, lettered, lettering, made,
    mesh, moved, onto, scan_of, simple, turned, with_fates,
};
use std::sync::Arc;
use taotie::asset::{
    BakeOptions, Baker, MeshSource, Packing, Requirement, Scan, ScanFile, ScanOptions, VerifyOptions, verify,
};
use taotie_engine::Progress;
use taotie_engine::bake::MapKind;
use taotie_engine::image::{Bitmap, Encoding, Texels, Texture};
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{GreenChannel, Material, NormalMap, NormalSpace, Scene};

#[test]
fn a_hidden_wall_below_the_surface() {
    let wall = || ball(FINE, |_, _| -0.01);
    let ghost = scan_of(joined([lettered(), wall()]));
    is_sound(&onto(&ghost, simple(lettered(), 6_000), 512), &ghost);
    // The result of a bake that mistakes the wall for the surface.
    let bare = onto(&scan_of(wall()), ball([64, 32], |_, _| -0.01), 256);
    let proof = is_bad(&bare, &ghost, (&["mean-angle", "p95-angle"], "normals are off"));
    let hidden = proof.figures.levels[0].coverage.hidden_of_scan;
    assert!((0.4..0.55).contains(&hidden), "{hidden}");
    assert!(proof.warnings.iter().any(|(what, _)| what.contains("hidden walls")));
}

#[test]
fn a_shard() {
    let scan = scan_of(lettered());
    is_bad(&onto(&scan, ball([4, 3], |_, _| 0.0), 512), &scan, (&["hausdorff"], "farthest apart"));
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
    let uses = first_texture();
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
    let preserved = made(&scan, 400, BakeOptions::AUTO_SIZE);
    assert_eq!(preserved.size(), [1024; 2]);
    let fine = is_sound(&preserved, &scan);
    let lossy = is_bad(&made(&scan, 400, 128), &scan, (&["patch-color"], "colours are off"));
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
    is_bad(
        &onto(&scan, ball([64, 32], |_, _| 0.0), 512),
        &scan,
        (&["hausdorff"], "no counterpart on the asset"),
    );
}

/// Copies of a scan's triangles as an asset, of which the `count` closest to a point are reversed.
fn with_a_black_patch(scan: &Scan, count: usize) -> Scene {
    let mesh = scan.mesh();
    let away = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        ((a + b + c) * (1.0 / 3.0) - Vec3::new(0.6, 0.5, 0.62)).length()
    };
    let mut near: Vec<usize> = (0..mesh.triangles().len()).collect();
    near.sort_by(|a, b| away(*a).total_cmp(&away(*b)));
    let turned = &near[..count];
    with_fates(&copy_of(scan), |t, _| if turned.contains(&t) { Fate::Reversed } else { Fate::Kept })
}

#[test]
fn triangles_that_are_wound_the_other_way() {
    let scan = scan_of(lettered());
    let low = || simple(lettered(), 6_000);
    is_sound(&onto(&scan, low(), 512), &scan);
    let reversed = turned(low(), |p| p.x > 0.9 && p.y.abs() < 0.3);
    is_bad(&onto(&scan, reversed, 512), &scan, (&["patch-angle"], "no counterpart on the asset"));
}

#[test]
fn seventeen_triangles_that_are_wound_the_other_way() {
    let scan = scan_of(ball([96, 48], lettering));
    is_sound(&with_a_black_patch(&scan, 0), &scan);
    is_bad(&with_a_black_patch(&scan, 17), &scan, (&["missed"], "no counterpart on the asset"));
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
    let shifted = moved(simple(lettered(), 6_000), |p| Vec3::new(p.x + 0.08, p.y, p.z));
    is_bad(&onto(&scan, shifted, 512), &scan, (&["hausdorff"], "farthest apart"));
}

#[test]
fn a_hole_and_a_part_too_many() {
    let scan = scan_of(lettered());
    let low = ball([64, 32], |_, _| 0.0);
    let keep = |t: &[u32; 3]| !t.iter().all(|v| low.positions[*v as usize].x > 0.93);
    let triangles = low.triangles.iter().copied().filter(keep).collect();
    let hole = MeshData { triangles, ..low.clone() };
    is_bad(&onto(&scan, hole, 256), &scan, (&["missed"], "no counterpart on the asset"));
    let more = joined([low, finger()]);
    is_bad(&onto(&scan, more, 256), &scan, (&["missed", "hausdorff"], "no counterpart on the scan"));
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

/// The verdict is the same, and about the same patch, whatever the initial number of samples.
#[test]
fn the_verdict_does_not_depend_on_the_samples_at_first() {
    let scan = scan_of(lettered());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("asset.glb");
    onto(&scan, ball([64, 32], |_, _| 0.0), 512).write(&path, &Packing::default(), Progress::SILENT).unwrap();
    let found = [2_000, 20_000, 200_000].map(|points| {
        let requirements: Vec<Requirement> =
            ["mean-angle=0.85", "p95-angle=7", "patch-angle=1.1", "hausdorff=0.66%"]
                .map(|text| text.parse().unwrap())
                .to_vec();
        let options =
            VerifyOptions { points, map: 16, view: 16, patch_view: 0, requirements: requirements.clone() };
        let proof = verify(&path, &scan, &options, Progress::SILENT).unwrap();
        let outcomes = proof.evaluate(&requirements);
        outcomes.iter().for_each(|met| println!("{points}: {} {}", met.name(), met.text()));
        let met: Vec<bool> = outcomes.iter().map(|met| met.met).collect();
        let patch = proof.figures.levels[0].patches.angle.unwrap();
        (met, patch.center, patch.interval)
    });
    for (met, center, [low, high]) in &found {
        assert_eq!((met, center), (&vec![false, true, true, true], &found[0].1));
        let [least, most] = found[2].2;
        assert!(*low <= most && least <= *high, "{found:?}");
    }
}

/// Bumps as a normal map whose green points down, on a ball whose file declares that it points up.
fn mapped_ball() -> Scene {
    let side = 256u32;
    let texel = |i: u32| {
        let (u, v) = (f64::from(i % side) * 0.2, f64::from(i / side) * 0.2);
        let normal = Vec3::new(-0.3 * libm::cos(u) * libm::sin(v), -0.3 * libm::sin(u) * libm::cos(v), 1.0)
            .normalize();
        let [r, g, b] = normal.to_array().map(|c| (c * 127.5 + 127.5).round() as u8);
        [r, g, b, 255]
    };
    let bitmap = Bitmap::new(side, side, 3, Texels::U8((0..side * side).map(texel).collect())).unwrap();
    let texture = first_texture();
    let normal = NormalMap { texture, scale: 1.0, space: NormalSpace::Tangent, green: GreenChannel::Up };
    let material = Material { normal: Some(normal), ..Material::default() };
    let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 48, 24), Material::default()).unwrap();
    let textures = vec![Texture::new(bitmap, Encoding::Normal)];
    scene.edit(|scene| (scene.textures, scene.materials) = (textures, vec![material])).unwrap();
    scene
}

fn read(scene: Scene, options: ScanOptions) -> Scan {
    ScanFile::from_scene(scene).unwrap().with_options(options).into_scan(Progress::SILENT).unwrap()
}

#[test]
fn a_scan_whose_map_has_green_pointing_down() {
    let scan = read(mapped_ball(), ScanOptions::default());
    let low = || Mesh::sphere(1.0, 48, 24).into_data();
    is_sound(&onto(&scan, low(), 512), &scan);
    let taken_as_told =
        read(mapped_ball(), ScanOptions { green: Some(GreenChannel::Up), ..ScanOptions::default() });
    is_bad(&onto(&taken_as_told, low(), 512), &scan, (&["mean-angle", "patch-angle"], "inverted"));
}

#[test]
fn a_nut_with_the_normals_of_its_facets() {
    let nut = || Scene::of_mesh(welded(&askew(nut(96))), Material::default()).unwrap();
    let scan = read(nut(), ScanOptions::default());
    let smooth = read(nut(), ScanOptions { crease_angle_deg: Some(180.0), ..ScanOptions::default() });
    is_sound(&made(&scan, 50_000, 512), &scan);
    is_bad(&made(&smooth, 50_000, 512), &scan, (&["mean-angle", "p95-angle"], "normals are off"));
}
