//! A scene that is written as glTF reads back unchanged.

use crate::{common, files, rich};
use std::path::{Path, PathBuf};
use taotie_engine::Warnings;
use taotie_engine::image::{Bitmap, Encoding, Sampler, Texels, Texture};
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{
    Camera, Classic, Falloff, GreenChannel, Instance, Light, LightKind, Material, NormalMap, NormalSpace,
    Projection, Scene, SceneData, TextureRef, UvTransform,
};
use taotie_io::{
    GltfFormat, ImageCodec, decode_bitmap, encode_jpeg_bitmap, encode_scene_as, load_model, write_scene,
};

/// The error of rounding to 32 bits and of a product of two rounded numbers, relative to the largest number.
const ROUNDING: f64 = 1e-6;

/// Writes a scene and reads it back; also returns the warnings of both.
fn back(scene: &Scene, path: &Path) -> (Scene, Warnings, Warnings) {
    let written = write_scene(path, scene, &GltfFormat::default()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(written.files[0], path);
    assert!(written.files.iter().all(|file| file.exists()));
    let loaded = load_model(path).unwrap_or_else(|e| panic!("{e}"));
    (loaded.scene, written.warnings, loaded.warnings)
}

fn close(a: &[f64], b: &[f64]) -> bool {
    let size = a.iter().chain(b).fold(0.0f64, |most, v| most.max(v.abs()));
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= ROUNDING * size)
}

fn assert_near(what: &str, a: &[f32], b: &[f32]) {
    if a == b {
        return;
    }
    let wide = |v: &[f32]| v.iter().map(|v| f64::from(*v)).collect::<Vec<_>>();
    assert!(close(&wide(a), &wide(b)), "{what}: {a:?} and {b:?}");
}

fn assert_same_place(a: &Mat4, b: &Mat4) {
    assert!(close(a.columns.as_flattened(), b.columns.as_flattened()), "{a:?} and {b:?}");
}

/// Compares corner by corner, since unused vertices are not read.
fn assert_same_mesh(a: &Mesh, b: &Mesh) {
    let corners =
        |mesh: &Mesh| mesh.triangles().as_flattened().iter().map(|v| *v as usize).collect::<Vec<_>>();
    let (at, bt) = (corners(a), corners(b));
    assert_eq!(at.len(), bt.len());
    assert_eq!((a.uvs().len(), a.colors().is_empty()), (b.uvs().len(), b.colors().is_empty()));
    assert_eq!(
        (a.normals().is_empty(), a.tangents().is_empty()),
        (b.normals().is_empty(), b.tangents().is_empty())
    );
    for (i, j) in at.into_iter().zip(bt) {
        assert_eq!(a.positions()[i], b.positions()[j]);
        let (uv, colors) = (a.uvs().iter().map(|uvs| uvs[i]), (a.colors().get(i), b.colors().get(j)));
        assert!(uv.eq(b.uvs().iter().map(|uvs| uvs[j])) && colors.0 == colors.1);
        if let (Some(a), Some(b)) = (a.normals().get(i), b.normals().get(j)) {
            assert_near("normals", &a.to_array(), &b.to_array());
        }
        if let (Some(a), Some(b)) = (a.tangents().get(i), b.tangents().get(j)) {
            assert_near("tangents", a, b);
        }
    }
}

/// Compares texel by texel; green is flipped if it pointed down.
fn assert_same_texture(a: &Texture, b: &Texture, turned: bool) {
    assert_eq!((a.width(), a.height(), a.encoding()), (b.width(), b.height(), b.encoding()));
    for y in 0..a.height() as usize {
        for x in 0..a.width() as usize {
            let [r, g, blue, alpha] = a.texel(0, x, y);
            let green = if turned { 1.0 - g } else { g };
            assert_near("texels", &[r, green, blue, alpha], &b.texel(0, x, y));
        }
    }
}

/// The properties of a material that glTF can express, without textures.
fn sayable(material: &Material) -> Material {
    let mut plain = material.clone();
    plain.retain_textures(|_| false);
    Material { f0: None, f82: None, classic: Classic::default(), height: None, ..plain }
}

