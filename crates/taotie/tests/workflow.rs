//! The whole workflow as a program sees it: scan, bake, write, verify, require; and cancellation.

use std::path::Path;
use std::sync::Arc;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use taotie::asset::{
    Asset, BakeOptions, Baker, Figure, Lod, MeshSource, Packing, Proof, RayDistance, Report, Requirement,
    Scan, ScanFile, SeparateMap, VerifyOptions, WrittenAsset,
};
use taotie::{Bytes, Limits};
use taotie_engine::bake::MapKind;
use taotie_engine::image::{Bitmap, Encoding, Sampler, Texels, Texture};
use taotie_engine::math::{Mat4, Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{
    GreenChannel, Instance, Material, NormalSpace, Scene, SceneData, TextureRef, UvTransform,
};
use taotie_engine::{Error, Progress, Result};
use taotie_io::{FileSet, GltfAsset, GltfFormat, GltfMaterial, ImageCodec, load_model, write_gltf};

#[path = "../../../tests/common/mod.rs"]
mod common;
#[path = "../../../tests/common/files.rs"]
mod files;
#[allow(dead_code, reason = "its `main` is for the command line")]
#[path = "../examples/scan_to_asset.rs"]
mod scan_to_asset;

/// Returns a ball with waves of 2 % of its radius, without UVs.
fn wavy(columns: usize, rows: usize) -> Mesh {
    let data = Mesh::sphere(1.0, columns, rows).into_data();
    let wave = |p: &Vec3| {
        let p = p.to_f64();
        let height = scalar::sin(9.0 * p.x) * scalar::sin(9.0 * p.y) * scalar::sin(9.0 * p.z);
        (p * (1.0 + 0.02 * height)).to_f32()
    };
    let mut positions: Vec<Vec3> = data.positions.iter().map(wave).collect();
    // The last column equals the first, and each pole is a single point: closed to the bit.
    for (j, row) in positions.chunks_exact_mut(columns + 1).enumerate() {
        row[columns] = row[0];
        if j == 0 || j == rows {
            row.fill(row[0]);
        }
    }
    Mesh::new(MeshData { positions, triangles: data.triangles, ..MeshData::default() }).unwrap()
}

fn small() -> Scan {
    Scan::from_mesh(wavy(128, 64), Progress::SILENT).unwrap()
}

fn options() -> BakeOptions {
    BakeOptions { triangles: 1000, size: 128, ..BakeOptions::default() }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn said(asset: &Asset) -> String {
    asset.warnings().iter().map(|(what, count)| format!("{what}: {count}\n")).collect()
}

/// Returns two balls in a scene of two nodes, with a texture of soft waves.
fn textured() -> Scan {
    let wave = |v: u32| (100.0 + 80.0 * scalar::sin(f64::from(v) * 0.2)) as u8;
    let waves = (0..128u32 * 128).map(|i| [wave(i % 128), wave(i / 128), 90, 255]);
    let bitmap = Bitmap::new(128, 128, 3, Texels::U8(waves.collect())).unwrap();
    let texture =
        TextureRef { texture: 0, uv_set: 0, sampler: Sampler::default(), transform: UvTransform::default() };
    let material = Material { base_color_texture: Some(texture), ..Material::default() };
    let place = |x: f64| Mat4::translation(Vec3::new(x, 0.0, 0.0));
    let instance = |x: f64| Instance { mesh: 0, material: 0, world_from_object: place(x) };
    let data = SceneData {
        meshes: vec![Mesh::sphere(1.0, 48, 24)],
        materials: vec![material],
        textures: vec![Texture::new(bitmap, Encoding::Srgb)],
        instances: vec![instance(-1.5), instance(1.5)],
        ..SceneData::default()
    };
    Scan::from_scene(Scene::new(data).unwrap(), Progress::SILENT).unwrap()
}

#[cfg(feature = "webp")]
#[test]
fn a_scan_that_is_smallest_as_it_is_is_packed() {
    let (scan, folder) = (textured(), tempfile::tempdir().unwrap());
    let wanted = BakeOptions { goal: Some(vec![Requirement::mean_angle_deg(1.0)]), ..BakeOptions::default() };
    let asset = Baker::new(wanted.clone()).bake(&scan, Progress::SILENT).unwrap();
    let chosen = asset.trials().iter().find(|trial| trial.is_chosen).unwrap();
    assert!(chosen.is_scan && asset.origin().is_scan && chosen.is_near, "{chosen:?}");
    assert!(asset.trials().iter().all(|trial| !trial.is_near || trial.bytes >= chosen.bytes));
    for name in ["scan.glb", "scan.gltf"] {
        let written = asset.write(folder.path().join(name), &Packing::default(), Progress::SILENT).unwrap();
        assert!(written.warnings().is_empty(), "{:?}", written.warnings());
        let loaded = load_model(written.path()).unwrap();
        assert_eq!((loaded.scene.instances().len(), loaded.scene.materials().len()), (2, 1));
        let proof = written.verify(&scan, &VerifyOptions::default(), Progress::SILENT).unwrap();
        let seen = &proof.figures.finest().unwrap().overview;
        assert!(seen.angles.unwrap().summary.mean <= 1.02 && seen.color.unwrap().summary.mean <= 1.02);
    }
    // Without the scan's materials a new material is made.
    let asset = Baker::new(BakeOptions { carry: false, ..wanted }).bake(&scan, Progress::SILENT).unwrap();
    assert!(asset.trials().iter().all(|trial| !trial.is_scan));
}

/// Baked assets do not move.
#[test]
fn a_scan_that_moves_is_packed_as_a_whole() {
    let moving =
        files::data_files("khronos-gltf-sample-assets", &["gltf", "glb"]).into_iter().filter(|path| {
            load_model(path).is_ok_and(|loaded| loaded.rig.is_some() && loaded.scene.triangle_count() < 5_000)
        });
    for path in moving {
        let scan = Scan::read(&path, &Limits::default(), Progress::SILENT).unwrap();
        let goal = Some(Requirement::visually_lossless());
        let wanted = BakeOptions { goal, ..BakeOptions::default() };
        let asset = Baker::new(wanted).bake(&scan, Progress::SILENT).unwrap();
        let out = tempfile::tempdir().unwrap();
        let written = asset.write(out.path().join("m.glb"), &Packing::default(), Progress::SILENT).unwrap();
        let own = load_model(&path).unwrap();
        let packed = load_model(written.path()).unwrap();
        assert!(asset.origin().is_scan && packed.rig.is_some(), "{}", path.display());
        assert_eq!(own.moving, packed.moving, "{}", path.display());
    }
}

#[test]
fn a_scan_becomes_an_asset_with_its_proof() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ball.glb");
    let scan = small();
    let maps = vec![MapKind::Normal, MapKind::Height];
    let asset = Baker::new(BakeOptions { maps, ..options() }).bake(&scan, Progress::SILENT).unwrap();
    assert_eq!(said(&asset), "");
    let triangles = asset.levels().next().unwrap().triangles().len();
    assert!((980..=1000).contains(&triangles), "{triangles}");
    assert_eq!((asset.counts().missed, asset.size()), (0, [128, 128]));
    assert_eq!(asset.origin().simplified.as_ref().unwrap().method, "edge-collapse");

    let written = asset.write(&path, &Packing::default(), Progress::SILENT).unwrap();
    assert_eq!(names(folder.path()), ["ball.glb", "ball.height.png"]);
    assert_eq!(written.path(), path);
    let options = VerifyOptions { points: 20_000, map: 64, view: 64, ..VerifyOptions::default() };
    let proof = written.verify(&scan, &options, Progress::SILENT).unwrap();
    let (figures, finest) = (&proof.figures, proof.figures.finest().unwrap());
    // Eight bits by themselves cost a sixth of a degree; texels of an 80th of the radius cost a degree of these
    // waves.
    let mean = finest.surface_angles.unwrap().mean;
    assert!((0.17..1.5).contains(&mean), "{mean}");
    assert!(mean < finest.without_map.unwrap().mean / 3.0, "the map gains: {figures:?}");
    assert!(finest.hausdorff_of_diagonal.upper < 0.02 && finest.views.len() == 8, "{figures:?}");
    let bytes = std::fs::metadata(&path).unwrap().len();
    assert_eq!((figures.bytes_out, figures.bytes_in), (bytes, 0));
    assert_eq!((proof.error_map.as_ref().unwrap().width(), proof.views.scan.len()), (64, 8));

    let unmet = proof.require(&[Requirement::mean_angle_deg(1.5), Requirement::bytes(10)]).unwrap_err();
    assert!(
        matches!(&unmet, Error::Unmet { what } if what.contains("at most 10") && !what.contains("angle")),
        "{unmet}"
    );
    proof.require(&[Requirement::mean_angle_deg(1.5)]).unwrap();
    let met = proof.evaluate(&[Requirement::mean_angle_deg(1.5), Requirement::bytes(10)]);
    assert_eq!(met.iter().map(|met| met.met).collect::<Vec<_>>(), [true, false]);
    // Passing the scan by value gives the same.
    let again = written.verify(scan, &options, Progress::SILENT).unwrap();
    assert_eq!(again.figures, proof.figures);
}

#[test]
fn what_could_not_be_measured_is_not_met() {
    let folder = tempfile::tempdir().unwrap();
    let scan = small();
    let asset = Baker::new(options()).bake(&scan, Progress::SILENT).unwrap();
    let written = asset.write(folder.path().join("a.glb"), &Packing::default(), Progress::SILENT).unwrap();
    let view = VerifyOptions { points: 10, map: 16, view: 16, ..VerifyOptions::default() };
    let mut proof = written.verify(scan, &view, Progress::SILENT).unwrap();
    proof.figures.levels[0].overview.angles = None;
    let met = proof.evaluate(&[Requirement::of(Figure::MaxAngle, 180.0)]);
    assert_eq!((met[0].value, met[0].met), (None, false));
}

/// The finest level has the figures of the asset; coarser ones are worse, since the map was baked for the finest.
/// Requirements apply to every level, and a failure states the level.
#[test]
fn every_level_is_measured_and_gated() {
    let folder = tempfile::tempdir().unwrap();
    let scan = small();
    let asset = Baker::new(BakeOptions {
        triangles: 2000,
        lods: vec![Lod::Triangles(900), Lod::Triangles(200)],
        ..options()
    });
    let asset = asset.bake(&scan, Progress::SILENT).unwrap();
    let packing = Packing { meshopt: true, ..Packing::default() };
    let written = asset.write(folder.path().join("levels.glb"), &packing, Progress::SILENT).unwrap();
    let options = VerifyOptions { points: 20_000, map: 64, view: 64, ..VerifyOptions::default() };
    let proof = written.verify(scan, &options, Progress::SILENT).unwrap();
    let (figures, levels) = (&proof.figures, &proof.figures.levels);
    let triangles: Vec<usize> = asset.levels().map(|mesh| mesh.triangles().len()).collect();
    assert_eq!(levels.iter().map(|level| level.triangles).collect::<Vec<_>>(), triangles);
    let [finest, middle, coarsest] = levels.as_slice() else { panic!("three levels were requested") };
    let means = [finest, middle, coarsest].map(|level| level.overview.angles.unwrap().summary.mean);
    assert!(means[0] < means[1] && means[1] < means[2], "{means:?}");
    assert!(
        coarsest.hausdorff.lower > finest.hausdorff.lower && coarsest.coverage.missed() < 0.01,
        "{coarsest:?}"
    );
    assert!(levels.iter().all(|level| level.views.len() == 8), "{figures:?}");
    assert_eq!(proof.coarser_views.iter().map(|views| views.asset.len()).collect::<Vec<_>>(), [8, 8]);

    let between = Requirement::mean_angle_deg((means[1] + means[2]) / 2.0);
    let met = proof.evaluate(&[between, between.at_level(1), Requirement::missed(1.0)]);
    let outcomes: Vec<_> = met.iter().map(|met| (met.level, met.met)).collect();
    let at = |level, is| (Some(level), is);
    // Coarser levels are never seen close up.
    assert_eq!(outcomes, [at(0, true), at(2, false), at(1, true), at(0, true)]);
}

/// Files with 8 bits report the error due to 8 bits; other files do not.
#[test]
fn the_floor_is_told_where_it_holds() {
    let folder = tempfile::tempdir().unwrap();
    let scan = small();
    let floor = |options: BakeOptions, images: ImageCodec| {
        let asset = Baker::new(BakeOptions { size: 32, ..options }).bake(&scan, Progress::SILENT).unwrap();
        let packing = Packing { images: images.into(), ..Packing::default() };
        let written = asset.write(folder.path().join("a.glb"), &packing, Progress::SILENT).unwrap();
        Report::of(&written).unwrap().bake.unwrap().floor_8_bit
    };
    let sixteen = || BakeOptions { bits: 16, ..options() };
    let separate = || BakeOptions { space: NormalSpace::Object, ..options() };
    assert_eq!(floor(options(), ImageCodec::Png), Some(Proof::FLOOR_8_BIT));
    assert_eq!(floor(sixteen(), ImageCodec::Png), None);
    if cfg!(feature = "basis") {
        assert_eq!(floor(options(), ImageCodec::Ktx2(0)), None, "it costs more");
    }
    assert_eq!(
        floor(separate(), ImageCodec::Ktx2(0)),
        Some(Proof::FLOOR_8_BIT),
        "next to the asset it is a PNG"
    );
    assert_eq!(floor(BakeOptions { maps: vec![MapKind::Height], ..options() }, ImageCodec::Png), None);
}

#[test]
fn all_can_be_sent_anywhere() {
    fn is_free<T: Send + Sync + 'static>() {}
    is_free::<ScanFile>();
    is_free::<Scan>();
    is_free::<Baker>();
    is_free::<Asset>();
    is_free::<WrittenAsset>();
    is_free::<Proof>();
    // And they are sent: a bake on another thread than the caller's.
    let (baker, scan) = (Baker::new(BakeOptions { size: 32, ..options() }), small());
    let asset = std::thread::spawn(move || baker.bake(scan, Progress::SILENT)).join().unwrap().unwrap();
    assert!(asset.counts().samples > 0);
}

#[test]
fn the_example_runs_on_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let [high, low] = ["scan.glb", "out.glb"].map(|name| folder.path().join(name));
    let levels = [&wavy(128, 64)];
    let material = GltfMaterial::default();
    let model = GltfAsset { levels: &levels, material, copyright: Some("nobody"), ..GltfAsset::default() };
    write_gltf(&high, &model, &GltfFormat::default()).unwrap();
    let text = scan_to_asset::run(&high, &low, options()).unwrap();
    assert!(text.contains("1000 triangles") || text.contains("99"), "{text}");
    assert!(text.ends_with("required: met"), "{text}");
    let read = taotie_io::load_model(&low).unwrap();
    assert_eq!(read.copyright.as_deref(), Some("nobody"));
    let packet: serde_json::Value = serde_json::from_str(&read.xmp[0].to_string()).unwrap();
    let source = packet["dc:source"].to_string();
    let hash = taotie_io::sha256(&high).unwrap();
    assert!(source.contains(&format!("scan.glb (sha256:{hash})")), "{source}");
}

