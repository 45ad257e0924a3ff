//! OBJ, PLY and STL: third-party files, and small ones with known values.

use crate::files::data_files;
use std::path::Path;
use taotie_engine::image::{Encoding, Texels, Wrap};
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{AlphaMode, Material, NormalSpace};
use taotie_io::{Loaded, load_model};

/// Loads the first of some small files, all put into one folder.
fn load(files: &[(&str, &[u8])]) -> taotie_engine::Result<Loaded> {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).expect("a file");
    }
    load_model(folder.path().join(files[0].0))
}

fn obj(text: &str) -> Loaded {
    load(&[("a.obj", text.as_bytes())]).expect("a valid file")
}

fn error(name: &str, bytes: &[u8]) -> String {
    let text = load(&[(name, bytes)]).err().map(|e| e.to_string()).unwrap_or_default();
    assert!(text.contains(name) && !text.contains('\n'), "{text}");
    text
}

/// The material of a square with the given MTL statements, and the given images next to it.
fn material(mtl: &str, pictures: &[(&str, Vec<u8>)]) -> (Material, Loaded) {
    let square = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                  usemtl m\nf 1/1 2/2 3/3 4/4\n";
    let comment = mtl.split_inclusive('\n').next().filter(|line| line.starts_with('#')).unwrap_or_default();
    let mtl = format!("{comment}newmtl m\n{}", &mtl[comment.len()..]);
    let mut files = vec![("a.obj", square.as_bytes()), ("a.mtl", mtl.as_bytes())];
    files.extend(pictures.iter().map(|(name, bytes)| (*name, bytes.as_slice())));
    let loaded = load(&files).expect("a valid file");
    (loaded.scene.materials()[0].clone(), loaded)
}

/// A PNG of 32 × 32 RGB texels.
fn png(texel: impl Fn(f32, f32) -> [f32; 3]) -> Vec<u8> {
    let mut rgb = Vec::new();
    for i in 0..1024 {
        let texel = texel((i % 32) as f32 / 31.0, (i / 32) as f32 / 31.0);
        rgb.extend(texel.map(|v| (v * 255.0).round() as u8));
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 32, 32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().and_then(|mut w| w.write_image_data(&rgb)).expect("an image");
    bytes
}

fn unit(x: f32, y: f32, z: f32) -> [f32; 3] {
    let length = (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|v| v / length * 0.5 + 0.5)
}

fn area(mesh: &Mesh) -> f64 {
    (0..mesh.triangles().len())
        .map(|i| {
            let [a, b, c] = mesh.corners(i).map(|p| p.to_f64());
            (b - a).cross(c - a).length() / 2.0
        })
        .sum()
}

fn notes(loaded: &Loaded) -> Vec<String> {
    loaded.warnings.iter().map(|(what, count)| format!("{count} {what}")).collect()
}

#[test]
fn every_file_loads_or_says_why_not_in_one_line() {
    for path in data_files("", &["obj", "ply", "stl"]) {
        match load_model(&path) {
            Ok(loaded) => assert!(loaded.scene.triangle_count() > 0, "{}", path.display()),
            Err(error) => {
                let text = error.to_string();
                assert!(!text.contains('\n') && text.len() < 500, "{text}");
                assert!(text.contains(&*path.file_name().expect("a name").to_string_lossy()), "{text}");
            }
        }
    }
}

#[test]
fn every_scan_loads_whole_and_as_another_reader_has_it() {
    for sub in ["odedstein-meshes", "threedscans-keijiro"] {
        for path in data_files(sub, &["obj", "ply", "stl"]) {
            let loaded = load_model(&path).unwrap_or_else(|e| panic!("{e}"));
            if path.extension().is_some_and(|e| e == "obj") {
                compare_with_tobj(&path, &loaded);
            }
        }
    }
}

/// Quadrilaterals may be triangulated differently, so corners are compared as sets if there are any.
fn compare_with_tobj(path: &Path, loaded: &Loaded) {
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ..Default::default() };
    let (models, _) = tobj::load_obj(path, &options).expect("a valid file");
    let mut theirs: Vec<[u32; 8]> = Vec::new();
    for mesh in models.iter().map(|m| &m.mesh) {
        for i in 0..mesh.positions.len() / 3 {
            let uv = mesh.texcoords.get(2 * i..2 * i + 2).map_or([0.0; 2], |t| [t[0], 1.0 - t[1]]);
            let n = mesh.normals.get(3 * i..3 * i + 3).map_or([0.0; 3], |n| [n[0], n[1], n[2]]);
            let p = &mesh.positions[3 * i..3 * i + 3];
            theirs.push([p[0], p[1], p[2], uv[0], uv[1], n[0], n[1], n[2]].map(rounded));
        }
    }
    let mut ours: Vec<[u32; 8]> = Vec::new();
    for mesh in loaded.scene.meshes() {
        for (i, p) in mesh.positions().iter().enumerate() {
            let uv = mesh.uvs().first().map_or([0.0; 2], |uvs| [uvs[i].x, uvs[i].y]);
            let n = mesh.normals().get(i).map_or([0.0; 3], |n| n.to_array());
            ours.push([p.x, p.y, p.z, uv[0], uv[1], n[0], n[1], n[2]].map(rounded));
        }
    }
    theirs.sort_unstable();
    ours.sort_unstable();
    assert_eq!(ours.len(), theirs.len(), "{}", path.display());
    let equal = ours.iter().zip(&theirs).filter(|(a, b)| a == b).count();
    assert!(equal * 1000 >= ours.len() * 999, "{}: {equal} of {}", path.display(), ours.len());
    let triangles: usize = models.iter().map(|m| m.mesh.indices.len() / 3).sum();
    assert_eq!(loaded.scene.triangle_count(), triangles, "{}", path.display());
}

