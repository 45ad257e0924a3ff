//! Files that are packed as a whole keep all their contents.

use crate::glb::Glb;
use crate::gltf_read::instanced;
use crate::{common, files};
use serde_json::{Value, json};
#[cfg(feature = "webp")]
use std::sync::Arc;
use taotie_engine::Warnings;
#[cfg(feature = "webp")]
use taotie_engine::image::Bitmap;
use taotie_engine::image::{Encoding, Sampler, Texels, Texture};
use taotie_engine::math::Mat4;
use taotie_engine::math::Vec3;
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{AlphaMode, Instance, Material, Scene, SceneData, TextureRef, UvTransform};
use taotie_io::{CodecSet, GltfPacker, GltfSource, Limits, Loaded, PackedGeometry, PackedImage, load_model};
use taotie_io::{GltfAsset, GltfFormat, GltfMaterial, encode_glb, encode_scene, encode_scene_as};
#[cfg(feature = "webp")]
use taotie_io::{ImageCodec, decode_bitmap};

/// Folders of test data with third-party glTF files.
const FOLDERS: [&str; 3] = ["khronos-gltf-sample-assets", "gltf-asset-generator", "polyhaven-models"];

/// Every corner shown by a file, in world space.
fn corners(loaded: &Loaded) -> Vec<Vec3<f64>> {
    corners_of(&loaded.scene)
}

fn corners_of(scene: &Scene) -> Vec<Vec3<f64>> {
    let of_instance = |instance: &taotie_engine::scene::Instance| {
        let mesh = &scene.meshes()[instance.mesh];
        let corner =
            |v: &u32| instance.world_from_object.transform_point(mesh.positions()[*v as usize].to_f64());
        mesh.triangles().as_flattened().iter().map(corner).collect::<Vec<_>>()
    };
    scene.instances().iter().flat_map(of_instance).collect()
}

/// The mean of points, and their mean distance from it.
fn moments(points: &[Vec3<f64>]) -> (Vec3<f64>, f64) {
    let count = points.len().max(1) as f64;
    let mean = points.iter().fold(Vec3::splat(0.0), |sum, p| sum + *p) / count;
    (mean, points.iter().map(|p| (*p - mean).length()).sum::<f64>() / count)
}

fn packed(packer: &GltfPacker, geometry: PackedGeometry, images: &[PackedImage]) -> (Vec<u8>, Loaded) {
    let (bytes, folder) = (packer.encode(geometry, images).unwrap(), tempfile::tempdir().unwrap());
    let path = folder.path().join("m.glb");
    std::fs::write(&path, &bytes).unwrap();
    (bytes, load_model(&path).unwrap())
}

fn every_file() -> impl Iterator<Item = (std::path::PathBuf, Loaded)> {
    let all = FOLDERS.into_iter().flat_map(|folder| files::data_files(folder, &["gltf", "glb"]));
    // Some are designed to be rejected.
    all.filter_map(|path| load_model(&path).ok().map(|loaded| (path, loaded)))
}

#[test]
fn all_stays_but_rounding() {
    let mut count = 0;
    for (path, own) in every_file() {
        let packer = GltfPacker::open(GltfSource::File(&path), &Limits::default()).unwrap();
        let (_, loaded) = packed(&packer, PackedGeometry::default(), &[]);
        let latest = PackedGeometry { codecs: CodecSet::WebLatest, ..PackedGeometry::default() };
        let (_, by_latest) = packed(&packer, latest, &[]);
        let name = path.display();
        assert!(corners(&loaded) == corners(&by_latest), "{name}");
        let is_packed = loaded.extensions_required.iter().any(|name| name == "EXT_meshopt_compression");
        let is_latest = by_latest.extensions_required.iter().any(|name| name == "KHR_meshopt_compression");
        assert_eq!(is_packed, is_latest, "{name}");
        assert_eq!(own.scene.materials(), loaded.scene.materials(), "{name}");
        assert_eq!(own.scene.instances().len(), loaded.scene.instances().len(), "{name}");
        assert_eq!(own.scene.textures().len(), loaded.scene.textures().len(), "{name}");
        let shape = |loaded: &Loaded| loaded.structure.as_ref().map(|s| (s.nodes, s.meshes, s.materials));
        assert_eq!(shape(&own), shape(&loaded), "{name}");
        assert_eq!((own.rig.is_some(), own.moving), (loaded.rig.is_some(), loaded.moving), "{name}");
        let (points, others) = (corners(&own), corners(&loaded));
        let ((mean, size), (other, other_size)) = (moments(&points), moments(&others));
        assert_eq!(points.len(), others.len(), "{name}");
        assert!((mean - other).length() <= 1e-4 * size, "{name}: {mean:?} {other:?} {size}");
        assert!((size - other_size).abs() <= 1e-4 * size, "{name}: {size} {other_size}");
        count += 1;
    }
    assert!(count > 60 || common::data_folder(FOLDERS[0]).is_none(), "{count}");
}

