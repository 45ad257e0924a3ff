//! Given low-poly meshes: rays meet where parts meet, detail that floats above them is baked, and what their files leave
//! unsaid comes from the scan.

use crate::pairs::{ball, direction, grid, is_bad, is_sound, joined, onto, proof, scan_of, scene_of};
use std::sync::Arc;
use taotie::asset::{Asset, BakeOptions, Baker, MeshSource, Requirement, Scan};
use taotie_engine::Progress;
use taotie_engine::math::{Vec2, Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{Material, Scene};
use taotie_io::{GltfFormat, write_scene};

fn mesh(data: MeshData) -> MeshSource {
    MeshSource::Mesh(Arc::new(Mesh::new(data).unwrap()))
}

fn baked(scan: &Scan, options: BakeOptions) -> Asset {
    Baker::new(BakeOptions { size: 256, ..options }).bake(scan, Progress::SILENT).unwrap()
}

/// The four walls of a box of side 2, each in its own tile or all in the first one.
fn walls(in_tiles: bool) -> MeshData {
    let mut data = MeshData { uvs: vec![Vec::new()], ..MeshData::default() };
    for i in 0..4u8 {
        let corner = |k: u8| {
            let (x, z) = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)][usize::from(k) % 4];
            Vec3::new(x, 0.0, z)
        };
        let (left, right, up) = (corner(i), corner(i + 1), Vec3::new(0.0, 1.0, 0.0));
        let first = data.positions.len() as u32;
        data.positions.extend([left - up, right - up, right + up, left + up]);
        data.normals.extend([(left + right).normalize(); 4]);
        let start = if in_tiles { f32::from(i) } else { f32::from(i) / 4.0 };
        let width = if in_tiles { 0.9 } else { 0.22 };
        data.uvs[0].extend(
            [(0.05, 0.9), (1.0, 0.9), (1.0, 0.1), (0.05, 0.1)].map(|(u, v)| Vec2::new(start + u * width, v)),
        );
        data.triangles.extend([[0, 2, 1], [0, 3, 2]].map(|t| t.map(|v| first + v)));
    }
    data
}

/// Rays along the normals of single walls would pass the round corners.
#[test]
fn tiles_are_seen_along_the_same_rays_where_they_meet() {
    let round = |u: f64, v: f64| {
        let angle = std::f64::consts::TAU * u;
        let [x, z] = [scalar::cos(angle), scalar::sin(angle)];
        let radius = [x, z].map(|p| scalar::pow(p.abs(), 8.0)).iter().sum::<f64>();
        let radius = scalar::pow(radius, -0.125);
        Vec3::new(x * radius, 1.0 - 2.0 * v, -z * radius)
    };
    let scan = scan_of(grid([512, 64], true, round));
    let missed = |udim: bool| -> Vec<String> {
        let asset = baked(
            &scan,
            BakeOptions { low: Some(mesh(walls(udim))), udim, keep_uvs: true, ..BakeOptions::default() },
        );
        let warnings: Vec<&str> = asset.warnings().iter().map(|(what, _)| what).collect();
        warnings.iter().filter(|what| what.contains("missed")).map(|what| (*what).to_owned()).collect()
    };
    assert_eq!(missed(false), [""; 0]);
    assert_eq!(missed(true), [""; 0]);
}

fn colored(data: MeshData, color: [f32; 4]) -> MeshData {
    MeshData { colors: vec![color; data.positions.len()], ..data }
}

/// A plate, and a sheet with a side of half its width at a height above it.
fn plate(height: f64) -> (MeshData, MeshData) {
    let sheet = |cells: usize, half: f64, z: f64| {
        grid([cells, cells], false, move |u, v| Vec3::new((2.0 * u - 1.0) * half, (1.0 - 2.0 * v) * half, z))
    };
    let mut low = sheet(4, 1.0, 0.0);
    low.uvs = vec![low.positions.iter().map(|p| Vec2::new(p.x + 1.0, 1.0 - p.y) * 0.5).collect()];
    let high = joined([
        colored(sheet(64, 1.0, 0.0), [0.5, 0.5, 0.5, 1.0]),
        colored(sheet(32, 0.5, height), [0.8, 0.1, 0.1, 1.0]),
    ]);
    (low, high)
}

#[test]
fn detail_that_floats_above_a_low_poly_mesh_is_baked() {
    let color = |low: MeshData, scan: &Scan| {
        let figures = proof(&onto(scan, low, 256), scan, Vec::new()).figures;
        let limit = [Requirement::mean_color(1.0)];
        figures.evaluate(&limit)[0].value.unwrap()
    };
    let (low, high) = plate(0.01);
    let scan = scan_of(high);
    let found = color(low, &scan);
    assert!(found < 1.0, "{found}");
    // Farther than 1 % of the diagonal, it is another part of the object.
    let (low, high) = plate(0.1);
    assert!(color(low, &scan_of(high)) > 5.0);
}

