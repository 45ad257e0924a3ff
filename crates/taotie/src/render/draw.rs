//! A mesh in the world with one material, as the stages see it.

use crate::math::Vec3;
use crate::mesh::Mesh;
use crate::pixel::NormalSource;
use crate::scene::{AlphaMode, Material, Scene};

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
        self.material.alpha != AlphaMode::Opaque
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