/// The bits without the last few, which are changed by normalisation.
fn rounded(v: f32) -> u32 {
    let coarse = (v * 1024.0).round() / 1024.0 + 0.0;
    coarse.to_bits()
}

#[test]
fn obj_negative_indices_quads_and_uv_origin() {
    let loaded = obj("v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nvt 0 0\nvt 1 0.25\nvn 0 0 2\n\
                      f -4/1/1 -3/-1/1 -2/2/-1 -1/1/1");
    let mesh = &loaded.scene.meshes()[0];
    assert_eq!((mesh.positions().len(), mesh.triangles()), (4, &[[0, 1, 2], [0, 2, 3]][..]));
    assert_eq!((mesh.uvs()[0][0].y, mesh.uvs()[0][1].y), (1.0, 0.75));
    assert_eq!(mesh.normals()[3].to_array(), [0.0, 0.0, 1.0]);
    assert!(loaded.warnings.is_empty() && loaded.format == "OBJ");
}

#[test]
fn obj_concave_polygons_keep_their_area() {
    let comb = "v 0 0 0\nv 7 0 0\nv 7 3 0\nv 6 3 0\nv 6 1 0\nv 4 1 0\nv 4 3 0\nv 3 3 0\nv 3 1 0\nv 1 1 0\n\
                v 1 3 0\nv 0 3 0\nf 1 2 3 4 5 6 7 8 9 10 11 12";
    let loaded = obj(comb);
    assert_eq!(loaded.scene.meshes()[0].triangles().len(), 10);
    assert!((area(&loaded.scene.meshes()[0]) - 13.0).abs() < 1e-6);
    let upright = obj(&comb.replace(" 0\n", " 5\n"));
    assert!((area(&upright.scene.meshes()[0]) - area(&loaded.scene.meshes()[0])).abs() < 1e-6);
}

#[test]
fn obj_in_other_encodings_and_with_continued_lines() {
    let text = "\u{FEFF}# 鼎\r\nv 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nusemtl d\u{e4}k\r\nf 1 \\\r\n2 3\r\n";
    let utf16: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let latin: Vec<u8> = text.chars().skip(5).map(|c| c as u32 as u8).collect();
    for bytes in [text.as_bytes().to_vec(), utf16, latin, text.replace("\r\n", "\r").into_bytes()] {
        let loaded = load(&[("a.obj", &bytes)]).expect("a valid file");
        assert_eq!((loaded.scene.triangle_count(), loaded.scene.materials()[0].name.as_str()), (1, "däk"));
    }
}

