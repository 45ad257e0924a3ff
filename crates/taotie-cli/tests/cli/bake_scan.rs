//! Options of `taotie bake` for reading a scan.

use super::place::Place;

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
