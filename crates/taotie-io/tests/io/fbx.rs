//! FBX: `panel.fbx` and variants of its text, with known values; and a file by Blender.

use taotie_engine::Error;
use taotie_engine::image::Encoding;
use taotie_engine::math::Vec3;
use taotie_engine::scene::{AlphaMode, Material};
use taotie_io::{Bytes, Limits, Loaded, PngColor, PngImage, PngSamples, encode_png, load_model_within};

const PANEL: &str = include_str!("../../../../tests/data/meshes/panel.fbx");

/// A grey image, which is not a normal map.
fn grey_png() -> Vec<u8> {
    let samples: Vec<u8> = (0..64).map(|i| i * 3).collect();
    let samples = PngSamples::U8(&samples);
    encode_png(&PngImage { width: 8, height: 8, color: PngColor::Grey, samples, encoding: Encoding::Linear })
        .unwrap()
}

/// Loads text as `a.fbx` in a folder with the images that it names.
fn load_within(bytes: &[u8], limits: Limits) -> taotie_engine::Result<Loaded> {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("maps")).expect("a folder");
    for name in ["bricks.png", "relief.png"] {
        std::fs::write(folder.path().join("maps").join(name), grey_png()).expect("a file");
    }
    let path = folder.path().join("a.fbx");
    std::fs::write(&path, bytes).expect("a file");
    load_model_within(&path, &limits)
}

