//! Radiance of each fragment: lights, ambient and emission.

use super::batch::{Batch, load, load3, splat3, store3};
use super::prepare::Draw;
use crate::math::{Pack, Vec3, dispatch_pack, scalar};
use crate::scene::{Falloff, Light, LightKind, Material};
use crate::shade::{self, Angles, Shading, Substance, fresnel, lights, ndf};
use fearless_simd::Level;

/// Reflectance at normal incidence of an ordinary dielectric, glTF 2.0 appendix B.
const DIELECTRIC_F0: f32 = 0.04;

/// A light made ready for shading.
#[derive(Debug, Clone, Copy)]
pub(super) struct Source {
    color: Vec3,
    /// The position, or for directional lights the unit direction to the light.
    place: Vec3,
    at_infinity: bool,
    falloff: Falloff,
    /// Axis of the cone and the cosines of its angles.
    cone: Option<(Vec3, f32, f32)>,
}

impl Source {
    pub(super) fn new(light: &Light) -> Self {
        let (place, at_infinity, cone) = match light.kind {
            LightKind::Point { position } => (position, false, None),
            LightKind::Directional { direction } => (-direction, true, None),
            LightKind::Spot { position, direction, inner, outer } => {
                let cos = |angle: f32| scalar::cos(f64::from(angle)) as f32;
                (position, false, Some((direction, cos(inner), cos(outer))))
            }
        };
        Self { color: light.color, place, at_infinity, falloff: light.falloff, cone }
    }

    /// From a point to the light; not normalised.
    pub(super) fn ray_from(&self, point: Vec3) -> Vec3 {
        if self.at_infinity { self.place } else { self.place - point }
    }

    /// How far a shadow ray along [`Self::ray_from`] goes, in its lengths.
    pub(super) fn ray_limit(&self) -> f32 {
        if self.at_infinity { f32::INFINITY } else { 1.0 }
    }

    /// The unit direction to the light and the irradiance on a plane that faces it.
    #[inline(always)]
    fn incidence<P: Pack>(&self, token: P::Token, position: Vec3<P>) -> (Vec3<P>, Vec3<P>) {
        let color = splat3(token, self.color);
        let place = splat3(token, self.place);
        if self.at_infinity {
            return (place, color);
        }
        let to_light = place - position;
        let distance_squared = to_light.dot(to_light).max(P::splat(token, 1e-12));
        let distance = distance_squared.sqrt();
        let l = to_light * (P::splat(token, 1.0) / distance);
        let mut attenuation = match self.falloff {
            Falloff::None => P::splat(token, 1.0),
            Falloff::InverseSquare => lights::inverse_square(distance_squared),
            Falloff::Windowed(range) => {
                lights::inverse_square(distance_squared)
                    * lights::range_window(distance_squared, P::splat(token, range))
            }
        };
        if let Some((axis, cos_inner, cos_outer)) = self.cone {
            let cos = -splat3(token, axis).dot(l);
            let (inner, outer) = (P::splat(token, cos_inner), P::splat(token, cos_outer));
            attenuation = attenuation * lights::spot_cone(cos, inner, outer);
        }
        (l, color * attenuation)
    }
}

/// What lighting needs beside a batch.
pub(super) struct Illumination<'a> {
    pub shading: Shading,
    pub sources: &'a [Source],
    pub ambient: Vec3,
    pub shadows: bool,
}

/// Fills `batch.radiance` and `batch.albedo`.
pub(super) fn light(level: Level, illumination: &Illumination<'_>, draw: &Draw<'_>, batch: &mut Batch) {
    dispatch_pack!(level, P, token => all_packs::<P>(token, illumination, draw, batch));
}

#[inline(always)]
fn all_packs<P: Pack>(token: P::Token, illumination: &Illumination<'_>, draw: &Draw<'_>, batch: &mut Batch) {
    for i in batch.packs::<P>() {
        let [r, g, b, _] = draw.material.base_color;
        let tint: Vec3<P> = load3(token, &batch.tint, i);
        let albedo = tint.mul_elements(splat3(token, Vec3::new(r, g, b)));
        let radiance =
            if draw.material.unlit { albedo } else { lit_pack(token, illumination, draw.material, batch, i) };
        store3(albedo, &mut batch.albedo, i);
        store3(radiance, &mut batch.radiance, i);
    }
}