/// Returns a ball of loose triangles, each scaled by `part`, which simplification to few triangles cannot follow.
fn in_pieces(ball: Mesh, part: f32) -> Scan {
    let shrunk = |t: usize| {
        let corners = ball.corners(t);
        let middle = (corners[0] + corners[1] + corners[2]) * (1.0 / 3.0);
        corners.map(|p| middle + (p - middle) * part)
    };
    let positions: Vec<Vec3> = (0..ball.triangles().len()).flat_map(shrunk).collect();
    let triangles = (0..ball.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let mesh = Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap();
    Scan::from_mesh(mesh, Progress::SILENT).unwrap()
}

#[test]
fn a_mesh_that_lost_the_shape_of_its_scan_is_an_error() {
    let bake =
        |options: BakeOptions| Baker::new(options).bake(in_pieces(wavy(100, 50), 0.9), Progress::SILENT);
    let error = bake(options()).unwrap_err().to_string();
    assert!(error.starts_with("a low-poly mesh of ") && error.contains("lost the scan's shape: "), "{error}");
    assert!(
        error.contains("farther than 2.0 % of the diagonal") && error.contains("use more triangles"),
        "{error}"
    );
    bake(BakeOptions { triangles: 9_500, size: 512, ..options() }).unwrap();
}

/// Meshes that lost the shape are not close enough, whatever their normals are, and the search goes on.
#[test]
fn a_search_passes_over_meshes_that_lost_the_shape() {
    let search = |scan: Scan| {
        let wanted = BakeOptions { goal: Some(vec![Requirement::mean_angle_deg(60.0)]), ..options() };
        Baker::new(wanted).bake(scan, Progress::SILENT)
    };
    let found = search(in_pieces(wavy(100, 50), 0.9)).unwrap();
    assert!(found.trials().iter().all(|trial| trial.triangles >= 5_000), "{:?}", found.trials());
    assert!(said(&found).contains("not considered: a low-poly mesh of "), "{}", said(&found));
    // If no simplification is like the scan, all of its triangles are used.
    let scan = in_pieces(wavy(50, 25), 0.3);
    let all = scan.mesh().triangles().len();
    let found = search(scan).unwrap();
    assert_eq!(found.levels().next().unwrap().triangles().len(), all);
    assert!(found.textures().normal.is_none() && found.size() == [0; 2]);
}

#[test]
fn a_bake_without_a_hit_is_an_error() {
    let far = Mesh::sphere(1.0, 32, 16).into_data();
    let moved = far.positions.iter().map(|p| *p + Vec3::new(30.0, 0.0, 0.0)).collect();
    let low = Mesh::new(MeshData { positions: moved, ..far }).unwrap();
    let bake = |low: Mesh, ray_distance: RayDistance| {
        let low = Some(MeshSource::Mesh(Arc::new(low)));
        Baker::new(BakeOptions { low, ray_distance, size: 64, ..options() }).bake(small(), Progress::SILENT)
    };
    let error = bake(low.clone(), RayDistance::Uniform(0.25)).unwrap_err();
    let text = error.to_string();
    assert!(matches!(error, Error::Invalid { .. }), "{text}");
    for part in ["projection rays met the scan", "0.250 model units", "do not overlap", "larger ray distance"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    let flat = MeshData { uvs: vec![vec![Default::default(); low.positions().len()]], ..low.into_data() };
    let text = bake(Mesh::new(flat).unwrap(), RayDistance::Auto).unwrap_err().to_string();
    assert!(text.contains("covers a texel") && text.contains("unwrap it"), "{text}");
}

#[test]
fn what_is_asked_for_and_not_used_is_told() {
    let colored = |count: usize| {
        let data = wavy(64, 32).into_data();
        let colors = (0..data.positions.len()).map(|i| [(i % count) as f32, 0.5, 0.5, 1.0]).collect();
        Scan::from_mesh(Mesh::new(MeshData { colors, ..data }).unwrap(), Progress::SILENT).unwrap()
    };
    let asked = BakeOptions {
        triangles: 200,
        size: 32,
        maps: vec![MapKind::Height],
        carry: false,
        bits: 16,
        ao_distance: Some(1.0),
        roughness: Some(0.5),
        ..BakeOptions::default()
    };
    let said = said(&Baker::new(asked.clone()).bake(colored(2), Progress::SILENT).unwrap());
    for part in [
        "base colour, on 100.0 %",
        "16 bits have no effect",
        "distance of occlusion",
        "roughness has no effect",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let error = Baker::new(BakeOptions { lods: vec![Lod::Triangles(300)], ..asked })
        .bake(colored(2), Progress::SILENT);
    assert!(error.unwrap_err().to_string().contains("the level of detail 300 after one of 200"));
    let limits = Limits { memory: Some(Bytes(1 << 20)), ..Limits::default() };
    let error = Baker::new(options()).with_limits(limits).bake(small(), Progress::SILENT).unwrap_err();
    assert!(matches!(error, Error::Limit { .. }), "{error}");
}

#[test]
fn every_file_that_is_written_was_foreseen() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.gltf");
    let maps = vec![MapKind::Normal, MapKind::Height, MapKind::Albedo, MapKind::Occlusion];
    let baker = Baker::new(BakeOptions { maps, triangles: 200, size: 32, ..options() });
    let asset = baker.bake(small(), Progress::SILENT).unwrap();
    let packings = [
        Packing { images: ImageCodec::Jpeg(90).into(), ..Packing::default() },
        Packing { images: ImageCodec::Ktx2(0).into(), green: GreenChannel::Down, ..Packing::default() },
    ];
    for packing in packings {
        let written = asset.write(&path, &packing, Progress::SILENT).unwrap();
        let expected = baker.may_write(&path, &packing);
        assert!(written.files().len() > 4 && expected[0] == path, "{:?}", written.files());
        let missing: Vec<_> = written.files().iter().filter(|file| !expected.contains(file)).collect();
        assert!(missing.is_empty(), "{missing:?}");
    }
}

#[test]
fn an_asset_is_proved_before_it_is_in_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.gltf");
    std::fs::write(&path, "before").unwrap();
    let (files, scan) = (FileSet::new(), small());
    let asset = Baker::new(BakeOptions { size: 32, ..options() }).bake(&scan, Progress::SILENT).unwrap();
    let written = asset.write_in(&files, &path, &Packing::default(), Progress::SILENT).unwrap();
    let few = VerifyOptions { points: 10, map: 16, view: 16, ..VerifyOptions::default() };
    let proof = written.verify(&scan, &few, Progress::SILENT).unwrap();
    assert!(proof.figures.bytes_out > 0);
    assert_eq!(std::fs::read(&path).unwrap(), b"before");
    files.commit().unwrap();
    assert_eq!(names(folder.path()), ["out.bin", "out.gltf", "out_normal.png"]);
    let again = written.verify(&scan, &few, Progress::SILENT).unwrap();
    assert_eq!(again.figures.bytes_out, proof.figures.bytes_out);
}

#[test]
fn files_of_the_low_poly_mesh_are_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let [path, buffer] = ["low.gltf", "low.bin"].map(|name| folder.path().join(name));
    let levels = [&Mesh::sphere(1.0, 24, 12)];
    let low = GltfAsset { levels: &levels, ..GltfAsset::default() };
    write_gltf(&path, &low, &GltfFormat::default()).unwrap();
    let before = std::fs::read(&buffer).unwrap();
    let source = Some(MeshSource::File(path.clone()));
    let baker = Baker::new(BakeOptions { low: source, size: 32, ..options() });
    let is_refused = |error: Error| error.to_string().contains("it would overwrite the input");
    // If it is known beforehand, it is refused as soon as the mesh is read.
    let files = FileSet::new();
    files.claim(&buffer).unwrap();
    let heard = Mutex::new(Vec::new());
    let listener = |stage: &'static str, _: f64| {
        heard.lock().unwrap().push(stage);
        true
    };
    let early = baker.clone().with_files(&files).bake(small(), Progress::new(&listener));
    assert!(is_refused(early.unwrap_err()));
    drop(files);
    let heard = heard.into_inner().unwrap();
    assert!(heard.contains(&"read the low-poly mesh") && !heard.contains(&"tangents"), "{heard:?}");
    let asset = baker.bake(small(), Progress::SILENT).unwrap();
    assert!(is_refused(asset.write(&path, &Packing::default(), Progress::SILENT).unwrap_err()));
    assert_eq!(std::fs::read(&buffer).unwrap(), before);
    assert_eq!(names(folder.path()), ["low.bin", "low.gltf"]);
}

