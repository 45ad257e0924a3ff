//! A surface point with everything that its reflection depends on, and the layers on top of its base: clearcoat and
//! sheen.

use super::geometry::Frame;
use super::light::EnvironmentTexels;
use super::material::MaterialPoint;
use crate::math::{Lane, Vec3};
use crate::shade::dfg::Dfg;
use crate::shade::sheen::{d_charlie, v_neubelt};
use crate::shade::{self, Angles, AnisotropicLobe, COAT_F0, Shading, coat_lobe};

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

/// A clearcoat: KHR_materials_clearcoat.
///
/// The base is attenuated by the coat's directional albedo, so that a white surface under a clearcoat reflects all light
/// at any roughness. For a smooth coat this equals the extension's 1 − F(n·v). For a rough coat, 1 − F(n·v) would leave
/// a dark rim, since a rough coat at a grazing angle reflects less than F.
/// Law: `white_room::clearcoat_over_white_returns_what_arrives`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coat<L> {
    /// The normal: unit, world space.
    pub n: Vec3<L>,
    /// The share of the surface that it covers, [0, 1].
    pub factor: L,
    /// The roughness as artists set it, [0, 1].
    pub roughness: L,
    /// Its directional albedo: [`coat_albedo`].
    pub albedo: L,
}

impl<L: Lane> Coat<L> {
    /// Returns the attenuation of the light that passes through it, [0, 1].
    #[inline(always)]
    pub fn kept(&self) -> L {
        self.factor.lit(1.0) - self.factor * self.albedo
    }

    /// Layers the clearcoat over the base's reflection of a light.
    #[inline(always)]
    pub fn over(&self, base: Vec3<L>, v: Vec3<L>, l: Vec3<L>) -> Vec3<L> {
        let lobe = coat_lobe(self.roughness, &Angles::new(self.n, v, l));
        base * self.kept() + Vec3::splat(self.factor * lobe)
    }

    /// Layers the clearcoat over the base's reflection of the environment; `gathered` is the radiance in its highlight.
    #[inline(always)]
    pub fn over_environment(&self, base: Vec3<L>, gathered: Vec3<L>) -> Vec3<L> {
        base * self.kept() + gathered * (self.factor * self.albedo)
    }
}

/// Returns the directional albedo of a clearcoat, [0, 1]; `dfg` is the entry of GGX at the coat's n·v and roughness.
#[inline(always)]
pub fn coat_albedo<L: Lane>(dfg: &Dfg<L>) -> L {
    dfg.scale.lit(COAT_F0) * dfg.scale + dfg.bias
}

/// Sheen: KHR_materials_sheen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sheen<L> {
    /// The colour, linear RGB in [0, 1].
    pub color: Vec3<L>,
    /// The roughness as artists set it, [0, 1].
    pub roughness: L,
    /// The directional albedo of white sheen: [`sheen_albedo`].
    pub albedo: L,
}

impl<L: Lane> Sheen<L> {
    /// Returns the attenuation of the base below it, [0, 1].
    #[inline(always)]
    pub fn kept(&self) -> L {
        let most = self.color.x.max(self.color.y).max(self.color.z);
        most.lit(1.0) - most * self.albedo
    }

    /// Layers the sheen over the base's reflection of a light.
    #[inline(always)]
    pub fn over(&self, base: Vec3<L>, a: &Angles<L>) -> Vec3<L> {
        let zero = a.n_dot_l.lit(0.0);
        let lobe = d_charlie(a.sin2_h, self.roughness) * v_neubelt(a.n_dot_l, a.n_dot_v) * a.n_dot_l;
        base * self.kept() + self.color * L::select(zero.lt(a.n_dot_l), lobe, zero)
    }

    /// Layers the sheen over the base's reflection of the environment, whose mean radiance is `mean`.
    #[inline(always)]
    pub fn over_mean(&self, base: Vec3<L>, mean: Vec3<L>) -> Vec3<L> {
        base * self.kept() + self.color.mul_elements(mean) * self.albedo
    }
}

/// Returns the directional albedo of white sheen from the table's value, at most 1: edge-on, the lobe reflects more light
/// than arrives, and the layer below must not become negative.
#[inline(always)]
pub fn sheen_albedo<L: Lane>(of_table: L) -> L {
    of_table.min(of_table.lit(1.0))
}
