//! Parts of a scan that are missing from a low-poly mesh.

use super::area_samples::sample_area;
use super::scan::Scan;
use crate::math::Vec3;
use crate::mesh::Mesh;
use crate::parallel;
use crate::trace::Bvh;

/// Returns those of `count` points spread evenly over a scan's area that are visible and farther from `low` than
/// `distance`, in model units; none if one of the meshes has no area. Deterministic.
pub fn uncovered(scan: &Scan, low: &Mesh, count: usize, distance: f64) -> Vec<Vec3<f64>> {
    let Ok(point) = sample_area(scan.mesh(), count) else { return Vec::new() };
    let bvh = Bvh::of(low.triangles().len(), |t| low.corners(t));
    let position = |i: usize| point(i).position(scan.mesh());
    let is_lacking = |i: usize| {
        bvh.closest(position(i), distance as f32).is_none() && scan.is_seen_from_anywhere(point(i))
    };
    let far = parallel::filter(count, is_lacking);
    far.into_iter().map(|i| position(i).to_f64()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, Scene};

    #[test]
    fn points_of_a_part_that_is_missing_are_found() {
        let ball = Mesh::sphere(1.0, 60, 30);
        let scan = Scan::new(Scene::of_mesh(ball.clone(), Material::default()).unwrap()).unwrap();
        assert!(uncovered(&scan, &Mesh::sphere(1.0, 30, 15), 1000, 0.05).is_empty());
        let mut data = ball.into_data();
        let top = |t: &[u32; 3]| t.iter().all(|v| data.positions[*v as usize].y > 0.5);
        data.triangles = data.triangles.iter().copied().filter(|t| !top(t)).collect();
        let points = uncovered(&scan, &Mesh::new(data).unwrap(), 1000, 0.05);
        // Rows of 6° above y = 0.5 reach down to 54° from the pole, where 0.05 of the border are still covered:
        // 51.1°, and (1 − cos 51.1°) / 2 = 0.186 of the ball.
        assert!((180..=192).contains(&points.len()), "{}", points.len());
        assert!(points.iter().all(|p| p.y > 0.5));
    }
}
