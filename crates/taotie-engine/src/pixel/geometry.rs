//! The geometry of a point: interpolated values, the source of the shading normal, and the directions that lighting
//! needs. [`Geometry::front_normal`] is the one place that chooses among the surface methods.

use crate::math::{Lane, Vec3};
use crate::scene::{HeightMap, Material, NormalMap, NormalSpace};
use crate::surface::{self, SurfaceMethod};

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

/// All normals are those of the front; [`Frame::new`] turns them to the visible side.
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

/// The directions of a point, unit, world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame<L> {
    /// The shading normal; not unit for `bump-printed`.
    pub n: Vec3<L>,
    /// The normal before any map, on the visible side.
    pub smooth: Vec3<L>,
    /// The direction to the viewer.
    pub v: Vec3<L>,
}

impl<L: Lane> Frame<L> {
    /// Creates the frame for the front's shading normal `n`. `side` is −1 if the surface is seen from behind and turns
    /// with it, else 1. If `softened`, a normal that faces away from the viewer is bent until it is just visible.
    ///
    /// Light is measured against this normal only, never against the smooth one: if a baked map and its coarse mesh
    /// disagree, the map is right, and the mesh's horizon would cut dark wedges into lit relief.
    #[inline(always)]
    pub fn new(geometry: &Geometry<L>, n: Vec3<L>, side: L, softened: bool) -> Self {
        let (smooth, n, v) = (geometry.smooth() * side, n * side, geometry.v);
        let n = if softened { towards_viewer(n, smooth, v) } else { n };
        Self { n, smooth, v }
    }
}

/// Returns the clearcoat's normal: `n` from its normal map, on the visible side, bent towards the viewer.
#[inline(always)]
pub fn coat_normal<L: Lane>(n: Vec3<L>, frame: &Frame<L>) -> Vec3<L> {
    towards_viewer(n, frame.smooth, frame.v)
}

/// Returns the direction of anisotropy, unit, at a right angle to the shading normal `n`. The last argument is the cosine
/// and sine of its angle from the tangent.
///
/// Source: KHR_materials_anisotropy.
#[inline(always)]
pub fn anisotropy_direction<L: Lane>(geometry: &Geometry<L>, n: Vec3<L>, [cos, sin]: [L; 2]) -> Vec3<L> {
    let tangent = geometry.tangent;
    let across = n.cross(tangent) * geometry.handedness;
    let along = tangent * cos + across * sin;
    let flat = along - n * n.dot(along);
    flat.normalize_or(n.any_perpendicular())
}

/// The smallest n·v of a mapped normal: where the smooth normal has at least as much, and at the rim, where it has none.
const LEAST_N_DOT_V: f64 = 0.25;
const LEAST_AT_RIM: f64 = 0.01;

/// Bends a mapped normal that faces away from the viewer until it is just visible: the smallest possible change, and a
/// continuous one. Mirroring the normal instead would light the wrong side of every steep slope.
#[inline(always)]
fn towards_viewer<L: Lane>(n: Vec3<L>, smooth: Vec3<L>, v: Vec3<L>) -> Vec3<L> {
    let zero = n.x.lit(0.0);
    let least = smooth.dot(v).clamp(LEAST_AT_RIM, LEAST_N_DOT_V);
    let lacking = (least - n.dot(v)).max(zero);
    Vec3::select(zero.lt(lacking), (n + v * lacking).normalize_or(smooth), n)
}
