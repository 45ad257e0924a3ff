//! The structures of the pixel program as parameters of a recording; whatever the variant determines is a constant.

use crate::recorder::{Recorded, Scope};
use crate::variant::Variant;
use taotie_engine::math::Vec3;
use taotie_engine::pixel::{
    Anisotropic, Coat, Frame, Geometry, MaterialPoint, MaterialUniforms, MaterialValues, PointLayers, Sheen,
    SurfacePoint, is_cook_torrance,
};
use taotie_engine::shade::{AnisotropicLobe, Compensation, MaterialSample};

/// The parameters of a stage.
#[derive(Clone, Copy)]
pub(super) struct Inputs<'g, 'v> {
    pub scope: Scope<'g>,
    pub variant: &'v Variant,
}

impl<'g> Inputs<'g, '_> {
    pub(super) fn number(self, path: &'static str) -> Recorded<'g> {
        self.scope.number(path)
    }

    pub(super) fn vector(self, path: &'static str) -> Vec3<Recorded<'g>> {
        self.scope.vector(path)
    }

    pub(super) fn constant(self, value: f64) -> Recorded<'g> {
        self.scope.constant(value)
    }

    fn number_or(self, known: bool, path: &'static str, value: f64) -> Recorded<'g> {
        if known { self.number(path) } else { self.constant(value) }
    }

    pub(super) fn vector_or(self, known: bool, path: &'static str, value: f64) -> Vec3<Recorded<'g>> {
        if known { self.vector(path) } else { Vec3::splat(self.constant(value)) }
    }

    /// The interpolated geometry; without tangents, the tangent is zero.
    pub(super) fn geometry(self) -> Geometry<Recorded<'g>> {
        Geometry {
            n_geom: self.vector("g.n_geom"),
            normal: self.vector("g.normal"),
            tangent: self.vector_or(self.variant.tangents, "g.tangent", 0.0),
            handedness: self.number_or(self.variant.tangents, "g.handedness", 1.0),
            facing: self.number("g.facing"),
            v: self.vector("g.v"),
        }
    }

    /// 1, or −1 if the surface is seen from behind and its normal turns with the side.
    pub(super) fn side(self) -> Recorded<'g> {
        self.number_or(self.variant.turns, "g.facing", 1.0)
    }

    /// The factors of the material.
    pub(super) fn uniforms(self) -> MaterialUniforms<Recorded<'g>> {
        let authored = &self.variant.authored;
        MaterialUniforms {
            base_color: self.vector("u.base_color"),
            f0: authored.f0.then(|| self.vector("u.f0")),
            f82: authored.f82.then(|| self.vector("u.f82")),
            dielectric_f0: self.number("u.dielectric_f0"),
            ambient: authored.ambient.then(|| self.vector("u.k_ambient")),
            diffuse: authored.diffuse.then(|| self.vector("u.k_diffuse")),
            specular: authored.specular.then(|| self.vector("u.k_specular")),
            slope: authored.slope.then(|| self.number("u.slope")),
            shininess: authored.shininess.then(|| self.number("u.shininess")),
        }
    }

    /// The values of the material.
    pub(super) fn values(self) -> MaterialValues<Recorded<'g>> {
        let variant = self.variant;
        MaterialValues {
            tint: self.vector_or(variant.is_tinted(), "m.tint", 1.0),
            metallic: self.number("m.metallic"),
            roughness: self.number("m.roughness"),
            specular: self.number("m.specular"),
            specular_color: self.vector("m.specular_color"),
            occlusion: self.number_or(variant.is_occluded(), "m.occlusion", 1.0),
            emissive: self.vector("m.emissive"),
            variance: self.number_or(variant.has_variance(), "m.variance", 0.0),
        }
    }

    /// The directions.
    pub(super) fn frame(self) -> Frame<Recorded<'g>> {
        Frame { n: self.vector("f.n"), smooth: self.vector("f.n_smooth"), v: self.vector("g.v") }
    }

    /// The point of the surface.
    pub(super) fn point(self) -> SurfacePoint<Recorded<'g>> {
        let frame = Frame { n: self.vector("p.n"), smooth: self.vector("p.n_smooth"), v: self.vector("p.v") };
        let material = MaterialPoint {
            sample: self.sample(),
            ambient: self.vector("p.ambient"),
            emissive: self.vector("p.emissive"),
            occlusion: self.number_or(self.variant.is_occluded(), "p.occlusion", 1.0),
        };
        SurfacePoint { shading: self.variant.shading, material, frame, layers: self.layers() }
    }

    fn sample(self) -> MaterialSample<Recorded<'g>> {
        let Variant { authored, shading, .. } = self.variant;
        let is_white = is_cook_torrance(*shading) && !authored.specular;
        MaterialSample {
            base_color: self.vector("p.base_color"),
            metallic: self.number("p.metallic"),
            roughness: self.number("p.roughness"),
            f0: self.vector("p.f0"),
            f90: self.number_or(!authored.f0, "p.f90", 1.0),
            f82_drop: self.vector_or(authored.f82, "p.f82_drop", 0.0),
            diffuse: self.vector("p.diffuse"),
            specular: self.vector_or(!is_white, "p.specular", 1.0),
            shininess: self.number("p.shininess"),
            slope: self.number("p.slope"),
            compensation: self.variant.compensated.then(|| Compensation {
                gain: self.vector("p.gain"),
                transmitted: self.number("p.transmitted"),
            }),
        }
    }

    fn layers(self) -> PointLayers<Recorded<'g>> {
        let layers = &self.variant.layers;
        PointLayers {
            anisotropic: (layers.taken && layers.anisotropy).then(|| AnisotropicLobe {
                tangent: self.vector("p.tangent"),
                bitangent: self.vector("p.bitangent"),
                along: self.number("p.along"),
                across: self.number("p.across"),
            }),
            coat: (layers.taken && layers.clearcoat).then(|| self.coat()),
            sheen: (layers.taken && layers.sheen).then(|| Sheen {
                color: self.vector("p.sheen_color"),
                roughness: self.number("p.sheen_roughness"),
                albedo: self.number("p.sheen_albedo"),
            }),
        }
    }

    pub(super) fn coat(self) -> Coat<Recorded<'g>> {
        Coat {
            n: self.vector("p.coat_n"),
            factor: self.number("p.coat"),
            roughness: self.number("p.coat_roughness"),
            albedo: self.number("p.coat_albedo"),
        }
    }

    /// The anisotropy of the highlight; bends the direction in which any model gathers the environment's light.
    pub(super) fn anisotropic(self) -> Option<Anisotropic<Recorded<'g>>> {
        self.variant.layers.anisotropy.then(|| Anisotropic {
            direction: self.vector("p.tangent"),
            strength: self.number("p.anisotropy"),
            roughness: self.number("p.roughness"),
        })
    }
}
