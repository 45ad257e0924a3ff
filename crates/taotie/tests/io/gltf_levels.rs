//! Levels of detail are read together, each at the place of the node that it stands in for.

use crate::gltf::{load, triangle, warned};
use std::path::PathBuf;
use taotie::io::{Loaded, load_levels};
use taotie::math::{Mat4, Vec3};
use tempfile::TempDir;

/// A file with these nodes, of which 0 and 1 are in the scene. Mesh 0 is a triangle, mesh 1 two at one place.
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

    /// The places of the triangles that are shown at each level.
    fn places(&self) -> Vec<Vec<Vec3<f64>>> {
        let levels = load_levels(&self.path).unwrap_or_else(|e| panic!("{e}"));
        let place = |world: Mat4| world.transform_point(Vec3::new(0.0, 0.0, 0.0));
        let of = |loaded: &Loaded| {
            loaded.scene.instances().iter().map(|instance| place(instance.world_from_object)).collect()
        };
        levels.iter().map(of).collect()
    }
}

/// Node 1 hangs node 2 at x = 1; nodes 3 and 4 are its coarser levels. Node 0 has one level alone.
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
    assert_eq!((loaded.levels, warned(&loaded, "levels of detail that are no nodes")), (2, 3));
    let levels = load_levels(&file.path).unwrap();
    assert_eq!(levels[0].warnings.iter().collect::<Vec<_>>(), loaded.warnings.iter().collect::<Vec<_>>());
    // A node that stands in for its own child is its own ancestor.
    let file = with("[1]");
    assert!(load(&file.path).is_ok(), "the finest level is sound");
    let error = load_levels(&file.path).unwrap_err().to_string();
    assert!(!error.contains('\n') && error.contains("levels.gltf"), "{error}");
    let many = with(&format!("[{}]", ["3"; 64].join(",")));
    assert_eq!(load(&many.path).unwrap().levels, 65);
    let error = load_levels(&many.path).unwrap_err().to_string();
    assert!(error.contains("there are 65; at most 64"), "{error}");
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
