//! Environment lookups at a point: directions, roughness, and the light found.

use super::frame::Frame;
use crate::math::{Lane, Vec3};
use crate::shade::sampling::mirrored;

/// The light of the environment at a point, linear RGB.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnvironmentTexels<L> {
    /// The radiance that the highlight gathers: [`highlight`].
    pub specular: Vec3<L>,
    /// The irradiance over π at the shading normal.
    pub mean: Vec3<L>,
    /// The radiance that the clearcoat's highlight gathers: [`coat_highlight`].
    pub coat: Vec3<L>,
}

/// The direction and width from which a highlight gathers its light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Highlight<L> {
    /// Unit, world space.
    pub direction: Vec3<L>,
    /// The roughness of its GGX lobe, [0, 1].
    pub roughness: L,
}

/// The anisotropy at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anisotropic<L> {
    /// The direction: unit, at a right angle to the shading normal.
    pub direction: Vec3<L>,
    /// [0, 1].
    pub strength: L,
    /// The roughness across, as artists set it, [0, 1].
    pub roughness: L,
}

/// Returns the highlight of the base; `roughness` is the roughness of its lobe, [0, 1].
#[inline(always)]
pub fn highlight<L: Lane>(
    frame: &Frame<L>,
    roughness: L,
    anisotropic: Option<&Anisotropic<L>>,
) -> Highlight<L> {
    let Frame { n, v, .. } = *frame;
    let lobe_normal = anisotropic.map_or(n, |anisotropic| anisotropic_normal(frame, anisotropic));
    Highlight { direction: towards_normal(mirrored(v, lobe_normal), n, roughness), roughness }
}

/// Returns the highlight of a clearcoat with the unit normal `n`.
#[inline(always)]
pub fn coat_highlight<L: Lane>(n: Vec3<L>, v: Vec3<L>, roughness: L) -> Highlight<L> {
    Highlight { direction: mirrored(v, n), roughness }
}

/// The direction in which a rough highlight gathers its light: half of the lobe of a rough
/// surface at a grazing angle is below the horizon. The direction moves from the mirror direction to the normal with
/// roughness⁴, which divides the error of the split sum by three at roughness 1 and hardly changes it below 0.5
/// (docs/errors.md).
#[inline(always)]
fn towards_normal<L: Lane>(mirrored: Vec3<L>, n: Vec3<L>, roughness: L) -> Vec3<L> {
    let share = roughness.squared().squared();
    (mirrored * (roughness.lit(1.0) - share) + n * share).normalize_or(n)
}

/// The normal about which an anisotropic highlight is mirrored: bent towards the viewer, across the anisotropy.
/// Source: McAuley 2015, "Rendering the World of Far Cry 4"; the blend of KHR_materials_anisotropy.
#[inline(always)]
fn anisotropic_normal<L: Lane>(frame: &Frame<L>, anisotropic: &Anisotropic<L>) -> Vec3<L> {
    let Frame { n, v, .. } = *frame;
    let Anisotropic { direction, strength, roughness } = *anisotropic;
    let one = roughness.lit(1.0);
    let bitangent = n.cross(direction);
    let bent = bitangent.cross(v).cross(bitangent).normalize_or(n);
    let round = one - strength * (one - roughness);
    let share = round.squared().squared();
    (bent * (one - share) + n * share).normalize_or(n)
}

/// A rotation about +y: x' = x cos + z sin, z' = z cos − x sin takes the environment to the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn<L> {
    /// The sine of its angle, counter-clockwise as seen from above.
    pub sin: L,
    /// The cosine of its angle.
    pub cos: L,
}

impl<N> Turn<N> {
    /// Converts the numbers.
    #[inline(always)]
    pub fn map<L>(self, f: impl Fn(N) -> L) -> Turn<L> {
        Turn { sin: f(self.sin), cos: f(self.cos) }
    }
}

impl<L: Lane> Turn<L> {
    /// Transforms a direction from world space to the environment's space.
    #[inline(always)]
    pub fn to_environment(self, world: Vec3<L>) -> Vec3<L> {
        let Self { sin, cos } = self;
        Vec3::new(world.x * cos - world.z * sin, world.y, world.z * cos + world.x * sin)
    }

    /// Transforms a direction from the environment's space to world space.
    #[inline(always)]
    pub fn to_world(self, direction: Vec3<L>) -> Vec3<L> {
        let Self { sin, cos } = self;
        Vec3::new(direction.x * cos + direction.z * sin, direction.y, direction.z * cos - direction.x * sin)
    }
}
