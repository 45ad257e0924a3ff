//! The source of a surface's shading normal: the map that bends it, and the one place that chooses among the methods.

use super::geometry::{Geometry, MappedNormal};
use crate::math::{Lane, Vec3};
use crate::scene::{HeightMap, Material, NormalMap, NormalSpace};
use crate::surface::SurfaceMethod;

/// A [`SurfaceMethod`] with the map that it reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NormalSource {
    /// The normal of each facet.
    Facet,
    /// The interpolated vertex normal.
    Smooth,
    /// A height map, with the height of a value of 1, model units.
    Bump(HeightMap, f32),
    /// A height map, with the factor of Guo and Wang 2025.
    BumpPrinted(HeightMap, f32),
    /// A map of normals in object space.
    ObjectMap(NormalMap),
    /// A map of normals relative to tangent, bitangent and normal.
    TangentMap(NormalMap),
}

impl NormalSource {
    /// Returns the source that suits a material best: its normal map, else its height map, else the vertex normals.
    pub fn best(material: &Material) -> Self {
        match (material.normal, material.height) {
            (Some(map), _) if map.space == NormalSpace::Object => Self::ObjectMap(map),
            (Some(map), _) => Self::TangentMap(map),
            (None, Some(map)) => Self::Bump(map, map.scale),
            (None, None) => Self::Smooth,
        }
    }

    /// Returns this source, or the vertex normals if the mesh has fewer uv sets than the map needs.
    #[must_use]
    pub fn on_mesh(self, uv_sets: usize) -> Self {
        if self.uv_set().is_some_and(|set| set >= uv_sets) { Self::Smooth } else { self }
    }

    /// Returns the method by which it is shaded.
    #[inline(always)]
    pub fn method(&self) -> SurfaceMethod {
        match self {
            Self::Facet => SurfaceMethod::Facet,
            Self::Smooth => SurfaceMethod::Smooth,
            Self::Bump(..) => SurfaceMethod::Bump,
            Self::BumpPrinted(..) => SurfaceMethod::BumpPrinted,
            Self::ObjectMap(_) => SurfaceMethod::ObjectNormal,
            Self::TangentMap(_) => SurfaceMethod::TangentNormal,
        }
    }

    /// Returns the normal map, if it reads one.
    #[inline(always)]
    pub fn normal_map(&self) -> Option<&NormalMap> {
        if let Self::ObjectMap(map) | Self::TangentMap(map) = self { Some(map) } else { None }
    }

    /// Returns the height map and its factor, if it reads one.
    #[inline(always)]
    pub fn height_map(&self) -> Option<(&HeightMap, f32)> {
        if let Self::Bump(map, factor) | Self::BumpPrinted(map, factor) = self {
            Some((map, *factor))
        } else {
            None
        }
    }

    /// Returns the uv set of its map, if it reads one.
    pub fn uv_set(&self) -> Option<usize> {
        let texture = self.normal_map().map(|map| &map.texture);
        texture.or(self.height_map().map(|(map, _)| &map.texture)).map(|texture| texture.uv_set)
    }

    /// Returns the uv set that tangents must follow, if tangents are used.
    pub fn tangent_set(&self) -> Option<usize> {
        if let Self::TangentMap(map) = self { Some(map.texture.uv_set) } else { None }
    }
}

/// Supplies what the methods of the shading normal read at a point. Each method reads only its own part.
pub trait NormalInputs<L> {
    /// The derivatives of the position and of the height with respect to two parameters of the surface, model units.
    fn bump(&self) -> ([Vec3<L>; 2], [L; 2]);
    /// The factor of Guo and Wang 2025, and half the difference of the grey levels.
    fn printed_bump(&self) -> [L; 2];
    /// The texel of the normal map.
    fn texel(&self) -> MappedNormal<L>;
    /// The columns of the matrix that takes normals from object to world space.
    fn normal_matrix(&self) -> [Vec3<L>; 3];
}

impl<L: Lane> Geometry<L> {
    /// Returns the shading normal of the front by a method.
    #[inline(always)]
    pub fn front_normal(&self, method: SurfaceMethod, inputs: &impl NormalInputs<L>) -> Vec3<L> {
        match method {
            SurfaceMethod::Facet => self.facet(),
            SurfaceMethod::Smooth => self.smooth(),
            SurfaceMethod::Bump => {
                let (dp, dh) = inputs.bump();
                self.bumped(dp, dh)
            }
            SurfaceMethod::BumpPrinted => {
                let [factor, grey] = inputs.printed_bump();
                self.bumped_as_printed(factor, grey, inputs.normal_matrix())
            }
            SurfaceMethod::ObjectNormal => Self::object_mapped(inputs.texel().stored, inputs.normal_matrix()),
            SurfaceMethod::TangentNormal => self.tangent_mapped(inputs.texel()),
        }
    }
}
