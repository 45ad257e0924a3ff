//! Small valid files of every format, damaged in fixed pseudo-random ways: a reader gives a result or an error, and
//! never panics. `crates/taotie-fuzz` searches further.

use crate::damage::{Dice, damage};
use std::io::Cursor;
use std::path::Path;
use taotie_io::{Loaded, decode_bitmap, load_model};

/// Number of times that each seed is damaged.
const ROUNDS: usize = 200;

/// Loads damaged copies of `seed`, put into a folder as `damaged` next to `model`, which may be the same.
fn torment(model: &str, text: &[u8], damaged: &str, seed: &[u8]) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(model);
    std::fs::write(&path, text).expect("a file");
    std::fs::write(folder.path().join(damaged), seed).expect("a file");
    let sound = load_model(&path).unwrap_or_else(|e| panic!("the seed itself must be valid: {e}"));
    assert!(sound.warnings.iter().all(|(what, _)| !what.contains("channels")), "{:?}", sound.warnings);
    let mut dice = Dice(1);
    for round in 0..ROUNDS {
        let bytes = damage(seed, &mut dice);
        std::fs::write(folder.path().join(damaged), &bytes).expect("a file");
        match load_model(&path) {
            Ok(loaded) => {
                let scene = &loaded.scene;
                assert!(scene.instances().iter().all(|i| i.mesh < scene.meshes().len()), "round {round}");
                assert!(
                    scene.instances().iter().all(|i| i.material < scene.materials().len()),
                    "round {round}"
                );
                scene.bounds();
                pose(loaded);
            }
            Err(e) => assert!(!e.to_string().contains('\n'), "round {round}: {e}"),
        }
    }
}

/// Poses at several times give a scene or an error.
fn pose(mut loaded: Loaded) {
    let Some(rig) = loaded.rig else { return };
    for animation in 0..rig.animations().len() {
        for seconds in [-1.0, 0.5, 1e30, f64::NAN] {
            let _ = rig.pose(&mut loaded.scene, animation, seconds);
        }
    }
}

fn torment_alone(name: &str, seed: &[u8]) {
    torment(name, seed, name, seed);
}

const OBJ: &str = "mtllib a.mtl\no x\nv 0 0 0 .1 .2 .3\nv 1 0 0\nv 1 1 0 1\nv 0 1 0\nv .5 .5 1\nvt 0 0\nvt 1 0\nvt 1 1\n\
    vn 0 0 1\nusemtl m\nf 1/1/1 2/2/1 3/3/1\nf -5//1 -4//-1 -3//1 -2//1\nf 1 2 3 \\\n 4 5\ns 1\np 1\nl 1 2\n";
const MTL: &str = "newmtl m\nKa .1 .1 .1\nKd .5 .5 .5\nKs 1\nNs 20\nKe 0 0 0\nd .9\nTr .1\nPr .3\nPm .4\n\
    map_Kd -s 1 2 3 -o .1 -mm 0 1 a.png\nmap_Bump -bm 2 -imfchan g a.png\nnorm a.png\nmap_Pr a.png\n\
    map_Pm -clamp on a.png\nmap_d a.png\nmap_Ke a.png\n";

#[test]
fn damaged_obj_and_mtl() {
    torment_alone("a.obj", OBJ.as_bytes());
    torment("a.obj", OBJ.as_bytes(), "a.mtl", MTL.as_bytes());
    let utf16: Vec<u8> = OBJ.encode_utf16().flat_map(u16::to_le_bytes).collect();
    torment_alone("a.obj", &utf16);
}

const PLY: &str = "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 4\nproperty float x\nproperty float y\n\
    property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n\
    property list uchar int vertex_indices\nproperty list uchar float texcoord\nelement tristrips 1\n\
    property list int int vertex_indices\nend_header\n0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 1 2 3\n\
    4 0 1 2 3 8 0 0 1 0 1 1 0 1\n3 0 1 2 6 0 0 1 0 1 1\n5 0 1 2 -1 3\n";

