//! Faults of scans that an artist would see: each is noted, with its place and share, and a sound twin is not.

use crate::files::data_files;
use crate::modelled::{askew, loose, nut, welded};
use crate::pairs::first_texture;
use taotie::Limits;
use taotie::asset::{Asset, BakeOptions, Baker, Packing, Requirement, Scan, ScanFile, ScanOptions};
use taotie::studio::{self, MaterialFactors, MaterialOptions};
use taotie_engine::Progress;
use taotie_engine::image::{Bitmap, Encoding, Texels, Texture};
use taotie_engine::math::{Mat4, Vec3, scalar};
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{
    GreenChannel, Instance, Material, NormalMap, NormalSpace, Scene, SceneData, TextureRef,
};
use taotie_io::{GltfFormat, load_model, write_scene};

fn read(scene: Scene, options: ScanOptions) -> Scan {
    ScanFile::from_scene(scene).unwrap().with_options(options).into_scan(Progress::SILENT).unwrap()
}

fn read_mesh(mesh: Mesh) -> Scan {
    read(Scene::of_mesh(mesh, Material::default()).unwrap(), ScanOptions::default())
}

fn warned(scan: &Scan) -> String {
    scan.warnings().iter().map(|(what, _)| format!("{what}\n")).collect()
}

/// Returns the coordinates of the place in a warning.
fn place(text: &str) -> Vec3<f64> {
    let (_, rest) = text.split_once("around (").expect(text);
    let (numbers, _) = rest.split_once(')').expect(text);
    let numbers: Vec<f64> = numbers.split(", ").map(|number| number.parse().expect(text)).collect();
    Vec3::new(numbers[0], numbers[1], numbers[2])
}

/// A ball about (2, 0, 0) in which triangles with a centroid near (3, 0, 0) are reversed.
fn patched_ball(normals: bool, reversed: bool) -> Mesh {
    let ball = Mesh::sphere(1.0, 60, 30);
    let mut data = ball.clone().into_data();
    data.positions
        .iter_mut()
        .for_each(|p| *p = (*p * 65536.0).map(|v| v.round() / 65536.0) + Vec3::new(2.0, 0.0, 0.0));
    let middle = |t: &[u32; 3]| {
        t.iter().fold(Vec3::splat(0.0), |sum, v| sum + data.positions[*v as usize].to_f64() / 3.0)
    };
    let near = |t: &[u32; 3]| reversed && (middle(t) - Vec3::new(3.0, 0.0, 0.0)).length() < 0.25;
    data.triangles = data.triangles.iter().map(|t| if near(t) { [t[0], t[2], t[1]] } else { *t }).collect();
    data.uvs.clear();
    if !normals {
        data.normals.clear();
    }
    Mesh::new(data).unwrap()
}

#[test]
fn reversed_triangles_are_turned_and_noted() {
    for normals in [false, true] {
        let sound = read_mesh(patched_ball(normals, false));
        assert!(sound.warnings().is_empty(), "{}", warned(&sound));
        let turned = read_mesh(patched_ball(normals, true));
        let text = warned(&turned);
        assert!(text.starts_with("reversed winding of some triangles of the scan, flipped"), "{text}");
        assert!((place(&text) - Vec3::new(3.0, 0.0, 0.0)).length() < 0.1, "{text}");
        assert!(["1.4 % ", "1.5 % ", "1.6 % "].iter().any(|share| text.contains(share)), "{text}");
        let corners = |scan: &Scan| -> Vec<[Vec3; 3]> {
            (0..scan.mesh().triangles().len()).map(|t| scan.mesh().corners(t)).collect()
        };
        let same_way = corners(&sound).iter().zip(corners(&turned)).all(|(a, b)| *a == b);
        assert!(same_way, "the scan is as if nothing had been reversed");
        assert_eq!(sound.mesh().normals(), turned.mesh().normals());
    }
}

/// Flat-shaded, so that the reversed triangles have separate normals, which point inward.
#[test]
fn facets_that_were_reversed_are_turned_with_their_normals() {
    let mut facets = askew(nut(48));
    for facet in &mut facets[20..25] {
        facet.corners.swap(1, 2);
    }
    let scan = read_mesh(loose(&facets));
    let text = warned(&scan);
    assert!(text.contains("flipped to match neighbours: 5 triangles"), "{text}");
    assert!(!text.contains("contradict"), "{text}");
    let sound = read_mesh(loose(&askew(nut(48))));
    let corners = |scan: &Scan, t: usize| scan.mesh().corners(t);
    assert!((0..facets.len()).all(|t| corners(&scan, t) == corners(&sound, t)));
}

#[test]
fn halves_that_face_different_ways_are_noted_and_stay() {
    let ball = patched_ball(false, false);
    let mut data = ball.clone().into_data();
    let half = data.triangles.len() * 2 / 5;
    data.triangles[..half].iter_mut().for_each(|t| t.swap(1, 2));
    let given = Mesh::new(data).unwrap();
    let scan = read_mesh(given.clone());
    let text = warned(&scan);
    assert!(
        text.contains("parts of the scan face opposite ways") && text.contains("% of its surface"),
        "{text}"
    );
    let stays = |t: usize| scan.mesh().corners(t) == given.corners(t);
    assert!((0..given.triangles().len()).all(stays));
}