/// Bakes and writes without reading files.
fn job(mesh: &Mesh, options: &BakeOptions, folder: &Path, progress: Progress<'_>) -> Result<WrittenAsset> {
    let scan = Scan::from_mesh(mesh.clone(), progress)?;
    let asset = Baker::new(options.clone()).bake(scan, progress)?;
    asset.write(
        folder.join("out.gltf"),
        &Packing { images: ImageCodec::Ktx2(0).into(), ..Packing::default() },
        progress,
    )
}

#[test]
fn a_cancel_in_any_stage_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, options) = (wavy(128, 64), BakeOptions { lods: vec![Lod::Triangles(500)], ..options() });
    let heard = Mutex::new(Vec::new());
    let listener = |stage: &'static str, _: f64| {
        heard.lock().unwrap().push(stage);
        true
    };
    job(&mesh, &options, folder.path(), Progress::new(&listener)).unwrap();
    let written = names(folder.path());
    assert_eq!(written, ["out.bin", "out.gltf", "out_lod1_normal.ktx2", "out_normal.ktx2"]);
    written.iter().for_each(|name| std::fs::remove_file(folder.path().join(name)).unwrap());
    let mut stages = heard.into_inner().unwrap();
    stages.dedup();
    stages.retain(|stage| !stage.is_empty());
    let wanted = [
        "join the scan",
        "inspect the scan",
        "simplify",
        "sort the scan",
        "fit normals",
        "unwrap",
        "tangents",
        "measure the gap",
        "bake",
        "store",
        "levels of detail",
        "write",
    ];
    assert_eq!(stages, wanted);
    for last in wanted {
        let listener = |stage: &'static str, _: f64| stage != last;
        let ended = job(&mesh, &options, folder.path(), Progress::new(&listener));
        assert!(matches!(ended, Err(Error::Cancelled)), "{last}");
        assert_eq!(names(folder.path()), [""; 0], "{last}");
    }
}

