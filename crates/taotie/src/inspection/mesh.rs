//! The soundness of a mesh.

use super::tangents::{TangentHealth, is_unit};
use super::uvs::UvHealth;
use crate::io::Loaded;
use crate::math::Vec3;
use crate::mesh::Mesh;
use crate::scene::{NormalSpace, Scene};
use std::collections::BTreeSet;

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
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
/// # use taotie::Warnings;
/// # use taotie::inspection::{Inspection, Normals};
/// # use taotie::io::Loaded;
/// # use taotie::mesh::Mesh;
/// # use taotie::scene::{Material, Scene};
/// let ball = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default())?;
/// let inspection = Inspection::of(&Loaded::new(ball, Warnings::default(), "glTF"));
/// assert_eq!(inspection.meshes[0].normals, Normals::Smooth);
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
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
    let materials = materials(&loaded.scene).into_iter().enumerate();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshData;

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
}