fn load(text: &str) -> Loaded {
    load_within(text.as_bytes(), Limits::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn error(bytes: &[u8], limits: Limits) -> Error {
    let error = load_within(bytes, limits).expect_err("it is refused");
    let text = error.to_string();
    assert!(text.contains("a.fbx") && !text.contains('\n'), "{text}");
    error
}

/// Replaces what must be there.
fn with(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from}");
    text.replace(from, to)
}

fn notes(loaded: &Loaded) -> Vec<String> {
    loaded.warnings.iter().map(|(what, count)| format!("{count} {what}")).collect()
}

/// Returns the corners of an instance's triangles in world space, in µm.
fn corners(loaded: &Loaded, instance: usize) -> Vec<[i64; 3]> {
    let instance = &loaded.scene.instances()[instance];
    let mesh = &loaded.scene.meshes()[instance.mesh];
    let world = |corner: &u32| {
        let p = instance.world_from_object.transform_point(mesh.positions()[*corner as usize].to_f64());
        p.to_array().map(|v| (v * 1e6).round() as i64)
    };
    mesh.triangles().as_flattened().iter().map(world).collect()
}

#[test]
fn nodes_geometric_transforms_unit_and_axes_are_applied() {
    let loaded = load(PANEL);
    assert_eq!(loaded.format, "FBX");
    assert_eq!(loaded.generator.as_deref(), Some("written by hand"));
    assert_eq!(loaded.objects.names, ["panel_high", "panel_low", "roof"]);
    assert_eq!(*loaded.objects.of_instances, [0, 0, 1, 1, 2]);
    assert_eq!(loaded.mesh_names, ["panel", "panel", "roof"]);
    // Half as high, turned by 90° about z, moved by 1 m along x; z becomes y.
    let m = 1_000_000;
    let left = [[0, 0], [1, 0], [1, 2], [0, 0], [1, 2], [0, 2]];
    assert_eq!(corners(&loaded, 0), left.map(|[u, v]| [m, v * m, -u * m]));
    assert_eq!(corners(&loaded, 1), left.map(|[u, v]| [m, v * m, -(u + 1) * m]));
    assert_eq!(corners(&loaded, 2), left.map(|[u, v]| [u * m, (10 + 2 * v) * m, 0]));
    let inches = load(&with(
        PANEL,
        "\"UnitScaleFactor\", \"double\", \"Number\", \"\",1",
        "\"UnitScaleFactor\", \"double\", \"Number\", \"\",2.54",
    ));
    assert_eq!(corners(&inches, 0)[2], [2_540_000, 5_080_000, -2_540_000]);
}

#[test]
fn y_up_stays_and_left_handed_files_are_mirrored() {
    let up =
        with(PANEL, "\"UpAxis\", \"int\", \"Integer\", \"\",2", "\"UpAxis\", \"int\", \"Integer\", \"\",1");
    let up = with(
        &up,
        "\"FrontAxis\", \"int\", \"Integer\", \"\",1",
        "\"FrontAxis\", \"int\", \"Integer\", \"\",2",
    );
    let up = with(
        &up,
        "\"FrontAxisSign\", \"int\", \"Integer\", \"\",-1",
        "\"FrontAxisSign\", \"int\", \"Integer\", \"\",1",
    );
    assert_eq!(corners(&load(&up), 2)[2], [1_000_000, 0, 14_000_000]);
    let left = with(
        &up,
        "\"FrontAxisSign\", \"int\", \"Integer\", \"\",1",
        "\"FrontAxisSign\", \"int\", \"Integer\", \"\",-1",
    );
    let left = load(&left);
    assert_eq!(corners(&left, 2)[2], [1_000_000, 0, -14_000_000]);
    assert!(left.scene.instances()[2].world_from_object.determinant3() < 0.0);
}

#[test]
fn attributes_of_corners() {
    let loaded = load(PANEL);
    let [left, right] = [0, 1].map(|i| &loaded.scene.meshes()[i]);
    assert_eq!((left.triangles().len(), left.positions().len()), (2, 4));
    assert!(left.normals().iter().all(|n| n.to_array() == [0.0, -1.0, 0.0]));
    let normals: Vec<[f32; 3]> = right.normals().iter().map(|n| n.to_array()).collect();
    assert_eq!(normals, [[0.0, -1.0, 0.0], [0.6, -0.8, 0.0], [0.6, -0.8, 0.0], [0.0, -1.0, 0.0]], "unit");
    let uvs: Vec<Vec<[f32; 2]>> =
        right.uvs().iter().map(|set| set.iter().map(|uv| [uv.x, uv.y]).collect()).collect();
    assert_eq!(uvs[0], [[0.5, 1.0], [1.0, 1.0], [1.0, 0.0], [0.5, 0.0]], "the origin is at the top");
    assert_eq!(uvs[1], [[0.25, 0.75], [0.25, 0.75], [0.75, 0.25], [0.75, 0.25]]);
    let [red, green, blue, alpha] = right.colors()[0];
    assert!((green - 0.214_041).abs() < 1e-5 && [red, blue, alpha] == [1.0, 0.0, 1.0], "sRGB: {green}");
    assert_eq!(right.colors()[2], [0.0, 0.0, 1.0, 0.25], "the other colour");
}

#[test]
fn smoothing_gives_normals_and_nothing_gives_none() {
    let roof = |smoothing: &str| load(&with(PANEL, "a: 1,1\n", smoothing)).scene.meshes()[2].clone();
    let (hard, smooth) = (roof("a: 0,0\n"), roof("a: 1,1\n"));
    assert_eq!((hard.positions().len(), smooth.positions().len()), (7, 5));
    assert!(hard.normals()[..4].iter().all(|n| n.to_array() == [0.0, -1.0, 0.0]));
    let between = Vec3::new(0.0, -1.0, -1.0);
    assert!(smooth.normals()[0].dot(between) > 1.0, "{:?}", smooth.normals()[0]);
    let start = PANEL.find("\t\tLayerElementSmoothing").expect("a layer");
    let end = start + PANEL[start..].find("\n\t}\n").expect("its end");
    let plain = load(&format!("{}{}", &PANEL[..start], &PANEL[end..]));
    assert!(plain.scene.meshes()[2].normals().is_empty());
    assert_eq!(plain.scene.meshes()[2].positions().len(), 5);
}

#[test]
fn materials_are_converted_like_those_of_mtl() {
    let loaded = load(PANEL);
    let of = |instance: usize| {
        let index = loaded.scene.instances()[instance].material;
        &loaded.scene.materials()[index]
    };
    let names: Vec<&str> = (0..5).map(|i| of(i).name.as_str()).collect();
    assert_eq!(names, ["bricks", "glass", "glass", "bricks", ""], "nodes have their own materials");
    let Material { base_color, roughness, classic, base_color_texture, height, .. } = of(0);
    assert_eq!(*base_color, [0.5, 0.5, 0.5, 1.0], "the texture replaces the colour, not the factor");
    assert!((roughness - (2.0f32 / 32.0).sqrt().sqrt()).abs() < 1e-6, "{roughness}");
    assert_eq!((classic.ambient, classic.specular), (Some([0.25; 3]), Some([0.5; 3])));
    let bricks = base_color_texture.expect("a texture");
    assert_eq!((bricks.uv_set, loaded.texture_names[bricks.texture].as_str()), (1, "maps\\bricks.png"));
    assert_eq!(bricks.transform.linear, [[2.0, 0.0], [0.0, 2.0]]);
    let relief = height.expect("a height map");
    assert!((relief.scale - 0.02).abs() < 1e-6, "in metres: {}", relief.scale);
    assert_eq!((loaded.files.len(), loaded.missing_files.len()), (2, 0));
    let glass = of(1);
    assert_eq!((glass.base_color, glass.emissive), ([0.1, 0.2, 0.3, 0.75], [2.0, 1.0, 0.0]));
    assert_eq!(glass.alpha, AlphaMode::Blend);
    assert_eq!(notes(&loaded), Vec::<String>::new());
}

#[test]
fn embedded_images_need_no_file() {
    use base64::Engine;
    let image = base64::engine::general_purpose::STANDARD.encode(grey_png());
    let video = format!(
        "\tVideo: 500, \"Video::inner\", \"Clip\" {{\n\t\tType: \"Clip\"\n\t\tFilename: \"inner.png\"\n\t\tContent: ,\n\t\t\t\"{image}\"\n\t}}\n\
         }}\nConnections:  {{\n\tC: \"OO\",500,400\n"
    );
    let text = with(PANEL, "}\nConnections:  {\n", &video);
    let text = with(&text, "maps\\bricks.png", "nowhere\\inner.png");
    let loaded = load(&text);
    assert!(loaded.scene.materials()[0].base_color_texture.is_some(), "{:?}", notes(&loaded));
    assert_eq!((loaded.files.len(), loaded.missing_files.len()), (1, 0));
    let damaged = load(&with(&text, &image[..8], "AAAAAAAA"));
    assert!(damaged.scene.materials()[0].base_color_texture.is_none());
    assert!(notes(&damaged)[0].contains("skipped texture 'nowhere\\\\inner.png'"), "{:?}", notes(&damaged));
}

#[test]
fn missing_images_and_those_outside_are_noted() {
    let loaded = load(&with(PANEL, "maps\\bricks.png", "maps\\none.png"));
    assert_eq!(notes(&loaded), ["1 skipped texture 'maps\\\\none.png': file not found"]);
    assert_eq!(loaded.missing_files, ["maps\\none.png"]);
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("inner")).expect("a folder");
    std::fs::write(folder.path().join("outer.png"), grey_png()).expect("a file");
    let path = folder.path().join("inner/a.fbx");
    std::fs::write(&path, with(PANEL, "maps\\bricks.png", "..\\outer.png")).expect("a file");
    let read = |allow_outside: bool| {
        let limits = Limits { allow_outside, ..Limits::default() };
        load_model_within(&path, &limits).unwrap_or_else(|e| panic!("{e}"))
    };
    assert!(notes(&read(false))[0].contains("--allow-outside"));
    assert!(read(true).scene.materials()[0].base_color_texture.is_some());
}