/// A listener is called every 20 ms, so that a cancellation takes effect within 100 ms; a machine that is busy with
/// other tests may take longer to wake a thread, hence the wider bound.
const MOST: Duration = Duration::from_millis(250);

#[test]
fn a_bake_of_a_million_triangles_is_cancelled_at_any_moment() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = wavy(1000, 501);
    assert_eq!(mesh.triangles().len(), 1_000_000);
    let options = BakeOptions { size: 1024, ..BakeOptions::default() };
    let (mut state, mut delays) = (14u32, Vec::new());
    for round in 0..6 {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        // At random between 0 and 300 ms in the first round, 1.8 s in the last.
        let moment = Duration::from_millis(u64::from(state >> 16) * 300 * (round + 1) / 65_536);
        let (stop, since) = (AtomicBool::new(false), Mutex::new(None));
        let listener = |_: &'static str, _: f64| !stop.load(Ordering::Relaxed);
        let ended = std::thread::scope(|scope| {
            scope.spawn(|| {
                std::thread::sleep(moment);
                *since.lock().unwrap() = Some(Instant::now());
                stop.store(true, Ordering::Relaxed);
            });
            let ended = job(&mesh, &options, folder.path(), Progress::new(&listener));
            (ended, Instant::now())
        });
        assert!(matches!(ended.0, Err(Error::Cancelled)), "already done after {moment:?}");
        delays.push(ended.1 - since.into_inner().unwrap().expect("it was stopped"));
        assert_eq!(names(folder.path()), [""; 0]);
    }
    assert!(delays.iter().all(|delay| *delay < MOST), "{delays:?}");
    // The median does not depend on how busy the machine is.
    delays.sort();
    assert!(delays[3] < Duration::from_millis(100), "{delays:?}");
}

