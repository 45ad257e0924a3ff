//! A point of a surface with everything that its reflection depends on.

use super::albedos;
use super::batch::{Batch, Lanes};
use super::draw::Draw;
use super::layers::{Coat, Sheen, Terminator};
use super::material_sample::material_sample;
use super::model::{Model, takes_albedos};
use super::normals::shade_normals;
use super::settings::RenderSettings;
use crate::math::{Pack, Vec3};
use crate::scene::Material;
use crate::shade::{self, Angles, AnisotropicLobe, MaterialSample, Shading};
use fearless_simd::Level;

/// Fills what points of a surface need beside interpolated and looked up values: the shading normals and the
/// directional albedos of the lobes.
pub(super) fn complete(level: Level, settings: &RenderSettings, draw: &Draw<'_>, batch: &mut Batch) {
    shade_normals(level, draw, settings.grazing_normals, batch);
    if takes_albedos(settings.shading) {
        albedos::look_up(level, settings, draw, batch);
    }
}

/// Shading points: a pack of fragments, or one, with all that their reflection depends on.
pub(super) struct ShadingPoint<L> {
    pub shading: Shading,
    pub sample: MaterialSample<L>,
    /// k_a, linear RGB.
    pub ambient: Vec3<L>,
    /// Emitted radiance that arrives at the viewer, linear RGB.
    pub emitted: Vec3<L>,
    /// The shading normal, unit, world space.
    pub n: Vec3<L>,
    /// The direction to the viewer: unit, world space.
    pub v: Vec3<L>,
    terminator: Terminator<L>,
    pub anisotropic: Option<AnisotropicLobe<L>>,
    pub coat: Option<Coat<L>>,
    pub sheen: Option<Sheen<L>>,
}

impl<P: Pack> ShadingPoint<P> {
    /// The fragments of `batch` from `i` on.
    #[inline(always)]
    pub(super) fn new(at: Lanes<'_, P>, Model { shading, layered }: Model, material: &Material) -> Self {
        let batch = at.batch;
        let (sample, ambient) = material_sample(at, shading, material);
        let (n, v) = (at.load3(&batch.n), at.load3(&batch.v));
        let is_anisotropic = layered && material.anisotropy.is_some();
        let anisotropic = is_anisotropic.then(|| {
            let tangent = at.load3(&batch.layers.anisotropy_direction);
            let strength = at.load(&batch.layers.anisotropy);
            AnisotropicLobe::new(tangent, n.cross(tangent), sample.roughness, strength)
        });
        let coat = (layered && material.clearcoat.is_some()).then(|| Coat::new(at));
        let sheen = (layered && material.sheen.is_some()).then(|| Sheen::new(at));
        let emitted = at.load3(&batch.emissive);
        let emitted = coat.as_ref().map_or(emitted, |coat| emitted * coat.kept);
        let terminator = Terminator::new(at);
        Self { shading, sample, ambient, emitted, n, v, terminator, anisotropic, coat, sheen }
    }

    /// Radiance to the viewer per unit of irradiance on a plane that faces the light in direction `l` (unit, world
    /// space), linear RGB: f · n·l.
    #[inline(always)]
    pub(super) fn reflect(&self, l: Vec3<P>) -> Vec3<P> {
        let reflected = self.reflect_bare(l);
        match &self.coat {
            Some(coat) => coat.over(reflected, self.v, l),
            None => reflected,
        }
    }

    /// Does what [`Self::reflect`] does, without the clearcoat.
    #[inline(always)]
    pub(super) fn reflect_bare(&self, l: Vec3<P>) -> Vec3<P> {
        let angles = Angles::new(self.n, self.v, l);
        let mut reflected = match &self.anisotropic {
            Some(lobe) => shade::reflect_anisotropic(&self.sample, lobe, &angles, [self.v, l]),
            None => shade::reflect(self.shading, &self.sample, &angles),
        };
        if let Some(sheen) = &self.sheen {
            reflected = sheen.over(reflected, &angles);
        }
        reflected * self.terminator.share(l)
    }

    /// Radiance to the viewer of what the environment sends, linear RGB; `batch.environment_radiance` and its tables
    /// must be filled.
    #[inline(always)]
    pub(super) fn reflect_environment(&self, at: Lanes<'_, P>) -> Vec3<P> {
        let batch = at.batch;
        let weights = shade::environment_weights(self.shading, &self.sample, &at.dfg());
        let occlusion = at.load(&batch.occlusion);
        let mean = at.load3(&batch.environment_radiance.mean) * occlusion;
        let n_dot_v = self.n.dot(self.v).clamp(0.0, 1.0);
        let seen = shade::specular_occlusion(n_dot_v, occlusion, self.sample.roughness);
        let gathered = at.load3(&batch.environment_radiance.specular) * seen;
        let mut radiance = weights.specular.mul_elements(gathered) + weights.diffuse.mul_elements(mean);
        if let Some(sheen) = &self.sheen {
            radiance = sheen.over_mean(radiance, mean);
        }
        match &self.coat {
            Some(coat) => coat.over_environment(radiance, at.load3(&batch.environment_radiance.coat)),
            None => radiance,
        }
    }
}