fn assert_same_material(a: (&Scene, &Material), b: (&Scene, &Material)) {
    let (mut plain, read) = (sayable(a.1), sayable(b.1));
    if plain.name.is_empty() {
        plain.name.clone_from(&read.name);
    }
    assert_near("emission", &plain.emissive, &read.emissive);
    plain.emissive = read.emissive;
    assert_eq!(plain, read);
    let maps = |material: &Material| {
        let mut said = Material { height: None, ..material.clone() };
        said.normal = said.normal.filter(|map| map.space == NormalSpace::Tangent);
        said.textures()
    };
    let scale =
        |material: &Material| material.normal.filter(|m| m.space == NormalSpace::Tangent).map(|m| m.scale);
    assert_eq!(scale(a.1), scale(b.1));
    let (ours, theirs) = (maps(a.1), maps(b.1));
    assert_eq!(ours.len(), theirs.len(), "{}", a.1.name);
    let down = a.1.normal.filter(|map| map.green == GreenChannel::Down).map(|map| map.texture.texture);
    for (ours, theirs) in ours.iter().zip(&theirs) {
        assert_same_use(ours, theirs);
        let (a, b) = (&a.0.textures()[ours.texture], &b.0.textures()[theirs.texture]);
        assert_same_texture(a, b, a.encoding() == Encoding::Normal && down == Some(ours.texture));
    }
}

fn assert_same_use(a: &TextureRef, b: &TextureRef) {
    assert_eq!((a.uv_set, a.sampler), (b.uv_set, b.sampler));
    assert_near("uv transform", a.transform.linear.as_flattened(), b.transform.linear.as_flattened());
    assert_near("uv offset", &a.transform.offset, &b.transform.offset);
}

fn assert_same_light(a: &Light, b: &Light) {
    let parts = |light: &Light| match light.kind {
        LightKind::Point { position } => (position, Vec3::splat(0.0), [0.0; 2]),
        LightKind::Directional { direction } => (Vec3::splat(0.0), direction, [0.0; 2]),
        LightKind::Spot { position, direction, inner, outer } => {
            (position, direction, [inner, outer].map(|angle| angle as f32))
        }
    };
    assert_eq!((&a.name, std::mem::discriminant(&a.kind)), (&b.name, std::mem::discriminant(&b.kind)));
    let ((a_at, a_to, a_cone), (b_at, b_to, b_cone)) = (parts(a), parts(b));
    assert_near("light's place", &a_at.to_array(), &b_at.to_array());
    assert_near("light's direction", &a_to.to_array(), &b_to.to_array());
    assert_near("light's cone", &a_cone, &b_cone);
    assert_near("light's colour", &a.color.to_array(), &b.color.to_array());
    let windowed = |light: &Light| matches!(light.falloff, Falloff::Windowed(_));
    assert!(windowed(a) == windowed(b) && (!windowed(a) || a.falloff == b.falloff));
}

fn assert_same_camera(a: &Camera, b: &Camera) {
    let numbers = |camera: &Camera| match camera.projection {
        Projection::Perspective { fov_y, aspect, near, far } => {
            [fov_y, aspect.unwrap_or(0.0), near, far.unwrap_or(0.0)]
        }
        Projection::Orthographic { half_width, half_height, near, far } => {
            [half_width, half_height, near, far]
        }
    };
    assert_eq!(a.name, b.name);
    assert_same_place(&a.world_from_view, &b.world_from_view);
    assert!(numbers(a).iter().zip(numbers(b)).all(|(a, b)| close(&[*a], &[b])), "{a:?} and {b:?}");
}

fn assert_same_scene(a: &Scene, b: &Scene) {
    assert_eq!(a.instances().len(), b.instances().len());
    let mut compared: Vec<[usize; 2]> = Vec::new();
    for (ours, theirs) in a.instances().iter().zip(b.instances()) {
        assert_same_place(&ours.world_from_object, &theirs.world_from_object);
        if compared.contains(&[ours.mesh, ours.material]) {
            continue;
        }
        compared.push([ours.mesh, ours.material]);
        assert_same_mesh(&a.meshes()[ours.mesh], &b.meshes()[theirs.mesh]);
        assert_same_material((a, &a.materials()[ours.material]), (b, &b.materials()[theirs.material]));
    }
    assert_eq!((a.lights().len(), a.cameras().len()), (b.lights().len(), b.cameras().len()));
    a.lights().iter().zip(b.lights()).for_each(|(a, b)| assert_same_light(a, b));
    a.cameras().iter().zip(b.cameras()).for_each(|(a, b)| assert_same_camera(a, b));
}

