//! Laws of skew correction: on flat faces of a low-poly mesh, projection rays follow the face.

use crate::bake_scan::{bare_sphere, scan};
use crate::modelled;
use taotie_engine::bake::{Cage, Scan};
use taotie_engine::math::Vec3;
use taotie_engine::mesh::{Mesh, MeshData, Point};
use taotie_engine::surface::vertex_normals;

/// A box with chamfers, smooth all over, and its scan: the same box, larger, with the normals of its facets.
fn chamfered_pair() -> (Mesh, Scan) {
    let facets = modelled::chamfered_box();
    let low = modelled::welded(&facets);
    let normals = vertex_normals(&low);
    let low = Mesh::new(MeshData { normals, ..low.into_data() }).unwrap();
    let larger = modelled::loose(&facets).into_data();
    let positions = larger.positions.iter().map(|p| *p * 1.06).collect();
    (low, scan(Mesh::new(MeshData { positions, ..larger }).unwrap()))
}

/// The axis and sign of the flat face of a triangle of the box; `None` on chamfers.
fn flat_face(low: &Mesh, triangle: usize) -> Option<(usize, f32)> {
    let corners = low.corners(triangle).map(Vec3::to_array);
    let on = |axis: usize, side: f32| corners.iter().all(|corner| corner[axis] == side);
    (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]).find(|(axis, side)| on(*axis, *side))
}

#[test]
fn relief_on_flat_faces_of_smooth_boxes_is_not_shifted() {
    let (low, scan) = chamfered_pair();
    let corrected = Cage::automatic(&low, &scan);
    let skewed = corrected.clone().skewed();
    // Of a map of 256 texels across a face.
    let texel = 2.0 / 256.0;
    let shifts = |cage: &Cage, margin: f32| {
        let mut shifts = Vec::new();
        for t in 0..low.triangles().len() {
            let Some((axis, side)) = flat_face(&low, t) else { continue };
            for [u, v] in (1..32).flat_map(|i| (1..32).map(move |k| [i as f32 / 32.0, k as f32 / 32.0])) {
                let weights = if u + v < 1.0 { [1.0 - u - v, u, v] } else { [u + v - 1.0, 1.0 - u, 1.0 - v] };
                let point = Point { triangle: t as u32, weights };
                let ray = cage.projection_ray(&low, point);
                let mut start = ray.point.to_array();
                let inside = (0..3).filter(|k| *k != axis).map(|k| 0.85 - start[k].abs()).fold(1.0, f32::min);
                if inside < margin {
                    continue;
                }
                let hit = scan.project(&ray).expect("the scan is above").point.position(scan.mesh());
                start[axis] = side * 1.06;
                shifts.push((hit - Vec3::from_array(start)).length());
            }
        }
        assert!(shifts.len() > 1000);
        shifts.into_iter().fold(0.0, f32::max) / texel
    };
    // The band is as wide as the ray distance, twice 0.08, times the tangent of 33°.
    assert!(shifts(&corrected, 0.12) < 0.01, "{}", shifts(&corrected, 0.12));
    assert!(shifts(&skewed, 0.12) > 3.0, "{}", shifts(&skewed, 0.12));
    // The same with a ray distance.
    let uniform = Cage::uniform(&low, 0.15).unwrap();
    assert!(shifts(&uniform, 0.12) > 3.0);
    assert!(shifts(&uniform.straightened(&low, &scan), 0.12) < 0.01);
}

#[test]
fn rays_of_a_flat_face_cover_the_scan_in_order_from_edge_to_edge() {
    let (low, scan) = chamfered_pair();
    let cage = Cage::automatic(&low, &scan);
    let surface = taotie_engine::trace::Bvh::of(low.triangles().len(), |t| low.corners(t));
    let at = |x: f32| {
        let closest = surface.closest(Vec3::new(x, 0.31, 1.0), 1e-3).expect("on the face").point();
        let found = scan.project(&cage.projection_ray(&low, closest)).expect("the scan is above");
        found.point.position(scan.mesh()).x
    };
    let found: Vec<f32> = (0..=400).map(|i| at(0.85 * (i as f32 / 200.0 - 1.0))).collect();
    let steps: Vec<f32> = found.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let (least, most) = steps.iter().fold((f32::MAX, 0.0f32), |(l, h), v| (l.min(*v), h.max(*v)));
    let step = 0.85 / 200.0;
    assert!(least > 0.5 * step && most < 2.5 * step, "{least} to {most} of {step}");
}

#[test]
fn rays_on_curved_surfaces_keep_their_directions() {
    let low = bare_sphere(1.0, 16, 8);
    for scan in [scan(bare_sphere(1.02, 128, 64)), scan(low.clone())] {
        let cage = Cage::automatic(&low, &scan);
        let skewed = cage.clone().skewed();
        for triangle in 0..low.triangles().len() as u32 {
            let point = Point { triangle, weights: [0.2, 0.3, 0.5] };
            let [ray, other] = [&cage, &skewed].map(|cage| cage.projection_ray(&low, point));
            assert_eq!((ray.direction, ray.distance), (other.direction, other.distance));
        }
    }
}

/// Materials and UDIM tiles have a mesh each: a face whose neighbours are in another one meets them along the averaged
/// normals too.
#[test]
fn faces_with_open_edges_turn_to_the_averaged_normals_there() {
    let (whole, scan) = chamfered_pair();
    let is_top = |t: &[u32; 3]| t.iter().all(|v| whole.positions()[*v as usize].z == 1.0);
    let triangles: Vec<[u32; 3]> = whole.triangles().iter().filter(|t| is_top(t)).copied().collect();
    assert_eq!(triangles.len(), 2);
    let low = Mesh::new(MeshData { triangles, ..whole.into_data() }).unwrap();
    let corrected = Cage::automatic(&low, &scan);
    let skewed = corrected.clone().skewed();
    let rays = |weights: [f32; 3]| {
        let point = Point { triangle: 0, weights };
        [&corrected, &skewed].map(|cage| cage.projection_ray(&low, point).direction)
    };
    // One of the edges is shared by the triangles of the face.
    let on_edges = [[0.7, 0.3, 0.0], [0.0, 0.7, 0.3], [0.3, 0.0, 0.7]].map(rays);
    assert_eq!(
        on_edges.iter().filter(|[corrected, skewed]| (*corrected - *skewed).length() < 1e-5).count(),
        2
    );
    let [corrected, skewed] = rays([0.6, 0.2, 0.2]);
    assert!(corrected.z > 0.999_999 && skewed.z < 0.99, "{corrected:?} {skewed:?}");
}