#[test]
fn obj_is_split_by_material_and_by_what_faces_have() {
    let loaded = obj("v 0 0 0 1 0 0\nv 1 0 0 1 1 1\nv 0 1 0\nvt 0 0\nusemtl a b\nf 1/1 2/1 3/1\nf 1 2 3\n\
                      usemtl c\nf 1 2 3\nusemtl a b\nf 3 2 1\nf 1/1 2 3\nf 1 2\nl 1 2");
    let triangles: Vec<usize> = loaded.scene.meshes().iter().map(|m| m.triangles().len()).collect();
    assert_eq!(triangles, [1, 3, 1]);
    let materials: Vec<usize> = loaded.scene.instances().iter().map(|i| i.material).collect();
    assert_eq!((materials, loaded.scene.materials().len()), (vec![0, 0, 1], 2));
    assert_eq!(loaded.scene.materials()[0].name, "a b");
    assert_eq!(loaded.scene.meshes()[0].colors()[..2], [[1.0, 0.0, 0.0, 1.0], [1.0; 4]]);
    let notes = notes(&loaded);
    assert!(notes.iter().any(|n| n.starts_with("1 faces with unusable uvs")), "{notes:?}");
    assert!(notes.iter().any(|n| n.starts_with("1 skipped faces with fewer than three")), "{notes:?}");
    assert!(notes.iter().any(|n| n.starts_with("1 line statements")), "{notes:?}");
}

#[test]
fn obj_content_that_is_not_read_is_counted() {
    let loaded = obj("v 0 0 0 1 0 0 .5\nv 1 0 0 1 1 1 1\nv 0 1 0\nf 1 2 3\ncall b.obj\nbzp 1 2 3\n");
    let expected = [
        "1 ignored alpha of vertex colours",
        "1 skipped statements that include other files",
        "1 free-form curves and surfaces are not drawn",
    ];
    assert_eq!(notes(&loaded), expected);
    assert_eq!(loaded.scene.meshes()[0].colors()[0], [1.0, 0.0, 0.0, 1.0]);
}

#[test]
fn obj_meshes_have_the_names_of_their_objects() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n";
    let named = obj(&format!("{vertices}o lid\nf 1 2 3\no foot of bronze\nf 1 2 3\nusemtl red\nf 2 3 1\n"));
    assert_eq!(named.mesh_names, ["lid, foot of bronze", "foot of bronze"]);
    let grouped = obj(&format!("{vertices}f 1 2 3\ng lid\nf 1//1 2//1 3//1\n"));
    assert_eq!(grouped.mesh_names, ["mesh 0", "lid"]);
    assert!(obj(&format!("{vertices}f 1 2 3\n")).mesh_names.is_empty());
    // Objects that are named for baking stay apart, also if another comes between their faces.
    let pair = "o lid_low\nf 1 2 3\no foot_low\nf 1 2 3\no lid_low\nf 2 3 1\n";
    let apart = obj(&format!("{vertices}f 1 2 3\n{pair}"));
    assert_eq!(apart.mesh_names, ["mesh 0", "lid_low", "foot_low"]);
    assert_eq!(apart.objects.names, apart.mesh_names);
    let triangles: Vec<usize> = apart.scene.meshes().iter().map(|mesh| mesh.triangles().len()).collect();
    assert_eq!(triangles, [1, 2, 1]);
}

#[test]
fn vertex_colours_are_decoded_from_srgb() {
    let loaded = obj("v 0 0 0 .5 .5 .5\nv 1 0 0 0 0 0\nv 0 1 0 1 1 1\nf 1 2 3");
    let grey = loaded.scene.meshes()[0].colors()[0][0];
    assert!((grey - 0.214_041).abs() < 1e-6, "{grey}");
    assert_eq!(loaded.scene.materials()[0].base_color, [1.0; 4]);
    let bytes = obj("v 0 0 0 127.5 127.5 127.5\nv 1 0 0 0 0 0\nv 0 1 0 255 255 255\nf 1 2 3");
    assert!((bytes.scene.meshes()[0].colors()[0][0] - 0.214_041).abs() < 1e-6);
}

#[test]
fn obj_errors_name_file_and_line() {
    assert!(error("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4").contains("line 4: vertex index 4"));
    assert!(error("a.obj", b"v 0 0 0\nv nan 0 0").contains("line 2: "));
    assert!(error("a.obj", b"").contains("no face"));
    assert!(error("a.obj", &[0x7F; 5000]).contains("no face"));
}