#[test]
fn a_search_is_one_stage_that_rises() {
    let goal = Some(vec![Requirement::mean_angle_deg(3.0)]);
    let scan = Scan::from_mesh(wavy(48, 24), Progress::SILENT).unwrap();
    let heard = Mutex::new(Vec::new());
    let listener = |stage: &'static str, done: f64| {
        heard.lock().unwrap().push((stage, done));
        true
    };
    Baker::new(BakeOptions { goal, ..options() }).bake(scan, Progress::new(&listener)).unwrap();
    let heard = heard.into_inner().unwrap();
    let parts: Vec<f64> =
        heard.iter().filter(|(stage, _)| *stage == "search").map(|(_, done)| *done).collect();
    assert!(parts.is_sorted() && parts[0] == 0.0 && parts[parts.len() - 1] > 0.3, "{parts:?}");
    assert!(!heard.iter().any(|(stage, _)| *stage == "bake"), "candidates have no separate stages");
}

/// If a search decides against a map, the levels of detail use the vertex normals.
#[test]
fn a_search_may_have_levels_of_detail_without_a_map() {
    let wanted = BakeOptions {
        goal: Some(vec![Requirement::mean_angle_deg(3.0)]),
        lods: vec![Lod::Triangles(200), Lod::Triangles(100)],
        ..options()
    };
    let found = Baker::new(wanted).bake(small(), Progress::SILENT).unwrap();
    let counts: Vec<usize> = found.levels().map(|mesh| mesh.triangles().len()).collect();
    assert!(found.size() == [0; 2] && counts.len() == 3, "{counts:?}, {:?}", found.size());
    assert!(counts[1] <= 204 && counts[2] <= 102 && counts[0] > counts[1], "{counts:?}");
    let folder = tempfile::tempdir().unwrap();
    let written = found.write(folder.path().join("out.glb"), &Packing::default(), Progress::SILENT).unwrap();
    assert!(written.warnings().is_empty(), "{:?}", written.warnings());
    assert_eq!(taotie_io::load_levels(written.path()).unwrap().len(), 3);
    let asked = Packing { images: ImageCodec::Ktx2(0).into(), ..Packing::default() };
    let written = found.write(folder.path().join("ktx2.glb"), &asked, Progress::SILENT).unwrap();
    let said: Vec<&str> = written.warnings().iter().map(|(what, _)| what).collect();
    assert!(said.iter().any(|what| what.starts_with("the search chose the packing")), "{said:?}");
}

#[test]
fn maps_are_available_without_files() {
    let options =
        BakeOptions { maps: vec![MapKind::Normal, MapKind::Occlusion, MapKind::Height], ..options() };
    let asset = Baker::new(options).bake(small(), Progress::SILENT).unwrap();
    let inside: Vec<MapKind> = asset.textures().inside().map(|(map, _)| map).collect();
    assert_eq!(inside, [MapKind::Normal, MapKind::Occlusion], "the scan has no roughness");
    let [height]: &[SeparateMap; 1] = asset.textures().separate.as_slice().try_into().unwrap();
    let range = height.range.unwrap();
    assert!(height.map == MapKind::Height && range.white > range.black, "{range:?}");
}
