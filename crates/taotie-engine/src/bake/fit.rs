//! How well the shapes of a low-poly mesh and a scan fit together: their distance and orientation, and the parts of
//! either that are far from the other.

use super::scan::Scan;
use super::verify::Verifier;
use crate::error::Result;
use crate::math::Vec3;
use crate::mesh::{Mesh, Point, Triangles, sample_area, sample_triangles};
use crate::parallel;
use crate::surface::facet_normal;
use crate::trace::Bvh;
use std::sync::LazyLock;

/// The fraction of the diagonal beyond which a scan does not match the surface of a low-poly mesh.
const AWAY: f64 = 0.02;

/// Measures how well a low-poly mesh and a scan fit together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// The fraction of the low-poly mesh that is farther than a fiftieth of the diagonal from the scan, [0, 1].
    pub away: f64,
    /// The fraction that faces the opposite way to the closest surface of the scan, [0, 1].
    pub turned: f64,
    /// The mean distance as a fraction of the diagonal.
    pub distance: f64,
}

/// Measures a pair of meshes before anything is baked.
impl Verifier<'_> {
    /// For points spread over the low-poly mesh: the fraction with no surface of the scan nearby, the fraction whose
    /// closest surface faces the other way, and the mean distance to it as a fraction of `diagonal`; `None` if the
    /// mesh has no area.
    pub fn fit(&self, count: usize, diagonal: f64) -> Option<Fit> {
        /// Distances that differ by less than this factor count as equal.
        const EQUAL: f32 = 1.01;
        let point = sample_area(self.mesh, count).ok()?;
        // Most meshes have no point to look at twice.
        let rounding = LazyLock::new(|| self.scan.mesh().rounding());
        let look = |i: usize| {
            let point = point(i);
            let facing = facet_normal(self.mesh.corners(point.triangle as usize)).unwrap_or_default();
            let position = point.position(self.mesh);
            let closest = self.scan.bvh().closest(position, f32::INFINITY)?;
            let is_turned = closest.point().normal(self.scan.mesh()).dot(facing) < 0.0
                && !self.scan_faces(facing, position, closest.distance * EQUAL + *rounding);
            Some((f64::from(closest.distance) / diagonal, is_turned))
        };
        let found: Vec<(f64, bool)> = parallel::collect(count, look).into_iter().flatten().collect();
        let part = |of: &dyn Fn(&(f64, bool)) -> bool| {
            found.iter().filter(|f| of(f)).count() as f64 / found.len().max(1) as f64
        };
        Some(Fit {
            away: part(&|f| f.0 > AWAY),
            turned: part(&|f| f.1),
            distance: found.iter().map(|f| f.0).sum::<f64>() / found.len().max(1) as f64,
        })
    }

    /// Returns `true` if a triangle of the scan within `reach` of a point faces the direction `facing`: both sides of a card
    /// may be as close as each other.
    fn scan_faces(&self, facing: Vec3, position: Vec3, reach: f32) -> bool {
        let mesh = self.scan.mesh();
        let faces_it = |t: u32| facet_normal(mesh.corners(t as usize)).is_some_and(|n| n.dot(facing) > 0.0);
        self.scan.bvh().closest_of(position, reach, faces_it).is_some()
    }
}

/// Number of points at which each surface is examined.
const POINTS: usize = 4_000;
/// On larger surfaces the points are on about this many triangles: summing the areas of twenty million takes a
/// second.
const TRIANGLES: usize = 1 << 16;

/// The fractions of a low-poly mesh and of its scan that are far from each other, [0, 1].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Astray {
    /// Fraction of the low-poly mesh's area that is far from the scan.
    pub low: f64,
    /// Fraction of the scan's area that is far from the low-poly mesh and can be seen.
    pub scan: f64,
}