#[test]
fn hidden_nodes_hide_those_below_them_unless_these_do_not_inherit() {
    let hidden = "\"A\",0,0,90\n\t\t\tP: \"Visibility\", \"Visibility\", \"\", \"A\",0";
    let text = with(PANEL, "\"A\",0,0,90", hidden);
    let loaded = load(&text);
    assert_eq!(loaded.objects.names, ["panel_low", "roof"]);
    assert!(notes(&loaded).contains(&"1 skipped hidden meshes".into()), "{:?}", notes(&loaded));
    let inheritance = |value: i32| {
        let property = format!(
            "\"A\",1,1,0.5\n\t\t\tP: \"Visibility Inheritance\", \"Visibility Inheritance\", \"\", \"\",{value}"
        );
        load(&with(&text, "\"A\",1,1,0.5", &property)).objects.names
    };
    assert_eq!(inheritance(0), ["panel_high", "panel_low", "roof"]);
    assert_eq!(inheritance(1), ["panel_low", "roof"]);
}

#[test]
fn parts_of_a_group_that_is_named_for_baking_have_its_name() {
    let names = |group: &str| {
        let text = with(PANEL, "Model::frame", &format!("Model::{group}"));
        load(&with(&text, "\"OO\",203,0", "\"OO\",203,200")).objects.names
    };
    assert_eq!(names("house_high"), ["panel_high", "panel_low", "house_high"], "the roof");
    assert_eq!(names("house"), ["panel_high", "panel_low", "roof"]);
}

