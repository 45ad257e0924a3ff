//! The directions of a point that lighting needs, the shading normal among them.

use super::geometry::Geometry;
use crate::math::{Lane, Vec3};

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