#[test]
fn normals_that_contradict_the_triangles_are_noted() {
    let ball = Mesh::sphere(1.0, 60, 30);
    assert!(read_mesh(ball.clone()).warnings().is_empty());
    let with = |is_turned: &dyn Fn(Vec3) -> bool| {
        let mut data = ball.clone().into_data();
        data.normals = data.normals.iter().map(|n| if is_turned(*n) { -*n } else { *n }).collect();
        warned(&read_mesh(Mesh::new(data).unwrap()))
    };
    let part = with(&|n| n.y > 0.8);
    assert!(part.starts_with("normals of the scan contradict its triangles, by more than 90°: "), "{part}");
    assert!((place(&part) - Vec3::new(0.0, 1.0, 0.0)).length() < 0.6 && part.contains("recompute"), "{part}");
    assert!(with(&|_| true).contains("inside out"));
}

/// Bumps as a normal map whose green points up or down.
fn bumps(green: GreenChannel) -> Bitmap {
    let side = 256u32;
    let sign = if green == GreenChannel::Up { 1.0 } else { -1.0 };
    let texel = |i: u32| {
        let (u, v) = (f64::from(i % side) * 0.2, f64::from(i / side) * 0.2);
        // The height is sin u · sin v, and v runs down the image.
        let normal = Vec3::new(
            -0.3 * scalar::cos(u) * scalar::sin(v),
            sign * 0.3 * scalar::sin(u) * scalar::cos(v),
            1.0,
        )
        .normalize();
        let [r, g, b] = normal.to_array().map(|c| (c * 127.5 + 127.5).round() as u8);
        [r, g, b, 255]
    };
    Bitmap::new(side, side, 3, Texels::U8((0..side * side).map(texel).collect())).unwrap()
}

/// A ball with a normal map whose green points up according to its file.
fn mapped_ball(pixels: GreenChannel) -> Scene {
    let texture = first_texture();
    let normal = NormalMap { texture, scale: 1.0, space: NormalSpace::Tangent, green: GreenChannel::Up };
    Scene::new(SceneData {
        meshes: vec![Mesh::sphere(1.0, 24, 12)],
        materials: vec![Material { name: "clay".into(), normal: Some(normal), ..Material::default() }],
        textures: vec![Texture::new(bumps(pixels), Encoding::Normal)],
        instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
        ..SceneData::default()
    })
    .unwrap()
}

/// Returns the normals of a scan at its triangles' centroids, including its maps.
fn shown_normals(scan: &Scan) -> Vec<Vec3> {
    let mesh = scan.mesh();
    let at = |t: usize| {
        let point = taotie_engine::mesh::Point { triangle: t as u32, weights: [0.2, 0.3, 0.5] };
        let lookup = taotie_engine::bake::LookupPoint::finest(point);
        scan.sorted().surface().normal(lookup, point.normal(mesh)).normal
    };
    (0..mesh.triangles().len()).map(at).collect()
}

#[test]
fn a_green_down_map_is_read_as_such_and_noted() {
    let with = |pixels, green| read(mapped_ball(pixels), ScanOptions { green, ..ScanOptions::default() });
    let (up, down) = (with(GreenChannel::Up, None), with(GreenChannel::Down, None));
    assert!(up.warnings().is_empty(), "{}", warned(&up));
    let text = warned(&down);
    assert!(text.starts_with("normal map of the scan with green pointing down (DirectX), 9"), "{text}");
    assert!(text.contains("% sure") && text.contains("clay"), "{text}");
    // The maps differ by one code where a half is rounded.
    let differ = |a: &Scan, b: &Scan| {
        let pairs = shown_normals(a).into_iter().zip(shown_normals(b));
        pairs.map(|(a, b)| f64::from((a - b).length())).fold(0.0, f64::max)
    };
    assert!(differ(&up, &down) < 0.02, "both show the same relief");
    assert!(differ(&up, &with(GreenChannel::Down, Some(GreenChannel::Up))) > 0.2);
    assert!(with(GreenChannel::Down, Some(GreenChannel::Down)).warnings().is_empty());
    assert!(differ(&up, &with(GreenChannel::Up, Some(GreenChannel::Down))) > 0.2);
}

#[test]
fn a_direction_of_green_without_a_map_is_noted() {
    let scene = Scene::of_mesh(Mesh::sphere(1.0, 24, 12), Material::default()).unwrap();
    let scan = read(scene, ScanOptions { green: Some(GreenChannel::Down), ..ScanOptions::default() });
    assert!(warned(&scan).contains("the direction of green has no effect"), "{}", warned(&scan));
}

