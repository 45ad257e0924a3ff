//! PLY and STL: small files with known values.

use taotie_io::{Loaded, load_model};

fn load(name: &str, bytes: &[u8]) -> taotie_engine::Result<Loaded> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("a file");
    load_model(&path)
}

fn sound(name: &str, bytes: &[u8]) -> Loaded {
    load(name, bytes).unwrap_or_else(|e| panic!("{e}"))
}

fn error(name: &str, bytes: &[u8]) -> String {
    let text = load(name, bytes).err().map(|e| e.to_string()).unwrap_or_default();
    assert!(text.contains(name) && !text.contains('\n'), "{text}");
    text
}

const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.5, 0.0]];

#[test]
fn ply_is_the_same_in_all_three_formats() {
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\ncomment caf\u{e9}\nelement vertex 4\nproperty uchar red\nproperty double x\n\
             property float y\nproperty float z\nproperty uchar green\nproperty uchar blue\nproperty short q\n\
             element face 1\nproperty list ushort int vertex_indices\nproperty float area\nend_header\n"
        )
    };
    let mut ascii = header("ascii");
    let mut little: Vec<u8> = header("binary_little_endian").chars().map(|c| c as u32 as u8).collect();
    let mut big = header("binary_big_endian").into_bytes();
    for [x, y, z] in SQUARE {
        ascii += &format!("255 {x} {y}\n{z} 128 0 -7 ");
        little.push(255);
        little.extend(f64::from(x).to_le_bytes());
        little.extend([y, z].map(f32::to_le_bytes).concat());
        little.extend([128, 0, 0xF9, 0xFF]);
        big.push(255);
        big.extend(f64::from(x).to_be_bytes());
        big.extend([y, z].map(f32::to_be_bytes).concat());
        big.extend([128, 0, 0xFF, 0xF9]);
    }
    ascii += "\n4 0 1 2 3 .5";
    little.extend([4, 0]);
    little.extend([0i32, 1, 2, 3].map(i32::to_le_bytes).concat());
    little.extend(0.5f32.to_le_bytes());
    big.extend([0, 4]);
    big.extend([0i32, 1, 2, 3].map(i32::to_be_bytes).concat());
    big.extend(0.5f32.to_be_bytes());
    for bytes in [ascii.into_bytes(), little, big] {
        let loaded = sound("a.ply", &bytes);
        let mesh = &loaded.scene.meshes()[0];
        assert_eq!(mesh.positions().iter().map(|p| p.to_array()).collect::<Vec<_>>(), SQUARE);
        assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
        let [r, g, b, a] = mesh.colors()[2];
        assert!((g - 0.215_861).abs() < 1e-6, "128 of 255 is sRGB-encoded: {g}");
        assert_eq!((r, b, a), (1.0, 0.0, 1.0));
        assert!(mesh.normals().is_empty() && mesh.uvs().is_empty());
        assert!(loaded.warnings.iter().all(|(what, _)| what.starts_with("ignored properties of element ")));
        assert_eq!(loaded.scene.materials()[0].base_color, [1.0; 4]);
    }
}

fn ply(vertex: &str, vertices: &str, face: &str, faces: &str) -> Vec<u8> {
    let count = |text: &str| text.lines().count();
    let properties =
        |names: &str| names.split(',').map(|n| format!("property {}\n", n.trim())).collect::<String>();
    format!(
        "ply\r\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n{}\
         element face {}\n{}end_header\n{vertices}\n{faces}\n",
        count(vertices),
        if vertex.is_empty() { String::new() } else { properties(vertex) },
        count(faces),
        properties(face),
    )
    .into_bytes()
}

const INDICES: &str = "list uchar int vertex_index";

