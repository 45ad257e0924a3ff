//! Coarser levels of detail look the same as the scan at the size they are shown, and share what they can.

use std::path::Path;
use taotie::Limits;
use taotie::asset::{
    Asset, BakeOptions, Baker, LevelFigures, Lod, Packing, Requirement, Scan, VerifyOptions,
};
use taotie_engine::Progress;
use taotie_engine::image::{Bitmap, Texels};
use taotie_engine::math::{Vec3, scalar::sin};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_io::{GltfAsset, GltfFormat, GltfMaterial, GltfSizes, GltfSource, load_levels, write_gltf};

/// A closed ball with waves.
fn wavy() -> Scan {
    const COLUMNS: usize = 128;
    let data = Mesh::sphere(1.0, COLUMNS, COLUMNS / 2).into_data();
    let wave = |p: &Vec3| {
        *p * (1.0 + 0.02 * [p.x, p.y, p.z].map(|v| sin(9.0 * f64::from(v))).iter().product::<f64>() as f32)
    };
    let mut positions: Vec<Vec3> = data.positions.iter().map(wave).collect();
    // The last column is the first, and each pole is one point: closed bit-exactly.
    for (j, row) in positions.chunks_exact_mut(COLUMNS + 1).enumerate() {
        row[COLUMNS] = row[0];
        if j == 0 || j == COLUMNS / 2 {
            row.fill(row[0]);
        }
    }
    let mesh = MeshData { positions, triangles: data.triangles, ..MeshData::default() };
    Scan::from_mesh(Mesh::new(mesh).unwrap(), Progress::SILENT).unwrap()
}

/// Returns mean angles, in degrees, at the size each level is shown: the proof computes them independently of the
/// search.
fn seen(asset: &Asset, folder: &Path) -> Vec<(f32, f64)> {
    let written = asset.write(folder.join("levels.glb"), &Packing::default(), Progress::SILENT).unwrap();
    let options = VerifyOptions { points: 20_000, map: 0, view: 32, ..VerifyOptions::default() };
    let proof = written.verify(wavy(), &options, Progress::SILENT).unwrap();
    let overview =
        |level: &LevelFigures| (level.overview.across, level.overview.angles.unwrap().summary.mean);
    proof.figures.levels.iter().map(overview).collect()
}

#[test]
fn levels_keep_the_limits_where_they_are_shown() {
    let folder = tempfile::tempdir().unwrap();
    let lods = vec![Lod::Pixels(64)];
    let goal = Some(vec![Requirement::mean_angle_deg(1.0), Requirement::mean_angle_deg(2.0).at_level(1)]);
    let searched = BakeOptions { goal, lods: lods.clone(), ..BakeOptions::default() };
    let by_hand = BakeOptions { triangles: 6000, size: 512, lods, ..BakeOptions::default() };
    for (options, limit) in [(searched, 2.0), (by_hand, 0.5)] {
        let asset = Baker::new(options).bake(wavy(), Progress::SILENT).unwrap();
        let counts: Vec<usize> = asset.levels().map(|mesh| mesh.triangles().len()).collect();
        assert!(counts.len() == 2 && counts[1] < counts[0], "{counts:?}");
        let (across, mean) = seen(&asset, folder.path())[1];
        assert!((across - 64.0).abs() < 0.01, "{across}");
        assert!((0.5 * limit..1.1 * limit).contains(&mean), "{mean}° at {across} pixels, {counts:?}");
    }
}

/// Normals baked for other triangles are off by degrees; a separate map makes a level good at small sizes.
#[test]
fn a_level_by_hand_gets_a_normal_map_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let options =
        BakeOptions { triangles: 3000, size: 512, lods: vec![Lod::Triangles(800)], ..BakeOptions::default() };
    let asset = Baker::new(options).bake(wavy(), Progress::SILENT).unwrap();
    let seen = seen(&asset, folder.path());
    assert!(seen[1].0 >= 64.0 && seen[1].1 < 0.55, "{seen:?}");
    let sizes =
        GltfSizes::read(GltfSource::File(&folder.path().join("levels.glb")), &Limits::default()).unwrap();
    assert_eq!(sizes.images.len(), 2, "{sizes:?}");
}

/// A glTF ball whose base colour is a texture.
fn textured(folder: &Path) -> Scan {
    let (mesh, path) = (Mesh::sphere(1.0, 128, 64), folder.join("textured.glb"));
    let texel = |i: u32| [(i % 64 * 4) as u8, (i / 64 * 4) as u8, (i % 7 * 30) as u8, 255];
    let colors = Bitmap::new(64, 64, 3, Texels::U8((0..64 * 64).map(texel).collect())).unwrap();
    let material = GltfMaterial { base_color_map: Some((&colors).into()), ..GltfMaterial::default() };
    let levels = [&mesh];
    let model = GltfAsset { levels: &levels, material, ..GltfAsset::default() };
    write_gltf(&path, &model, &GltfFormat::default()).unwrap();
    Scan::read(&path, &Limits::default(), Progress::SILENT).unwrap()
}

#[test]
fn levels_of_a_packed_scan_share_its_textures() {
    let folder = tempfile::tempdir().unwrap();
    let goal = Some(vec![Requirement::mean_angle_deg(0.5), Requirement::mean_angle_deg(2.0).at_level(1)]);
    for (lods, levels) in [(vec![Lod::Pixels(64)], 2), (vec![Lod::Triangles(500), Lod::Triangles(100)], 3)] {
        let options = BakeOptions { goal: goal.clone(), lods, ..BakeOptions::default() };
        let asset = Baker::new(options).bake(textured(folder.path()), Progress::SILENT).unwrap();
        assert!(asset.origin().is_scan && asset.levels().count() == levels, "{asset:?}");
        for name in ["out.glb", "out.gltf"] {
            let path = folder.path().join(name);
            let written = asset.write(&path, &Packing::default(), Progress::SILENT).unwrap();
            let read = load_levels(written.path()).unwrap();
            let counts: Vec<usize> = read.iter().map(|level| level.scene.triangle_count()).collect();
            let wanted: Vec<usize> = asset.levels().map(|mesh| mesh.triangles().len()).collect();
            assert_eq!(counts, wanted);
            let sizes = GltfSizes::read(GltfSource::File(&path), &Limits::default()).unwrap();
            assert_eq!(sizes.images.len(), 1, "{sizes:?}");
        }
    }
}