#[inline(always)]
fn lit_pack<P: Pack>(
    token: P::Token,
    illumination: &Illumination<'_>,
    material: &Material,
    batch: &Batch,
    i: usize,
) -> Vec3<P> {
    let surface: SurfacePoint<P> = SurfacePoint::new(token, illumination.shading, material, batch, i);
    let ambient = surface.ambient;
    let position = load3(token, &batch.position, i);
    let surround = splat3(token, illumination.ambient) * load(token, &batch.occlusion, i);
    let mut radiance = load3(token, &batch.emissive, i) + ambient.mul_elements(surround);
    for (index, source) in illumination.sources.iter().enumerate() {
        let (l, irradiance) = source.incidence(token, position);
        let mut reflected = surface.reflect(l).mul_elements(irradiance);
        if illumination.shadows {
            reflected = reflected * load(token, &batch.visibility[index], i);
        }
        radiance += reflected;
    }
    radiance
}

/// Points of a surface with everything that their reflection depends on: a pack of fragments, or one.
pub(super) struct SurfacePoint<L> {
    shading: Shading,
    pub substance: Substance<L>,
    /// k_a, linear RGB.
    pub ambient: Vec3<L>,
    /// The shading normal, unit, world space.
    pub n: Vec3<L>,
    /// Unit, to the viewer, world space.
    pub v: Vec3<L>,
}

impl<P: Pack> SurfacePoint<P> {
    /// The fragments of `batch` from `i` on.
    #[inline(always)]
    pub(super) fn new(
        token: P::Token,
        shading: Shading,
        material: &Material,
        batch: &Batch,
        i: usize,
    ) -> Self {
        let (substance, ambient) = substance(token, shading, material, batch, i);
        let (n, v) = (load3(token, &batch.n, i), load3(token, &batch.v, i));
        Self { shading, substance, ambient, n, v }
    }

    /// Radiance to the viewer per unit of irradiance on a plane that faces the light in direction `l` (unit, world
    /// space), linear RGB: f · n·l.
    #[inline(always)]
    pub(super) fn reflect(&self, l: Vec3<P>) -> Vec3<P> {
        shade::reflect(self.shading, &self.substance, &Angles::new(self.n, self.v, l))
    }
}

/// Whether the model multiplies k_s by a Fresnel term made from F0, so that k_s itself is 1 where not authored.
fn takes_fresnel(shading: Shading) -> bool {
    matches!(shading, Shading::CookTorrance | Shading::CookTorrancePrinted)
}

/// The surface's parameters in every model's terms, and k_a. What the material does not author follows from the
/// metallic-roughness values.
#[inline(always)]
fn substance<P: Pack>(
    token: P::Token,
    shading: Shading,
    material: &Material,
    batch: &Batch,
    i: usize,
) -> (Substance<P>, Vec3<P>) {
    let tint = load3(token, &batch.tint, i);
    let (metallic, roughness): (P, P) = (load(token, &batch.metallic, i), load(token, &batch.roughness, i));
    let one = P::splat(token, 1.0);
    let authored = |rgb: [f32; 3]| splat3(token, Vec3::from_array(rgb));
    let [r, g, b, _] = material.base_color;
    let base_color = tint.mul_elements(authored([r, g, b]));
    let f0 = match material.f0 {
        Some(f0) => authored(f0),
        None => Vec3::splat(P::splat(token, DIELECTRIC_F0)) * (one - metallic) + base_color * metallic,
    };
    let f82_drop = match material.f82 {
        Some(f82) => fresnel::f82_drop(f0, authored(f82)),
        None => Vec3::splat(P::splat(token, 0.0)),
    };
    let diffuse = match material.classic.diffuse {
        Some(diffuse) => authored(diffuse).mul_elements(tint),
        None => base_color * (one - metallic),
    };
    let specular = match material.classic.specular {
        Some(specular) => authored(specular),
        None if takes_fresnel(shading) => Vec3::splat(one),
        None => f0,
    };
    let alpha = (roughness * roughness).max(P::splat(token, 0.02));
    let shininess = material
        .classic
        .shininess
        .map_or_else(|| ndf::shininess_from_alpha(alpha), |shininess| P::splat(token, shininess));
    let slope = material.classic.slope.map_or(alpha, |slope| P::splat(token, slope));
    let ambient = match material.classic.ambient {
        Some(ambient) => authored(ambient).mul_elements(tint),
        None => diffuse + f0,
    };
    let substance = Substance {
        base_color,
        metallic,
        roughness,
        f0,
        f90: one,
        f82_drop,
        diffuse,
        specular,
        shininess,
        slope,
        compensation: None,
    };
    (substance, ambient)
}
