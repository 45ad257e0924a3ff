//! The soundness of the tangents in a file, and their deviation from MikkTSpace's.

use crate::math::{Vec3, scalar};
use crate::mesh::Mesh;
use crate::surface::{TangentMethod, uv_derivatives, with_tangents};

/// The faults of the tangents that a mesh has in its file.
///
/// ```
/// use taotie::inspection::TangentHealth;
///
/// /// Returns the number of faults.
/// fn faults(tangents: &TangentHealth) -> usize {
///     tangents.not_unit + tangents.not_perpendicular + tangents.mixed_handedness
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct TangentHealth {
    /// Vertices whose tangent is more than 1 % from unit length.
    pub not_unit: usize,
    /// Vertices whose tangent is more than 1° from perpendicular to the normal.
    pub not_perpendicular: usize,
    /// Triangles whose corners differ in handedness.
    pub mixed_handedness: usize,
    /// Comparison with MikkTSpace's tangents, if a normal map is used.
    pub mikktspace: Option<Agreement>,
}

/// Tangents compared with MikkTSpace's, over the corners of triangles that have uv area.
///
/// ```
/// use taotie::inspection::{Agreement, MeshReport};
///
/// /// Returns the deviation of a mesh's tangents from MikkTSpace's, if both are known.
/// fn agreement(mesh: &MeshReport) -> Option<&Agreement> {
///     mesh.tangents.as_ref()?.mikktspace.as_ref()
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Agreement {
    /// The uv set of the normal map.
    pub uv_set: usize,
    /// Mean angle, degrees.
    pub mean_degrees: f64,
    /// Maximum angle, degrees.
    pub max_degrees: f64,
    /// Corners with the opposite handedness.
    pub other_handedness: usize,
}

/// The maximum difference of a direction's length from 1.
const UNIT_MARGIN: f32 = 0.01;

/// The sine of 1°.
const PERPENDICULAR_MARGIN: f32 = 0.017_45;

impl TangentHealth {
    /// Measures the tangents that `mesh` has, if any. `uv_set` is that of its normal map.
    pub(super) fn of(mesh: &Mesh, uv_set: Option<usize>) -> Option<Self> {
        if mesh.tangents().is_empty() {
            return None;
        }
        let tangents = mesh.tangents().iter().map(direction);
        let pairs = tangents.clone().zip(mesh.normals());
        Some(Self {
            not_unit: tangents.filter(|t| !is_unit(*t)).count(),
            not_perpendicular: pairs.filter(|(t, n)| leans(*t, **n)).count(),
            mixed_handedness: mesh.triangles().iter().filter(|t| is_mixed(mesh, t)).count(),
            mikktspace: uv_set.and_then(|set| Agreement::of(mesh, set)),
        })
    }
}

/// Returns `true` if `v` has unit length within [`UNIT_MARGIN`].
pub(super) fn is_unit(v: Vec3) -> bool {
    (v.length() - 1.0).abs() <= UNIT_MARGIN
}

fn direction([x, y, z, _]: &[f32; 4]) -> Vec3 {
    Vec3::new(*x, *y, *z)
}

/// Returns `true` if the angle between them differs by more than 1° from a right angle.
fn leans(t: Vec3, n: Vec3) -> bool {
    t.dot(n).abs() > PERPENDICULAR_MARGIN * t.length() * n.length()
}

fn is_mixed(mesh: &Mesh, triangle: &[u32; 3]) -> bool {
    let [a, b, c] = triangle.map(|i| mesh.tangents()[i as usize][3]);
    a != b || b != c
}

impl Agreement {
    fn of(mesh: &Mesh, uv_set: usize) -> Option<Self> {
        let uvs = mesh.uvs().get(uv_set)?;
        let made = with_tangents(mesh, uv_set, TangentMethod::MikkTSpace).ok()?.mesh;
        let mut sum = Self { uv_set, mean_degrees: 0.0, max_degrees: 0.0, other_handedness: 0 };
        let mut corners = 0;
        for (index, (given, wanted)) in mesh.triangles().iter().zip(made.triangles()).enumerate() {
            if uv_derivatives(mesh.corners(index), given.map(|i| uvs[i as usize])).is_none() {
                continue;
            }
            for (a, b) in given.iter().zip(wanted) {
                sum.add(&mesh.tangents()[*a as usize], &made.tangents()[*b as usize]);
                corners += 1;
            }
        }
        sum.mean_degrees /= f64::from(corners.max(1));
        (corners > 0).then_some(sum)
    }

    fn add(&mut self, given: &[f32; 4], wanted: &[f32; 4]) {
        let degrees = angle(direction(given), direction(wanted)).to_degrees();
        self.mean_degrees += degrees;
        self.max_degrees = self.max_degrees.max(degrees);
        self.other_handedness += usize::from(given[3] != wanted[3]);
    }
}

/// Returns the angle in radians, accurate for small angles too.
fn angle(a: Vec3, b: Vec3) -> f64 {
    let (a, b) = (a.to_f64(), b.to_f64());
    scalar::atan2(a.cross(b).length(), a.dot(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;
    use crate::mesh::MeshData;

    fn square(tangents: [[f32; 4]; 4]) -> Mesh {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        Mesh::new(MeshData {
            positions: corners.map(|(x, y)| Vec3::new(x, y, 0.0)).into(),
            normals: vec![Vec3::new(0.0, 0.0, 1.0); 4],
            tangents: tangents.into(),
            uvs: vec![corners.map(|(x, y)| Vec2::new(x, 1.0 - y)).into()],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..MeshData::default()
        })
        .unwrap()
    }

    #[test]
    fn sound_tangents_agree() {
        let health = TangentHealth::of(&square([[1.0, 0.0, 0.0, 1.0]; 4]), Some(0)).unwrap();
        assert_eq!((health.not_unit, health.not_perpendicular, health.mixed_handedness), (0, 0, 0));
        let agreement = health.mikktspace.unwrap();
        assert!(agreement.max_degrees < 1e-4 && agreement.other_handedness == 0, "{agreement:?}");
    }

    #[test]
    fn each_fault_is_counted() {
        let faults =
            [[2.0, 0.0, 0.0, 1.0], [0.9, 0.0, 0.435_89, 1.0], [0.0, 1.0, 0.0, 1.0], [1.0, 0.0, 0.0, -1.0]];
        let health = TangentHealth::of(&square(faults), Some(0)).unwrap();
        assert_eq!((health.not_unit, health.not_perpendicular, health.mixed_handedness), (1, 1, 1));
        let agreement = health.mikktspace.unwrap();
        assert!((agreement.max_degrees - 90.0).abs() < 1e-4, "{agreement:?}");
        assert_eq!(agreement.other_handedness, 1);
    }
}
