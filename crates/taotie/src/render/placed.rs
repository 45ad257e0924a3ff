//! Instances in world space, which refer to the scene by index.

use super::draw::Draw;
use crate::math::{Mat4, Vec3, scalar};
use crate::mesh::Mesh;
use crate::pixel::NormalSource;
use crate::scene::Scene;
use std::borrow::Cow;
use std::sync::Arc;

/// A mesh with normals, and with tangents if they are read.
#[derive(Clone)]
pub(super) enum Body {
    /// The scene's own mesh, by index, if it lacks nothing.
    OfScene(usize),
    Made(Arc<Mesh>),
}

impl Body {
    /// Stores the mesh computed for `index`, if any.
    pub(super) fn new(index: usize, mesh: Cow<'_, Mesh>) -> Self {
        match mesh {
            Cow::Borrowed(_) => Self::OfScene(index),
            Cow::Owned(mesh) => Self::Made(Arc::new(mesh)),
        }
    }

    pub(super) fn mesh<'p>(&'p self, scene: &'p Scene) -> &'p Mesh {
        match self {
            Self::OfScene(index) => &scene.meshes()[*index],
            Self::Made(mesh) => mesh,
        }
    }
}

/// An instance in world space.
pub(super) struct Placed {
    body: Body,
    /// Index into the scene's materials.
    material: usize,
    first_triangle: u32,
    normal_source: NormalSource,
    /// The deformed positions; none if nothing deforms the mesh.
    positions: Option<Vec<Vec3>>,
    normals: Vec<Vec3>,
    tangents: Vec<[f32; 4]>,
    normal_matrix: [Vec3; 3],
    mirrored: bool,
}

/// The parts of a [`Placed`] other than its mesh.
pub(super) struct Placement {
    pub material: usize,
    pub first_triangle: u32,
    pub normal_source: NormalSource,
    pub world_from_object: Mat4,
    /// `true` if tangents are read.
    pub takes_tangents: bool,
}

impl Placed {
    pub(super) fn new(scene: &Scene, body: Body, placement: &Placement) -> Self {
        let (mesh, m) = (body.mesh(scene), placement.world_from_object);
        let normal_matrix = uniform_normal_matrix(&m);
        let mirrored = m.determinant3() < 0.0;
        let moved = || mesh.positions().iter().map(|p| m.transform_point(p.to_f64()).to_f32()).collect();
        let positions = (m != Mat4::IDENTITY).then(moved);
        let normals = mesh.normals().iter().map(|n| unit(apply(&normal_matrix, *n))).collect();
        let tangents = if placement.takes_tangents { world_tangents(mesh, &m, mirrored) } else { Vec::new() };
        Self {
            material: placement.material,
            first_triangle: placement.first_triangle,
            normal_source: placement.normal_source,
            positions,
            normals,
            tangents,
            normal_matrix,
            mirrored,
            body,
        }
    }

    /// The number of its triangles.
    pub(super) fn triangle_count(&self, scene: &Scene) -> usize {
        self.body.mesh(scene).triangles().len()
    }

    pub(super) fn draw<'p>(&'p self, scene: &'p Scene) -> Draw<'p> {
        let mesh = self.body.mesh(scene);
        Draw {
            mesh,
            material: &scene.materials()[self.material],
            first_triangle: self.first_triangle,
            normal_source: self.normal_source,
            positions: self.positions.as_deref().unwrap_or(mesh.positions()),
            normals: &self.normals,
            tangents: &self.tangents,
            normal_matrix: self.normal_matrix,
            mirrored: self.mirrored,
        }
    }
}

/// Mirroring reverses the cross product of normal and tangent, so the handedness flips with it.
fn world_tangents(mesh: &Mesh, m: &Mat4, mirrored: bool) -> Vec<[f32; 4]> {
    let sign = if mirrored { -1.0 } else { 1.0 };
    let turn = |[x, y, z, w]: &[f32; 4]| {
        let t = unit(m.transform_vector(Vec3::new(*x, *y, *z).to_f64()).to_f32());
        [t.x, t.y, t.z, w * sign]
    };
    mesh.tangents().iter().map(turn).collect()
}

fn uniform_normal_matrix(m: &Mat4) -> [Vec3; 3] {
    let cofactors = m.normal_matrix();
    let size = scalar::pow(cofactors.determinant3().abs(), 1.0 / 3.0);
    let scale = if size > 0.0 { 1.0 / size } else { 1.0 };
    [0, 1, 2].map(|j| (cofactors.axis(j) * scale).to_f32())
}

fn apply([x, y, z]: &[Vec3; 3], v: Vec3) -> Vec3 {
    *x * v.x + *y * v.y + *z * v.z
}

fn unit(v: Vec3) -> Vec3 {
    v.normalize_or(Vec3::new(0.0, 0.0, 1.0))
}
