//! Faulty pairs and scans: each causes a clear warning or is refused, none is baked silently.

use super::balls::{Ball, LOW, SCAN};
use super::place::Place;

/// Returns the warnings, one a line.
fn said(place: &Place, line: &str) -> String {
    let assert = place.taotie(&format!("bake {line} -o out.glb --size 64")).assert().success();
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    said.lines().skip(1).map(|line| format!("{line}\n")).collect()
}

/// Returns the error of a pair that cannot be baked.
fn refused(obj: String) -> String {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", obj);
    let assert = place.taotie("bake scan.obj --low low.obj -o out.glb --size 64").assert().code(2);
    assert_eq!(place.files(), ["low.obj", "scan.obj"], "no asset");
    String::from_utf8_lossy(&assert.get_output().stderr).into_owned()
}

fn with_low(obj: String) -> String {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", obj);
    said(&place, "scan.obj --low low.obj --no-verify")
}

fn with_scan(obj: String) -> String {
    let place = Place::with("scan.obj", obj);
    place.write("low.obj", LOW.obj());
    said(&place, "scan.obj --low low.obj")
}

#[track_caller]
fn assert_says(said: &str, parts: &[&str]) {
    assert!(parts.iter().all(|part| said.contains(part)), "{said}");
}

#[test]
fn a_good_pair_gets_no_warning() {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", LOW.obj());
    assert_eq!(said(&place, "scan.obj --low low.obj"), "");
}

#[test]
fn moved() {
    let said = with_low(Ball { center: [0.3, 0.0, 0.0], ..LOW }.obj());
    assert_says(
        &said,
        &[
            "the meshes are apart: ",
            "2 % of the diagonal from the scan",
            "moved, scaled or posed differently?",
        ],
    );
}

#[test]
fn in_another_pose() {
    // Its upper part leans over.
    let obj: String = LOW
        .obj()
        .lines()
        .map(|line| match line.split(' ').collect::<Vec<_>>()[..] {
            ["v", x, y, z] => {
                let [x, y]: [f64; 2] = [x, y].map(|v| v.parse().expect("a number"));
                format!("v {} {y} {z}\n", x + y.max(0.0) * 0.5)
            }
            _ => format!("{line}\n"),
        })
        .collect();
    assert_says(
        &with_low(obj),
        &["the meshes are apart: ", "is one of them moved, scaled or posed differently?"],
    );
}

#[test]
fn far_apart() {
    let said = refused(Ball { center: [30.0, 0.0, 0.0], ..LOW }.obj());
    assert_says(&said, &["projection rays met the scan", "the meshes do not overlap: 100.0 %"]);
    assert!(!said.contains("reverse"), "which side is closer is random: {said}");
}

#[test]
fn of_another_size() {
    assert_says(&refused(Ball { radius: 2.0, ..LOW }.obj()), &["the meshes do not overlap: ", "scaled"]);
}

#[test]
fn inside_out() {
    let turned: Vec<_> = LOW.faces().into_iter().map(|[a, b, c]| [a, c, b]).collect();
    let said = refused(LOW.obj_of(&turned));
    assert_says(&said, &["one of the meshes is inside out: 100.0 %", "reverse its triangles and normals"]);
}

#[test]
fn some_triangles_turned() {
    let mut faces = LOW.faces();
    faces[..60].iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
    assert_says(&with_low(LOW.obj_of(&faces)), &["reversed winding of some triangles: "]);
}

#[test]
fn uvs_that_overlap() {
    let said = with_low(Ball { uv: Some(|u, v| [u.min(1.0 - u) * 2.0, v]), ..LOW }.obj());
    assert_says(
        &said,
        &["of the map is under more than one triangle: UV islands overlap", "unwrap the low-poly mesh"],
    );
}

#[test]
fn uvs_out_of_range() {
    let said = with_low(Ball { uv: Some(|u, v| [u * 0.9 - 0.5, v]), ..LOW }.obj());
    assert_says(
        &said,
        &["vertices of the low-poly mesh with uvs outside the map, which is repeated there ("],
    );
    assert!(!said.contains("overlap"), "{said}");
}

#[test]
fn uvs_without_area() {
    let said = refused(Ball { uv: Some(|_, v| [0.5, v]), ..LOW }.obj());
    assert_says(&said, &["none of its 528 triangles covers a texel of the map (528 without uv area)"]);
}

#[test]
fn a_scan_with_holes() {
    let faces: Vec<_> =
        SCAN.faces().into_iter().enumerate().filter(|(i, _)| i % 20 > 0).map(|(_, f)| f).collect();
    let said = with_scan(SCAN.obj_of(&faces));
    let holes = SCAN.faces().len().div_ceil(20);
    assert_says(
        &said,
        &[
            "of the texels have rays that missed the scan",
            &format!("open (boundary) edges of the scan ({} times)", holes * 3),
        ],
    );
}

#[test]
fn a_scan_with_triangles_twice() {
    let mut faces = SCAN.faces();
    faces.extend_from_within(1000..1010);
    let said = with_scan(SCAN.obj_of(&faces));
    assert_says(&said, &["duplicate triangles of the scan (10 times)", "where more than two triangles meet"]);
}

#[test]
fn a_scan_with_fins() {
    let mut faces = SCAN.faces();
    let [a, b, _] = faces[3000];
    faces.push([a, b, faces[6000][0]]);
    let said = with_scan(SCAN.obj_of(&faces));
    assert_says(
        &said,
        &[
            "edges of the scan where more than two triangles meet",
            "open (boundary) edges of the scan (2 times)",
        ],
    );
}
