//! Lights as seen from a surface point.

use crate::math::{Lane, Vec3, scalar};
use crate::scene;
use crate::shade::lights;

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