#[test]
fn mtl_numbers_reach_the_material() {
    let (m, loaded) = material("Ka .1 .2 .3\nKd .4 .5 .6\nKs .7 .8 .9\nNs 30\nKe 1 2 3\nTr .25", &[]);
    assert_eq!(m.base_color, [0.4, 0.5, 0.6, 0.75]);
    assert!((m.roughness - 0.5).abs() < 1e-6, "α² = 2/32 makes roughness a half: {}", m.roughness);
    assert_eq!((m.metallic, m.emissive, m.alpha), (0.0, [1.0, 2.0, 3.0], AlphaMode::Blend));
    let classic = m.classic;
    assert_eq!((classic.ambient, classic.diffuse), (Some([0.1, 0.2, 0.3]), Some([0.4, 0.5, 0.6])));
    assert_eq!((classic.specular, classic.shininess), (Some([0.7, 0.8, 0.9]), Some(30.0)));
    assert!(loaded.warnings.is_empty());
    let (m, _) = material("Ns 30\nPr .2\nPm .9\nd .5\nTr .9", &[]);
    assert_eq!((m.roughness, m.metallic, m.base_color[3]), (0.2, 0.9, 0.5));
}

#[test]
fn mtl_by_blender_is_read_as_blender_does() {
    let grey = [("a.png", png(|_, _| [0.5; 3]))];
    let read = |header: &str, shininess: &str| {
        material(&format!("{header}Ns {shininess}\nKd 0.8 0.8 0.8\nmap_Kd a.png\n"), &grey).0
    };
    let new = read("# Blender 4.2.3 LTS MTL File: 'None'\n", "250");
    assert!((new.roughness - 0.5).abs() < 1e-6, "{}", new.roughness);
    assert_eq!(new.base_color, [1.0; 4], "the texture replaces the colour");
    let old = read("# Blender MTL File: 'vase.blend'\n", "323.999994");
    assert!((old.roughness - 0.4).abs() < 1e-4, "{}", old.roughness);
    let other = read("# by hand\n", "250");
    assert_eq!(other.base_color, [0.8, 0.8, 0.8, 1.0], "they are multiplied");
    assert!((other.roughness - 0.2985).abs() < 1e-3, "{}", other.roughness);
}

#[test]
fn missing_files_are_named_and_drawn_without() {
    let (m, loaded) = material("map_Kd C:\\art\\none.png\nrefl x.png", &[]);
    assert!(m.base_color_texture.is_none());
    assert_eq!(loaded.missing_files, ["C:\\art\\none.png"]);
    let notes = notes(&loaded);
    assert!(notes.iter().any(|n| n.contains("none.png")), "{notes:?}");
    assert!(notes.iter().any(|n| n.contains("ignored MTL statement 'refl'")), "{notes:?}");
    let single = obj("mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3");
    assert_eq!(single.missing_files, ["gone.mtl"]);
    let (_, broken) = material("map_Kd a.png", &[("a.png", b"not a picture".to_vec())]);
    assert!(broken.missing_files.is_empty() && notes_contain(&broken, "a.png"));
}

fn notes_contain(loaded: &Loaded, what: &str) -> bool {
    loaded.warnings.iter().any(|(note, _)| note.contains(what))
}

#[test]
fn texture_options_place_the_picture() {
    let (m, loaded) = material(
        "Kd 0 0 0\nmap_Kd -s 2 3 1 -o .5 .25 -clamp on Bild 1.png",
        &[("bild 1.PNG", png(|u, _| [u; 3]))],
    );
    let texture = m.base_color_texture.expect("a texture");
    let uv = texture.transform.apply(taotie_engine::math::Vec2::new(0.5, 1.0 - 0.5));
    assert_eq!((uv.x, 1.0 - uv.y), (0.5 * 2.0 + 0.5, 0.5 * 3.0 + 0.25));
    assert_eq!((texture.sampler.wrap_u, texture.sampler.wrap_v), (Wrap::Clamp, Wrap::Clamp));
    assert_eq!(loaded.scene.textures()[0].encoding(), Encoding::Srgb);
    assert_eq!(m.base_color, [1.0; 4]);
    assert!(notes_contain(&loaded, "Kd 0 0 0"));
}

