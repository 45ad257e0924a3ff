//! glTF: compressed geometry unpacks to the original model, and damaged geometry gives an error.

use crate::damage::{Dice, damage};
use crate::gltf::{self, load};
#[cfg(feature = "draco")]
use crate::{common::absent, files::data_files, gltf::warned};
#[cfg(feature = "draco")]
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
#[cfg(feature = "draco")]
use taotie_engine::math::Vec3;
use taotie_engine::mesh::Mesh;
use taotie_io::{Loaded, load_model};

fn own(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/meshes").join(name)
}

fn patch(name: &str) -> Loaded {
    load(&own(name)).unwrap_or_else(|e| panic!("{e}"))
}

/// The largest difference between two lists of numbers.
fn apart<'a>(a: impl IntoIterator<Item = &'a f32>, b: impl IntoIterator<Item = &'a f32>) -> f32 {
    let (a, b): (Vec<&f32>, Vec<&f32>) = (a.into_iter().collect(), b.into_iter().collect());
    assert!(a.len() == b.len() && !a.is_empty(), "{} and {}", a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (*a - b).abs()).fold(0.0, f32::max)
}

fn normals(mesh: &Mesh) -> Vec<f32> {
    mesh.normals().iter().flat_map(|n| n.to_array()).collect()
}

fn uvs(mesh: &Mesh) -> Vec<f32> {
    mesh.uvs()[0].iter().flat_map(|uv| [uv.x, uv.y]).collect()
}

/// The triangles, each rotated to start with its smallest corner: the part that triangle codecs preserve.
fn turned(mesh: &Mesh) -> Vec<[u32; 3]> {
    let turn = |t: &[u32; 3]| (0..3).map(|k| [t[k], t[(k + 1) % 3], t[(k + 2) % 3]]).min();
    mesh.triangles().iter().filter_map(turn).collect()
}

/// The keyframes of the only animation: times and quaternions.
fn keyframes(loaded: &Loaded) -> (Vec<f32>, Vec<f32>) {
    let sampler = &loaded.rig.as_ref().unwrap().animations()[0].samplers[0];
    (sampler.times().to_vec(), sampler.values().to_vec())
}

// ------------------------------------------------------------------------------------------------ meshoptimizer

/// Streams from meshoptimizer's own encoder, version 0 with the older extension and 1 with the newer. Unfiltered data
/// is exact; the rest is within the step of its bits.
#[test]
fn meshoptimizer_s_streams_unpack_to_what_was_packed() {
    let plain = patch("patch.glb");
    for name in ["patch-meshopt-ext.glb", "patch-meshopt-khr.glb"] {
        let packed = patch(name);
        assert!(packed.warnings.is_empty(), "{:?}", packed.warnings);
        assert_eq!(packed.scene.meshes().len(), 2);
        for (a, b) in packed.scene.meshes().iter().zip(plain.scene.meshes()) {
            assert_eq!(a.positions(), b.positions(), "no filter");
            assert_eq!(turned(a), turned(b), "both index modes");
            assert!(apart(&normals(a), &normals(b)) < 1.5 / 127.0, "octahedral, 8 bits");
            let tangents = |mesh: &Mesh| mesh.tangents().as_flattened().to_vec();
            assert!(apart(&tangents(a), &tangents(b)) < 1.5 / 2047.0, "octahedral, 12 bits");
            assert!(apart(&uvs(a), &uvs(b)) < 1.0 / 8192.0, "exponential, 15 bits");
            let step = if name.contains("khr") { 2.0 / 255.0 } else { 1e-9 };
            assert!(
                apart(a.colors().as_flattened(), b.colors().as_flattened()) < step,
                "colour, 8 bits, or exact"
            );
        }
        let ((times, turns), (plain_times, plain_turns)) = (keyframes(&packed), keyframes(&plain));
        assert_eq!(times, plain_times);
        assert!(apart(&turns, &plain_turns) < 2.0 / 8191.0, "quaternions, 14 bits");
    }
}

/// The patch follows the formula in `data/make-meshes.mjs`.
#[test]
fn the_plain_patch_is_what_its_formula_says() {
    let plain = patch("patch.glb");
    let mesh = &plain.scene.meshes()[0];
    assert_eq!((mesh.positions().len(), mesh.triangles().len()), (63, 96));
    for p in mesh.positions() {
        let (x, y) = (f64::from(p.x), f64::from(p.y));
        let z = taotie_engine::math::scalar::sin(4.0 * x) * taotie_engine::math::scalar::cos(5.0 * y) / 8.0;
        assert!((f64::from(p.z) - z).abs() < 1e-6, "{p:?}");
    }
}

