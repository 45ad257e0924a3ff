//! Joins all meshes of a scene into one, in world space.

use crate::error::Result;
use crate::math::{Mat4, Vec2, Vec3};
use crate::mesh::{Mesh, MeshData};
use crate::scene::{Instance, Scene};
use crate::surface;
use std::collections::BTreeSet;

/// The vertex arrays kept when meshes are moved or joined, in addition to positions, normals and colours.
#[derive(Debug, Clone, Copy)]
pub(super) struct Keep {
    /// The maximum number of uv sets.
    pub uv_sets: usize,
    pub tangents: bool,
}

/// Returns the low-poly mesh of a scene: all its instances as one mesh in world space, with normals. A single
/// instance that is not moved is kept as it is, tangents included.
///
/// # Errors
/// [`crate::Error::Limit`] if the scene has more than 2^32 − 1 vertices.
pub fn low_poly_mesh(scene: Scene) -> Result<Mesh> {
    let mut scene = scene.into_data();
    joined(&mut scene.meshes, &scene.instances, Keep { uv_sets: 1, tangents: false })
}

/// Returns the low-poly mesh of a scene as viewers shade each of its meshes: all instances as one mesh in world
/// space, with normals and with the tangents that each mesh has in its own space: the file's, else MikkTSpace's of uv
/// set 0.
///
/// # Errors
/// As [`low_poly_mesh`]; [`crate::Error::Invalid`] if a mesh has no uvs.
pub fn framed_low_poly_mesh(scene: Scene) -> Result<Mesh> {
    let mut scene = scene.into_data();
    let shown: BTreeSet<usize> = scene.instances.iter().map(|instance| instance.mesh).collect();
    for mesh in shown {
        scene.meshes[mesh] = surface::with_frames(&scene.meshes[mesh], 0, None)?.0.into_owned();
    }
    joined(&mut scene.meshes, &scene.instances, Keep { uv_sets: 1, tangents: true })
}

/// Returns one mesh of all instances in world space, with normals. A single instance that is not moved is kept as it
/// is.
pub(super) fn joined(meshes: &mut [Mesh], instances: &[Instance], keep: Keep) -> Result<Mesh> {
    if let [only] = instances
        && only.world_from_object == Mat4::IDENTITY
    {
        return with_normals(std::mem::take(&mut meshes[only.mesh]));
    }
    let mut all = MeshData::default();
    let colored = instances.iter().any(|i| !meshes[i.mesh].colors().is_empty());
    let uv_sets = instances.iter().map(|i| meshes[i.mesh].uvs().len()).max().unwrap_or(0);
    all.uvs = vec![Vec::new(); uv_sets.min(keep.uv_sets)];
    for instance in instances {
        let mesh = &meshes[instance.mesh];
        add(&mut all, mesh, instance.world_from_object);
        if colored {
            pad(&mut all.colors, mesh.colors(), mesh.positions().len(), [1.0; 4]);
        }
        if keep.tangents {
            add_tangents(&mut all.tangents, mesh, instance.world_from_object);
        }
    }
    Mesh::new(all)
}

/// Returns a mesh moved back by the inverse of a transform, without tangents; unchanged if there is no inverse.
pub(super) fn moved_back(mesh: Mesh, m: &Mat4) -> Result<Mesh> {
    let Some(inverse) = m.inverse_affine() else { return Ok(mesh) };
    let mut moved = MeshData { uvs: vec![Vec::new(); mesh.uvs().len()], ..MeshData::default() };
    add(&mut moved, &mesh, inverse);
    moved.colors = mesh.colors().to_vec();
    Mesh::new(moved)
}

fn with_normals(mesh: Mesh) -> Result<Mesh> {
    if !mesh.normals().is_empty() {
        return Ok(mesh);
    }
    let normals = surface::vertex_normals(&mesh);
    Mesh::new(MeshData { normals, ..mesh.into_data() })
}

/// Appends positions, normals, triangles and the uv sets that `all` has.
fn add(all: &mut MeshData, mesh: &Mesh, m: Mat4) {
    let (first, count) = (all.positions.len() as u32, mesh.positions().len());
    let made = if mesh.normals().is_empty() { surface::vertex_normals(mesh) } else { Vec::new() };
    let normals = if made.is_empty() { mesh.normals() } else { &made };
    let matrix = m.normal_matrix();
    let turn = |n: &Vec3| matrix.transform_vector(n.to_f64()).normalize_or(n.to_f64()).to_f32();
    all.positions.extend(mesh.positions().iter().map(|p| m.transform_point(p.to_f64()).to_f32()));
    all.normals.extend(normals.iter().map(turn));
    for (set, uvs) in all.uvs.iter_mut().enumerate() {
        pad(uvs, mesh.uvs().get(set).map_or(&[][..], Vec::as_slice), count, Vec2::default());
    }
    // Mirroring flips the winding; normals define which side is out, so triangles keep theirs unless mirrored.
    let mirrored = m.determinant3() < 0.0;
    all.triangles.extend(mesh.triangles().iter().map(|[a, b, c]| {
        let [b, c] = if mirrored { [c, b] } else { [b, c] };
        [a + first, b + first, c + first]
    }));
}

/// Appends `values`, then pads with `fill` up to `count`.
fn pad<T: Copy>(all: &mut Vec<T>, values: &[T], count: usize, fill: T) {
    all.extend(values);
    all.extend(std::iter::repeat_n(fill, count - values.len()));
}

/// Appends the tangents of a mesh, or placeholders. Mirroring reverses the cross product of normal and tangent, so
/// handedness flips with it.
fn add_tangents(all: &mut Vec<[f32; 4]>, mesh: &Mesh, m: Mat4) {
    let sign = if m.determinant3() < 0.0 { -1.0 } else { 1.0 };
    let turn = |[x, y, z, w]: [f32; 4]| {
        let t = Vec3::new(x, y, z).to_f64();
        let [x, y, z] = m.transform_vector(t).normalize_or(t).to_f32().to_array();
        [x, y, z, w * sign]
    };
    let turned: Vec<[f32; 4]> = mesh.tangents().iter().map(|t| turn(*t)).collect();
    pad(all, &turned, mesh.positions().len(), [1.0, 0.0, 0.0, 1.0]);
}
