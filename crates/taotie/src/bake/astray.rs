//! How much of two surfaces is far from one another.

use super::scan::Scan;
use super::verify::sample_area;
use crate::error::Result;
use crate::mesh::Mesh;
use crate::parallel;
use crate::trace::Bvh;

/// Points at which each surface is examined.
const POINTS: usize = 4_000;

/// The fractions of a low-poly mesh and of its scan that are far from one another, [0, 1].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Astray {
    /// Of the low-poly mesh's area: what is far from the scan.
    pub low: f64,
    /// Of the scan's area: what is far from the low-poly mesh.
    pub scan: f64,
}

impl Astray {
    /// Measures what is farther away than `far`, above 0, model units.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) if one of the meshes has no area.
    pub fn measure(low: &Mesh, scan: &Scan, far: f64) -> Result<Self> {
        let of_low = Bvh::of(low.triangles().len(), |t| low.corners(t));
        Ok(Self { low: far_part(low, scan.bvh(), far)?, scan: far_part(scan.mesh(), &of_low, far)? })
    }
}

/// Returns the fraction of a mesh's area that is farther than `far` from some triangles.
fn far_part(mesh: &Mesh, from: &Bvh, far: f64) -> Result<f64> {
    let point = sample_area(mesh, POINTS)?;
    let is_far = |i: usize| from.closest(point(i).position(mesh), far as f32).is_none();
    Ok(parallel::count(POINTS, is_far) as f64 / POINTS as f64)
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

    #[test]
    fn each_side_is_measured() {
        let wall = |right: f32| {
            let corner = |x: f32, y: f32| Vec3::new(x * right, y, 0.0);
            let positions = vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
            let triangles = vec![[0, 1, 2], [0, 2, 3]];
            Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap()
        };
        let [half, whole] = [wall(0.5), wall(1.0)];
        let found = Astray::measure(&half, &scan(&whole), 0.1).unwrap();
        assert!(found.low == 0.0 && (found.scan - 0.4).abs() < 0.01, "{found:?}");
        let found = Astray::measure(&whole, &scan(&half), 0.1).unwrap();
        assert!(found.scan == 0.0 && (found.low - 0.4).abs() < 0.01, "{found:?}");
    }
}
