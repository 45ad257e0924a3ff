//! The inputs of a whole pixel: interpolated geometry, values of textures, factors, and the light around.

use super::environment::Turn;
use super::geometry::{Geometry, MappedNormal};
use super::light::Incidence;
use super::material::{MaterialUniforms, MaterialValues};
use crate::math::Vec3;
use crate::shade::Shading;
use crate::shade::environment::Environment;

/// A point of a surface before any stage has run, and what is known of it before any pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelInputs<L> {
    /// The reflectance model.
    pub shading: Shading,
    /// The interpolated geometry.
    pub geometry: Geometry<L>,
    /// The source of the shading normal.
    pub normal: NormalSource<L>,
    /// `true` where the normal turns with the side that is seen.
    pub turns: bool,
    /// `true` where mapped normals at grazing angles are softened.
    pub softened: bool,
    /// `true` where light that scatters several times is added, for models that have a form of it.
    pub compensated: bool,
    /// The factors of the material.
    pub uniforms: MaterialUniforms<L>,
    /// Its values at the point.
    pub values: MaterialValues<L>,
    /// Its layers at the point.
    pub layers: LayerInputs<L>,
}

/// The source of the shading normal, with what it needs beside [`Geometry`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NormalSource<L> {
    /// The triangle's own normal: [`Geometry::facet`].
    Facet,
    /// The interpolated normal: [`Geometry::smooth`].
    Smooth,
    /// A height map: [`Geometry::bumped`].
    Bump {
        /// The derivatives of the position by u and v, model units.
        dp: [Vec3<L>; 2],
        /// Those of the height, model units.
        dh: [L; 2],
    },
    /// A height map as Guo and Wang 2025 print it: [`Geometry::bumped_as_printed`].
    BumpPrinted {
        /// Their factor.
        factor: L,
        /// Half the difference of grey levels.
        grey: L,
        /// The columns of the matrix that takes normals to world space.
        normal_matrix: [Vec3<L>; 3],
    },
    /// A normal map in object space: [`Geometry::object_mapped`].
    ObjectMap {
        /// The texel, each component in [0, 1].
        stored: Vec3<L>,
        /// The columns of the matrix that takes normals to world space.
        normal_matrix: [Vec3<L>; 3],
    },
    /// A normal map in tangent space: [`Geometry::tangent_mapped`].
    TangentMap(MappedNormal<L>),
}

/// The layers at a point, for models that take any; `None` where the material has none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LayerInputs<L> {
    /// The clearcoat.
    pub clearcoat: Option<CoatInputs<L>>,
    /// The sheen.
    pub sheen: Option<SheenInputs<L>>,
    /// The anisotropy.
    pub anisotropy: Option<AnisotropyInputs<L>>,
}

/// A clearcoat at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoatInputs<L> {
    /// The part of the surface that it covers, [0, 1].
    pub factor: L,
    /// The roughness as artists set it, widened by what hides within the pixel, [0, 1].
    pub roughness: L,
    /// The texel of its own normal map; without one it has the smooth normal.
    pub normal: Option<MappedNormal<L>>,
}

/// A sheen at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SheenInputs<L> {
    /// The colour, linear RGB in [0, 1].
    pub color: Vec3<L>,
    /// The roughness as artists set it, [0, 1].
    pub roughness: L,
}

/// Anisotropy at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnisotropyInputs<L> {
    /// Cosine and sine of its angle from the tangent.
    pub turn: [L; 2],
    /// [0, 1].
    pub strength: L,
}

/// The light that reaches a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Surroundings<'e, L> {
    /// The light of each light.
    pub arriving: Vec<Incidence<L>>,
    /// Radiance from all around, linear RGB.
    pub ambient: Vec3<L>,
    /// The environment, if there is one.
    pub environment: Option<EnvironmentSource<'e, L>>,
}

/// An environment as a scene has it.
#[derive(Debug, Clone, Copy)]
pub struct EnvironmentSource<'e, L> {
    /// The environment.
    pub environment: &'e Environment,
    /// Its turn.
    pub turn: Turn<L>,
    /// The factor of its radiance, at least 0.
    pub intensity: L,
}

/// Two sources are equal where they are the same environment, not another with the same light.
impl<L: PartialEq> PartialEq for EnvironmentSource<'_, L> {
    fn eq(&self, other: &Self) -> bool {
        let is_same = std::ptr::eq(self.environment, other.environment);
        is_same && self.turn == other.turn && self.intensity == other.intensity
    }
}

impl<N: Copy> PixelInputs<N> {
    /// The same inputs in other numbers.
    pub fn map<L>(&self, f: impl Fn(N) -> L) -> PixelInputs<L> {
        PixelInputs {
            shading: self.shading,
            geometry: self.geometry.map(&f),
            normal: self.normal.map(&f),
            turns: self.turns,
            softened: self.softened,
            compensated: self.compensated,
            uniforms: self.uniforms.map(&f),
            values: self.values.map(&f),
            layers: self.layers.map(&f),
        }
    }
}

impl<N: Copy> NormalSource<N> {
    fn map<L>(&self, f: impl Fn(N) -> L) -> NormalSource<L> {
        let vector = |vector: Vec3<N>| vector.map(&f);
        match *self {
            Self::Facet => NormalSource::Facet,
            Self::Smooth => NormalSource::Smooth,
            Self::Bump { dp, dh } => NormalSource::Bump { dp: dp.map(vector), dh: dh.map(&f) },
            Self::BumpPrinted { factor, grey, normal_matrix } => NormalSource::BumpPrinted {
                factor: f(factor),
                grey: f(grey),
                normal_matrix: normal_matrix.map(vector),
            },
            Self::ObjectMap { stored, normal_matrix } => {
                NormalSource::ObjectMap { stored: vector(stored), normal_matrix: normal_matrix.map(vector) }
            }
            Self::TangentMap(texel) => NormalSource::TangentMap(texel.map(&f)),
        }
    }
}

impl<N: Copy> LayerInputs<N> {
    fn map<L>(&self, f: impl Fn(N) -> L) -> LayerInputs<L> {
        LayerInputs {
            clearcoat: self.clearcoat.map(|coat| CoatInputs {
                factor: f(coat.factor),
                roughness: f(coat.roughness),
                normal: coat.normal.map(|texel| texel.map(&f)),
            }),
            sheen: self
                .sheen
                .map(|sheen| SheenInputs { color: sheen.color.map(&f), roughness: f(sheen.roughness) }),
            anisotropy: self.anisotropy.map(|anisotropy| AnisotropyInputs {
                turn: anisotropy.turn.map(&f),
                strength: f(anisotropy.strength),
            }),
        }
    }
}

impl<'e, N: Copy> Surroundings<'e, N> {
    /// The same light in other numbers.
    pub fn map<L>(&self, f: impl Fn(N) -> L) -> Surroundings<'e, L> {
        Surroundings {
            arriving: self.arriving.iter().map(|arriving| arriving.map(&f)).collect(),
            ambient: self.ambient.map(&f),
            environment: self.environment.map(|source| EnvironmentSource {
                environment: source.environment,
                turn: source.turn.map(&f),
                intensity: f(source.intensity),
            }),
        }
    }
}
