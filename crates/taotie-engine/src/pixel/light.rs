//! The light that arrives at a point: light sources as seen from it, and lookups of the environment, with their
//! directions and roughness.

use super::geometry::Frame;
use crate::math::{Lane, Vec3, scalar};
use crate::scene;
use crate::shade::lights;
use crate::shade::sampling::mirrored;

/// A light prepared for shading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightSource<L> {
    /// Intensity, or irradiance if it is infinitely far away, linear RGB.
    pub color: Vec3<L>,
    /// Its place.
    pub place: Place<L>,
    /// The falloff with distance; none for infinitely distant lights.
    pub falloff: Falloff<L>,
    /// The cone that limits it.
    pub cone: Option<Cone<L>>,
}

/// The place of a light, world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place<L> {
    /// A position.
    At(Vec3<L>),
    /// Infinitely far away, in this unit direction from everywhere.
    Towards(Vec3<L>),
}

/// The falloff of a light with distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Falloff<L> {
    /// None.
    None,
    /// Inverse square.
    InverseSquare,
    /// Inverse square, faded to zero at a range, model units.
    Windowed(L),
}

/// The cone of a spot light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone<L> {
    /// Its axis: unit, away from the light.
    pub axis: Vec3<L>,
    /// The cosine of the angle at which the light begins to fade.
    pub cos_inner: L,
    /// The cosine of the angle at which it ends.
    pub cos_outer: L,
}

/// The light that arrives at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Incidence<L> {
    /// The unit direction to the light.
    pub l: Vec3<L>,
    /// The irradiance on a plane that faces it, linear RGB.
    pub irradiance: Vec3<L>,
}

impl<N: Copy> Incidence<N> {
    /// Converts the numbers.
    #[inline(always)]
    pub fn map<L>(&self, f: impl Fn(N) -> L) -> Incidence<L> {
        Incidence { l: self.l.map(&f), irradiance: self.irradiance.map(&f) }
    }
}

impl LightSource<f32> {
    /// Prepares a light of a scene.
    pub fn new(light: &scene::Light) -> Self {
        // In the 32 bits of files, so that an angle and its decimal text are the same light.
        let cos = |angle: f64| scalar::cos(f64::from(angle as f32)) as f32;
        let cone = |axis, inner, outer| Cone { axis, cos_inner: cos(inner), cos_outer: cos(outer) };
        let (place, cone) = match light.kind {
            scene::LightKind::Point { position } => (Place::At(position), None),
            scene::LightKind::Directional { direction } => (Place::Towards(-direction), None),
            scene::LightKind::Spot { position, direction, inner, outer } => {
                (Place::At(position), Some(cone(direction, inner, outer)))
            }
        };
        let falloff = match light.falloff {
            scene::Falloff::None => Falloff::None,
            scene::Falloff::InverseSquare => Falloff::InverseSquare,
            scene::Falloff::Windowed(range) => Falloff::Windowed(range),
        };
        Self { color: light.color, place, falloff, cone }
    }

    /// Converts the numbers.
    #[inline(always)]
    pub fn map<L>(&self, f: impl Fn(f32) -> L) -> LightSource<L> {
        let vector = |vector: Vec3| vector.map(&f);
        LightSource {
            color: vector(self.color),
            place: match self.place {
                Place::At(position) => Place::At(vector(position)),
                Place::Towards(direction) => Place::Towards(vector(direction)),
            },
            falloff: match self.falloff {
                Falloff::None => Falloff::None,
                Falloff::InverseSquare => Falloff::InverseSquare,
                Falloff::Windowed(range) => Falloff::Windowed(f(range)),
            },
            cone: self.cone.map(|cone| Cone {
                axis: vector(cone.axis),
                cos_inner: f(cone.cos_inner),
                cos_outer: f(cone.cos_outer),
            }),
        }
    }

    /// Returns the vector from a point to the light; not normalised.
    pub fn ray_from(&self, point: Vec3) -> Vec3 {
        match self.place {
            Place::At(position) => position - point,
            Place::Towards(direction) => direction,
        }
    }

    /// The length limit of a shadow ray along [`Self::ray_from`], in multiples of that vector.
    pub fn ray_limit(&self) -> f32 {
        match self.place {
            Place::At(_) => 1.0,
            Place::Towards(_) => f32::INFINITY,
        }
    }
}

impl<L: Lane> LightSource<L> {
    /// Returns the light that arrives at `position`, unshadowed.
    #[inline(always)]
    pub fn incidence(&self, position: Vec3<L>) -> Incidence<L> {
        let place = match self.place {
            Place::At(place) => place,
            Place::Towards(l) => return Incidence { l, irradiance: self.color },
        };
        let to_light = place - position;
        let distance_squared = to_light.dot(to_light).max(position.x.lit(1e-12));
        let distance = distance_squared.sqrt();
        let l = to_light * (position.x.lit(1.0) / distance);
        let mut attenuation = match self.falloff {
            Falloff::None => position.x.lit(1.0),
            Falloff::InverseSquare => lights::inverse_square(distance_squared),
            Falloff::Windowed(range) => {
                lights::inverse_square(distance_squared) * lights::range_window(distance_squared, range)
            }
        };
        if let Some(Cone { axis, cos_inner, cos_outer }) = self.cone {
            attenuation = attenuation * lights::spot_cone(-axis.dot(l), cos_inner, cos_outer);
        }
        Incidence { l, irradiance: self.color * attenuation }
    }
}

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
