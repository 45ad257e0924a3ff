//! The whole pixel program on a single point: its inputs (interpolated geometry, texture values, factors, incident
//! light), and all stages in order, with the lookups between them.

use super::geometry::{Frame, Geometry, MappedNormal, NormalInputs, anisotropy_direction, coat_normal};
use super::light::{Anisotropic, EnvironmentTexels, Highlight, Incidence, Turn, coat_highlight, highlight};
use super::material::{
    MaterialPoint, MaterialUniforms, MaterialValues, is_cook_torrance, lobe_roughness, lobe_slope,
    takes_albedos, takes_layers,
};
use super::surface_point::{Coat, PointLayers, Sheen, SurfacePoint, coat_albedo, sheen_albedo};
use crate::math::{Lane, Number, Vec3};
use crate::shade::dfg::{AlbedoTable, Dfg, TablePosition};
use crate::shade::environment::Environment;
use crate::shade::{AnisotropicLobe, Shading};
use crate::surface::SurfaceMethod;
use std::f64::consts::FRAC_1_PI;

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

impl<L: Lane> PixelInputs<L> {
    /// Returns a smooth, rough, white dielectric with this unit `normal`, as seen from the unit direction `v`.
    pub fn smooth(shading: Shading, normal: Vec3<L>, v: Vec3<L>) -> Self {
        let one = v.x.lit(1.0);
        Self {
            shading,
            geometry: Geometry {
                n_geom: normal,
                normal,
                tangent: normal.any_perpendicular(),
                handedness: one,
                facing: one,
                v,
            },
            method: SurfaceMethod::Smooth,
            normal: NormalValues::none(one),
            turns: false,
            softened: false,
            compensated: true,
            uniforms: MaterialUniforms::white(one),
            values: MaterialValues::rough(one),
            layers: LayerInputs::NONE,
        }
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

impl<L> LayerInputs<L> {
    /// No layers.
    pub const NONE: Self = Self { clearcoat: None, sheen: None, anisotropy: None };
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

/// A surface point ready for lighting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadedPixel<L> {
    /// The parameters of its reflection.
    pub point: SurfacePoint<L>,
    /// The directional albedos of its lobe; zeros for models without them.
    pub dfg: Dfg<L>,
    /// The highlight that gathers the environment's light.
    pub highlight: Highlight<L>,
}

impl<L: Number> PixelInputs<L> {
    /// Returns the shading normal of the front, before it is turned to the visible side and the viewer.
    pub fn front_normal(&self) -> Vec3<L> {
        self.geometry.front_normal(self.method, &self.normal)
    }

    /// Returns the radiance to the viewer, linear RGB, unshadowed.
    pub fn radiance(&self, light: &IncidentLight<'_, L>) -> Vec3<L> {
        self.shaded(self.front_normal()).radiance(light)
    }

    /// Prepares the point for lighting, with this shading normal of the front.
    pub fn shaded(&self, front: Vec3<L>) -> ShadedPixel<L> {
        let frame = Frame::new(&self.geometry, front, self.side(), self.softened);
        let (dfg, anisotropic) = (self.albedos(&frame), self.anisotropic(&frame));
        let compensating = Some(dfg).filter(|_| self.compensated);
        let material = MaterialPoint::new(self.shading, &self.uniforms, &self.values, compensating);
        let layers = match takes_layers(self.shading) {
            true => self.layers(&frame, anisotropic),
            false => PointLayers { anisotropic: None, coat: None, sheen: None },
        };
        let roughness = lobe_roughness(self.shading, &self.uniforms, &self.values);
        ShadedPixel {
            point: SurfacePoint { shading: self.shading, material, frame, layers },
            dfg,
            highlight: highlight(&frame, roughness, anisotropic.as_ref()),
        }
    }

    fn side(&self) -> L {
        let facing = self.geometry.facing;
        if self.turns { facing } else { facing.lit(1.0) }
    }

    /// The directional albedos of the model's lobe.
    fn albedos(&self, frame: &Frame<L>) -> Dfg<L> {
        let n_dot_v = frame.n.dot(frame.v);
        if !takes_albedos(self.shading) {
            let zero = n_dot_v.lit(0.0);
            return Dfg { scale: zero, bias: zero, edge: zero, diffuse_edge: zero };
        }
        match is_cook_torrance(self.shading) {
            true => {
                let slope = lobe_slope(&self.uniforms, &self.values);
                TablePosition::of_cook_torrance(n_dot_v, slope).read(AlbedoTable::CookTorrance)
            }
            false => TablePosition::of_ggx(n_dot_v, self.values.roughness).read(AlbedoTable::Ggx),
        }
    }

    fn anisotropic(&self, frame: &Frame<L>) -> Option<Anisotropic<L>> {
        self.layers.anisotropy.map(|anisotropy| Anisotropic {
            direction: anisotropy_direction(&self.geometry, frame.n, anisotropy.turn),
            strength: anisotropy.strength,
            roughness: self.values.roughness,
        })
    }

    fn layers(&self, frame: &Frame<L>, anisotropic: Option<Anisotropic<L>>) -> PointLayers<L> {
        let lobe = |Anisotropic { direction, strength, roughness }| {
            AnisotropicLobe::new(direction, frame.n.cross(direction), roughness, strength)
        };
        PointLayers {
            anisotropic: anisotropic.map(lobe),
            coat: self.layers.clearcoat.map(|coat| self.coat(&coat, frame)),
            sheen: self.layers.sheen.map(|sheen| {
                let place = TablePosition::of_ggx(frame.n.dot(frame.v), sheen.roughness);
                let albedo = sheen_albedo(place.read(AlbedoTable::Sheen).scale);
                Sheen { color: sheen.color, roughness: sheen.roughness, albedo }
            }),
        }
    }

    fn coat(&self, coat: &CoatInputs<L>, frame: &Frame<L>) -> Coat<L> {
        let mapped = |texel| self.geometry.tangent_mapped(texel) * self.side();
        let n = coat_normal(coat.normal.map_or(frame.smooth, mapped), frame);
        let place = TablePosition::of_ggx(n.dot(frame.v), coat.roughness);
        let albedo = coat_albedo(&place.read(AlbedoTable::Ggx));
        Coat { n, factor: coat.factor, roughness: coat.roughness, albedo }
    }
}

impl<L: Number> ShadedPixel<L> {
    /// Returns the radiance to the viewer, linear RGB, unshadowed.
    pub fn radiance(&self, light: &IncidentLight<'_, L>) -> Vec3<L> {
        let mut radiance = self.without_lights(light);
        light.arriving.iter().for_each(|arriving| radiance += self.lit(arriving));
        radiance
    }

    /// Returns the radiance to the viewer without light sources: emission, ambient light, and the environment.
    pub fn without_lights(&self, light: &IncidentLight<'_, L>) -> Vec3<L> {
        let own = self.point.own(light.ambient);
        match &light.environment {
            Some(source) => own + self.point.reflect_environment(&self.gathered(source), &self.dfg),
            None => own,
        }
    }

    /// Returns the radiance to the viewer due to the light that arrives from a light source.
    pub fn lit(&self, arriving: &Incidence<L>) -> Vec3<L> {
        self.point.reflect(arriving.l).mul_elements(arriving.irradiance)
    }

    /// The light of the environment at the point.
    fn gathered(&self, source: &EnvironmentSource<'_, L>) -> EnvironmentTexels<L> {
        let EnvironmentSource { environment, turn, intensity } = *source;
        let seen = |highlight: Highlight<L>| {
            environment.specular(turn.to_environment(highlight.direction), highlight.roughness) * intensity
        };
        let Frame { n, v, .. } = self.point.frame;
        let mean = environment.irradiance(turn.to_environment(n)) * (intensity * intensity.lit(FRAC_1_PI));
        let none = Vec3::splat(intensity.lit(0.0));
        let coat = self.point.layers.coat.as_ref();
        EnvironmentTexels {
            specular: seen(self.highlight),
            mean,
            coat: coat.map_or(none, |coat| seen(coat_highlight(coat.n, v, coat.roughness))),
        }
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
