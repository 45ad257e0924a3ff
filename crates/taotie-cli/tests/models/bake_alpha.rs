//! `taotie bake` on a third-party model with opaque, cut-out and blended parts: so are those of its asset.

use crate::command::{json, number};
use crate::files::data_files;
use crate::validator;
use std::path::Path;
use taotie_engine::bake::{LookupPoint, TexturedMesh};
use taotie_engine::mesh::Point;
use taotie_engine::scene::AlphaMode;
use taotie_io::load_model;

/// Points of a triangle along each side of the square that is folded onto it.
const SIDE: u32 = 400;

fn read(path: &Path) -> TexturedMesh {
    TexturedMesh::new(load_model(path).unwrap().scene).unwrap()
}

/// Returns the visible fraction of a mask's triangle, [0, 1].
fn part_there(surface: &TexturedMesh, triangle: u32, cutoff: f32) -> f64 {
    let is_there = |i: &u32| {
        let [u, v] = [i % SIDE, i / SIDE].map(|k| (k as f32 + 0.5) / SIDE as f32);
        let [u, v] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
        let point = Point { triangle, weights: [1.0 - u - v, u, v] };
        surface.sample(LookupPoint::finest(point)).alpha >= cutoff
    };
    (0..SIDE * SIDE).filter(is_there).count() as f64 / f64::from(SIDE * SIDE)
}

/// Returns the area of all masks, and its visible part.
fn mask_areas(surface: &TexturedMesh) -> [f64; 2] {
    let mesh = surface.mesh();
    let mut areas = [0.0; 2];
    for t in 0..mesh.triangles().len() {
        if let AlphaMode::Mask(cutoff) = surface.material(t as u32).alpha {
            let [a, b, c] = mesh.corners(t).map(|corner| corner.to_f64());
            let area = (b - a).cross(c - a).length() * 0.5;
            areas[0] += area;
            areas[1] += area * part_there(surface, t as u32, cutoff);
        }
    }
    areas
}

#[test]
fn what_is_cut_out_or_blended_stays_so_and_the_rest_is_opaque() {
    for scan in data_files("khronos-gltf-sample-assets/AlphaBlendModeTest", &["glb"]) {
        let folder = tempfile::tempdir().unwrap();
        let name = scan.to_str().expect("a path of text");
        let report = json(&["bake", name, "-o", "out.glb", "--size", "2048"], folder.path());
        let said = report["warnings"].to_string();
        assert!(!said.contains("blended"), "{said}");
        let out = folder.path().join("out.glb");
        validator::assert_valid(&out);
        let scene = load_model(&out).unwrap().scene;
        let shown = scene.instances().iter().map(|instance| scene.materials()[instance.material].alpha);
        // Masks with three cutoffs become one.
        let wanted = [AlphaMode::Opaque, AlphaMode::Mask(0.5), AlphaMode::Blend];
        assert!(shown.eq(wanted), "{name}");
        let [[all, there], [asset_all, asset_there]] = [&scan, &out].map(|path| mask_areas(&read(path)));
        println!("{name}: {there:.4} of {all:.4} visible; {asset_there:.4} of {asset_all:.4} of the asset");
        assert!((asset_all / all - 1.0).abs() < 0.01, "{asset_all} of {all}");
        assert!((asset_there / there - 1.0).abs() < 0.01, "{asset_there} of {there}");
        assert!(there < 0.95 * all, "something is cut out");
        let flips: Vec<f64> =
            (0..8).map(|i| number(&report, &format!("/proof/levels/0/full_views/{i}/flip"))).collect();
        println!("{name}: FLIP {flips:.4?}");
        assert!(flips.iter().all(|flip| *flip < 0.04), "{flips:?}");
    }
}
