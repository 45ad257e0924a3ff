//! A surface point with everything that its reflection depends on.

use super::environment::EnvironmentTexels;
use super::frame::Frame;
use super::layers::{Coat, Sheen};
use super::material::MaterialPoint;
use crate::math::{Lane, Vec3};
use crate::shade::dfg::Dfg;
use crate::shade::{self, Angles, AnisotropicLobe, Shading};

/// A surface point, or a pack of them, with everything that reflection depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint<L> {
    /// The reflectance model.
    pub shading: Shading,
    /// The material.
    pub material: MaterialPoint<L>,
    /// The directions.
    pub frame: Frame<L>,
    /// The layers.
    pub layers: PointLayers<L>,
}

/// The layers of a surface; `None` if the material or the model lacks one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointLayers<L> {
    /// The anisotropic lobe, in place of the model's own.
    pub anisotropic: Option<AnisotropicLobe<L>>,
    /// The clearcoat.
    pub coat: Option<Coat<L>>,
    /// The sheen.
    pub sheen: Option<Sheen<L>>,
}

impl<L: Lane> SurfacePoint<L> {
    /// Returns the radiance to the viewer per unit of irradiance on a plane that faces the light in direction `l` (unit,
    /// world space), linear RGB: f · n·l.
    #[inline(always)]
    pub fn reflect(&self, l: Vec3<L>) -> Vec3<L> {
        let reflected = self.reflect_base(l);
        match &self.layers.coat {
            Some(coat) => coat.over(reflected, self.frame.v, l),
            None => reflected,
        }
    }

    /// Like [`Self::reflect`], without the clearcoat.
    #[inline(always)]
    pub fn reflect_base(&self, l: Vec3<L>) -> Vec3<L> {
        let Frame { n, v, .. } = self.frame;
        let angles = Angles::new(n, v, l);
        let sample = &self.material.sample;
        let mut reflected = match &self.layers.anisotropic {
            Some(lobe) => shade::reflect_anisotropic(sample, lobe, &angles, [v, l]),
            None => shade::reflect(self.shading, sample, &angles),
        };
        if let Some(sheen) = &self.layers.sheen {
            reflected = sheen.over(reflected, &angles);
        }
        reflected
    }

    /// Returns the emission and the reflection of the `ambient` light, linear RGB.
    #[inline(always)]
    pub fn own(&self, ambient: Vec3<L>) -> Vec3<L> {
        let MaterialPoint { emissive, ambient: reflected, occlusion, .. } = self.material;
        let emitted = self.layers.coat.as_ref().map_or(emissive, |coat| emissive * coat.kept());
        emitted + reflected.mul_elements(ambient * occlusion)
    }

    /// Returns the environment's reflection to the viewer, linear RGB; `dfg` are the directional albedos of the lobe.
    #[inline(always)]
    pub fn reflect_environment(&self, light: &EnvironmentTexels<L>, dfg: &Dfg<L>) -> Vec3<L> {
        let weights = shade::environment_weights(self.shading, &self.material.sample, dfg);
        let occlusion = self.material.occlusion;
        let mean = light.mean * occlusion;
        let n_dot_v = self.frame.n.dot(self.frame.v).clamp(0.0, 1.0);
        let seen = shade::specular_occlusion(n_dot_v, occlusion, self.material.sample.roughness);
        let gathered = light.specular * seen;
        let mut radiance = weights.specular.mul_elements(gathered) + weights.diffuse.mul_elements(mean);
        if let Some(sheen) = &self.layers.sheen {
            radiance = sheen.over_mean(radiance, mean);
        }
        match &self.layers.coat {
            Some(coat) => coat.over_environment(radiance, light.coat),
            None => radiance,
        }
    }
}
