//! The instances of a scene in world space, each a mesh with one material: as they are stored, as the stages see
//! them, and as plain arrays for renderers that draw the triangles themselves.

use crate::math::{Mat4, Vec2, Vec3, scalar};
use crate::mesh::Mesh;
use crate::pixel::NormalSource;
use crate::scene::{AlphaMode, Material, Scene};
use std::borrow::Cow;
use std::sync::Arc;

/// A mesh in the world with one material.
#[derive(Debug, Clone, Copy)]
pub(super) struct Draw<'p> {
    pub mesh: &'p Mesh,
    pub material: &'p Material,
    /// The index of its first triangle over all draws.
    pub first_triangle: u32,
    pub normal_source: NormalSource,
    /// The vertices' positions, in world space.
    pub positions: &'p [Vec3],
    /// The vertices' normals: unit, in world space.
    pub normals: &'p [Vec3],
    /// The tangents: unit, in world space, with handedness; empty unless a tangent-space map or a direction is read.
    pub tangents: &'p [[f32; 4]],
    /// Transforms object-space normals to world space, keeping the length of uniformly scaled ones.
    pub normal_matrix: [Vec3; 3],
    /// `true` if the transform turns counter-clockwise triangles into clockwise ones.
    pub mirrored: bool,
}

impl Draw<'_> {
    /// The indices of its triangles over all draws.
    pub(super) fn numbers(&self) -> std::ops::Range<u32> {
        self.first_triangle..self.first_triangle + self.mesh.triangles().len() as u32
    }

    /// The corners of a triangle, given by its index over all draws.
    #[inline(always)]
    pub(super) fn vertices(&self, triangle: u32) -> [u32; 3] {
        self.mesh.triangles()[(triangle - self.first_triangle) as usize]
    }

    /// Returns true if parts of the surface may be missing, so that visibility depends on the material.
    pub(super) fn layered(&self) -> bool {
        self.material.alpha != AlphaMode::Opaque || self.material.transmits()
    }

    /// Returns true if the surface emits light.
    pub(super) fn shines(&self) -> bool {
        self.material.unlit || self.material.emissive != [0.0; 3]
    }
}

/// All draws of a scene, in the order of their triangles' indices.
#[derive(Debug)]
pub(super) struct Draws<'p> {
    pub scene: &'p Scene,
    pub all: Vec<Draw<'p>>,
}

impl<'p> Draws<'p> {
    /// The index of the draw that contains a triangle.
    pub(super) fn number_of(&self, triangle: u32) -> usize {
        self.all.partition_point(|draw| draw.first_triangle <= triangle) - 1
    }

    /// The draw that contains a triangle.
    pub(super) fn of(&self, triangle: u32) -> &Draw<'p> {
        &self.all[self.number_of(triangle)]
    }
}

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

/// A mesh in the world with one material, as arrays. Arrays of vertices have equal lengths, except for empty ones.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Surface<'p> {
    /// The vertices' positions, in world space.
    pub positions: &'p [Vec3],
    /// The vertices' normals: unit, in world space.
    pub normals: &'p [Vec3],
    /// The vertices' normals: unit, in object space. Read by [`NormalSource::BumpPrinted`].
    pub object_normals: &'p [Vec3],
    /// The tangents: unit, in world space, with handedness in the fourth number; empty unless a tangent-space map or
    /// a direction is read.
    pub tangents: &'p [[f32; 4]],
    /// The uv sets, origin top left.
    pub uvs: &'p [Vec<Vec2>],
    /// The vertices' colours, linear RGBA; may be empty.
    pub colors: &'p [[f32; 4]],
    /// Indices of three vertices each.
    pub triangles: &'p [[u32; 3]],
    /// The material.
    pub material: &'p Material,
    /// The source of the shading normals.
    pub normal_source: NormalSource,
    /// The columns of the matrix that transforms object-space normals to world space and keeps the length of
    /// uniformly scaled ones.
    pub normal_matrix: [Vec3; 3],
    /// `true` if front faces are clockwise, since the transform mirrors.
    pub mirrored: bool,
}

impl<'p> Surface<'p> {
    pub(super) fn of(draw: &Draw<'p>) -> Self {
        Self {
            positions: draw.positions,
            normals: draw.normals,
            object_normals: draw.mesh.normals(),
            tangents: draw.tangents,
            uvs: draw.mesh.uvs(),
            colors: draw.mesh.colors(),
            triangles: draw.mesh.triangles(),
            material: draw.material,
            normal_source: draw.normal_source,
            normal_matrix: draw.normal_matrix,
            mirrored: draw.mirrored,
        }
    }
}