#[test]
fn ply_float_colours_are_linear_and_normals_and_uvs_are_read() {
    let file = ply(
        "float red, float green, float blue, float alpha, float nx, float ny, float nz, float s, float t",
        "0 0 0 .5 .25 0 1 0 0 2 0 0\n1 0 0 .5 .25 0 1 0 0 2 1 0\n0 1 0 .5 .25 0 1 0 0 2 0 .75",
        INDICES,
        "3 0 1 2",
    );
    let loaded = sound("a.ply", &file);
    let mesh = &loaded.scene.meshes()[0];
    assert_eq!(mesh.colors()[0], [0.5, 0.25, 0.0, 1.0]);
    assert_eq!(mesh.normals()[0].to_array(), [0.0, 0.0, 1.0]);
    assert_eq!((mesh.uvs()[0][1].x, mesh.uvs()[0][1].y, mesh.uvs()[0][2].y), (1.0, 1.0, 0.25));
}

#[test]
fn ply_zero_normals_are_left_out_and_counted() {
    let file =
        ply("float nx, float ny, float nz", "0 0 0 0 0 1\n1 0 0 0 0 0\n0 1 0 nan 0 1", INDICES, "3 0 1 2");
    let loaded = sound("a.ply", &file);
    assert!(loaded.scene.meshes()[0].normals().is_empty());
    assert_eq!(loaded.warnings.iter().next().map(|(_, n)| n), Some(2));
}

#[test]
fn ply_uvs_and_colours_of_faces_split_vertices() {
    let square = "0 0 0\n1 0 0\n1 1 0\n0 1 0";
    let faces = "3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0 0 1 1 .5 1\n3 0 1 3 6 .1 0 1 0 0 1";
    let loaded =
        sound("a.ply", &ply("", square, "list uchar int vertex_indices, list uchar float texcoord", faces));
    let mesh = &loaded.scene.meshes()[0];
    assert_eq!((mesh.positions().len(), mesh.triangles()[1]), (6, [0, 2, 3]));
    assert_eq!((mesh.uvs()[0][0].x, mesh.uvs()[0][0].y, mesh.uvs()[0][2].y), (0.0, 1.0, 0.0));

    let faces = "3 0 1 2 255 0 0\n3 0 2 3 0 0 255";
    let face = "list uchar int vertex_indices, uchar red, uchar green, uchar blue";
    let loaded = sound("a.ply", &ply("", square, face, faces));
    let mesh = &loaded.scene.meshes()[0];
    assert_eq!((mesh.positions().len(), mesh.colors()[0]), (6, [1.0, 0.0, 0.0, 1.0]));
}

#[test]
fn ply_strips_and_polygons_become_triangles() {
    let strips = b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0 1 0 0 0 1 0 1 1 0 7 0 1 2 3 -1 0 1\n";
    let loaded = sound("a.ply", strips);
    assert_eq!(loaded.scene.meshes()[0].triangles(), [[0, 1, 2], [2, 1, 3]]);
    let arrow = ply("", "0 0 0\n4 0 0\n4 4 0\n2 1 0\n0 4 0", INDICES, "5 0 1 2 3 4\n2 0 1");
    let loaded = sound("a.ply", &arrow);
    assert_eq!(loaded.scene.meshes()[0].triangles().len(), 3);
    assert_eq!(loaded.warnings.iter().count(), 1);
}

#[test]
fn ply_names_its_texture() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = ply("float u, float v", "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1", INDICES, "3 0 1 2");
    let text =
        String::from_utf8(file).expect("text").replace("1.0\n", "1.0\ncomment TextureFile my skin.png\n");
    let path = folder.path().join("a.ply");
    std::fs::write(&path, text).expect("a file");
    let loaded = load_model(&path).expect("a valid file");
    assert_eq!(loaded.missing_files, ["my skin.png"]);
    assert!(loaded.scene.materials()[0].base_color_texture.is_none());
    std::fs::write(folder.path().join("my skin.png"), image_of(7)).expect("a file");
    let loaded = load_model(&path).expect("a valid file");
    assert!(loaded.scene.materials()[0].base_color_texture.is_some_and(|t| t.texture == 0));
    assert_eq!(loaded.texture_names, ["my skin.png"]);
}

fn image_of(grey: u8) -> Vec<u8> {
    let mut picture = Vec::new();
    let encoder = png::Encoder::new(&mut picture, 1, 1);
    encoder.write_header().and_then(|mut w| w.write_image_data(&[grey])).expect("an image");
    picture
}