/// The file's JSON after `change`, with its binary chunk.
fn changed(name: &str, change: impl FnOnce(String) -> String) -> Result<Loaded, String> {
    let bytes = std::fs::read(own(name)).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let mut json = change(String::from_utf8(bytes[20..20 + length].to_vec()).unwrap()).into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let rest = &bytes[20 + length..];
    let size = (20 + json.len() + rest.len()) as u32;
    let head = [&bytes[..8], &size.to_le_bytes(), &(json.len() as u32).to_le_bytes(), b"JSON"].concat();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("changed.glb"), [&head[..], &json, rest].concat()).unwrap();
    load(&folder.path().join("changed.glb"))
}

#[test]
fn a_buffer_for_other_programs_is_not_asked_for() {
    let fallback = r#""extensions":{"EXT_meshopt_compression":{"fallback":true}}"#;
    let elsewhere = format!(r#""uri":"not%20there.bin",{fallback}"#);
    let loaded = changed("patch-meshopt-ext.glb", |json| json.replace(fallback, &elsewhere)).unwrap();
    assert_eq!(loaded.scene.meshes()[0].positions(), patch("patch.glb").scene.meshes()[0].positions());
}

#[test]
fn packed_views_that_contradict_themselves_are_named() {
    let change = |from: &str, to: &str| {
        let error = changed("patch-meshopt-ext.glb", |json| {
            assert!(json.contains(from), "{json}");
            json.replacen(from, to, 1)
        });
        error.err().unwrap_or_default()
    };
    let positions = r#""byteStride":12,"count":63"#;
    for (to, part) in [
        (r#""byteStride":13,"count":63"#, "63 elements of 13 bytes"),
        (r#""byteStride":12,"count":99000000"#, "cannot hold"),
        (r#""byteStride":12,"count":99"#, "damaged"),
        (r#""byteStride":12,"count":"x""#, "invalid count"),
        (r#""byteStride":12"#, "missing count"),
    ] {
        let error = change(positions, to);
        assert!(
            error.contains(part) && error.contains("POSITION") && error.contains("buffer view 0"),
            "{error}"
        );
    }
    let error =
        change(r#""EXT_meshopt_compression":{"buffer":0"#, r#""EXT_meshopt_compression":{"buffer":1"#);
    assert!(error.contains("buffer 1 has no data"), "{error}");
}

/// Many views of one packed stream: a small file must not request gigabytes.
#[test]
fn views_that_share_packed_bytes_without_end_are_refused() {
    let zeros = meshopt::encode_vertex_buffer_level(&vec![[0u32; 4]; 1 << 20], 2, Some(1)).unwrap();
    assert!(zeros.len() < 1 << 16, "{}", zeros.len());
    let mut maker = gltf::Maker::default();
    maker.view(&zeros, "");
    let view = format!(
        r#"{{"buffer":0,"byteLength":1,"extensions":{{"EXT_meshopt_compression":{{"buffer":0,"byteLength":{},
        "byteStride":16,"count":1048576,"mode":"ATTRIBUTES"}}}}}}"#,
        zeros.len()
    );
    maker.views.extend(vec![view; 1000]);
    maker.accessors.push(r#"{"bufferView":1000,"count":3,"componentType":5126,"type":"VEC3"}"#.into());
    let error = maker.try_load(&gltf::one_primitive(r#""POSITION":0"#, "")).unwrap_err();
    assert!(error.contains("unpack to too many bytes"), "{error}");
}

// -------------------------------------------------------------------------------------------------------- Draco

/// For each vertex of `mesh`, the vertex of `of` at the same place.
#[cfg(feature = "draco")]
fn matched(mesh: &Mesh, of: &Mesh) -> Vec<usize> {
    let nearest = |p: &Vec3| {
        let distance = |q: &Vec3| (*p - *q).length();
        let (i, q) =
            of.positions().iter().enumerate().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1))).unwrap();
        assert!(distance(q) < 1.0 / 8192.0, "14 bits: {p:?} and {q:?}");
        i
    };
    mesh.positions().iter().map(nearest).collect()
}

/// Streams from Draco's own encoder. Points may be reordered but keep their attributes; indices and colours are
/// exact, the rest is within the step of its bits.
#[cfg(feature = "draco")]
#[test]
fn draco_s_streams_unpack_to_what_was_packed() {
    let plain = patch("patch.glb");
    for name in ["patch-draco-sequential.glb", "patch-draco-edgebreaker.glb"] {
        let packed = patch(name);
        assert!(packed.warnings.is_empty(), "{:?}", packed.warnings);
        assert_eq!(packed.scene.meshes().len(), 2, "{name}");
        for (a, b) in packed.scene.meshes().iter().zip(plain.scene.meshes()) {
            let vertex = matched(a, b);
            assert_eq!(vertex.iter().collect::<BTreeSet<_>>().len(), b.positions().len(), "each exists once");
            let at = |mesh: &Mesh, i: usize| {
                let (n, uv, t) = (mesh.normals()[i], mesh.uvs()[0][i], mesh.tangents()[i]);
                ([n.x, n.y, n.z, t[0], t[1], t[2], t[3], uv.x, uv.y], mesh.colors()[i])
            };
            for (i, v) in vertex.iter().enumerate() {
                let ((a, a_color), (b, b_color)) = (at(a, i), at(b, *v));
                assert!(apart(&a[..3], &b[..3]) < 2.0 / 511.0, "normals of 10 bits: {a:?} {b:?}");
                assert!(apart(&a[3..7], &b[3..7]) < 2.0 / 2048.0, "tangents of 12 bits: {a:?} {b:?}");
                assert!(apart(&a[7..], &b[7..]) < 1.0 / 4095.0, "uvs of 12 bits");
                assert_eq!(a_color, b_color, "{name}");
            }
            let named = a.triangles().iter().map(|t| t.map(|i| vertex[i as usize] as u32));
            let sorted = |triangles: Vec<[u32; 3]>| {
                let turn = |t: &[u32; 3]| (0..3).map(|k| [t[k], t[(k + 1) % 3], t[(k + 2) % 3]]).min();
                triangles.iter().filter_map(turn).collect::<BTreeSet<_>>()
            };
            assert_eq!(sorted(named.collect()), sorted(b.triangles().to_vec()), "{name}");
            assert_eq!(a.triangles().len(), b.triangles().len(), "{name}");
        }
        assert_eq!(keyframes(&packed), keyframes(&plain), "uncompressed data is unchanged");
    }
}

/// The traversal for large meshes; the hill follows the formula in `data/make-meshes.mjs`.
#[cfg(feature = "draco")]
#[test]
fn draco_s_valence_traversal() {
    let hill = patch("hill-draco-valence.glb");
    let mesh = &hill.scene.meshes()[0];
    assert_eq!((mesh.triangles().len(), hill.scene.instances().len()), (2048, 1));
    // Normals are those of the faces, since the file has none, so corners are not shared.
    let mut area = 0.0;
    for triangle in 0..mesh.triangles().len() {
        let [a, b, c] = mesh.corners(triangle).map(|p| p.to_f64());
        let normal = (b - a).cross(c - a);
        assert!(normal.z > 0.0, "all face up");
        area += normal.z / 2.0;
        for p in [a, b, c] {
            let [x, y] = [p.x, p.y].map(|v| (v * 32.0).round() / 32.0);
            let off = [p.x - x, p.y - y, p.z - x * (1.0 - x) * y * (1.0 - y)];
            assert!(off.iter().all(|d| d.abs() < 1.0 / 16383.0), "{p:?}");
        }
    }
    assert!((area - 1.0).abs() < 1e-3, "it covers the square once: {area}");
}

/// Box of the sample assets, whose corners lie on seams, compressed by another program.
#[cfg(feature = "draco")]
#[test]
fn draco_files_by_others() {
    let mut packed = data_files("khronos-gltf-sample-assets", &["gltf"]);
    packed.retain(|path| path.components().any(|part| part.as_os_str() == "glTF-Draco"));
    if packed.is_empty() {
        absent("no sample asset is compressed by Draco");
    }
    for packed in packed {
        let model = packed.parent().unwrap().parent().unwrap();
        let plain = model.join("glTF").join(packed.file_name().unwrap());
        let [packed, plain] = [packed, plain].map(|path| load(&path).unwrap_or_else(|e| panic!("{e}")));
        for (a, b) in packed.scene.meshes().iter().zip(plain.scene.meshes()) {
            let corners = |mesh: &Mesh| {
                let corner = |i: u32| {
                    let (p, n) = (mesh.positions()[i as usize], mesh.normals()[i as usize]);
                    [p.x, p.y, p.z, n.x, n.y, n.z].map(|v| (v * 100.0).round() as i32)
                };
                let turn = |t: [[i32; 6]; 3]| (0..3).map(|k| [t[k], t[(k + 1) % 3], t[(k + 2) % 3]]).min();
                mesh.triangles().iter().filter_map(|t| turn(t.map(corner))).collect::<BTreeSet<_>>()
            };
            assert_eq!(corners(a), corners(b));
        }
    }
}

#[cfg(feature = "draco")]
#[test]
fn damaged_draco_streams_are_named_or_stood_in_for() {
    let name = "patch-draco-sequential.glb";
    let packed = r#""KHR_draco_mesh_compression":{"bufferView":1,"#;
    let other = |view: &str| changed(name, |json| json.replacen(packed, &packed.replace('1', view), 1));
    let loaded = other("99").unwrap();
    assert_eq!(
        warned(&loaded, "skipped mesh 0, primitive 0: POSITION: accessor 1"),
        1,
        "{:?}",
        loaded.warnings
    );
    // Draco cannot decode the animation's view; the other primitive stays.
    let loaded = other("0").unwrap();
    assert_eq!(warned(&loaded, "Draco compression"), 1, "{:?}", loaded.warnings);
    let loaded =
        changed(name, |json| json.replacen(r#""NORMAL":1,"TANGENT""#, r#""NORMAL":77,"TANGENT""#, 1))
            .unwrap();
    assert_eq!(warned(&loaded, "attribute NORMAL is missing"), 1, "{:?}", loaded.warnings);
}

/// A primitive whose accessors have uncompressed data falls back to it if the compressed data is damaged.
#[cfg(feature = "draco")]
#[test]
fn uncompressed_data_stands_in_for_damaged_draco() {
    let mut maker = gltf::triangle();
    maker.accessor(&[0, 1, 2], (3, 5121, "SCALAR"), "");
    let draco = |mode: &str| {
        format!(
            r#","indices":1{mode},"extensions":{{"KHR_draco_mesh_compression":{{"bufferView":1,"attributes":{{"POSITION":0}}}}}}"#
        )
    };
    let loaded = maker.load(&gltf::one_primitive(r#""POSITION":0"#, &draco("")));
    assert_eq!(warned(&loaded, "using its uncompressed data"), 1, "{:?}", loaded.warnings);
    assert_eq!(loaded.scene.meshes()[0].triangles().len(), 1);
    let loaded = maker.load(&gltf::one_primitive(r#""POSITION":0"#, &draco(r#","mode":5"#)));
    assert_eq!(warned(&loaded, "without strips"), 1, "{:?}", loaded.warnings);
}

// ---------------------------------------------------------------------------------------------------- damage

/// Damaged copies load or fail with a one-line error; they never panic.
fn torment(name: &str) {
    let seed = std::fs::read(own(name)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.glb");
    let mut dice = Dice(3);
    let truncated = (0..seed.len()).step_by(13).map(|length| seed[..length].to_vec());
    // After the JSON, in the streams.
    let streams = 20 + u32::from_le_bytes(seed[12..16].try_into().unwrap()) as usize;
    let flipped: Vec<Vec<u8>> = (0..600)
        .map(|_| {
            let mut bytes = seed.clone();
            for _ in 0..1 + dice.roll(3) {
                let at = streams + 8 + dice.roll(seed.len() - streams - 8);
                bytes[at] = dice.roll(256) as u8;
            }
            bytes
        })
        .collect();
    let damaged: Vec<Vec<u8>> = (0..200).map(|_| damage(&seed, &mut dice)).collect();
    for bytes in truncated.chain(flipped).chain(damaged) {
        std::fs::write(&path, bytes).unwrap();
        if let Err(error) = load_model(&path) {
            assert!(!error.to_string().contains('\n'), "{error}");
        }
    }
}

#[test]
fn damaged_meshoptimizer_streams_never_panic() {
    torment("patch-meshopt-ext.glb");
    torment("patch-meshopt-khr.glb");
}

#[cfg(feature = "draco")]
#[test]
fn damaged_draco_streams_never_panic() {
    torment("patch-draco-sequential.glb");
    torment("patch-draco-edgebreaker.glb");
    torment("hill-draco-valence.glb");
}
