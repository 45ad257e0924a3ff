//! Interpolated geometry at a point, and the normals that the surface methods derive from it.

use crate::math::{Lane, Vec3};
use crate::surface;

/// The interpolated geometry of a surface point, world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geometry<L> {
    /// The geometric normal: unit, on the visible side of the face.
    pub n_geom: Vec3<L>,
    /// The interpolated normal, not normalised; object space for [`Self::bumped_as_printed`].
    pub normal: Vec3<L>,
    /// The interpolated tangent, not normalised.
    pub tangent: Vec3<L>,
    /// The sign of the bitangent, ±1.
    pub handedness: L,
    /// The visible side: 1 for the front, −1 for the back.
    pub facing: L,
    /// The direction to the viewer, unit.
    pub v: Vec3<L>,
}

/// A texel of a normal map with its decoding parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MappedNormal<L> {
    /// The stored vector, each component in [0, 1].
    pub stored: Vec3<L>,
    /// Multiplies x and y.
    pub scale: L,
    /// 1 if green points up (OpenGL, glTF), −1 if it points down (DirectX).
    pub green: L,
}

impl<N: Copy> Geometry<N> {
    /// Converts the numbers.
    #[inline(always)]
    pub fn map<L>(&self, f: impl Fn(N) -> L) -> Geometry<L> {
        Geometry {
            n_geom: self.n_geom.map(&f),
            normal: self.normal.map(&f),
            tangent: self.tangent.map(&f),
            handedness: f(self.handedness),
            facing: f(self.facing),
            v: self.v.map(&f),
        }
    }
}

impl<N: Copy> MappedNormal<N> {
    /// Converts the numbers.
    #[inline(always)]
    pub fn map<L>(&self, f: impl Fn(N) -> L) -> MappedNormal<L> {
        MappedNormal { stored: self.stored.map(&f), scale: f(self.scale), green: f(self.green) }
    }
}

/// All normals are those of the front; [`super::Frame::new`] turns them to the visible side.
impl<L: Lane> Geometry<L> {
    /// The normal of the facet.
    #[inline(always)]
    pub fn facet(&self) -> Vec3<L> {
        self.n_geom * self.facing
    }

    /// The interpolated normal, unit.
    #[inline(always)]
    pub fn smooth(&self) -> Vec3<L> {
        self.normal.normalize_or(self.n_geom)
    }

    /// The normal of a height map. `dp` are the derivatives of the position and `dh` those of the height with respect to
    /// u and v, model units.
    #[inline(always)]
    pub fn bumped(&self, dp: [Vec3<L>; 2], dh: [L; 2]) -> Vec3<L> {
        let n = self.smooth();
        surface::bump(n, surface::surface_gradient(n, dp, dh))
    }

    /// The normal of a height map as printed by Guo and Wang 2025: `factor` is theirs, `g` half the difference of grey
    /// levels. The computed normal is in object space; `normal_matrix` transforms it to world space.
    #[inline(always)]
    pub fn bumped_as_printed(&self, factor: L, g: L, normal_matrix: [Vec3<L>; 3]) -> Vec3<L> {
        let bumped = surface::bump_printed(self.smooth(), factor, g);
        let [x, y, z] = normal_matrix;
        x * bumped.x + y * bumped.y + z * bumped.z
    }

    /// The normal of an object-space map; the components of `stored` are in [0, 1].
    #[inline(always)]
    pub fn object_mapped(stored: Vec3<L>, normal_matrix: [Vec3<L>; 3]) -> Vec3<L> {
        surface::object_normal(surface::decode_object_normal(stored), normal_matrix)
    }

    /// The normal of a tangent-space map.
    #[inline(always)]
    pub fn tangent_mapped(&self, map: MappedNormal<L>) -> Vec3<L> {
        let stored = surface::decode_normal(map.stored, map.scale, map.green);
        surface::tangent_normal(self.normal, self.tangent, self.handedness, stored)
    }
}