#[test]
fn damaged_ply() {
    torment_alone("a.ply", PLY.as_bytes());
    for (format, big) in [("binary_little_endian", false), ("binary_big_endian", true)] {
        let end = PLY.find("end_header\n").expect("a header") + 11;
        let mut bytes = PLY[..end].replace("ascii", format).into_bytes();
        let float = |v: f32| if big { v.to_be_bytes() } else { v.to_le_bytes() };
        let int = |v: i32| if big { v.to_be_bytes() } else { v.to_le_bytes() };
        for [x, y] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
            bytes.extend([float(x), float(y), float(0.0)].concat());
            bytes.extend([1, 2, 3]);
        }
        for corners in [4, 3] {
            bytes.push(corners);
            bytes.extend((0..i32::from(corners)).flat_map(int));
            bytes.push(2 * corners);
            bytes.extend((0..2 * corners).flat_map(|v| float(f32::from(v))));
        }
        bytes.extend([5, 0, 1, 2, -1, 3].into_iter().flat_map(int));
        torment_alone("a.ply", &bytes);
    }
}

#[test]
fn damaged_stl() {
    let facet =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    torment_alone(
        "a.stl",
        format!("solid a\n{facet}endsolid a\nsolid b\n{facet}{facet}endsolid\n").as_bytes(),
    );
    let mut binary = vec![b' '; 80];
    binary.extend(2u32.to_le_bytes());
    for _ in 0..2 {
        let numbers = [0.0f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        binary.extend(numbers.iter().flat_map(|v| v.to_le_bytes()));
        binary.extend([0, 0]);
    }
    torment_alone("a.stl", &binary);
}

#[cfg(feature = "fbx")]
#[test]
fn damaged_fbx() {
    torment_alone("a.fbx", include_bytes!("../../../../tests/data/meshes/panel.fbx"));
    torment_alone("a.fbx", include_bytes!("../../../../tests/data/meshes/blender.fbx"));
}

/// A triangle whose positions are the nine words of 0, 0, 0; 1, 0, 0; 0, 1, 0 and padded indices 0, 1, 2. It has a
/// skin and a morph target, both animated; the positions serve as times and values too.
const GLTF: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"mesh":0,"translation":[1,2,3],"children":[1,2]},{"camera":0,"rotation":[0,0,0,1]},
    {"mesh":1,"skin":0,"weights":[0.25]}],
    "cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":0.1}}],
    "materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,1],"metallicFactor":0.5},"alphaMode":"MASK"}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0,"mode":4}]},
    {"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":2,"WEIGHTS_0":3},"targets":[{"POSITION":0}]}],"weights":[0.5]}],
    "skins":[{"joints":[1]}],
    "animations":[{"name":"a","channels":[{"sampler":0,"target":{"node":2,"path":"weights"}},
    {"sampler":1,"target":{"node":1,"path":"rotation"}},{"sampler":2,"target":{"node":0,"path":"scale"}}],
    "samplers":[{"input":4,"output":4,"interpolation":"STEP"},{"input":4,"output":6,"interpolation":"LINEAR"},
    {"input":4,"output":5,"interpolation":"CUBICSPLINE"}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
    {"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"},
    {"bufferView":0,"componentType":5121,"count":3,"type":"VEC4"},
    {"bufferView":0,"byteOffset":12,"componentType":5121,"count":3,"type":"VEC4","normalized":true},
    {"bufferView":0,"byteOffset":8,"componentType":5126,"count":2,"type":"SCALAR"},
    {"componentType":5126,"count":6,"type":"VEC3"},{"bufferView":0,"componentType":5126,"count":2,"type":"VEC4"}],
    "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
    "buffers":[{"byteLength":44BUFFER}]}"#;

fn gltf_buffer() -> Vec<u8> {
    let positions = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut buffer: Vec<u8> = positions.iter().flat_map(|v| v.to_le_bytes()).collect();
    buffer.extend([0u16, 1, 2, 0].iter().flat_map(|v| v.to_le_bytes()));
    buffer
}

#[test]
fn damaged_gltf() {
    let hex: String = gltf_buffer().iter().map(|b| format!("%{b:02X}")).collect();
    let uri = format!(",\"uri\":\"data:application/octet-stream,{hex}\"");
    let external = GLTF.replace("BUFFER", ",\"uri\":\"a.bin\"");
    torment("a.gltf", external.as_bytes(), "a.bin", &gltf_buffer());
    torment_alone("a.gltf", GLTF.replace("BUFFER", &uri).as_bytes());

    let mut json = GLTF.replace("BUFFER", "").into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let chunk = |kind: &[u8; 4], data: &[u8]| [&(data.len() as u32).to_le_bytes(), &kind[..], data].concat();
    let chunks = [chunk(b"JSON", &json), chunk(b"BIN\0", &gltf_buffer())].concat();
    let length = (12 + chunks.len()) as u32;
    torment_alone("a.glb", &[&b"glTF\x02\0\0\0"[..], &length.to_le_bytes(), &chunks].concat());
}

#[test]
fn damaged_pictures() {
    let grey =
        image::DynamicImage::ImageLuma8(image::GrayImage::from_fn(9, 7, |x, y| image::Luma([(x * y) as u8])));
    let deep = image::DynamicImage::ImageRgba16(grey.to_rgba16());
    let float = image::DynamicImage::ImageRgb32F(grey.to_rgb32f());
    let seeds = [
        ("a.png", &grey, image::ImageFormat::Png),
        ("b.png", &deep, image::ImageFormat::Png),
        ("a.jpg", &grey, image::ImageFormat::Jpeg),
        ("a.tga", &grey, image::ImageFormat::Tga),
        ("a.hdr", &float, image::ImageFormat::Hdr),
    ];
    for (name, picture, format) in seeds {
        let mut seed = Cursor::new(Vec::new());
        picture.write_to(&mut seed, format).expect("an encoder");
        torment_picture(name, &seed.into_inner(), (9, 7));
    }
    #[cfg(feature = "exr")]
    torment_picture("a.exr", &open_exr(), (9, 7));
    #[cfg(feature = "basis")]
    for (name, seed) in [
        ("etc1s.ktx2", &include_bytes!("../../../../tests/data/pictures/etc1s.ktx2")[..]),
        ("etc1s-alpha.ktx2", include_bytes!("../../../../tests/data/pictures/etc1s-alpha.ktx2")),
        ("uastc-alpha.ktx2", include_bytes!("../../../../tests/data/pictures/uastc-alpha.ktx2")),
        ("uastc-zstd.ktx2", include_bytes!("../../../../tests/data/pictures/uastc-zstd.ktx2")),
    ] {
        torment_picture(name, seed, (40, 24));
    }
    #[cfg(feature = "avif")]
    for (name, seed) in [
        ("avif-420.avif", &include_bytes!("../../../../tests/data/pictures/avif-420.avif")[..]),
        ("avif-alpha.avif", include_bytes!("../../../../tests/data/pictures/avif-alpha.avif")),
    ] {
        torment_picture(name, seed, (40, 24));
    }
    #[cfg(feature = "webp")]
    for (name, seed) in [
        ("lossy.webp", &include_bytes!("../../../../tests/data/pictures/lossy.webp")[..]),
        ("lossless.webp", include_bytes!("../../../../tests/data/pictures/lossless.webp")),
    ] {
        torment_picture(name, seed, (40, 24));
    }
}

/// A 9 × 7 float image as OpenEXR.
#[cfg(feature = "exr")]
fn open_exr() -> Vec<u8> {
    let samples: Vec<f32> = (0..9 * 7 * 3).map(|i| i as f32 / 100.0).collect();
    let layer = taotie_io::ExrLayer { name: "", channels: &["R", "G", "B"], samples: &samples };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    taotie_io::write_exr(&path, (9, 7), &[layer]).unwrap();
    std::fs::read(path).unwrap()
}

fn torment_picture(name: &str, seed: &[u8], size: (u32, u32)) {
    let sound = decode_bitmap(seed, name, Path::new(name)).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((sound.width(), sound.height()), size, "{name}");
    let mut dice = Dice(2);
    for round in 0..ROUNDS {
        if let Err(e) = decode_bitmap(&damage(seed, &mut dice), name, Path::new(name)) {
            assert!(!e.to_string().contains('\n'), "{name}, round {round}: {e}");
        }
    }
}
