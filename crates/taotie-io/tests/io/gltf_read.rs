//! glTF: third-party files load or give a one-line reason why not, and small files made here give the right numbers.

use crate::common::data_folder;
use crate::files::data_files;
use crate::gltf::{Maker, PIXEL, load, one_primitive, triangle, v, warned};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use taotie_engine::image::{MipFilter, TexelFilter, Wrap};
use taotie_engine::math::Vec2;
use taotie_engine::scene::{AlphaMode, Falloff, LightKind, Projection};

// ---------------------------------------------------------------------------------------------- third-party files

fn models(sub: &str) -> Vec<PathBuf> {
    data_files(sub, &["gltf", "glb"])
}

/// The JSON of a file; null if it has none.
fn json_of(path: &Path) -> serde_json::Value {
    let bytes = std::fs::read(path).unwrap();
    let of_glb = || {
        let length = u32::from_le_bytes(bytes.get(12..16)?.try_into().ok()?) as usize;
        bytes.get(20..)?.get(..length)
    };
    let text = if bytes.starts_with(b"glTF") { of_glb().unwrap_or_default() } else { &bytes[..] };
    serde_json::from_slice(text).unwrap_or_default()
}

/// Missing files with geometry that the file refers to; names with escapes are not included.
fn missing_buffers(path: &Path) -> Vec<String> {
    let json = json_of(path);
    let uris = json["buffers"].as_array().into_iter().flatten().filter_map(|buffer| buffer["uri"].as_str());
    uris.filter(|uri| !uri.starts_with("data:") && !uri.contains('%'))
        .filter(|uri| !path.with_file_name(uri).exists())
        .map(str::to_owned)
        .collect()
}

/// Returns `true` if a valid file is not drawn for an expected reason, judging from its content: it requires an
/// unsupported extension or version, or has only points and lines.
fn is_stated_case(path: &Path, error: &str) -> bool {
    let json = json_of(path);
    let strings = |key: &str| {
        let list = json[key].as_array().into_iter().flatten();
        list.filter_map(|v| v.as_str().map(str::to_owned)).collect::<Vec<_>>()
    };
    let modes: Vec<u64> = json["meshes"]
        .as_array()
        .into_iter()
        .flatten()
        .flat_map(|m| m["primitives"].as_array().cloned().unwrap_or_default())
        .map(|p| p["mode"].as_u64().unwrap_or(4))
        .collect();
    strings("extensionsRequired").iter().any(|e| error.contains(&format!("required extension {e}")))
        || json["asset"]["minVersion"].as_str().is_some_and(|v| v != "2.0" && error.contains("glTF version"))
        || (modes.iter().all(|m| *m < 4) && error.contains("only points or lines"))
}

#[test]
fn models_by_others_load() {
    for sub in ["khronos-gltf-sample-assets", "gltf-asset-generator", "polyhaven-models", "materialx"] {
        for path in models(sub) {
            match load(&path) {
                Ok(loaded) => assert!(loaded.missing_files.is_empty(), "{}", path.display()),
                Err(error) => assert!(is_stated_case(&path, &error), "{error}"),
            }
        }
    }
}

#[test]
fn odd_models_load_or_say_why() {
    for path in models("malformed-and-odd-inputs") {
        match load(&path) {
            Ok(loaded) => {
                assert!(loaded.scene.triangle_count() > 0, "{}", path.display());
                let reported = !loaded.missing_files.is_empty() || loaded.warnings.iter().next().is_some();
                assert!(
                    missing_buffers(&path).is_empty() || reported,
                    "{}: nothing is reported",
                    path.display()
                );
            }
            Err(error) => {
                let reason = error.split_once(&*path.file_name().unwrap().to_string_lossy()).unwrap().1;
                assert!(reason.split_whitespace().count() > 3, "no reason: {error}");
                let missing = missing_buffers(&path);
                let named = missing.iter().any(|file| error.contains(&format!("'{file}' is missing")));
                assert!(missing.is_empty() || named || is_stated_case(&path, &error), "{error}");
            }
        }
    }
}