#[test]
fn maps_that_share_a_texture_but_not_its_options_are_noted() {
    let grey = |name| (name, png(|u, _| [u; 3]));
    for (mtl, note) in [
        (
            "map_Kd -s 2 2 a.png\nmap_d b.png",
            "map_d and map_Kd have different options; using those of map_Kd",
        ),
        (
            "map_Pr a.png\nmap_Pm -clamp on b.png",
            "map_Pm and map_Pr have different options; using those of map_Pr",
        ),
        ("map_Kd -mm 0 2 a.png", "ignored MTL option '-mm'"),
    ] {
        let (_, loaded) = material(mtl, &[grey("a.png"), grey("b.png")]);
        assert_eq!(notes(&loaded), [format!("1 {note}")], "{mtl}");
    }
    let (_, loaded) = material("map_Kd -s 2 2 a.png\nmap_d -s 2 2 b.png", &[grey("a.png"), grey("b.png")]);
    assert!(loaded.warnings.is_empty(), "{:?}", notes(&loaded));
}

#[test]
fn map_bump_is_told_by_its_pixels() {
    let waves = |u: f32, v: f32| unit((u * 9.0).fract() - 0.5, (v * 7.0).fract() - 0.5, 1.0);
    let (m, _) = material("map_Bump -bm 2 n.png", &[("n.png", png(waves))]);
    let normal = m.normal.expect("a normal map");
    assert_eq!((normal.scale, normal.space, m.height), (2.0, NormalSpace::Tangent, None));

    let (m, loaded) = material("bump h.png -bm .05", &[("h.png", png(|u, v| [u * v; 3]))]);
    let height = m.height.expect("a height map");
    assert_eq!((height.scale, m.normal), (0.05, None));
    assert_eq!(loaded.scene.textures()[height.texture.texture].encoding(), Encoding::Linear);

    let everywhere = |u: f32, v: f32| unit(u - 0.5, v - 0.5, (u * 5.0).fract() - 0.5);
    let (m, _) = material("norm o.png", &[("o.png", png(everywhere))]);
    assert_eq!(m.normal.expect("a normal map").space, NormalSpace::Object);

    let (m, loaded) = material("bump -imfchan g c.png", &[("c.png", png(|u, _| [1.0, u, 0.0]))]);
    let height = m.height.expect("a height map").texture.texture;
    assert_eq!(loaded.scene.textures()[height].texel(0, 31, 0)[0], 1.0);
    assert_eq!(loaded.scene.textures()[height].texel(0, 0, 0)[0], 0.0);
}

#[test]
fn roughness_and_metalness_maps_become_one() {
    let grey = |v: f32| png(move |_, _| [v; 3]);
    let (m, loaded) =
        material("Pr .1\nPm .2\nmap_Pr r.png\nmap_Pm m.png", &[("r.png", grey(0.4)), ("m.png", grey(0.8))]);
    let texture = m.metallic_roughness_texture.expect("a texture").texture;
    assert_eq!(loaded.scene.textures().len(), 1);
    assert!(
        matches!(loaded.scene.textures()[texture].bitmap().texels(), Texels::U8(t) if t[0] == [255, 102, 204, 255])
    );
    assert_eq!((m.roughness, m.metallic), (1.0, 1.0));

    let (m, loaded) = material("Pr .1\nPm .2\nmap_Pr r.png\nmap_Pm gone.png", &[("r.png", grey(0.4))]);
    assert_eq!((m.roughness, m.metallic), (1.0, 0.2));
    assert_eq!(loaded.missing_files, ["gone.png"]);

    let packed = png(|_, v| [1.0, 0.2, v]);
    let (m, loaded) = material("map_Pr p.png\nmap_Pm p.png", &[("p.png", packed)]);
    let texture = m.metallic_roughness_texture.expect("a texture").texture;
    assert!((loaded.scene.textures()[texture].texel(0, 0, 31)[1] - 0.2).abs() < 1e-6);
    assert_eq!(loaded.scene.textures()[texture].texel(0, 0, 31)[2], 1.0);
}

#[test]
fn opacity_maps_go_into_the_base_colour() {
    let mask = png(|u, _| [if u < 0.5 { 0.0 } else { 1.0 }; 3]);
    let red = png(|_, _| [1.0, 0.0, 0.0]);
    let (m, loaded) = material("map_Kd c.png\nmap_d d.png", &[("c.png", red), ("d.png", mask)]);
    assert_eq!(m.alpha, AlphaMode::Mask(0.5));
    let texture = &loaded.scene.textures()[m.base_color_texture.expect("a texture").texture];
    assert_eq!(
        (texture.texel(0, 0, 0), texture.texel(0, 31, 0)),
        ([1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 1.0])
    );
    let (m, _) = material("map_d d.png", &[("d.png", png(|u, _| [u; 3]))]);
    assert_eq!(m.alpha, AlphaMode::Blend);
}
