//! The high-poly surface that is baked from.

use super::color::Colors;
use crate::error::Result;
use crate::math::{Mat4, Vec3};
use crate::mesh::{Mesh, MeshData, Point};
use crate::scene::{Instance, Scene};
use crate::surface;
use crate::trace::Bvh;

/// The triangles of a high-poly scene, sorted so that they can be found from points of a low-poly one.
///
/// Its relief is its geometry: normal maps of its materials are not read.
pub struct Scan {
    mesh: Mesh,
    bvh: Bvh,
    colors: Colors,
}

impl Scan {
    /// Takes a scene over: one mesh in world space, with smooth normals where it had none.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] where the scene has more than 2^32 − 1 vertices.
    pub fn new(scene: Scene) -> Result<Self> {
        let mut scene = scene.into_data();
        let instances = std::mem::take(&mut scene.instances);
        let mesh = merged(&mut scene.meshes, &instances)?;
        let mesh = Mesh::new(MeshData { tangents: Vec::new(), ..mesh.into_data() })?;
        let bvh = Bvh::of(mesh.triangles().len(), |t| mesh.corners(t));
        Ok(Self { colors: Colors::new(scene, &instances), mesh, bvh })
    }

    /// Returns the triangles, world space, with normals.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Returns the triangles alone.
    pub fn into_mesh(self) -> Mesh {
        self.mesh
    }

    /// Returns the triangles sorted for rays.
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// Returns the base colour at a point, linear RGB.
    pub fn color(&self, point: Point) -> [f32; 3] {
        self.colors.at(&self.mesh, point)
    }
}

/// Returns the low-poly mesh of a scene: all its instances as one mesh in world space, with normals. A single one that
/// is not moved stays as it is, tangents included.
///
/// # Errors
/// [`crate::Error::Limit`] where the scene has more than 2^32 − 1 vertices.
pub fn low_poly_mesh(scene: Scene) -> Result<Mesh> {
    let mut scene = scene.into_data();
    merged(&mut scene.meshes, &scene.instances)
}

/// Returns one mesh of all instances, world space, with normals. That of a single instance that is not moved is taken
/// as it is; others lose their tangents.
pub(super) fn merged(meshes: &mut [Mesh], instances: &[Instance]) -> Result<Mesh> {
    if let [only] = instances
        && only.world_from_object == Mat4::IDENTITY
    {
        return with_normals(std::mem::take(&mut meshes[only.mesh]));
    }
    let mut all = MeshData::default();
    let has = |of: fn(&Mesh) -> bool| instances.iter().any(|i| of(&meshes[i.mesh]));
    let (colored, mapped) = (has(|m| !m.colors().is_empty()), has(|m| !m.uvs().is_empty()));
    if mapped {
        all.uvs.push(Vec::new());
    }
    for instance in instances {
        add(&mut all, &meshes[instance.mesh], instance.world_from_object, [colored, mapped]);
    }
    Mesh::new(all)
}

fn with_normals(mesh: Mesh) -> Result<Mesh> {
    if !mesh.normals().is_empty() {
        return Ok(mesh);
    }
    let normals = surface::vertex_normals(&mesh);
    Mesh::new(MeshData { normals, ..mesh.into_data() })
}

fn add(all: &mut MeshData, mesh: &Mesh, m: Mat4, [colored, mapped]: [bool; 2]) {
    let (first, count) = (all.positions.len() as u32, mesh.positions().len());
    let made = if mesh.normals().is_empty() { surface::vertex_normals(mesh) } else { Vec::new() };
    let normals = if made.is_empty() { mesh.normals() } else { &made };
    let matrix = m.normal_matrix();
    let turn = |n: &Vec3| matrix.transform_vector(n.to_f64()).normalize_or(n.to_f64()).to_f32();
    all.positions.extend(mesh.positions().iter().map(|p| m.transform_point(p.to_f64()).to_f32()));
    all.normals.extend(normals.iter().map(turn));
    if colored {
        let white = std::iter::repeat_n([1.0; 4], count - mesh.colors().len());
        all.colors.extend(mesh.colors().iter().copied().chain(white));
    }
    if mapped {
        let uvs = mesh.uvs().first().map_or(&[][..], Vec::as_slice);
        let zero = std::iter::repeat_n(Default::default(), count - uvs.len());
        all.uvs[0].extend(uvs.iter().copied().chain(zero));
    }
    // Mirroring turns the winding; normals say which side is out, so triangles keep theirs only if nothing is mirrored.
    let mirrored = m.determinant3() < 0.0;
    all.triangles.extend(mesh.triangles().iter().map(|[a, b, c]| {
        let [b, c] = if mirrored { [c, b] } else { [b, c] };
        [a + first, b + first, c + first]
    }));
}