/// The validator's report next to each file shows whether it is valid. A valid file loads unless it has no geometry
/// or no triangles.
#[test]
fn models_that_the_validator_accepts_load() {
    let mut sound = 0;
    for path in models("gltf-validator") {
        let result = load(&path);
        let report = PathBuf::from(format!("{}.report.json", path.display()));
        let report: serde_json::Value = serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap();
        if report["issues"]["numErrors"] != 0 {
            continue;
        }
        sound += 1;
        if let Err(error) = result {
            let triangles = report["info"]["totalTriangleCount"].as_u64().unwrap_or(0);
            let minimum = report["info"]["minVersion"].is_string() && error.contains("glTF version");
            assert!(triangles == 0 && error.contains("nothing to draw") || minimum, "{error}");
        }
    }
    assert!(sound > 0 || data_folder("gltf-validator").is_none(), "no file is valid");
}

// ------------------------------------------------------------------------------------------------ made here

#[test]
fn without_normals_they_are_flat_and_tangents_go() {
    let mut maker = Maker::default();
    maker.floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.], "VEC3");
    maker.floats(&[1.0; 16], "VEC4");
    maker.accessor(&[0, 1, 2, 0, 2, 3], (6, 5121, "SCALAR"), "");
    let loaded = maker.load(&one_primitive(r#""POSITION":0,"TANGENT":1"#, r#","indices":2"#));
    let mesh = &loaded.scene.meshes()[0];
    assert_eq!(mesh.triangles(), [[0, 1, 2], [3, 4, 5]]);
    let (z, x) = (v(0.0, 0.0, 1.0), v(1.0, 0.0, 0.0));
    assert_eq!(mesh.normals(), [z, z, z, x, x, x]);
    assert!(mesh.tangents().is_empty());
    // There is no material: the default is glTF's, not this program's.
    let material = &loaded.scene.materials()[loaded.scene.instances()[0].material];
    assert_eq!((material.base_color, material.metallic, material.roughness), ([1.0; 4], 1.0, 1.0));
}

#[test]
fn given_normals_and_tangents_stay() {
    let mut maker = triangle();
    maker.floats(&[0.0, 0.6, 0.8].repeat(3), "VEC3");
    let tangents = [0.5, 0.25, 0.0, -1.0].repeat(3);
    maker.floats(&tangents, "VEC4");
    let loaded = maker.load(&one_primitive(r#""POSITION":0,"NORMAL":1,"TANGENT":2"#, ""));
    let mesh = &loaded.scene.meshes()[0];
    assert_eq!(mesh.tangents().as_flattened(), tangents);
    assert!((mesh.normals()[2] - v(0.0, 0.6, 0.8)).length() < 1e-7);
    assert!(loaded.warnings.is_empty());
}

#[test]
fn sparse_accessors_with_and_without_a_base() {
    let mut maker = triangle();
    let indices = maker.view(&[2, 0], "");
    let values: Vec<u8> = [7f32, 8., 9., 4., 5., 6.].iter().flat_map(|f| f.to_le_bytes()).collect();
    let values = maker.view(&values, "");
    for base in [r#""bufferView":0,"#, ""] {
        maker.accessors.push(format!(
            r#"{{{base}"count":3,"componentType":5126,"type":"VEC3","sparse":{{"count":2,
            "indices":{{"bufferView":{indices},"componentType":5121}},"values":{{"bufferView":{values}}}}}}}"#
        ));
    }
    let positions = |index: usize| {
        let loaded = maker.load(&one_primitive(&format!(r#""POSITION":{index}"#), ""));
        loaded.scene.meshes()[0].positions().to_vec()
    };
    assert_eq!(positions(1), [v(4.0, 5.0, 6.0), v(1.0, 0.0, 0.0), v(7.0, 8.0, 9.0)]);
    assert_eq!(positions(2), [v(4.0, 5.0, 6.0), v(0.0, 0.0, 0.0), v(7.0, 8.0, 9.0)]);
}

#[test]
fn quantised_attributes() {
    let mut maker = Maker::default();
    let shorts = |values: &[i16]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    // Positions: normalised shorts 8 bytes apart. Normals: normalised bytes. UVs: 16-bit integers.
    let stride =
        maker.view(&shorts(&[0, 0, 0, 0, 32767, 0, 0, 0, 0, -32767, 16384, 0]), r#","byteStride":8"#);
    maker.accessors.push(format!(
        r#"{{"bufferView":{stride},"count":3,"componentType":5122,"type":"VEC3","normalized":true}}"#
    ));
    let normals = [0i8, 0, 127, 0, 0, 0, 127, 0, 0, -128, 0, 0].map(|b| b as u8);
    let view = maker.view(&normals, r#","byteStride":4"#);
    maker.accessors.push(format!(
        r#"{{"bufferView":{view},"count":3,"componentType":5120,"type":"VEC3","normalized":true}}"#
    ));
    maker.accessor(&shorts(&[0, 0, 2, 0, 0, 300]), (3, 5123, "VEC2"), "");
    maker.accessor(&[255, 0, 51, 0, 0, 0, 255, 255, 255], (3, 5121, "VEC3"), r#","normalized":true"#);
    let attributes = r#""POSITION":0,"NORMAL":1,"TEXCOORD_0":2,"COLOR_0":3"#;
    let required =
        r#","extensionsUsed":["KHR_mesh_quantization"],"extensionsRequired":["KHR_mesh_quantization"]"#;
    let loaded = maker.load(&(one_primitive(attributes, "") + required));
    let mesh = &loaded.scene.meshes()[0];
    assert_eq!(mesh.positions(), [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, -1.0, 16384.0 / 32767.0)]);
    assert_eq!(mesh.normals(), [v(0.0, 0.0, 1.0), v(0.0, 0.0, 1.0), v(0.0, -1.0, 0.0)]);
    assert_eq!(mesh.uvs()[0], [Vec2::new(0.0, 0.0), Vec2::new(2.0, 0.0), Vec2::new(0.0, 300.0)]);
    assert_eq!(mesh.colors()[0], [1.0, 0.0, 0.2, 1.0]);
    assert!(loaded.warnings.is_empty());
}

#[test]
fn node_transforms_multiply_down_the_tree() {
    let nodes = r#""scene":1,"scenes":[{},{"nodes":[0]}],
        "nodes":[{"children":[1],"translation":[1,2,3],"rotation":[0,0,0.70710678,0.70710678],"scale":[2,2,2]},
                 {"mesh":0,"matrix":[1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]},{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_1":0,"TEXCOORD_8":0,"_ID":0}}]}]"#;
    let loaded = triangle().load(nodes);
    assert_eq!(loaded.scene.instances().len(), 1, "node 2 is in no shown scene");
    let notes: Vec<(&str, usize)> = loaded.warnings.iter().collect();
    let sets = "ignored uv sets beyond the first 8, and colour sets beyond the first";
    assert_eq!(notes, [("ignored scenes other than the default", 1), (sets, 2)]);
    // (1, 0, 0) + 5 along x, doubled, turned by 90° about z, moved.
    let p = loaded.scene.instances()[0].world_from_object.transform_point(v(1.0, 0.0, 0.0).to_f64());
    assert!((p - v(1.0, 14.0, 3.0).to_f64()).length() < 1e-6, "{p:?}");
}

#[test]
fn restarts_and_wrong_tangents_are_noted() {
    let mut maker = Maker::default();
    let position = |i: u32| [f64::from(i % 16) as f32, (i / 16) as f32, 0.0];
    maker.floats(&(0..256).map(position).collect::<Vec<_>>().concat(), "VEC3");
    maker.floats(&[0.0, 0.0, 1.0].repeat(256), "VEC3");
    maker.floats(&[1.0, 0.0, 0.0, 0.0].repeat(256), "VEC4");
    maker.accessor(&[0, 1, 16, 239, 254, 255], (6, 5121, "SCALAR"), "");
    let attributes = r#""attributes":{"POSITION":0,"NORMAL":1,"TANGENT":2}"#;
    let nodes =
        format!(r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{{attributes},"indices":3}}]}}]"#);
    let loaded = maker.load(&nodes);
    let notes: Vec<(&str, usize)> = loaded.warnings.iter().collect();
    assert!(
        notes.iter().any(|(what, count)| what.contains("start of a new primitive") && *count == 1),
        "{notes:?}"
    );
    assert!(notes.iter().any(|(what, count)| what.contains("neither 1 nor -1") && *count == 6), "{notes:?}");
}

/// A file of a triangle whose node, moved by 10 along x, has instances with these attributes; accessor 1 moves three
/// instances along y, 2 turns them by normalised 16-bit numbers, 3 scales them.
pub fn instanced(attributes: &str, rest: &str) -> (Maker, String) {
    let mut maker = triangle();
    maker.floats(&[0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 3.0, 0.0], "VEC3");
    let half_turn = [0i16, 0, i16::MAX, 0].map(i16::to_le_bytes).concat();
    maker.accessor(&half_turn.repeat(3), (3, 5122, "VEC4"), r#","normalized":true"#);
    maker.floats(&[2.0; 9], "VEC3");
    maker.floats(&[1.0; 6], "VEC3");
    let nodes = format!(
        r#""extensionsUsed":["EXT_mesh_gpu_instancing"],"extensionsRequired":["EXT_mesh_gpu_instancing"],
        "nodes":[{{"mesh":0,"translation":[10,0,0],
            "extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{attributes}}}}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}]{rest}"#
    );
    (maker, nodes)
}

#[test]
fn instances_of_a_mesh_are_placed_below_its_node() {
    let all = r#"{"TRANSLATION":1,"ROTATION":2,"SCALE":3,"_ID":9}"#;
    let (maker, nodes) = instanced(all, "");
    let loaded = maker.load(&nodes);
    assert!(loaded.warnings.is_empty());
    assert_eq!((loaded.scene.meshes().len(), loaded.scene.triangle_count()), (1, 3));
    let corner = v(1.0, 0.0, 0.0).to_f64();
    for (i, instance) in loaded.scene.instances().iter().enumerate() {
        // Doubled, turned by 180° about z, moved.
        let p = instance.world_from_object.transform_point(corner);
        assert!((p - v(8.0, 1.0 + i as f32, 0.0).to_f64()).length() < 1e-4, "{i}: {p:?}");
    }
    let (maker, nodes) = instanced(r#"{"SCALE":3}"#, "");
    assert_eq!(maker.load(&nodes).scene.instances().len(), 3);
    let (maker, nodes) = instanced(r#"{"_ID":1}"#, "");
    assert_eq!(maker.load(&nodes).scene.instances().len(), 1, "without transforms, it is shown once");
}

#[test]
fn instances_move_with_their_node() {
    let (mut maker, nodes) = instanced(
        r#"{"TRANSLATION":1}"#,
        r#","animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}},
            {"sampler":0,"target":{"node":1,"path":"translation"}}],"samplers":[{"input":5,"output":6}]}]"#,
    );
    maker.floats(&[0.0, 1.0], "SCALAR");
    maker.floats(&[0.0, 0.0, 0.0, 0.0, 0.0, 5.0], "VEC3");
    let loaded = maker.load(&nodes);
    let rig = loaded.rig.as_ref().expect("it is animated");
    assert_eq!(rig.data().animations[0].channels.len(), 1, "instances are not nodes of the file");
    assert_eq!(rig.data().instances, [Some(1), Some(2), Some(3)]);
    assert_eq!(warned(&loaded, "skipped channels"), 1);
}

#[test]
fn malformed_instances_are_refused() {
    for (attributes, why) in [
        (r#"{"TRANSLATION":9}"#, "TRANSLATION: accessor 9 does not exist"),
        (r#"{"TRANSLATION":2}"#, "TRANSLATION must have 3 numbers per instance, not 4"),
        (r#"{"ROTATION":1}"#, "ROTATION must have 4 numbers"),
        (r#"{"TRANSLATION":1,"SCALE":4}"#, "SCALE has 2 elements, but other attributes 3"),
        (r#"{"SCALE":"x"}"#, "SCALE is not an accessor"),
        ("[]", "missing attributes"),
    ] {
        let (maker, nodes) = instanced(attributes, "");
        let error = maker.try_load(&nodes).unwrap_err();
        assert!(error.contains("node 0: EXT_mesh_gpu_instancing: ") && error.contains(why), "{error}");
    }
}

#[test]
fn cycles_and_double_parents() {
    let rest = |nodes: &str| {
        format!(r#""nodes":{nodes},"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}]"#)
    };
    let error = triangle().try_load(&rest(r#"[{"children":[1]},{"children":[0],"mesh":0}]"#)).unwrap_err();
    assert!(error.contains("node 0") && error.contains("ancestor"), "{error}");
    assert!(triangle().try_load(&rest(r#"[{"children":[0],"mesh":0}]"#)).is_err());
    let doubled = triangle().load(&rest(r#"[{"children":[2]},{"children":[2]},{"mesh":0}]"#));
    assert_eq!((doubled.scene.instances().len(), warned(&doubled, "two parents")), (1, 1));
}

#[test]
fn deep_hierarchies_do_not_exhaust_the_stack() {
    let depth = 100_000;
    let links: Vec<String> = (1..depth).map(|i| format!(r#"{{"children":[{i}]}}"#)).collect();
    let mesh = r#""meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#;
    let loaded = triangle().load(&format!(r#""nodes":[{},{{"mesh":0}}],{mesh}"#, links.join(",")));
    assert_eq!(loaded.scene.instances().len(), 1);
}

#[test]
fn morph_targets_take_the_node_s_weights_before_the_mesh_s() {
    let mut maker = triangle();
    maker.floats(&[0.0, 0.0, 1.0].repeat(3), "VEC3");
    maker.floats(&[2.0, 0.0, 0.0].repeat(3), "VEC3");
    let mesh = r#""meshes":[{"weights":[0.5,0],"primitives":[{"attributes":{"POSITION":0},
        "targets":[{"POSITION":1},{"POSITION":2}]}]}],"nodes":[{"mesh":0},{"mesh":0,"weights":[0,1]}]"#;
    let loaded = maker.load(mesh);
    let first = |i: usize| loaded.scene.meshes()[loaded.scene.instances()[i].mesh].positions()[0];
    assert_eq!([first(0), first(1)], [v(0.0, 0.0, 0.5), v(2.0, 0.0, 0.0)]);
}

#[test]
fn skins_put_the_mesh_where_the_joints_are() {
    let mut maker = triangle();
    maker.accessor(&[0, 1, 9, 9].repeat(3), (3, 5121, "VEC4"), "");
    maker.floats(&[0.75, 0.25, 0.0, 0.0].repeat(3), "VEC4");
    let mut binds = [0.0; 32];
    for i in 0..2 {
        (0..4).for_each(|d| binds[16 * i + 5 * d] = 1.0);
    }
    binds[16 + 12] = -10.0; // the second joint was bound at x = 10
    maker.floats(&binds, "MAT4");
    let attributes = r#""POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2"#;
    let rest = format!(
        r#""nodes":[{{"mesh":0,"skin":0,"translation":[100,0,0]}},{{"translation":[0,4,0]}},{{"translation":[10,0,8]}}],
        "skins":[{{"joints":[1,2],"inverseBindMatrices":3}}],
        "meshes":[{{"primitives":[{{"attributes":{{{attributes}}}}}]}}]"#
    );
    let loaded = maker.load(&rest);
    let instance = loaded.scene.instances()[0];
    let p = loaded.scene.meshes()[instance.mesh].positions()[1];
    let p = instance.world_from_object.transform_point(p.to_f64());
    assert!((p - v(1.0, 3.0, 2.0).to_f64()).length() < 1e-6, "{p:?}");
    assert!(loaded.warnings.is_empty(), "joints of weight zero may have any index");
}

#[test]
fn materials_with_textures_samplers_and_extensions() {
    let mut maker = triangle();
    maker.floats(&[0.0; 6], "VEC2");
    let rest = format!(
        r#"{},"images":[{{"uri":"{PIXEL}"}}],
        "samplers":[{{"wrapS":33071,"wrapT":33648,"magFilter":9728,"minFilter":9985}}],
        "textures":[{{"source":0,"sampler":0}},{{"source":0}}],
        "materials":[{{"name":"m","alphaMode":"MASK","doubleSided":true,"emissiveFactor":[1,0.5,0],
          "pbrMetallicRoughness":{{"baseColorFactor":[0.1,0.2,0.3,0.4],"metallicFactor":0,"roughnessFactor":0.25,
            "baseColorTexture":{{"index":0,"extensions":{{"KHR_texture_transform":{{
              "offset":[0.5,0],"rotation":1.5707964,"scale":[2,4],"texCoord":0}}}},"texCoord":3}}}},
          "normalTexture":{{"index":1,"scale":0.5,"extensions":{{"KHR_texture_transform":{{"scale":[3,3]}}}}}},
          "occlusionTexture":{{"index":1,"strength":0.75}},
          "extensions":{{"KHR_materials_emissive_strength":{{"emissiveStrength":4}},
            "KHR_materials_ior":{{"ior":2}},"KHR_materials_unlit":{{}}}}}}]"#,
        one_primitive(r#""POSITION":0,"TEXCOORD_0":1"#, r#","material":0"#)
    );
    let loaded = maker.load(&rest);
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    let m = &loaded.scene.materials()[0];
    assert_eq!((m.name.as_str(), m.alpha, m.double_sided, m.unlit), ("m", AlphaMode::Mask(0.5), true, true));
    assert_eq!((m.base_color, m.metallic, m.roughness), ([0.1, 0.2, 0.3, 0.4], 0.0, 0.25));
    assert_eq!((m.emissive, m.occlusion_strength), ([4.0, 2.0, 0.0], 0.75));
    assert_eq!((m.ior, m.f0), (2.0, None));
    let base = m.base_color_texture.unwrap();
    assert_eq!((base.sampler.wrap_u, base.sampler.wrap_v), (Wrap::Clamp, Wrap::Mirror));
    assert_eq!((base.sampler.magnify, base.sampler.minify), (TexelFilter::Nearest, TexelFilter::Linear));
    assert_eq!((base.sampler.mip, base.uv_set), (MipFilter::Nearest, 0));
    // A quarter turn: u' = 4v + 0.5, v' = −2u.
    let uv = base.transform.apply(Vec2::new(0.25, 0.125));
    assert!((uv.x - 1.0).abs() < 1e-6 && (uv.y + 0.5).abs() < 1e-6, "{uv:?}");
    let normal = m.normal.unwrap();
    assert_eq!((normal.scale, normal.texture.transform.linear), (0.5, [[3.0, 0.0], [0.0, 3.0]]));
    // One image as colour, data and normals: exactly three textures, since each has separate mip levels.
    assert_eq!(loaded.scene.textures().len(), 3);
    assert_ne!(m.occlusion_texture.unwrap().texture, normal.texture.texture);
}

#[test]
fn lights_and_cameras() {
    let rest = format!(
        r#"{},"extensions":{{"KHR_lights_punctual":{{"lights":[
          {{"type":"point","intensity":20,"color":[1,0.5,0],"range":7,"name":"lamp"}},
          {{"type":"spot","spot":{{"innerConeAngle":0.1,"outerConeAngle":0.3}}}},
          {{"type":"directional","intensity":3}},{{"type":"lava"}}]}}}},
        "cameras":[{{"type":"perspective","perspective":{{"yfov":0.8,"znear":0.1,"aspectRatio":1.5}},"name":"eye"}},
          {{"type":"orthographic","orthographic":{{"xmag":2,"ymag":1,"znear":0,"zfar":9}}}},
          {{"type":"perspective","perspective":{{"yfov":0,"znear":0.1}}}}]"#,
        one_primitive(r#""POSITION":0"#, "").replace(
            r#""nodes":[{"mesh":0}]"#,
            r#""nodes":[{"mesh":0},
              {"translation":[1,2,3],"extensions":{"KHR_lights_punctual":{"light":0}}},
              {"rotation":[0,0.70710678,0,0.70710678],"extensions":{"KHR_lights_punctual":{"light":1}}},
              {"extensions":{"KHR_lights_punctual":{"light":2}}},{"extensions":{"KHR_lights_punctual":{"light":3}}},
              {"camera":0,"translation":[0,0,5],"scale":[3,3,3]},{"camera":1,"name":"plan"},{"camera":2},{"camera":9}]"#
        )
    );
    let loaded = triangle().load(&rest);
    let [lamp, spot, sun] = loaded.scene.lights() else { panic!("{:?}", loaded.scene.lights()) };
    assert_eq!(
        (lamp.name.as_str(), lamp.color, lamp.falloff),
        ("lamp", v(20.0, 10.0, 0.0), Falloff::Windowed(7.0))
    );
    assert_eq!(lamp.kind, LightKind::Point { position: v(1.0, 2.0, 3.0) });
    let LightKind::Spot { direction, inner, outer, .. } = spot.kind else { panic!("{spot:?}") };
    assert!((direction - v(-1.0, 0.0, 0.0)).length() < 1e-6);
    assert_eq!((inner as f32, outer as f32, spot.falloff), (0.1, 0.3, Falloff::InverseSquare));
    assert_eq!(sun.kind, LightKind::Directional { direction: v(0.0, 0.0, -1.0) });
    assert_eq!(warned(&loaded, "light of node 4"), 1);
    let [eye, plan] = loaded.scene.cameras() else { panic!("{:?}", loaded.scene.cameras()) };
    let Projection::Perspective { aspect, far, .. } = eye.projection else { panic!("{eye:?}") };
    assert_eq!((eye.name.as_str(), aspect, far), ("eye", Some(1.5), None));
    assert_eq!(eye.world_from_view.axis(2), v(0.0, 0.0, 1.0).to_f64());
    let Projection::Orthographic { half_width, .. } = plan.projection else { panic!("{plan:?}") };
    assert_eq!((plan.name.as_str(), half_width), ("plan", 2.0));
    assert_eq!(warned(&loaded, "camera of node"), 2);
}

#[test]
fn strips_fans_and_points() {
    let mut maker = Maker::default();
    maker.floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.], "VEC3");
    maker.floats(&[0.0, 0.0, 1.0].repeat(4), "VEC3");
    let triangles = |mode: u32| {
        let rest = one_primitive(r#""POSITION":0,"NORMAL":1"#, &format!(r#","mode":{mode}"#));
        maker.try_load(&rest).map(|l| l.scene.meshes()[0].triangles().to_vec())
    };
    assert_eq!(triangles(5).unwrap(), [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(triangles(6).unwrap(), [[1, 2, 0], [2, 3, 0]]);
    assert!(triangles(1).unwrap_err().contains("only points or lines"));
    assert!(triangles(7).unwrap_err().contains("mode"));
}

#[test]
fn damage_is_named_by_mesh_primitive_and_attribute() {
    let error = |maker: &Maker, rest: &str| maker.try_load(rest).unwrap_err();
    let mut nan = Maker::default();
    nan.floats(&[0.0, 0.0, 0.0, f32::NAN, 0.0, 0.0, 0.0, 1.0, 0.0], "VEC3");
    let text = error(&nan, &one_primitive(r#""POSITION":0"#, ""));
    assert!(text.contains("mesh 0, primitive 0") && text.contains("POSITION: vertex 1"), "{text}");
    let mut index = triangle();
    index.accessor(&[0, 1, 3], (3, 5121, "SCALAR"), "");
    let text = error(&index, &one_primitive(r#""POSITION":0"#, r#","indices":1"#));
    assert!(text.contains("index 2 refers to vertex 3"), "{text}");
    let mut long = triangle();
    long.accessors[0] = long.accessors[0].replace(r#""count":3"#, r#""count":4"#);
    let text = error(&long, &one_primitive(r#""POSITION":0"#, ""));
    assert!(text.contains("POSITION") && text.contains("do not fit"), "{text}");
    let text = error(&triangle(), &one_primitive(r#""POSITION":7"#, ""));
    assert!(text.contains("accessor 7"), "{text}");
    assert!(error(&triangle(), r#""nodes":[{}]"#).contains("nothing to draw"));
    let mut huge = Maker::default();
    huge.accessors.push(r#"{"count":4294967295,"componentType":5126,"type":"VEC3"}"#.into());
    let text = error(&huge, &one_primitive(r#""POSITION":0"#, ""));
    assert!(text.contains("4294967295 elements without data"), "{text}");
}

#[test]
fn one_bad_primitive_among_good_ones_is_left_out() {
    let mut maker = triangle();
    maker.floats(&[f32::NAN; 9], "VEC3");
    maker.floats(&[0.5, f32::INFINITY, 0.5, f32::NAN, -2e12, 0.5], "VEC2");
    maker.floats(&[0.0; 9], "VEC3");
    let rest = r#""nodes":[{"mesh":0}],"meshes":[{"name":"M","primitives":[{"attributes":{"POSITION":1}},
        {"attributes":{"POSITION":0,"TEXCOORD_0":2,"NORMAL":3,"COLOR_0":99}},{"attributes":{"NORMAL":3}}]}]"#;
    let loaded = maker.load(rest);
    assert_eq!(loaded.scene.instances().len(), 1);
    assert_eq!(warned(&loaded, "skipped mesh 0 'M', primitive 0: POSITION"), 1);
    assert_eq!(warned(&loaded, "uvs that were infinite, NaN or beyond ±1e12"), 3);
    assert_eq!(warned(&loaded, "normals that were zero or NaN"), 3);
    assert_eq!(warned(&loaded, "primitive 1: skipped COLOR_0"), 1);
    assert_eq!(warned(&loaded, "without POSITION"), 1);
    assert_eq!(loaded.scene.meshes()[0].normals(), [v(0.0, 0.0, 1.0); 3]);
}

#[test]
fn missing_textures_and_odd_materials_are_drawn_without() {
    let rest = format!(
        r#"{},"images":[{{"uri":"no%20such.png"}},{{"uri":"data:image/png;base64,AAAA"}}],
        "textures":[{{"source":0}},{{"source":1}},{{"extensions":{{"XX_texture":{{"source":0}}}}}}],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}},"metallicRoughnessTexture":{{"index":1}},
          "roughnessFactor":7}},"normalTexture":{{"index":2}},"emissiveTexture":{{"index":5}},
          "occlusionTexture":{{"index":1,"texCoord":4000000000}}}}],
        "extensionsUsed":["XX_texture","XX_unknown"]"#,
        one_primitive(r#""POSITION":0"#, r#","material":0"#)
    );
    let loaded = triangle().load(&rest);
    let m = &loaded.scene.materials()[0];
    assert!(m.base_color_texture.is_none() && m.metallic_roughness_texture.is_none() && m.normal.is_none());
    assert_eq!((m.roughness, loaded.scene.textures().len()), (1.0, 0));
    assert_eq!(loaded.missing_files, ["no%20such.png"]);
    for part in [
        "no%20such.png",
        "skipped image 1",
        "texture 2 has no image",
        "texture 5",
        "uv set 4000000000",
        "XX_unknown",
    ] {
        assert_eq!(warned(&loaded, part), 1, "{part}: {:?}", loaded.warnings);
    }
}

#[test]
fn uv_sets_that_the_mesh_lacks_are_zero() {
    let rest = format!(
        r#"{},"images":[{{"uri":"{PIXEL}"}}],"textures":[{{"source":0}}],
        "materials":[{{"emissiveTexture":{{"index":0,"texCoord":2}}}}]"#,
        one_primitive(r#""POSITION":0"#, r#","material":0"#)
    );
    let loaded = triangle().load(&rest);
    assert_eq!(
        (loaded.scene.meshes()[0].uvs().len(), warned(&loaded, "uv sets that its mesh lacks")),
        (3, 1)
    );
}

/// A hundred thousand primitives over the same vertices: a small file must not request gigabytes.
#[test]
fn sharing_data_without_end_is_refused() {
    let mut maker = Maker::default();
    maker.floats(&[0.0; 30_000], "VEC3");
    let primitive = r#"{"attributes":{"POSITION":0}}"#;
    let primitives = vec![primitive; 100_000].join(",");
    let rest = format!(r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{primitives}]}}]"#);
    let error = maker.try_load(&rest).unwrap_err();
    assert!(error.contains("bytes too often"), "{error}");
}

/// The list in the documentation matches the reader's own.
#[test]
fn the_documentation_lists_every_extension() {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/gltf.md")).unwrap();
    let rows = page.lines().filter_map(|line| line.strip_prefix("| ")?.split_once(" |"));
    let listed: BTreeSet<&str> = rows.map(|(name, _)| name).filter(|name| *name != "extension").collect();
    assert_eq!(listed, BTreeSet::from(taotie_io::GLTF_EXTENSIONS));
}

/// Small files with modified bytes load or fail; they never panic.
#[test]
fn damaged_variants_never_panic() {
    let mut maker = triangle();
    maker.accessor(&[0, 1, 0, 0].repeat(3), (3, 5121, "VEC4"), "");
    maker.floats(&[1.0, 0.0, 0.0, 0.0].repeat(3), "VEC4");
    maker.floats(&[0.0, 1.0], "SCALAR");
    maker.floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0], "VEC4");
    let attributes = r#""POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2"#;
    let animation = r#"{"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}},
        {"sampler":1,"target":{"node":1,"path":"rotation"}}],
        "samplers":[{"input":3,"output":3},{"input":3,"output":4,"interpolation":"LINEAR"}]}"#;
    let text = maker.text(&format!(
        r#""nodes":[{{"mesh":0,"skin":0,"children":[1]}},{{"translation":[1,2,3]}}],"skins":[{{"joints":[0,1]}}],
        "meshes":[{{"primitives":[{{"attributes":{{{attributes}}},"targets":[{{"POSITION":0}}]}}],"weights":[1]}}],
        "animations":[{animation}]"#
    ));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.gltf");
    let mut seed = 7u64;
    let mut below = |bound: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % bound
    };
    for _ in 0..3000 {
        let mut bytes = text.clone().into_bytes();
        for _ in 0..1 + below(3) {
            let digits: Vec<usize> = (0..bytes.len()).filter(|i| bytes[*i].is_ascii_digit()).collect();
            bytes[digits[below(digits.len())]] = b"0123456789-.e"[below(13)];
        }
        std::fs::write(&path, &bytes).unwrap();
        let _ = load(&path);
    }
}