#[test]
fn fewer_triangles_stay_on_the_surface() {
    let mut count = 0;
    for (path, own) in every_file().filter(|(_, own)| own.scene.triangle_count() > 1000) {
        let packer = GltfPacker::open(GltfSource::File(&path), &Limits::default()).unwrap();
        let (_, loaded) = packed(&packer, PackedGeometry { kept: 0.5, ..PackedGeometry::default() }, &[]);
        let (triangles, all) = (loaded.scene.triangle_count(), own.scene.triangle_count());
        let name = path.display();
        assert!(triangles <= all && 2 * triangles + 100 >= all, "{name}: {triangles} of {all}");
        let [bounds, other] = [&own, &loaded].map(|loaded| loaded.scene.bounds().unwrap().diagonal());
        assert!((bounds / other - 1.0).abs() < 0.01, "{name}: {bounds} {other}");
        count += usize::from(10 * triangles <= 6 * all);
    }
    assert!(count > 3 || common::data_folder(FOLDERS[0]).is_none(), "{count}");
}

#[test]
fn what_moves_keeps_its_triangles() {
    let mut count = 0;
    for (path, own) in every_file().filter(|(_, own)| own.moving.is_some()) {
        let packer = GltfPacker::open(GltfSource::File(&path), &Limits::default()).unwrap();
        let (_, loaded) = packed(&packer, PackedGeometry { kept: 0.1, ..PackedGeometry::default() }, &[]);
        assert_eq!(own.scene.triangle_count(), loaded.scene.triangle_count(), "{}", path.display());
        let animations = own.rig.as_ref().map_or(0, |rig| rig.animations().len());
        for (animation, seconds) in (0..animations).flat_map(|i| [(i, 0.3), (i, 1.7)]) {
            let posed = |loaded: &Loaded| {
                let mut scene = loaded.scene.clone();
                loaded.rig.as_ref().unwrap().pose(&mut scene, animation, seconds).unwrap();
                moments(&corners_of(&scene))
            };
            let ((mean, size), (other, other_size)) = (posed(&own), posed(&loaded));
            let off = (mean - other).length().max((size - other_size).abs());
            assert!(off <= 5e-4 * size, "{}: {off} of {size}", path.display());
            count += 1;
        }
    }
    assert!(count > 0 || common::data_folder(FOLDERS[0]).is_none());
}

/// A file may have a shape once for each of its materials.
#[test]
fn equal_shapes_are_stored_once() {
    let bytes = |count: usize| {
        let meshes = vec![Mesh::sphere(1.0, 64, 32); count];
        let material = |i: usize| Material { roughness: 0.1 * i as f32, ..Material::default() };
        let world_from_object = |i: usize| Mat4::translation(Vec3::new(3.0 * i as f64, 0.0, 0.0));
        let instance = |i: usize| Instance { mesh: i, material: i, world_from_object: world_from_object(i) };
        let scene = SceneData {
            meshes,
            materials: (0..count).map(material).collect(),
            instances: (0..count).map(instance).collect(),
            ..SceneData::default()
        };
        let file = encode_scene(&Scene::new(scene).unwrap(), &[], &mut Warnings::default()).unwrap();
        let packer = GltfPacker::open(GltfSource::Glb(&file), &Limits::default()).unwrap();
        let (bytes, loaded) = packed(&packer, PackedGeometry { kept: 0.3, ..PackedGeometry::default() }, &[]);
        assert_eq!(loaded.scene.instances().len(), count);
        let triangles = |mesh: &Mesh| mesh.triangles().len();
        assert!(loaded.scene.meshes().iter().all(|mesh| triangles(mesh) < 2_500));
        bytes.len()
    };
    let (one, five) = (bytes(1), bytes(5));
    assert!(five < one + 2_500, "{five} of five, {one} of one");
}

