//! Fragments of a batch as inputs of the pixel program.

use super::albedos;
use super::batch::{Batch, Lanes};
use super::draw::Draw;
use super::normals::shade_normals;
use super::settings::RenderSettings;
use crate::math::{Pack, Vec3};
use crate::pixel::{
    Anisotropic, Coat, EnvironmentTexels, Frame, Geometry, MaterialPoint, MaterialUniforms, MaterialValues,
    Model, PointLayers, Sheen, SurfacePoint, takes_albedos, takes_compensation,
};
use crate::scene::Material;
use crate::shade::AnisotropicLobe;
use fearless_simd::Level;

/// Fills what points of a surface need in addition to interpolated and looked-up values: the shading normals and the
/// directional albedos of the lobes.
pub(super) fn complete(level: Level, settings: &RenderSettings, draw: &Draw<'_>, batch: &mut Batch) {
    shade_normals(level, draw, settings.grazing_normals, batch);
    if takes_albedos(settings.shading) {
        albedos::look_up(level, settings, draw, batch);
    }
}

impl<P: Pack> Lanes<'_, P> {
    /// The interpolated geometry.
    #[inline(always)]
    pub(super) fn geometry(&self) -> Geometry<P> {
        let batch = self.batch;
        Geometry {
            n_geom: self.load3(&batch.geometry.n_geom),
            normal: self.load3(&batch.geometry.normal),
            tangent: self.load3(&batch.geometry.tangent),
            handedness: self.load(&batch.geometry.handedness),
            facing: self.load(&batch.geometry.facing),
            v: self.load3(&batch.geometry.v),
        }
    }

    /// The directions, once shading normals are filled.
    #[inline(always)]
    pub(super) fn frame(&self) -> Frame<P> {
        let batch = self.batch;
        Frame {
            n: self.load3(&batch.frame.n),
            smooth: self.load3(&batch.frame.smooth),
            v: self.load3(&batch.geometry.v),
        }
    }

    /// The material's factors.
    #[inline(always)]
    pub(super) fn uniforms(&self, material: &Material) -> MaterialUniforms<P> {
        MaterialUniforms::new(material).map(|factor| self.splat(factor))
    }

    /// The material's values.
    #[inline(always)]
    pub(super) fn values(&self) -> MaterialValues<P> {
        let batch = self.batch;
        MaterialValues {
            tint: self.load3(&batch.material.tint),
            metallic: self.load(&batch.material.metallic),
            roughness: self.load(&batch.material.roughness),
            specular: self.load(&batch.material.specular),
            specular_color: self.load3(&batch.material.specular_color),
            occlusion: self.load(&batch.material.occlusion),
            emissive: self.load3(&batch.material.emissive),
            variance: self.load(&batch.material.variance),
        }
    }

    /// The anisotropy, if the material has one.
    #[inline(always)]
    pub(super) fn anisotropic(&self) -> Anisotropic<P> {
        let layers = &self.batch.layers;
        Anisotropic {
            direction: self.load3(&layers.anisotropy_direction),
            strength: self.load(&layers.anisotropy),
            roughness: self.load(&self.batch.material.roughness),
        }
    }

    /// Everything that reflection depends on.
    #[inline(always)]
    pub(super) fn surface_point(
        &self,
        Model { shading, layered }: Model,
        material: &Material,
    ) -> SurfacePoint<P> {
        let frame = self.frame();
        let compensated = self.batch.albedos.compensated && takes_compensation(shading);
        let dfg = compensated.then(|| self.dfg());
        let point = MaterialPoint::new(shading, &self.uniforms(material), &self.values(), dfg);
        let layers = match layered {
            true => self.layers(material, frame.n),
            false => PointLayers { anisotropic: None, coat: None, sheen: None },
        };
        SurfacePoint { shading, material: point, frame, layers }
    }

    #[inline(always)]
    fn layers(&self, material: &Material, n: Vec3<P>) -> PointLayers<P> {
        let layers = &self.batch.layers;
        PointLayers {
            anisotropic: material.anisotropy.is_some().then(|| {
                let Anisotropic { direction, strength, roughness } = self.anisotropic();
                AnisotropicLobe::new(direction, n.cross(direction), roughness, strength)
            }),
            coat: material.clearcoat.is_some().then(|| Coat {
                n: self.load3(&layers.coat_n),
                factor: self.load(&layers.coat),
                roughness: self.load(&layers.coat_roughness),
                albedo: self.load(&layers.coat_albedo),
            }),
            sheen: material.sheen.is_some().then(|| Sheen {
                color: self.load3(&layers.sheen_color),
                roughness: self.load(&layers.sheen_roughness),
                albedo: self.load(&layers.sheen_albedo),
            }),
        }
    }

    /// The environment's light, if it was looked up.
    #[inline(always)]
    pub(super) fn environment(&self) -> EnvironmentTexels<P> {
        let radiance = &self.batch.environment.radiance;
        EnvironmentTexels {
            specular: self.load3(&radiance.specular),
            mean: self.load3(&radiance.mean),
            coat: self.load3(&radiance.coat),
        }
    }
}
