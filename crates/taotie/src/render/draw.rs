//! A mesh in the world with one material, as the stages see it.

use crate::math::Vec3;
use crate::mesh::Mesh;
use crate::scene::{AlphaMode, HeightMap, Material, NormalMap, Scene};

/// A mesh in the world with one material.
#[derive(Debug, Clone, Copy)]
pub(super) struct Draw<'p> {
    pub mesh: &'p Mesh,
    pub material: &'p Material,
    /// The number of its first triangle over all draws.
    pub first_triangle: u32,
    pub normal_source: NormalSource,
    /// The vertices' positions, world space.
    pub positions: &'p [Vec3],
    /// The vertices' normals: unit, world space.
    pub normals: &'p [Vec3],
    /// The tangents: unit, world space, with handedness; empty unless a tangent-space map or a direction is read.
    pub tangents: &'p [[f32; 4]],
    /// Takes object-space normals to world space, keeping the length of uniformly scaled ones.
    pub normal_matrix: [Vec3; 3],
    /// `true` where the transform turns counter-clockwise triangles into clockwise ones.
    pub mirrored: bool,
}

/// The source of a surface's shading normals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NormalSource {
    /// The normal of each facet.
    Facet,
    /// The interpolated vertex normal.
    Smooth,
    /// A height map, with the height of 1 in model units.
    Bump(HeightMap, f32),
    /// A height map, with the paper's factor.
    BumpPrinted(HeightMap, f32),
    /// A map of normals in object space.
    ObjectMap(NormalMap),
    /// A map of normals relative to tangent, bitangent and normal.
    TangentMap(NormalMap),
}

impl NormalSource {
    /// Says whether an image turns the normals, and not as printed.
    pub fn is_mapped(&self) -> bool {
        match self {
            Self::Facet | Self::Smooth | Self::BumpPrinted(..) => false,
            Self::Bump(..) | Self::ObjectMap(_) | Self::TangentMap(_) => true,
        }
    }
}

impl Draw<'_> {
    /// The numbers of its triangles over all draws.
    pub(super) fn numbers(&self) -> std::ops::Range<u32> {
        self.first_triangle..self.first_triangle + self.mesh.triangles().len() as u32
    }

    /// The corners of a triangle, whose number counts over all draws.
    #[inline(always)]
    pub(super) fn vertices(&self, triangle: u32) -> [u32; 3] {
        self.mesh.triangles()[(triangle - self.first_triangle) as usize]
    }

    /// Says whether parts of the surface may be missing, so that visibility must ask the material.
    pub(super) fn layered(&self) -> bool {
        self.material.alpha != AlphaMode::Opaque
    }

    /// Says whether the surface emits light.
    pub(super) fn shines(&self) -> bool {
        self.material.unlit || self.material.emissive != [0.0; 3]
    }
}

/// All draws of a scene, in the order of their triangles' numbers.
#[derive(Debug)]
pub(super) struct Draws<'p> {
    pub scene: &'p Scene,
    pub all: Vec<Draw<'p>>,
}

impl<'p> Draws<'p> {
    /// The number of the draw that a triangle belongs to.
    pub(super) fn number_of(&self, triangle: u32) -> usize {
        self.all.partition_point(|draw| draw.first_triangle <= triangle) - 1
    }

    /// The draw that a triangle belongs to.
    pub(super) fn of(&self, triangle: u32) -> &Draw<'p> {
        &self.all[self.number_of(triangle)]
    }
}