#[test]
fn all_that_gltf_can_say_is_read_as_it_was() {
    let (scene, folder) = (rich::scene(), tempfile::tempdir().unwrap());
    for name in ["a.glb", "a scene.gltf"] {
        let (read, unsaid, wrong) = back(&scene, &folder.path().join(name));
        assert!(unsaid.is_empty() && wrong.is_empty(), "{unsaid:?} {wrong:?}");
        assert_same_scene(&scene, &read);
        let (again, ..) = back(&read, &folder.path().join("again.glb"));
        assert_same_scene(&read, &again);
    }
}

#[test]
fn a_packed_scene_stands_where_it_stood() {
    let (scene, folder) = (rich::scene(), tempfile::tempdir().unwrap());
    let path = folder.path().join("packed.glb");
    let format = GltfFormat { meshopt: true, ..GltfFormat::default() };
    write_scene(&path, &scene, &format).unwrap();
    let read = load_model(&path).unwrap().scene;
    assert_eq!(scene.triangle_count(), read.triangle_count());
    let (a, b) = (scene.bounds().unwrap(), read.bounds().unwrap());
    // Grid steps are 1/65535 of a mesh, and half a step for bounds of rotated ones.
    assert!((a.min - b.min).length() + (a.max - b.max).length() < 1e-4 * a.diagonal(), "{a:?} {b:?}");
}

#[test]
fn what_gltf_cannot_say_is_counted() {
    let mut scene = rich::scene();
    scene
        .edit(|scene| {
            let material = &mut scene.materials[0];
            material.f0 = Some([0.9; 3]);
            material.classic.shininess = Some(8.0);
            material.normal.as_mut().unwrap().space = NormalSpace::Object;
            scene.lights[1].falloff = Falloff::None;
            scene.meshes.push(Mesh::sphere(1.0, 4, 3));
            scene.instances[0].world_from_object.columns[1][0] = 0.5;
        })
        .unwrap();
    let folder = tempfile::tempdir().unwrap();
    let (.., unsaid, _) = back(&scene, &folder.path().join("a.glb"));
    let counted =
        |part: &str| unsaid.iter().filter(|(what, _)| what.contains(part)).map(|(_, n)| n).sum::<usize>();
    let parts = [
        "reflectance",
        "classic",
        "object-space",
        "distance falloff",
        "without triangles or instances",
        "sheared",
    ];
    assert_eq!(parts.map(counted), [1; 6], "{unsaid:?}");
}

#[test]
fn a_scene_that_shows_nothing_is_refused() {
    let path = PathBuf::from("never-written.glb");
    let why = |scene: &Scene, path: &Path| {
        write_scene(path, scene, &GltfFormat::default()).unwrap_err().to_string()
    };
    assert!(why(&Scene::default(), &path).contains("no triangle"));
    assert!(why(&rich::scene(), Path::new("a.obj")).contains(".glb or .gltf"));
    let far = Mat4::translation(Vec3::new(1e300, 0.0, 0.0));
    let mut scene = rich::scene();
    scene.edit(|scene| scene.instances[0].world_from_object = far).unwrap();
    assert!(why(&scene, &path).contains("32-bit"));
}

/// Third-party models that are small enough to be compared texel by texel.
fn models() -> Vec<PathBuf> {
    const LARGEST: u64 = 300_000;
    let folders = ["khronos-gltf-sample-assets", "gltf-asset-generator"];
    let folders = folders.into_iter().filter_map(common::data_folder);
    let files = folders.flat_map(|folder| files::files_below(&folder, &["glb", "gltf", "obj"]));
    let small = |path: &PathBuf| std::fs::metadata(path).is_ok_and(|file| file.len() < LARGEST);
    files.filter(small).collect()
}