/// Two squares with an edge in common, as MeshLab writes them: each with a texture number.
fn with_textures(numbers: [i32; 2], files: &[&str]) -> Vec<u8> {
    let vertices = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 0\n2 1 0";
    let face = "list uchar int vertex_indices, list uchar float texcoord, int texnumber";
    let faces =
        format!("4 0 1 2 3 8 0 0 1 0 1 1 0 1 {}\n4 1 4 5 2 8 0 0 1 0 1 1 0 1 {}", numbers[0], numbers[1]);
    let comments: String = files.iter().map(|file| format!("comment TextureFile {file}\n")).collect();
    let text = String::from_utf8(ply("", vertices, face, &faces)).expect("text");
    text.replace("1.0\n", &format!("1.0\n{comments}")).into_bytes()
}

#[test]
fn ply_faces_are_grouped_by_texture() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("vase.ply");
    for (name, grey) in [("vase_A.png", 10), ("b.png", 200)] {
        std::fs::write(folder.path().join(name), image_of(grey)).expect("a file");
    }
    let files = ["<this>_A.png", "b.png", "c.png"];
    let load = |numbers: [i32; 2]| {
        std::fs::write(&path, with_textures(numbers, &files)).expect("a file");
        load_model(&path).expect("a valid file")
    };
    let loaded = load([1, 0]);
    let scene = &loaded.scene;
    assert_eq!(loaded.texture_names, ["vase_A.png", "b.png"], "in the order of the header");
    assert!(loaded.warnings.is_empty() && loaded.missing_files.is_empty());
    let names: Vec<&str> = scene.materials().iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["vase_A.png", "b.png"]);
    let shown = scene.instances().iter().map(|instance| {
        let (mesh, material) = (&scene.meshes()[instance.mesh], &scene.materials()[instance.material]);
        let texture = material.base_color_texture.expect("a texture").texture;
        (mesh.positions()[0].x, mesh.positions().len(), mesh.triangles().len(), texture)
    });
    assert_eq!(shown.collect::<Vec<_>>(), [(1.0, 4, 2, 0), (0.0, 4, 2, 1)]);

    let loaded = load([-1, 2]);
    assert_eq!(loaded.missing_files, ["c.png"], "only files in use are opened");
    assert_eq!(
        loaded.warnings.iter().next().map(|(what, count)| (what.contains("'c.png'"), count)),
        Some((true, 1))
    );
    assert!(loaded.scene.materials().iter().all(|material| material.base_color_texture.is_none()));
    assert_eq!(load([1, 1]).scene.meshes().len(), 1);
}

#[test]
fn ply_texture_numbers_are_checked() {
    let of = |numbers| error("a.ply", &with_textures(numbers, &["a.png", "b.png"]));
    assert!(of([0, 2]).contains("face 1: texnumber 2 is out of range"));
    assert!(of([-2, 0]).contains("face 0: texnumber -2 is out of range"));
    assert!(load("a.ply", &with_textures([7, 7], &[])).is_ok(), "numbers of no textures have no meaning");
}

#[test]
fn ply_errors_name_the_place() {
    let points = ply("", "0 0 0\n1 0 0", INDICES, "");
    assert!(error("a.ply", &points).contains("point cloud (2 points, no faces)"));
    assert!(
        error("a.ply", &ply("", "0 0 0", INDICES, "3 0 0 1"))
            .contains("face 0: vertex index 1 is out of range")
    );
    assert!(error("a.ply", &ply("", "0 0 0", INDICES, "3 0 0 -1")).contains("face 0: negative vertex index"));
    assert!(error("a.ply", &ply("", "0 inf 0", INDICES, "3 0 0 0")).contains("vertex 0: the position"));
    assert!(error("a.ply", &ply("", "0 x 0", INDICES, "3 0 0 0")).contains("'x' is not a number"));
    assert!(error("a.ply", b"ply\nformat ascii 1.0\nelement vertex").contains("line 3"));
    let lie = b"ply\nformat binary_little_endian 1.0\nelement vertex 99999999999999\nproperty float x\nend_header\n";
    assert!(error("a.ply", lie).contains("only 0 bytes follow"));
    let lie = b"ply\nformat ascii 1.0\nelement vertex 99999999999999\nproperty float x\nend_header\n1\n";
    assert!(error("a.ply", lie).contains("unexpected end of file"));
    let lie = b"ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uint int vertex_index\n\
        end_header\n\xFF\xFF\xFF\xFF";
    assert!(error("a.ply", lie).contains("element face"));
}