/// A ball with a texture whose texels are half transparent, in a material of this mode, as GLB.
#[cfg(feature = "avif")]
fn half_clear(alpha: AlphaMode, images: ImageCodec) -> Vec<u8> {
    let texels = (0..64 * 64).map(|i| [i as u8, (i / 64) as u8 * 4, 90, 128]).collect();
    let bitmap = Bitmap::new(64, 64, 4, Texels::U8(texels)).unwrap();
    let (sampler, transform) = (Sampler::default(), UvTransform::default());
    let shown = TextureRef { texture: 0, uv_set: 0, sampler, transform };
    let material = Material { alpha, base_color_texture: Some(shown), ..Material::default() };
    let scene = SceneData {
        meshes: vec![Mesh::sphere(1.0, 16, 8)],
        materials: vec![material],
        textures: vec![Texture::new(bitmap, Encoding::Srgb)],
        instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
        ..SceneData::default()
    };
    let format = GltfFormat { images: images.into(), ..GltfFormat::default() };
    encode_scene_as(&Scene::new(scene).unwrap(), &[], &format, &mut Warnings::default()).unwrap()
}

#[cfg(feature = "avif")]
#[test]
fn alpha_that_no_material_reads_is_left_out() {
    for (mode, fits) in [(AlphaMode::Opaque, true), (AlphaMode::Blend, false)] {
        let file = half_clear(mode, ImageCodec::Png);
        let packer = GltfPacker::open(GltfSource::Glb(&file), &Limits::default()).unwrap();
        assert_eq!(packer.image(0).unwrap().fits(ImageCodec::Jpeg(90), 64), fits, "{mode:?}");
    }
}

#[cfg(feature = "avif")]
#[test]
fn an_extension_that_nothing_needs_any_more_is_not_required() {
    let opaque = Bitmap::new(64, 64, 3, Texels::U8(vec![[9, 90, 200, 255]; 64 * 64])).unwrap();
    let material = GltfMaterial { base_color_map: Some((&opaque).into()), ..GltfMaterial::default() };
    let (mesh, images) = (Mesh::sphere(1.0, 16, 8), ImageCodec::Avif(90).into());
    let levels = [&mesh];
    let asset = GltfAsset { levels: &levels, material, ..GltfAsset::default() };
    let file = encode_glb(&asset, &GltfFormat { images, ..GltfFormat::default() }).unwrap();
    let packer = GltfPacker::open(GltfSource::Glb(&file), &Limits::default()).unwrap();
    let required =
        |images: &[PackedImage]| packed(&packer, PackedGeometry::default(), images).1.extensions_required;
    let has = |required: &[String], name: &str| required.iter().any(|known| known == name);
    assert!(has(&required(&[]), "EXT_texture_avif"));
    let png = encode(&packer, 0, (64, ImageCodec::Png));
    assert!(!has(&required(&[png]), "EXT_texture_avif"));
}

#[cfg(feature = "webp")]
#[test]
fn smaller_images_are_near_the_own_ones() {
    let mut count = 0;
    for (path, _) in every_file() {
        let packer = GltfPacker::open(GltfSource::File(&path), &Limits::default()).unwrap();
        for number in 0..packer.image_count() {
            let Some(image) = packer.image(number).filter(|image| image.side() <= 512) else { continue };
            let encoded = |side: u32, codec| encode(&packer, number, (side, codec));
            let side = image.side();
            let own = image.bitmap();
            let losses = [
                (ImageCodec::WebP, 0.002),
                (ImageCodec::LossyWebP(97), 0.25),
                (ImageCodec::Jpeg(97), 0.25),
                (ImageCodec::Ktx2(0), 0.25),
            ];
            for (codec, most) in losses.into_iter().filter(|(codec, _)| image.fits(*codec, side)) {
                let error = difference(own, &encoded(side, codec));
                // 16 bits per channel are rounded to 8.
                assert!(error < most, "{}, image {number}, {codec}: {error}", path.display());
            }
            let of_half = [ImageCodec::Ktx2(2), ImageCodec::Jpeg(97), ImageCodec::WebP];
            let fitting = of_half.into_iter().find(|codec| image.fits(*codec, side.div_ceil(2))).unwrap();
            let half = encoded(side.div_ceil(2), fitting);
            assert_eq!(half.side, side.div_ceil(2));
            let (bytes, loaded) = packed(&packer, PackedGeometry::default(), &[half]);
            assert!(loaded.scene.textures().len() == packer_textures(&path) && !bytes.is_empty());
            count += 1;
        }
    }
    assert!(count > 10 || common::data_folder(FOLDERS[0]).is_none(), "{count}");
}

