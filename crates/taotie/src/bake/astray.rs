//! Measures how much of two surfaces is far apart.

use super::area_samples::{Triangles, sample_triangles};
use super::scan::Scan;
use crate::error::Result;
use crate::mesh::{Mesh, Point};
use crate::parallel;
use crate::trace::Bvh;

/// Number of points at which each surface is examined.
const POINTS: usize = 4_000;
/// On larger surfaces the points are on about this many triangles: summing the areas of twenty million takes a
/// second.
const TRIANGLES: usize = 1 << 16;

/// The fractions of a low-poly mesh and of its scan that are far from each other, [0, 1].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Astray {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
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
    fn a_part_of_many_triangles_stands_for_all() {
        let fine = wall(1.0, 400);
        assert!(fine.triangles().len() > 4 * TRIANGLES);
        let found = Astray::measure(&wall(0.5, 1), &scan(&fine), 0.1).unwrap();
        assert!(found.low == 0.0 && (found.scan - 0.4).abs() < 0.02, "{found:?}");
    }
}