impl Astray {
    /// Measures the parts farther away than `far`, which is above 0, in model units.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) if one of the meshes has no area.
    pub fn measure(low: &Mesh, scan: &Scan, far: f64) -> Result<Self> {
        let of_low = Bvh::of(low.triangles().len(), |t| low.corners(t));
        let is_far =
            |mesh: &Mesh, point: Point, from: &Bvh| from.closest(point.position(mesh), far as f32).is_none();
        Ok(Self {
            low: part(low, &|point| is_far(low, point, scan.bvh()))?,
            scan: part(scan.mesh(), &|point| {
                is_far(scan.mesh(), point, &of_low) && scan.is_seen_from_anywhere(point)
            })?,
        })
    }
}

/// Returns the fraction of a mesh's area whose points satisfy a condition.
fn part(mesh: &Mesh, is_it: &(dyn Fn(Point) -> bool + Sync)) -> Result<f64> {
    // An odd step, so that both halves of a grid's squares are sampled.
    let step = (mesh.triangles().len() / TRIANGLES) | 1;
    let point = sample_triangles(mesh, Triangles::Every(step), POINTS)?;
    Ok(parallel::count(POINTS, |i| is_it(point(i))) as f64 / POINTS as f64)
}

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
    use crate::bake::Cage;
    use crate::mesh::MeshData;
    use crate::scene::{Material, Scene};

    fn scan(mesh: &Mesh) -> Scan {
        Scan::new(Scene::of_mesh(mesh.clone(), Material::default()).unwrap()).unwrap()
    }

    /// Makes a wall of this width and of height 1, of `cells` by `cells` squares.
    fn wall(width: f32, cells: u32) -> Mesh {
        let side = cells + 1;
        let at = |i: u32| [i % side, i / side].map(|v| v as f32 / cells as f32);
        let positions = (0..side * side).map(at).map(|[x, y]| Vec3::new(x * width, y, 0.0)).collect();
        let square = |i: u32| {
            let a = i / cells * side + i % cells;
            [[a, a + 1, a + side + 1], [a, a + side + 1, a + side]]
        };
        let triangles = (0..cells * cells).flat_map(square).collect();
        Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap()
    }

    #[test]
    fn each_side_is_measured() {
        let [half, whole] = [wall(0.5, 1), wall(1.0, 1)];
        let found = Astray::measure(&half, &scan(&whole), 0.1).unwrap();
        assert!(found.low == 0.0 && (found.scan - 0.4).abs() < 0.01, "{found:?}");
        let found = Astray::measure(&whole, &scan(&half), 0.1).unwrap();
        assert!(found.scan == 0.0 && (found.low - 0.4).abs() < 0.01, "{found:?}");
    }

    #[test]
    fn both_sides_of_a_card_face_its_scan_but_a_turned_wall_does_not() {
        let turned = |mesh: &Mesh| {
            let triangles = mesh.triangles().iter().map(|[a, b, c]| [*a, *c, *b]).collect();
            let positions = mesh.positions().to_vec();
            Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap()
        };
        let front = wall(1.0, 8);
        let card = Mesh::joined(&[front.clone(), turned(&front)]).unwrap();
        let part = |low: &Mesh, of: &Mesh| {
            let (scan, cage) = (scan(of), Cage::uniform(low, 0.1).unwrap());
            Verifier { mesh: low, shown: None, cage: &cage, scan: &scan }.fit(500, 1.0).unwrap().turned
        };
        assert_eq!(part(&card, &card), 0.0);
        assert_eq!(part(&turned(&front), &card), 0.0);
        assert_eq!(part(&turned(&front), &front), 1.0);
    }

    #[test]
    fn a_part_of_many_triangles_stands_for_all() {
        let fine = wall(1.0, 400);
        assert!(fine.triangles().len() > 4 * TRIANGLES);
        let found = Astray::measure(&wall(0.5, 1), &scan(&fine), 0.1).unwrap();
        assert!(found.low == 0.0 && (found.scan - 0.4).abs() < 0.02, "{found:?}");
    }

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