/// Encodes an image with `side` texels along its longer side.
#[cfg(feature = "webp")]
fn encode(packer: &GltfPacker, number: usize, (side, codec): (u32, ImageCodec)) -> PackedImage {
    let bytes = packer.image(number).unwrap().encoded(side, codec).unwrap();
    PackedImage { number, side, bytes: Arc::new(bytes) }
}

/// Returns the root mean square difference of texels, [0, 1].
#[cfg(feature = "webp")]
fn difference(own: &Bitmap, packed: &PackedImage) -> f32 {
    let other = decode_bitmap(&packed.bytes, "a packed image", std::path::Path::new("")).unwrap();
    let count = own.texels().len();
    let squared = |i: usize| {
        let [a, b] = [own.stored(i), other.stored(i)];
        (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum::<f32>() / 3.0
    };
    ((0..count).map(squared).sum::<f32>() / count as f32).sqrt()
}

#[cfg(feature = "webp")]
fn packer_textures(path: &std::path::Path) -> usize {
    load_model(path).unwrap().scene.textures().len()
}

/// Valid files stay valid.
#[cfg(feature = "webp")]
#[test]
fn packed_files_are_valid() {
    use crate::validator::assert_valid;
    let folder = tempfile::tempdir().unwrap();
    for path in files::data_files(FOLDERS[0], &["gltf", "glb"]) {
        let sound = std::panic::catch_unwind(|| assert_valid(&path));
        let Ok(Some(known)) = sound else { continue };
        let packer = GltfPacker::open(GltfSource::File(&path), &Limits::default()).unwrap();
        let codecs = [ImageCodec::Jpeg(75), ImageCodec::LossyWebP(75), ImageCodec::Ktx2(2)];
        let of = |number: usize| {
            let image = packer.image(number)?;
            let mut by_turns = codecs.into_iter().cycle().skip(number % codecs.len());
            let codec = by_turns.find(|codec| image.fits(*codec, 256)).unwrap();
            Some(encode(&packer, number, (256, codec)))
        };
        let images: Vec<PackedImage> = (0..packer.image_count()).filter_map(of).collect();
        let out = folder.path().join("m.glb");
        std::fs::write(&out, packer.encode(PackedGeometry::default(), &images).unwrap()).unwrap();
        let infos = assert_valid(&out).unwrap_or_default();
        let code = |info: &String| info.split(' ').next().unwrap_or_default().to_owned();
        let known: Vec<String> = known.iter().map(code).collect();
        let of_packing = ["UNSUPPORTED_EXTENSION", "UNUSED_OBJECT"];
        let new = infos
            .iter()
            .filter(|info| !known.contains(&code(info)) && !of_packing.contains(&code(info).as_str()));
        let new: Vec<&String> = new.collect();
        assert!(new.is_empty(), "{}: {new:#?}", path.display());
    }
}

#[test]
fn instances_stay_where_they_are() {
    let (maker, nodes) = instanced(r#"{"TRANSLATION":1,"ROTATION":2}"#, "");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, maker.text(&nodes)).unwrap();
    let own = load_model(&path).unwrap();
    let packer = GltfPacker::open(GltfSource::File(&path), &Limits::default()).unwrap();
    let (_, loaded) = packed(&packer, PackedGeometry::default(), &[]);
    assert_eq!((own.scene.instances().len(), loaded.scene.instances()), (3, own.scene.instances()));
}

/// The columns of vertices at both sides of a seam often differ by rounding.
#[test]
fn a_seam_that_rounding_splits_stays_closed() {
    let mut data = Mesh::sphere(1.0, 64, 32).into_data();
    let is_end: Vec<bool> = data.uvs[0].iter().map(|uv| uv.x == 1.0).collect();
    assert!(is_end.contains(&true));
    let ends = data.positions.iter_mut().zip(is_end).filter(|(_, is_end)| *is_end);
    ends.for_each(|(place, _)| place.z += 2e-7);
    let scene = Scene::of_mesh(Mesh::new(data).unwrap(), Material::default()).unwrap();
    let file = taotie_io::encode_scene(&scene, &[], &mut taotie_engine::Warnings::default()).unwrap();
    let packer = GltfPacker::open(GltfSource::Glb(&file), &Limits::default()).unwrap();
    for kept in [1.0, 0.3] {
        let (_, loaded) = packed(&packer, PackedGeometry { kept, ..PackedGeometry::default() }, &[]);
        let mesh = &loaded.scene.meshes()[0];
        let place = |v: u32| mesh.positions()[v as usize].to_array().map(f32::to_bits);
        let mut edges = std::collections::BTreeMap::new();
        for [a, b, c] in mesh.triangles().iter().map(|t| t.map(place)) {
            for [from, to] in [[a, b], [b, c], [c, a]].into_iter().filter(|[from, to]| from != to) {
                *edges.entry([from.min(to), from.max(to)]).or_insert(0) += 1;
            }
        }
        let open = edges.values().filter(|uses| **uses == 1).count();
        assert!(open == 0 && edges.len() > 500, "{kept}: {open} of {}", edges.len());
    }
}

/// A ball as a file whose JSON is changed, after floats are added as accessors (components, values).
fn ball_with(added: &[(&str, &[f32])], change: impl Fn(&mut Value, usize)) -> Vec<u8> {
    let scene = Scene::of_mesh(Mesh::sphere(1.0, 64, 32), Material::default()).unwrap();
    let mut glb = Glb::read(&encode_scene(&scene, &[], &mut Warnings::default()).unwrap());
    let first = glb.json["accessors"].as_array().unwrap().len();
    for (kind, values) in added {
        glb.bytes.resize(glb.bytes.len().next_multiple_of(4), 0);
        let (start, width) =
            (glb.bytes.len(), ["SCALAR", "VEC2", "VEC3", "VEC4"].iter().position(|k| k == kind));
        glb.bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
        let views = glb.json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 0, "byteOffset": start, "byteLength": 4 * values.len() }));
        let (view, count) = (views.len() - 1, values.len() / (width.unwrap() + 1));
        let accessors = glb.json["accessors"].as_array_mut().unwrap();
        accessors.push(json!({ "bufferView": view, "componentType": 5126, "count": count, "type": kind }));
    }
    glb.json["buffers"][0]["byteLength"] = glb.bytes.len().into();
    change(&mut glb.json, first);
    glb.file()
}

