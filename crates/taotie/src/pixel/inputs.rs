//! The inputs of a whole pixel: interpolated geometry, texture values, factors, and incident light.

use super::environment::Turn;
use super::geometry::{Geometry, MappedNormal};
use super::light::Incidence;
use super::material::{MaterialUniforms, MaterialValues};
use super::normal_source::NormalInputs;
use crate::math::{Lane, Vec3};
use crate::shade::Shading;
use crate::shade::environment::Environment;
use crate::surface::SurfaceMethod;

/// A surface point before any stage has run, with the facts that are the same for all pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelInputs<L> {
    /// The reflectance model.
    pub shading: Shading,
    /// The interpolated geometry.
    pub geometry: Geometry<L>,
    /// The method of the shading normal.
    pub method: SurfaceMethod,
    /// The inputs of that method.
    pub normal: NormalValues<L>,
    /// `true` if the normal turns to the visible side.
    pub turns: bool,
    /// `true` if mapped normals are softened at grazing angles.
    pub softened: bool,
    /// `true` if multiple scattering is added, for models that support it.
    pub compensated: bool,
    /// The factors of the material.
    pub uniforms: MaterialUniforms<L>,
    /// Its values at the point.
    pub values: MaterialValues<L>,
    /// Its layers at the point.
    pub layers: LayerInputs<L>,
}

/// The inputs of the shading normal as plain values: [`NormalInputs`]. Fields that the method does not read may have any
/// value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalValues<L> {
    /// The derivatives of the position by two parameters of the surface, model units.
    pub dp: [Vec3<L>; 2],
    /// Those of the height, model units.
    pub dh: [L; 2],
    /// The factor of Guo and Wang 2025, and half the difference of the grey levels.
    pub printed: [L; 2],
    /// The texel of the normal map.
    pub texel: MappedNormal<L>,
    /// The columns of the matrix that takes normals from object to world space.
    pub normal_matrix: [Vec3<L>; 3],
}

impl<L: Copy> NormalInputs<L> for NormalValues<L> {
    fn bump(&self) -> ([Vec3<L>; 2], [L; 2]) {
        (self.dp, self.dh)
    }
    fn printed_bump(&self) -> [L; 2] {
        self.printed
    }
    fn texel(&self) -> MappedNormal<L> {
        self.texel
    }
    fn normal_matrix(&self) -> [Vec3<L>; 3] {
        self.normal_matrix
    }
}

impl<L: Lane> NormalValues<L> {
    /// Returns the inputs of methods that read no map, from any number.
    pub fn none(zero: L) -> Self {
        let (zero, one) = (zero.lit(0.0), zero.lit(1.0));
        let none = Vec3::splat(zero);
        Self {
            dp: [none; 2],
            dh: [zero; 2],
            printed: [zero; 2],
            texel: MappedNormal { stored: none, scale: one, green: one },
            normal_matrix: [
                Vec3::new(one, zero, zero),
                Vec3::new(zero, one, zero),
                Vec3::new(zero, zero, one),
            ],
        }
    }
}

/// The layers at a point, for models that support them; `None` if the material lacks one.
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
    /// The share of the surface that it covers, [0, 1].
    pub factor: L,
    /// The roughness as artists set it, widened by detail within the pixel, [0, 1].
    pub roughness: L,
    /// The texel of its normal map; without one it follows the smooth normal.
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

/// The light that arrives at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct IncidentLight<'e, L> {
    /// The light from each light source.
    pub arriving: Vec<Incidence<L>>,
    /// Ambient radiance, linear RGB.
    pub ambient: Vec3<L>,
    /// The environment, if there is one.
    pub environment: Option<EnvironmentSource<'e, L>>,
}

/// An environment as placed in a scene.
#[derive(Debug, Clone, Copy)]
pub struct EnvironmentSource<'e, L> {
    /// The environment.
    pub environment: &'e Environment,
    /// Its rotation.
    pub turn: Turn<L>,
    /// The factor of its radiance, at least 0.
    pub intensity: L,
}

/// Two sources are equal only if they share the environment; equal contents do not count.
impl<L: PartialEq> PartialEq for EnvironmentSource<'_, L> {
    fn eq(&self, other: &Self) -> bool {
        let is_same = std::ptr::eq(self.environment, other.environment);
        is_same && self.turn == other.turn && self.intensity == other.intensity
    }
}

impl<N: Copy> PixelInputs<N> {
    /// Converts the numbers.
    pub fn map<L>(&self, f: impl Fn(N) -> L) -> PixelInputs<L> {
        PixelInputs {
            shading: self.shading,
            geometry: self.geometry.map(&f),
            method: self.method,
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

impl<N: Copy> NormalValues<N> {
    fn map<L>(&self, f: impl Fn(N) -> L) -> NormalValues<L> {
        let vector = |vector: Vec3<N>| vector.map(&f);
        NormalValues {
            dp: self.dp.map(vector),
            dh: self.dh.map(&f),
            printed: self.printed.map(&f),
            texel: self.texel.map(&f),
            normal_matrix: self.normal_matrix.map(vector),
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

impl<'e, N: Copy> IncidentLight<'e, N> {
    /// Converts the numbers.
    pub fn map<L>(&self, f: impl Fn(N) -> L) -> IncidentLight<'e, L> {
        IncidentLight {
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
