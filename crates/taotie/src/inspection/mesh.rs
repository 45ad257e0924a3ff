//! The soundness of a mesh: its normals, its uv sets, and the tangents in the file with their deviation from
//! MikkTSpace's.

use rayon::prelude::*;
use std::collections::BTreeSet;
use taotie_engine::math::{Vec2, Vec3, scalar};
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{NormalSpace, Scene};
use taotie_engine::surface::{TangentMethod, uv_derivatives, with_tangents};
use taotie_io::Loaded;

/// A mesh: its size and its faults.
///
/// ```
/// use taotie::inspection::MeshReport;
///
/// /// Returns `true` if all normals can be used as they are.
/// fn has_sound_normals(mesh: &MeshReport) -> bool {
///     mesh.zero_area_triangles == 0 && mesh.normals_not_unit == 0
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct MeshReport {
    /// As in the file, else derived from its index.
    pub name: String,
    /// The number of triangles.
    pub triangles: usize,
    /// The number of vertices.
    pub vertices: usize,
    /// Triangles with an area of exactly 0.
    pub zero_area_triangles: usize,
    /// The kind of vertex normals.
    pub normals: Normals,
    /// Normals more than 1 % from unit length.
    pub normals_not_unit: usize,
    /// `true` if there are vertex colours.
    pub colors: bool,
    /// Faults of the tangents in the file; `None` if it has none.
    pub tangents: Option<TangentHealth>,
    /// Faults of each uv set.
    pub uv_sets: Vec<UvHealth>,
    /// The indices of the materials of its instances.
    pub materials: Vec<usize>,
}

/// The kind of normals that a mesh has.
///
/// ```
/// # use taotie::inspection::{Inspection, Normals};
/// # use taotie::{Loaded, Material, Mesh, Scene, Warnings};
/// let ball = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default())?;
/// let inspection = Inspection::of(&Loaded::new(ball, Warnings::default(), "glTF"));
/// assert_eq!(inspection.meshes[0].normals, Normals::Smooth);
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Normals {
    /// None; smooth ones are computed from the faces.
    Missing,
    /// Each corner has its face's normal, as glTF requires for meshes without normals.
    Flat,
    /// At least one corner's normal differs from its face's.
    Smooth,
}

/// Returns reports on all meshes, in order.
pub(super) fn reports(loaded: &Loaded) -> Vec<MeshReport> {
    let materials = materials(&loaded.scene).into_par_iter().enumerate();
    materials.map(|(index, materials)| report(loaded, index, materials)).collect()
}

fn report(loaded: &Loaded, index: usize, materials: Vec<usize>) -> MeshReport {
    let mesh = &loaded.scene.meshes()[index];
    let uv_set = mapped_uv_set(&loaded.scene, &materials);
    MeshReport {
        name: loaded.mesh_names.get(index).cloned().unwrap_or_else(|| format!("mesh {index}")),
        triangles: mesh.triangles().len(),
        vertices: mesh.positions().len(),
        zero_area_triangles: mesh.degenerate_triangles(),
        normals: Normals::of(mesh),
        normals_not_unit: mesh.normals().iter().filter(|n| !is_unit(**n)).count(),
        colors: !mesh.colors().is_empty(),
        tangents: TangentHealth::of(mesh, uv_set),
        uv_sets: (0..mesh.uvs().len()).map(|set| UvHealth::of(mesh, set)).collect(),
        materials,
    }
}

/// Returns the distinct materials of each mesh's instances.
fn materials(scene: &Scene) -> Vec<Vec<usize>> {
    let mut materials = vec![BTreeSet::new(); scene.meshes().len()];
    for instance in scene.instances() {
        materials[instance.mesh].insert(instance.material);
    }
    materials.into_iter().map(|materials| materials.into_iter().collect()).collect()
}

/// Returns the uv set of the first tangent-space normal map among `materials`.
fn mapped_uv_set(scene: &Scene, materials: &[usize]) -> Option<usize> {
    let maps = materials.iter().filter_map(|index| scene.materials()[*index].normal);
    maps.filter(|map| map.space == NormalSpace::Tangent).map(|map| map.texture.uv_set).next()
}

impl Normals {
    fn of(mesh: &Mesh) -> Self {
        if mesh.normals().is_empty() {
            return Self::Missing;
        }
        let flat = (0..mesh.triangles().len()).all(|triangle| is_flat(mesh, triangle));
        if flat { Self::Flat } else { Self::Smooth }
    }
}

/// Returns `true` if the corners' normals equal the face's, to a thousandth. A triangle without area has no normal to
/// compare.
fn is_flat(mesh: &Mesh, triangle: usize) -> bool {
    const MARGIN: f64 = 1e-3;
    let [a, b, c] = mesh.corners(triangle).map(Vec3::to_f64);
    let face = (b - a).cross(c - a);
    let length = face.length();
    let normals = mesh.triangles()[triangle].map(|i| mesh.normals()[i as usize].to_f64());
    length == 0.0 || normals.iter().all(|n| (*n - face * (1.0 / length)).length() <= MARGIN)
}

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
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
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
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
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
    fn of(mesh: &Mesh, uv_set: Option<usize>) -> Option<Self> {
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
fn is_unit(v: Vec3) -> bool {
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

/// The faults of a uv set.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
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
const UV_MARGIN: f32 = 1e-4;

impl UvHealth {
    /// Measures the uv set `set` of `mesh`.
    fn of(mesh: &Mesh, set: usize) -> Self {
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
    let within = |v: f32| (-UV_MARGIN..=1.0 + UV_MARGIN).contains(&v);
    !(within(uv.x) && within(uv.y))
}

fn fraction(part: usize, all: usize) -> f64 {
    if all == 0 { 0.0 } else { part as f64 / all as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::mesh::MeshData;

    fn triangle(normals: Vec<Vec3>) -> Mesh {
        let positions = vec![Vec3::default(), Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)];
        Mesh::new(MeshData { positions, normals, triangles: vec![[0, 1, 2]], ..MeshData::default() }).unwrap()
    }

    #[test]
    fn flat_is_told_from_smooth() {
        let up = Vec3::new(0.0, 0.0, 1.0);
        assert_eq!(Normals::of(&triangle(Vec::new())), Normals::Missing);
        assert_eq!(Normals::of(&triangle(vec![up; 3])), Normals::Flat);
        assert_eq!(Normals::of(&triangle(vec![up, up, Vec3::new(0.0, 0.1, 0.995)])), Normals::Smooth);
    }

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
