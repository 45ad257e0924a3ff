//! Levels of detail are read together, each at the place of the node that it replaces.

use crate::gltf::{load, triangle, warned};
use crate::{bumpy, validator};
use std::path::{Path, PathBuf};
use taotie_engine::Warnings;
use taotie_engine::image::Bitmap;
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::scene::Scene;
use taotie_io::{
    GltfAsset, GltfFormat, GltfMaterial, Loaded, encode_glb, encode_scene, join_levels, load_levels,
};
use tempfile::TempDir;

/// A file with these nodes; 0 and 1 are in the scene. Mesh 0 is a triangle, mesh 1 two in the same place.
struct File {
    path: PathBuf,
    _folder: TempDir,
}

impl File {
    fn new(nodes: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("levels.gltf");
        let part = r#"{"attributes":{"POSITION":0}}"#;
        let meshes = format!(r#"[{{"primitives":[{part}]}},{{"primitives":[{part},{part}]}}]"#);
        let rest = format!(r#""scenes":[{{"nodes":[0,1]}}],"scene":0,"nodes":{nodes},"meshes":{meshes}"#);
        std::fs::write(&path, triangle().text(&rest)).unwrap();
        Self { path, _folder: folder }
    }

    /// The places of the triangles shown at each level.
    fn places(&self) -> Vec<Vec<Vec3<f64>>> {
        let levels = load_levels(&self.path).unwrap_or_else(|e| panic!("{e}"));
        let place = |world: Mat4| world.transform_point(Vec3::new(0.0, 0.0, 0.0));
        let of = |loaded: &Loaded| {
            loaded.scene.instances().iter().map(|instance| place(instance.world_from_object)).collect()
        };
        levels.iter().map(of).collect()
    }
}

/// Node 2 is a child of node 1 at x = 1; nodes 3 and 4 are its coarser levels. Node 0 has only one level.
const TWO: &str = r#"[{"mesh":0,"translation":[0,5,0]},{"children":[2],"translation":[1,0,0]},
    {"mesh":0,"extensions":{"MSFT_lod":{"ids":[3,4]}}},{"mesh":1,"translation":[0,0,2]},{"mesh":0}]"#;

#[test]
fn stand_ins_take_the_place_of_their_node() {
    let file = File::new(TWO);
    let (plain, at_one) = (Vec3::new(0.0, 5.0, 0.0), Vec3::new(1.0, 0.0, 0.0));
    let moved = Vec3::new(1.0, 0.0, 2.0);
    let places = file.places();
    assert_eq!(places[0], [plain, at_one]);
    assert_eq!(places[1], [plain, moved, moved], "its own transform counts, and its parent's");
    assert_eq!(places[2], [plain, at_one]);
    assert_eq!((places.len(), load(&file.path).unwrap().levels), (3, 3));
}

#[test]
fn wrong_levels_are_told_and_do_no_harm() {
    let with = |ids: &str| File::new(&TWO.replace("[3,4]", ids));
    let file = with(r#"[3,99,-1,"x"]"#);
    let loaded = load(&file.path).unwrap();
    assert_eq!((loaded.levels, warned(&loaded, "levels of detail that are not nodes")), (2, 3));
    let levels = load_levels(&file.path).unwrap();
    assert_eq!(levels[0].warnings.iter().collect::<Vec<_>>(), loaded.warnings.iter().collect::<Vec<_>>());
    // A node that replaces its own child is its own ancestor.
    let file = with("[1]");
    assert!(load(&file.path).is_ok(), "the finest level is valid");
    let error = load_levels(&file.path).unwrap_err().to_string();
    assert!(!error.contains('\n') && error.contains("levels.gltf"), "{error}");
    let many = with(&format!("[{}]", ["3"; 64].join(",")));
    assert_eq!(load(&many.path).unwrap().levels, 65);
    let error = load_levels(&many.path).unwrap_err().to_string();
    assert!(error.contains("65 levels; the maximum is 64"), "{error}");
    for odd in ["[2]", "{}", "7"] {
        let file = with(odd);
        let levels = load(&file.path).unwrap().levels;
        assert_eq!(load_levels(&file.path).unwrap().len(), levels, "{odd}");
    }
}

#[test]
fn other_formats_have_one_level() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.obj");
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let levels = load_levels(&path).unwrap();
    assert_eq!((levels.len(), levels[0].levels), (1, 1));
}

/// A ball of `columns` columns with a colour texture and a normal map, as GLB.
fn ball(columns: usize, normals: &Bitmap, format: &GltfFormat) -> Vec<u8> {
    let (mesh, colors) = (bumpy::sphere(columns, columns / 2), bumpy::colors(16));
    let levels = [&mesh];
    let (base_color_map, normal_map) = (Some((&colors).into()), Some(normals.into()));
    let material = GltfMaterial { base_color_map, normal_map, ..GltfMaterial::default() };
    encode_glb(&GltfAsset { levels: &levels, material, ..GltfAsset::default() }, format).unwrap()
}

#[test]
fn joined_levels_are_what_they_were_and_share_what_is_equal() {
    let (plain, packed) = (GltfFormat::default(), GltfFormat { meshopt: true, ..GltfFormat::default() });
    let (own, other) = (bumpy::normals(16, 2), bumpy::normals(8, 2));
    let files = [ball(40, &own, &plain), ball(20, &own, &packed), ball(10, &other, &plain)];
    let coarser = [&files[1][..], &files[2][..]];
    let folder = tempfile::tempdir().unwrap();
    for name in ["joined.glb", "joined.gltf"] {
        let path = folder.path().join(name);
        let joined = join_levels(&path, (&files[0], &coarser), &[0.01, 0.001, 0.0]).unwrap();
        joined.iter().for_each(|file| std::fs::write(&file.path, &file.bytes).unwrap());
        assert_joined(&path, &files);
        let external: Vec<_> =
            joined[1..].iter().filter_map(|file| file.path.file_name()?.to_str()).collect();
        let wanted: &[&str] = match name {
            "joined.glb" => &[],
            _ => &["joined.bin", "joined_color.png", "joined_normal.png", "joined_lod2_normal.png"],
        };
        assert_eq!(external, wanted);
    }
    let wrong = join_levels(Path::new("a.glb"), (&files[0], &coarser), &[0.01, 0.0]).unwrap_err();
    assert!(wrong.to_string().contains("one in [0, 1]"));
}

/// Each level is as in its file, and items shared by several are stored once.
fn assert_joined(path: &Path, files: &[Vec<u8>]) {
    let levels = load_levels(path).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(
        levels.iter().map(|level| level.coverage).collect::<Vec<_>>(),
        [None, Some(0.01), Some(0.001)]
    );
    for (level, file) in levels.iter().zip(files) {
        let single = path.with_file_name("single.glb");
        std::fs::write(&single, file).unwrap();
        let single = load(&single).unwrap().scene;
        let (mesh, before) = (&level.scene.meshes()[0], &single.meshes()[0]);
        assert_eq!((mesh.positions(), mesh.triangles()), (before.positions(), before.triangles()));
        assert_eq!(level.scene.instances()[0].world_from_object, single.instances()[0].world_from_object);
        let normal = |scene: &Scene| {
            let material = &scene.materials()[scene.instances()[0].material];
            scene.textures()[material.normal.as_ref().unwrap().texture.texture].bitmap().clone()
        };
        assert!(normal(&level.scene) == normal(&single), "its own map");
    }
    let json = json(path);
    let lists = ["images", "textures", "materials", "samplers", "meshes"];
    let counts = lists.map(|list| json[list].as_array().map_or(0, Vec::len));
    assert_eq!(counts, [3, 3, 2, 1, 3], "two levels show one material");
    if let Some(infos) = validator::assert_valid(path) {
        // It does not know MSFT_lod, which refers to the nodes of coarser levels.
        let known = ["UNSUPPORTED_EXTENSION", "UNUSED_OBJECT at /nodes"];
        let unknown: Vec<_> =
            infos.iter().filter(|info| !known.iter().any(|known| info.starts_with(known))).collect();
        assert!(unknown.is_empty(), "{unknown:#?}");
    }
}

/// The JSON of a file.
fn json(path: &Path) -> serde_json::Value {
    let bytes = std::fs::read(path).unwrap();
    if !bytes.starts_with(b"glTF") {
        return serde_json::from_slice(&bytes).unwrap();
    }
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

#[test]
fn several_roots_are_replaced_together() {
    let file = File::new(r#"[{"mesh":0},{"mesh":0,"translation":[0,0,3]}]"#);
    let scene = load(&file.path).unwrap().scene;
    let glb = encode_scene(&scene, &[], &mut Warnings::default()).unwrap();
    let path = file.path.with_extension("glb");
    let joined = join_levels(&path, (&glb, &[&glb]), &[0.5, 0.0]).unwrap();
    std::fs::write(&path, &joined[0].bytes).unwrap();
    let levels = load_levels(&path).unwrap();
    assert_eq!(levels.iter().map(|level| level.scene.instances().len()).collect::<Vec<_>>(), [2, 2]);
}