/// A grid with more faces than are decoded at a time: quads, but every fifth is two triangles and every eleventh a
/// point. Returns the file, and its triangles.
fn large_ply(first_index_of_last_face: i32) -> (Vec<u8>, Vec<[u32; 3]>) {
    const SIDE: u32 = 300;
    let (mut vertices, mut faces, mut triangles, mut count) = (Vec::new(), Vec::new(), Vec::new(), 0);
    for i in 0..SIDE * SIDE {
        let place = [(i % SIDE) as f32, (i / SIDE) as f32 * 0.5, 0.25];
        vertices.extend(place.iter().flat_map(|v| v.to_be_bytes()));
    }
    let mut face = |corners: &[u32]| {
        faces.push(9);
        faces.push(corners.len() as u8);
        faces.extend(corners.iter().flat_map(|c| c.to_be_bytes()));
        count += 1;
    };
    for i in (0..SIDE * (SIDE - 1)).filter(|i| i % SIDE < SIDE - 1) {
        let [a, b, c, d] = [i, i + 1, i + SIDE + 1, i + SIDE];
        match i {
            i if i % 5 == 0 => [[a, b, c], [a, c, d]].iter().for_each(|t| face(t)),
            i if i % 11 == 0 => face(&[a]),
            _ => face(&[a, b, c, d]),
        }
        if i % 5 == 0 || i % 11 != 0 {
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let [a, b, c] = [first_index_of_last_face, 1, SIDE as i32];
    faces.extend([9, 3]);
    faces.extend([a, b, c].iter().flat_map(|c| c.to_be_bytes()));
    triangles.push([a as u32, b as u32, c as u32]);
    let header = format!(
        "ply\nformat binary_big_endian 1.0\nelement face {}\nproperty uchar flags\n\
         property list uchar uint vertex_indices\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nend_header\n",
        count + 1,
        SIDE * SIDE
    );
    ([header.into_bytes(), faces, vertices].concat(), triangles)
}

#[test]
fn ply_of_several_blocks_is_read_in_order() {
    let (file, triangles) = large_ply(0);
    let loaded = sound("a.ply", &file);
    let mesh = &loaded.scene.meshes()[0];
    assert_eq!(mesh.positions()[299 * 300 + 7].to_array(), [7.0, 149.5, 0.25]);
    assert!(mesh.triangles() == triangles);
    let few = loaded.warnings.iter().any(|(what, _)| what == "skipped faces with fewer than three corners");
    assert!(few, "{:?}", loaded.warnings);

    let (file, _) = large_ply(-1);
    let faces =
        String::from_utf8_lossy(&file[..80]).lines().nth(2).and_then(|l| l[13..].parse::<usize>().ok());
    let last = faces.expect("a count") - 1;
    assert!(error("a.ply", &file).contains(&format!("face {last}: negative vertex index")));
}

#[test]
fn ply_content_that_is_not_read_is_counted() {
    let file = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float quality\nproperty int flags\n\
        element face 1\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n\
        property uchar blue\nelement edge 1\nproperty int vertex1\nelement user 0\nproperty int id\nend_header\n\
        0 0 0 1 2 3 .5 1\n1 0 0 1 2 3 .5 1\n0 1 0 1 2 3 .5 1\n3 0 1 2 4 5 6\n0\n";
    let loaded = sound("a.ply", file);
    let notes: Vec<String> = loaded.warnings.iter().map(|(what, n)| format!("{n} {what}")).collect();
    let expected = [
        "2 ignored properties of element 'vertex', such as 'quality'",
        "1 ignored elements, such as 'edge'",
        "1 ignored colours of faces, since vertices have colours",
    ];
    assert_eq!(notes, expected);
}

/// Two triangles that share an edge, with one negative zero.
fn stl_triangles() -> [[[f32; 3]; 3]; 2] {
    let [a, b, c, d] = SQUARE;
    [[a, b, c], [[-0.0, 0.0, 0.0], c, d]]
}

fn binary_stl(header: &str, count: u32) -> Vec<u8> {
    let mut bytes = header.as_bytes().to_vec();
    bytes.resize(80, b' ');
    bytes.extend(count.to_le_bytes());
    for triangle in stl_triangles() {
        bytes.extend([0; 12]);
        bytes.extend(triangle.as_flattened().iter().flat_map(|v| v.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn ascii_stl(solid: &str) -> String {
    let mut text = String::new();
    for [a, b, c] in stl_triangles() {
        let vertex = |[x, y, z]: [f32; 3]| format!("vertex {x} {y} {z}\n");
        text += &format!(
            "{solid}\n facet normal 0 0 1\nouter loop\n{}{}{}endloop\n",
            vertex(a),
            vertex(b),
            vertex(c)
        );
        text += "endfacet\nendsolid my solid\n";
    }
    text
}

#[test]
fn stl_is_welded_in_both_formats() {
    let files = [
        binary_stl("exported", 2),
        binary_stl("solid but binary\n", 2),
        ascii_stl("solid two").into_bytes(),
        ascii_stl(" SOLID").to_uppercase().replace('\n', "\r\n").into_bytes(),
    ];
    for bytes in files {
        let loaded = sound("a.stl", &bytes);
        let mesh = &loaded.scene.meshes()[0];
        assert_eq!((mesh.positions().len(), mesh.triangles()), (4, &[[0, 1, 2], [0, 2, 3]][..]));
        assert!(mesh.normals().is_empty() && loaded.warnings.is_empty());
        assert!(loaded.scene.materials()[0].double_sided);
    }
}

#[test]
fn colours_of_binary_stl_are_noted() {
    let notes = |header: &str, words: [u16; 2]| {
        let mut bytes = binary_stl(header, 2);
        for (i, word) in words.into_iter().enumerate() {
            bytes[132 + 50 * i..134 + 50 * i].copy_from_slice(&word.to_le_bytes());
        }
        let loaded = sound("a.stl", &bytes);
        loaded.warnings.iter().map(|(what, count)| format!("{count} {what}")).collect::<Vec<_>>()
    };
    assert_eq!(notes("x", [0x8000, 0xFC1F]), ["2 ignored colours of triangles"]);
    assert_eq!(
        notes("x", [7, 0xFC1F]),
        ["1 ignored colours of triangles", "1 ignored attributes of triangles"]
    );
    let magics = "exported COLOR=\u{1}\u{2}\u{3}\u{4}";
    assert_eq!(notes(magics, [0xFFFF, 0x8000]), ["1 ignored the colour in the header"]);
    let of_both = ["1 ignored the colour in the header", "1 ignored colours of triangles"];
    assert_eq!(notes(magics, [0xFFFF, 0x001F]), of_both);
}

#[test]
fn stl_errors_name_the_place() {
    assert!(error("a.stl", &binary_stl("x", 3)).contains("3 triangles declared, but the file ends after 2"));
    assert!(error("a.stl", &binary_stl("x", u32::MAX)).contains("ends after 2"));
    assert!(error("a.stl", &binary_stl("x", 0)).contains("no triangles"));
    assert!(error("a.stl", b"").contains("too few"));
    assert!(error("a.stl", b"solid a\nendsolid a\n").contains("no triangles"));
    let text = ascii_stl("solid a");
    assert!(error("a.stl", text.replacen("1.5", "nan", 1).as_bytes()).contains("solid 2, triangle 0"));
    assert!(error("a.stl", &text.as_bytes()[..text.len() / 3]).contains("solid 1, triangle 0"));
    assert!(error("a.stl", format!("{text}\nfoo").as_bytes()).contains("expected `solid`, found 'foo'"));
    let mut bad = binary_stl("x", 2);
    bad[100..104].copy_from_slice(&f32::INFINITY.to_le_bytes());
    assert!(error("a.stl", &bad).contains("triangle 0: a position is infinite"));
    let loaded = sound("a.stl", &binary_stl("x", 1));
    assert_eq!(loaded.warnings.iter().next(), Some(("bytes after the last triangle", 50)));
}