fn repacked(file: &[u8]) -> (Vec<u8>, Glb) {
    let packer = GltfPacker::open(GltfSource::Glb(file), &Limits::default()).unwrap();
    let bytes = packer.encode(PackedGeometry::default(), &[]).unwrap();
    let glb = Glb::read(&bytes);
    (bytes, glb)
}

#[test]
fn geometry_is_packed_under_unknown_extensions_that_name_none() {
    let own = |extension: Value| {
        ball_with(&[], |json, _| {
            json["extensionsUsed"] = json!(["VRM", "FB_ngon_encoding"]);
            json["meshes"][0]["primitives"][0]["extensions"] = json!({ "FB_ngon_encoding": {} });
            json["extensions"] = json!({ "VRM": extension });
        })
    };
    let (plain, _) = repacked(&ball_with(&[], |_, _| ()));
    for extension in [json!({ "title": "a ball" }), json!({ "bone": 7_000 })] {
        let (packed, glb) = repacked(&own(extension.clone()));
        assert!(packed.len() < plain.len() + 1_000, "{} {}", packed.len(), plain.len());
        assert_eq!(glb.json["extensions"]["VRM"], extension);
        assert!(glb.json["meshes"][0]["primitives"][0].get("extensions").is_none());
    }
    // A number that may be that of an accessor keeps it, at its place.
    let file = own(json!({ "curve": 1 }));
    let (_, glb) = repacked(&file);
    let bytes = |glb: &Glb| {
        let view =
            &glb.json["bufferViews"][glb.json["accessors"][1]["bufferView"].as_u64().unwrap() as usize];
        let [start, length] =
            ["byteOffset", "byteLength"].map(|name| view[name].as_u64().unwrap_or(0) as usize);
        glb.bytes[start..start + length].to_vec()
    };
    assert!(bytes(&glb).len() > 1_000 && bytes(&glb) == bytes(&Glb::read(&file)));
}