fn is_small(scene: &Scene) -> bool {
    let texels = |texture: &Texture| u64::from(texture.width()) * u64::from(texture.height());
    scene.textures().iter().map(texels).sum::<u64>() < 1 << 18 && scene.triangle_count() < 50_000
}

#[test]
fn models_of_others_are_read_as_they_were() {
    let (folder, mut compared) = (tempfile::tempdir().unwrap(), 0);
    let models = models();
    for path in &models {
        let Ok(loaded) = load_model(path) else { continue };
        // Shown faceted, meshes have a different number of vertices; `warnings` report that.
        if is_small(&loaded.scene) && loaded.scene.meshes().iter().all(|mesh| !mesh.normals().is_empty()) {
            let (read, ..) = back(&loaded.scene, &folder.path().join("a.glb"));
            assert_same_scene(&loaded.scene, &read);
            compared += 1;
        }
    }
    assert!(compared > 0 || models.is_empty(), "none of {} models is small", models.len());
}

#[test]
fn a_mesh_shown_in_two_materials_shares_its_numbers() {
    let scene = rich::scene();
    let mut data = SceneData { lights: Vec::new(), cameras: Vec::new(), ..scene.into_data() };
    data.instances = vec![Instance { mesh: 0, material: 1, world_from_object: Mat4::IDENTITY }];
    let folder = tempfile::tempdir().unwrap();
    let size = |data: &SceneData, name: &str| {
        let path = folder.path().join(name);
        let (read, ..) = back(&Scene::new(data.clone()).unwrap(), &path);
        assert_eq!(read.instances().len(), data.instances.len());
        std::fs::metadata(path).unwrap().len()
    };
    let one = size(&data, "one.glb");
    data.materials.push(Material {
        name: "another".into(),
        base_color_texture: None,
        ..data.materials[1].clone()
    });
    data.instances.push(Instance { material: data.materials.len() - 1, ..data.instances[0] });
    assert!(size(&data, "two.glb") < one + 2000);
}

/// Returns a JPEG, and the same one with metadata, and with bytes after its end.
fn jpegs() -> [Vec<u8>; 2] {
    let texels = (0..4096u32).map(|i| [(i % 64) as u8, (i / 64) as u8, 255, 255]).collect();
    let plain = encode_jpeg_bitmap(&Bitmap::new(64, 64, 3, Texels::U8(texels)).unwrap(), 90).unwrap();
    let metadata = b"\xff\xe1\0\x0eExif\0\0secret";
    let (start, rest) = plain.split_at(2);
    let with_metadata = [start, metadata, rest, b"secret"].concat();
    [plain, with_metadata]
}

#[test]
fn a_page_stores_the_files_of_textures_without_their_metadata() {
    let [plain, file] = jpegs();
    let bitmap = decode_bitmap(&file, "a.jpg", Path::new("a.jpg")).unwrap();
    let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default()).unwrap();
    let texture = scene.add_texture(Texture::new(bitmap, Encoding::Normal));
    let used =
        TextureRef { texture, uv_set: 0, sampler: Sampler::default(), transform: UvTransform::default() };
    let glb = |green: GreenChannel, for_page: bool| {
        let mut shown = scene.clone();
        let map = NormalMap { texture: used, scale: 1.0, green, space: NormalSpace::Tangent };
        shown.edit(|data| data.materials[0].normal = Some(map)).unwrap();
        let format = GltfFormat { images: ImageCodec::WebP.into(), for_page, ..GltfFormat::default() };
        encode_scene_as(&shown, &[], &format, &mut Warnings::default()).unwrap()
    };
    let holds = |glb: &[u8], part: &[u8]| glb.windows(part.len()).any(|found| found == part);
    let page = glb(GreenChannel::Up, true);
    assert!(holds(&page, &plain) && holds(&page, b"image/jpeg") && !holds(&page, b"secret"));
    for changed in [glb(GreenChannel::Down, true), glb(GreenChannel::Up, false)] {
        assert!(!holds(&changed, &plain) && holds(&changed, b"image/webp"));
    }
}
