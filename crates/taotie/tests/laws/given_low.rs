//! Given low-poly meshes: rays meet where parts meet, detail that floats above them is baked, and what their files leave
//! unsaid comes from the scan.

use crate::pairs::{direction, grid, is_sound, joined, onto, proof, scan_of};
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