#[test]
fn what_is_not_read_is_noted() {
    let objects = "\tModel: 600, \"Model::sun\", \"Light\" {\n\t\tVersion: 232\n\t}\n\
                   \tNodeAttribute: 601, \"NodeAttribute::sun\", \"Light\" {\n\t\tTypeFlags: \"Light\"\n\t}\n\
                   }\nConnections:  {\n\tC: \"OO\",600,0\n\tC: \"OO\",601,600\n\tC: \"OP\",401,301, \"ReflectionColor\"\n";
    let text = with(PANEL, "}\nConnections:  {\n", objects);
    let text = with(
        &text,
        "\"A\",0,0,2000",
        "\"A\",0,0,2000\n\t\t\tP: \"Visibility\", \"Visibility\", \"\", \"A\",0",
    );
    let text = with(&text, "a: 0,-1,0,0,-1,0,0,-1,0,0,-1,0,0,-2,0", "a: 0,0,0,0,-1,0,0,-1,0,0,-1,0,0,-2,0");
    let text = with(&text, "a: 0,0,0.5,0,1,0", "a: nan,0,0.5,0,1,0");
    let text = with(&text, "UVIndex: *8 {\n\t\t\t\ta: 0,1,4,3", "UVIndex: *8 {\n\t\t\t\ta: 0,1,99,3");
    let loaded = load(&text);
    let notes = notes(&loaded);
    for note in [
        "1 ignored lights",
        "1 skipped hidden meshes",
        "1 replaced unusable normals (zero, infinite or NaN) by those of triangles",
        "1 replaced unusable uvs (infinite or NaN) by 0",
        "1 limited indices to the values that exist",
        "1 ignored textures of properties that are not read",
    ] {
        assert!(notes.iter().any(|n| n == note), "{note}: {notes:?}");
    }
    assert_eq!(loaded.scene.meshes()[0].normals()[0].to_array(), [0.0, -1.0, 0.0]);
}

#[test]
fn limits_and_errors() {
    let memory = |bytes: u64| Limits { memory: Some(Bytes(bytes)), ..Limits::default() };
    assert!(load_within(PANEL.as_bytes(), memory(4 << 20)).is_ok());
    for bytes in [1 << 10, 20 << 10, 100 << 10] {
        assert!(matches!(error(PANEL.as_bytes(), memory(bytes)), Error::Limit { .. }), "{bytes}");
    }
    let nodes = error(PANEL.as_bytes(), Limits { nodes: 3, ..Limits::default() });
    assert!(matches!(&nodes, Error::Limit { .. }) && nodes.to_string().contains("5 nodes"), "{nodes}");
    for bytes in [&b""[..], b"Kaydara FBX Binary  \0\x1a\0\xe8\x1c\0\0", &PANEL.as_bytes()[..4000]] {
        assert!(matches!(error(bytes, Limits::default()), Error::Parse { .. }), "{} bytes", bytes.len());
    }
    let empty = error(
        with(PANEL, "\tC: \"OO\",100,201\n\tC: \"OO\",100,202\n\tC: \"OO\",101,203\n", "").as_bytes(),
        Limits::default(),
    );
    assert!(empty.to_string().contains("no polygons"), "{empty}");
    let infinite =
        error(with(PANEL, "a: 0,0,0,100,0,0,200", "a: 0,0,0,100,0,0,1e300").as_bytes(), Limits::default());
    assert!(infinite.to_string().contains("mesh 'panel': position"), "{infinite}");
}

/// A prism below an empty node, shown twice, with an embedded image.
#[test]
fn binary_files_by_blender() {
    let loaded = load_within(include_bytes!("../../../../tests/data/meshes/blender.fbx"), Limits::default());
    let loaded = loaded.unwrap_or_else(|e| panic!("{e}"));
    assert!(loaded.generator.as_deref().is_some_and(|g| g.contains("Blender")), "{:?}", loaded.generator);
    assert_eq!(loaded.objects.names, ["prism_copy", "prism_high"]);
    assert_eq!(*loaded.objects.of_instances, [0, 0, 1, 1]);
    // Two heptagons and seven quadrilaterals.
    assert_eq!(loaded.scene.meshes().iter().map(|m| m.triangles().len()).sum::<usize>(), 24);
    assert!(loaded.scene.meshes().iter().all(|m| !m.normals().is_empty() && m.uvs().len() == 1));
    let [red, stripes] = loaded.scene.materials() else { panic!("two materials") };
    let near = |a: f32, b: f32| (a - b).abs() < 1e-5;
    assert!(near(red.roughness, 0.3) && near(red.metallic, 0.75) && near(red.base_color[0], 0.8), "{red:?}");
    assert!(near(stripes.roughness, 0.5) && stripes.base_color_texture.is_some());
    assert!(loaded.files.is_empty() && loaded.missing_files.is_empty());
    assert_eq!(notes(&loaded), Vec::<String>::new());
    // Blender's x, y, z are x, z, −y here: the origin of the copy, which has the same parent.
    let origin = loaded.scene.instances()[0].world_from_object.transform_point(Vec3::splat(0.0));
    let (sin, cos) = (0.479_425_538_604_203, 0.877_582_561_890_372_8);
    let expected = [1.0 - 4.0 * sin, 3.0, -(2.0 + 4.0 * cos)];
    assert!(origin.to_array().iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{origin:?}");
}
