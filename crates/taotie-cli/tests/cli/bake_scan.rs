//! Options of `taotie bake` for reading a scan.

use super::place::Place;
use std::fmt::Write;
use taotie_engine::bake::Faults;
use taotie_engine::math::Vec3;
use taotie_engine::mesh::{Mesh, MeshData};

/// Returns a hexagonal prism as STL, whose facets are intended.
fn prism() -> String {
    let corner = |i: usize, z: f64| {
        let [x, y] =
            [[1.0, 0.0], [0.5, 0.866], [-0.5, 0.866], [-1.0, 0.0], [-0.5, -0.866], [0.5, -0.866]][i % 6];
        format!("vertex {x} {y} {z}\n")
    };
    let facet = |corners: [String; 3]| {
        format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", corners.concat())
    };
    let ends = ["vertex 0 0 1\n".to_owned(), "vertex 0 0 0\n".to_owned()];
    let mut text = "solid\n".to_owned();
    for i in 0..6 {
        let j = i + 1;
        text += &facet([corner(i, 0.0), corner(j, 0.0), corner(j, 1.0)]);
        text += &facet([corner(i, 0.0), corner(j, 1.0), corner(i, 1.0)]);
        text += &facet([ends[0].clone(), corner(i, 1.0), corner(j, 1.0)]);
        text += &facet([ends[1].clone(), corner(j, 0.0), corner(i, 0.0)]);
    }
    text + "endsolid\n"
}

#[test]
fn hard_edges_of_a_modelled_shape_are_kept_unless_asked_otherwise() {
    let place = Place::with("nut.stl", prism());
    let said = |options: &str| {
        let line = format!("bake nut.stl -o out.glb --size 64 --no-verify {options}");
        let assert = place.taotie(&line).assert().success();
        String::from_utf8_lossy(&assert.get_output().stderr).into_owned()
    };
    let kept = "scan without smooth normals: smoothed below 26°, 18 hard edges kept (";
    assert!(said("").contains(kept), "{}", said(""));
    assert!(said("--crease-angle 70").contains("smoothed below 70°, 12 hard edges kept ("));
    for options in ["--crease-angle 180", "--flat"] {
        assert!(!said(options).contains("hard edges"), "{options}");
    }
    assert!(said("--scan-green down").contains("the direction of green has no effect"));
}

#[test]
fn options_of_the_scan_that_cannot_be_are_refused() {
    let place = Place::with("nut.stl", prism());
    let cases = [
        ("--crease-angle 200", "expected an angle between 0 and 180 degrees"),
        ("--crease-angle sharp", "expected an angle in degrees"),
        ("--crease-angle 30 --flat", "cannot be used with"),
        ("--scan-green left", "invalid value 'left'"),
    ];
    for (options, words) in cases {
        let assert = place.taotie(&format!("bake nut.stl -o out.glb {options}")).assert().code(2);
        let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(said.contains(words), "{options}: {said}");
    }
    assert_eq!(place.files(), ["nut.stl"]);
}

/// Returns two balls that overlap, a third inside, and one with a hole next to them, as OBJ of separate triangles.
fn soup() -> String {
    const MISSING: usize = 2080;
    let (mut text, mut count) = (String::new(), 0);
    for (radius, x) in [(1.0, 0.0), (0.8, 1.1), (0.5, 0.2), (0.6, -1.8)] {
        let ball = Mesh::sphere(radius, 64, 32);
        for t in 0..ball.triangles().len() {
            let corners = ball.corners(t).map(|p| p + Vec3::new(x, 0.0, 0.0));
            if x < 0.0 && t == MISSING {
                continue;
            }
            for p in corners {
                let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
            }
            let _ = writeln!(text, "f {} {} {}", count + 1, count + 2, count + 3);
            count += 3;
        }
    }
    text
}

/// Returns the faults of a model's triangles in world space.
fn faults(place: &Place, name: &str) -> Faults {
    let scene = taotie::load_model(place.path(name)).unwrap().scene;
    let mut all = MeshData::default();
    for mesh in scene.meshes() {
        let first = all.positions.len() as u32;
        all.positions.extend(mesh.positions());
        all.triangles.extend(mesh.triangles().iter().map(|t| t.map(|v| v + first)));
    }
    Faults::of(&Mesh::new(all).unwrap())
}

#[test]
fn a_soup_becomes_a_watertight_mesh_close_to_its_visible_surface() {
    let place = Place::with("soup.obj", soup());
    let line = "bake soup.obj -o out.glb --remesh --triangles 800 --size 128 --json";
    let report = place.json(line);
    let Faults { open_edges, crowded_edges, duplicates, .. } = faults(&place, "out.glb");
    assert_eq!((open_edges, crowded_edges, duplicates), (0, 0, 0));
    let remesh = &report["origin"]["simplified"]["remesh"];
    assert_eq!((&remesh["scan_shells"], &remesh["shells"]), (&4.into(), &2.into()), "{remesh}");
    assert!(remesh["open_borders"].as_u64() > Some(0), "{remesh}");
    assert_eq!(report["parameters"]["remesh"], true);
    let said = report["warnings"].to_string();
    assert!(said.contains("remeshed: 4 separate parts and "), "{said}");
    assert!(!said.contains("that simplification left open"), "{said}");
    let line =
        "verify out.glb --scan soup.obj --require mean-angle=1,missed=0.1%,hausdorff=1%,completeness=99%";
    place.taotie(line).assert().success();
}

#[test]
fn remeshing_needs_a_scan_to_make_the_mesh_from() {
    let place = Place::with("soup.obj", soup());
    let cases = [
        ("bake soup.obj -o out.glb --remesh --low soup.obj", "cannot be used with"),
        ("bake soup.obj -o out.png --remesh", "--remesh: out.png holds only maps"),
    ];
    for (line, words) in cases {
        let assert = place.taotie(line).assert().code(2);
        let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(said.contains(words), "{line}: {said}");
    }
}