#[test]
fn vertices_that_extensions_refer_to_keep_their_order() {
    for place in ["primitive", "mesh"] {
        let file = ball_with(&[], |json, _| {
            json["extensionsUsed"] = json!(["CESIUM_primitive_outline"]);
            let mesh = &mut json["meshes"][0];
            let of = if place == "mesh" { mesh } else { &mut mesh["primitives"][0] };
            of["extensions"] = json!({ "CESIUM_primitive_outline": { "indices": 0 } });
        });
        let elements = |glb: &Glb| glb.accessors().into_iter().map(|(_, bytes)| bytes).collect::<Vec<_>>();
        assert_eq!(elements(&repacked(&file).1), elements(&Glb::read(&file)), "{place}");
    }
}

#[test]
fn animations_keep_their_length_and_integers() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turn = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half];
    let added: [(&str, &[f32]); 4] =
        [("SCALAR", &[0.0, 1.0]), ("VEC4", &turn), ("SCALAR", &[0.0, 10.0]), ("VEC3", &[0.0; 6])];
    let channel =
        |sampler: usize, path: &str| json!({ "sampler": sampler, "target": { "node": 0, "path": path } });
    let file = ball_with(&added, |json, first| {
        // A still translation, before the rotation ends and after it, and a boolean.
        json["animations"] = json!([{
            "channels": [channel(0, "rotation"), channel(1, "translation"), channel(2, "scale"), {
                "sampler": 3,
                "target": { "path": "pointer", "extensions": {
                    "KHR_animation_pointer": { "pointer": "/nodes/0/extensions/KHR_node_visibility/visible" } } },
            }],
            "samplers": [
                { "input": first, "output": first + 1 }, { "input": first + 2, "output": first + 3 },
                { "input": first, "output": first + 4 },
                { "input": first, "output": first + 5, "interpolation": "STEP" },
            ],
        }]);
        json["extensionsUsed"] = json!(["KHR_animation_pointer"]);
        let accessors = json["accessors"].as_array_mut().unwrap();
        let mut scale = accessors[first + 3].clone();
        scale["count"] = 2.into();
        accessors.push(scale);
        let mut visible = accessors[first].clone();
        visible["componentType"] = 5121.into();
        accessors.push(visible);
    });
    let (bytes, glb) = repacked(&file);
    let accessor = |number: &Value| &glb.json["accessors"][number.as_u64().unwrap() as usize];
    let samplers = glb.json["animations"][0]["samplers"].as_array().unwrap();
    assert!(samplers.iter().any(|sampler| accessor(&sampler["output"])["componentType"] == 5121));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.glb");
    std::fs::write(&path, bytes).unwrap();
    let rig = load_model(&path).unwrap().rig.unwrap();
    assert_eq!(rig.animations()[0].seconds(), 10.0);
}

/// The buffer that packed views unpack to may name a file, which only programs without a decoder need.
#[test]
fn a_missing_fallback_buffer_is_not_needed() {
    let (file, mut glb) = repacked(&ball_with(&[], |_, _| ()));
    let (expected, _) = repacked(&file);
    let buffer = glb.json["buffers"].as_array_mut().unwrap().last_mut().unwrap();
    assert!(buffer["extensions"].to_string().contains("fallback"), "{buffer}");
    buffer["uri"] = "absent.bin".into();
    let (again, found) = repacked(&glb.file());
    assert!(found.json["buffers"].as_array().unwrap().iter().all(|buffer| buffer.get("uri").is_none()));
    assert!(again == expected);
}
