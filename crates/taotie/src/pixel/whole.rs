//! All stages of a pixel in order, with the lookups between them.

use super::environment::{Anisotropic, EnvironmentTexels, Highlight, coat_highlight, highlight};
use super::frame::{Frame, anisotropy_direction, coat_normal};
use super::inputs::{CoatInputs, EnvironmentSource, IncidentLight, PixelInputs};
use super::layers::{Coat, Sheen, coat_albedo, sheen_albedo};
use super::light::Incidence;
use super::material::{MaterialPoint, lobe_roughness, lobe_slope};
use super::model::{is_cook_torrance, takes_albedos, takes_layers};
use super::surface_point::{PointLayers, SurfacePoint};
use crate::math::{Number, Vec3};
use crate::shade::AnisotropicLobe;
use crate::shade::dfg::{AlbedoTable, Dfg, TablePosition};
use std::f64::consts::FRAC_1_PI;

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
