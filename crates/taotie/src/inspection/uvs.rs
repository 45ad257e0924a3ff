//! The soundness of a uv set.

use crate::math::Vec2;
use crate::mesh::Mesh;
use crate::surface::uv_derivatives;

/// The faults of a uv set.
///
/// ```
/// use taotie::inspection::UvHealth;
///
/// /// Returns `true` if maps can be baked onto this uv set.
/// fn can_be_baked_onto(uvs: &UvHealth) -> bool {
///     uvs.outside == 0.0 && uvs.degenerate == 0
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct UvHealth {
    /// The fraction of triangles with a corner outside [0, 1].
    pub outside: f64,
    /// Triangles whose uvs span no area.
    pub degenerate: usize,
    /// The fraction of triangles with uv area whose uvs are mirrored.
    pub mirrored: f64,
}

/// The allowed distance of a uv outside [0, 1]: less than half a texel of a 4K map.
const MARGIN: f32 = 1e-4;

impl UvHealth {
    /// Measures the uv set `set` of `mesh`.
    pub(super) fn of(mesh: &Mesh, set: usize) -> Self {
        let (mut outside, mut degenerate, mut mirrored) = (0, 0, 0);
        for (index, triangle) in mesh.triangles().iter().enumerate() {
            let uvs = triangle.map(|i| mesh.uvs()[set][i as usize]);
            outside += usize::from(uvs.iter().any(|uv| is_outside(*uv)));
            match uv_derivatives(mesh.corners(index), uvs) {
                None => degenerate += 1,
                Some(derivatives) => mirrored += usize::from(derivatives.handedness < 0.0),
            }
        }
        let all = mesh.triangles().len();
        Self { outside: fraction(outside, all), degenerate, mirrored: fraction(mirrored, all - degenerate) }
    }
}

fn is_outside(uv: Vec2) -> bool {
    let within = |v: f32| (-MARGIN..=1.0 + MARGIN).contains(&v);
    !(within(uv.x) && within(uv.y))
}

fn fraction(part: usize, all: usize) -> f64 {
    if all == 0 { 0.0 } else { part as f64 / all as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::mesh::MeshData;

    #[test]
    fn counts_each_fault() {
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
        let positions = corners.map(|(x, y)| Vec3::new(x, y, 0.0));
        let upright = [(0.0, 1.0), (1.0, 1.0), (0.0, 0.0)];
        let mirrored = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
        let outside = upright.map(|(u, v)| (u + 0.5, v));
        let sets = [upright, mirrored, outside, [(0.5, 0.5); 3]];
        let mesh = Mesh::new(MeshData {
            positions: positions.repeat(4),
            uvs: vec![sets.iter().flatten().map(|(u, v)| Vec2::new(*u, *v)).collect()],
            triangles: (0..4).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
            ..MeshData::default()
        });
        let health = UvHealth::of(&mesh.unwrap(), 0);
        assert_eq!(health, UvHealth { outside: 0.25, degenerate: 1, mirrored: 1.0 / 3.0 });
    }
}