#[test]
fn white_vertex_colors_are_no_appearance() {
    let (low, high) = plate(0.01);
    let scan = scan_of(high);
    is_colored(&onto(&scan, colored(low.clone(), [1.0; 4]), 256), &scan);
    // Neither are distances.
    let ray_colors = |new_uvs: bool| {
        let low = Some(mesh(colored(low.clone(), [0.5, 0.0, 0.0, 1.0])));
        baked(&scan, BakeOptions { low, ray_colors: true, new_uvs, ..BakeOptions::default() })
    };
    is_colored(&ray_colors(false), &scan);
    is_colored(&ray_colors(true), &scan);
}

fn is_colored(asset: &Asset, scan: &Scan) {
    let figures = proof(asset, scan, Vec::new()).figures;
    let met = figures.evaluate(&[Requirement::mean_color(1.0)]);
    assert!(met[0].met, "{}", met[0].text());
}

#[test]
fn new_uvs_keep_the_sides_and_bake_the_colors() {
    let bowl = grid([96, 48], true, |u, v| direction(if v == 1.0 { 0.0 } else { u }, 0.5 + 0.5 * v));
    let paint = |p: &Vec3| [0.5 + 0.4 * p.x, 0.5 + 0.4 * p.y, 0.3, 1.0];
    let colors = bowl.positions.iter().map(paint).collect();
    let bowl = Mesh::new(MeshData { colors, ..bowl }).unwrap();
    let material = Material { double_sided: true, base_color: [1.0; 4], ..Material::default() };
    let scene = Scene::of_mesh(bowl, material).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bowl.glb");
    write_scene(&path, &scene, &GltfFormat::default()).unwrap();
    let scan = Scan::from_scene(scene, Progress::SILENT).unwrap();
    let options = BakeOptions { low: Some(MeshSource::File(path)), new_uvs: true, ..BakeOptions::default() };
    is_sound(&baked(&scan, options), &scan);
}

/// Rays of a hard edge lean over: where they meet nothing, the mesh shows its own normal, not theirs.
#[test]
fn a_wall_without_a_scan_keeps_its_normal() {
    let mut high = walls(false);
    high.uvs.clear();
    high.positions.iter_mut().for_each(|p| *p = *p * 1.02);
    high.triangles.drain(..2);
    let low = Some(mesh(walls(false)));
    let ray_distance = taotie::asset::RayDistance::Uniform(0.05);
    let asset = baked(&scan_of(high), BakeOptions { low, ray_distance, ..BakeOptions::default() });
    let scene = scene_of(&asset);
    let normal = scene.materials()[0].normal.unwrap();
    let bitmap = scene.textures()[normal.texture.texture].bitmap();
    // Within the island of the first wall.
    let (mut most, side) = (0.0_f32, bitmap.width());
    for (x, y) in (side / 5..4 * side / 5).flat_map(|y| (side / 16..side / 6).map(move |x| (x, y))) {
        let [x, y, ..] = bitmap.stored((y * side + x) as usize).map(|v| 2.0 * v - 1.0);
        most = most.max(x.hypot(y));
    }
    assert!(most < 0.01, "{most}");
}

/// A coloured PLY file states no roughness, and is shown as a dielectric.
#[test]
fn a_coloured_file_without_a_material_states_no_roughness() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scan.ply");
    let ball = ball([48, 24], |_, _| 0.0);
    let colors: Vec<[f32; 4]> =
        ball.positions.iter().map(|p| [0.5 + 0.4 * p.x, 0.5 + 0.4 * p.y, 0.3, 1.0]).collect();
    let srgb = |v: f32| (taotie_engine::math::srgb::srgb_from_linear(v.into()) * 255.0 + 0.5) as u8;
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n\
         property uchar green\nproperty uchar blue\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        ball.positions.len(),
        ball.triangles.len()
    );
    for (p, [r, g, b, _]) in ball.positions.iter().zip(&colors) {
        text += &format!("{} {} {} {} {} {}\n", p.x, p.y, p.z, srgb(*r), srgb(*g), srgb(*b));
    }
    ball.triangles.iter().for_each(|[a, b, c]| text += &format!("3 {a} {b} {c}\n"));
    std::fs::write(&path, text).unwrap();
    let scan = Scan::read(&path, &taotie::Limits::default(), Progress::SILENT).unwrap();
    let asset = |metallic: f32, roughness: f32| {
        let material = Material { base_color: [1.0; 4], metallic, roughness, ..Material::default() };
        let data = MeshData { colors: colors.clone(), ..scan.mesh().clone().into_data() };
        Scene::of_mesh(Mesh::new(data).unwrap(), material).unwrap()
    };
    is_sound(&asset(0.0, 0.6), &scan);
    is_sound(&asset(0.0, 0.2), &scan);
    is_bad(&asset(1.0, 0.6), &scan, (&["mean-material"], "metal"));
    // Onto a mesh whose material is glTF's default, a rough metal.
    let low = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default_of_gltf()).unwrap();
    let file = folder.path().join("low.glb");
    write_scene(&file, &low, &GltfFormat::default()).unwrap();
    let baked = baked(&scan, BakeOptions { low: Some(MeshSource::File(file)), ..BakeOptions::default() });
    let shown = scene_of(&baked);
    let material = &shown.materials()[0];
    assert_eq!((material.metallic, material.roughness), (0.0, 0.6));
}