#[test]
fn shared_scans_have_none_of_these_faults() {
    let files = [("odedstein-meshes", "obj"), ("threedscans-keijiro", "obj"), ("polyhaven-models", "gltf")];
    for path in files.iter().flat_map(|(sub, extension)| data_files(sub, &[*extension])) {
        let scan = read(taotie_io::load_model(&path).unwrap().scene, ScanOptions::default());
        let text = warned(&scan);
        println!("{}: {text}", path.display());
        let faults = ["green pointing down", "contradict", "opposite ways"];
        assert!(!faults.iter().any(|fault| text.contains(fault)), "{}: {text}", path.display());
    }
}

#[test]
fn a_crease_angle_out_of_range_is_refused() {
    let options = ScanOptions { crease_angle_deg: Some(200.0), ..ScanOptions::default() };
    let scene = Scene::of_mesh(welded(&nut(24)), Material::default()).unwrap();
    let refused = ScanFile::from_scene(scene).unwrap().with_options(options).into_scan(Progress::SILENT);
    assert!(refused.unwrap_err().to_string().contains("between 0 and 180"));
}

/// A ball with a texture of 128 texels across, and a material with it.
fn textured(texel: fn(u32) -> [u8; 4], encoding: Encoding, material: fn(TextureRef) -> Material) -> Scene {
    let texture = first_texture();
    let bitmap = Bitmap::new(128, 128, 3, Texels::U8((0..128 * 128).map(texel).collect())).unwrap();
    Scene::new(SceneData {
        meshes: vec![Mesh::sphere(1.0, 48, 24)],
        materials: vec![material(texture)],
        textures: vec![Texture::new(bitmap, encoding)],
        instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
        ..SceneData::default()
    })
    .unwrap()
}

/// Returns the smallest asset of a scan whose normals are off by at most a degree.
fn smallest(scan: ScanFile) -> Asset {
    let options =
        BakeOptions { goal: Some(vec![Requirement::mean_angle_deg(1.0)]), ..BakeOptions::default() };
    Baker::new(options).bake(scan.into_scan(Progress::SILENT).unwrap(), Progress::SILENT).unwrap()
}

/// A packed scan is not its file if its materials were changed since.
#[test]
fn an_edited_scan_is_packed_as_edited() {
    let (folder, limits) = (tempfile::tempdir().unwrap(), Limits::default());
    let path = folder.path().join("scan.glb");
    let waves = |i: u32| {
        let wave = |v: u32| (100.0 + 80.0 * scalar::sin(f64::from(v) * 0.2)) as u8;
        [wave(i % 128), wave(i / 128), 90, 255]
    };
    let scene = textured(waves, Encoding::Srgb, |texture| Material {
        base_color_texture: Some(texture),
        roughness: 0.7,
        ..Material::default()
    });
    write_scene(&path, &scene, &GltfFormat::default()).unwrap();
    let factors = MaterialFactors { roughness: Some(0.2), ..MaterialFactors::default() };
    let edited = MaterialOptions { factors, ..MaterialOptions::default() };
    for (options, roughness) in [(MaterialOptions::default(), 0.7), (edited, 0.2)] {
        let loaded = studio::load(&path, &options, &limits).unwrap();
        let asset = smallest(ScanFile::from_loaded(loaded, &path, &limits).unwrap());
        assert!(asset.trials().iter().any(|trial| trial.is_scan && trial.is_near), "{:?}", asset.trials());
        assert!(asset.origin().is_scan, "{:?}", asset.trials());
        let out = folder.path().join("out.glb");
        let written = asset.write(out, &Packing::default(), Progress::SILENT).unwrap();
        let packed = load_model(written.path()).unwrap();
        assert!((packed.scene.materials()[0].roughness - roughness).abs() < 1e-6, "{roughness}");
    }
}

/// A packed scan is not its file either if green of its normal map points down, which glTF does not allow.
#[test]
fn a_scan_with_green_pointing_down_is_packed_with_green_pointing_up() {
    let (folder, limits) = (tempfile::tempdir().unwrap(), Limits::default());
    let path = folder.path().join("scan.glb");
    let scene = textured(
        |_| [128, 192, 238, 255],
        Encoding::Normal,
        |texture| {
            let (space, green) = (NormalSpace::Tangent, GreenChannel::Up);
            let normal = Some(NormalMap { texture, scale: 1.0, space, green });
            Material { normal, base_color: [0.8, 0.1, 0.1, 1.0], ..Material::default() }
        },
    );
    write_scene(&path, &scene, &GltfFormat::default()).unwrap();
    for green in [GreenChannel::Up, GreenChannel::Down] {
        let options = ScanOptions { green: Some(green), ..ScanOptions::default() };
        let asset = smallest(ScanFile::read(&path, &limits, Progress::SILENT).unwrap().with_options(options));
        let packed = asset.trials().iter().filter(|trial| trial.is_scan).map(|trial| trial.mean_angle);
        assert!(packed.fold(f64::INFINITY, f64::min) < 1.0, "{green:?}: {:?}", asset.trials());
    }
}
