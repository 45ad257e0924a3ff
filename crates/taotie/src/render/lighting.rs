//! Radiance of each fragment: lights, ambient and emission.

use super::batch::{Batch, load, load3, splat3, store3};
use super::prepare::Draw;
use crate::math::{Lane, Vec3, scalar};
use crate::scene::{Falloff, Light, LightKind, Material};
use crate::shade::{self, Angles, Shading, Substance, fresnel, lights, ndf};
use fearless_simd::{Level, Simd, dispatch, f32x8, prelude::*};

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
    pub(super) fn to_light(&self, point: Vec3) -> Vec3 {
        if self.at_infinity { self.place } else { self.place - point }
    }

    /// How far a shadow ray along [`Self::to_light`] goes, in its lengths.
    pub(super) fn ray_limit(&self) -> f32 {
        if self.at_infinity { f32::INFINITY } else { 1.0 }
    }

    /// The unit direction to the light and the irradiance on a plane that faces it.
    #[inline(always)]
    fn incidence<S: Simd>(&self, simd: S, position: Vec3<f32x8<S>>) -> (Vec3<f32x8<S>>, Vec3<f32x8<S>>) {
        let color = splat3(simd, self.color);
        let place = splat3(simd, self.place);
        if self.at_infinity {
            return (place, color);
        }
        let to_light = place - position;
        let distance_squared = Lane::max(to_light.dot(to_light), f32x8::splat(simd, 1e-12));
        let distance = Lane::sqrt(distance_squared);
        let l = to_light * (f32x8::splat(simd, 1.0) / distance);
        let mut attenuation = match self.falloff {
            Falloff::None => f32x8::splat(simd, 1.0),
            Falloff::InverseSquare => lights::inverse_square(distance_squared),
            Falloff::Windowed(range) => {
                lights::inverse_square(distance_squared)
                    * lights::range_window(distance_squared, f32x8::splat(simd, range))
            }
        };
        if let Some((axis, cos_inner, cos_outer)) = self.cone {
            let cos = -splat3(simd, axis).dot(l);
            let (inner, outer) = (f32x8::splat(simd, cos_inner), f32x8::splat(simd, cos_outer));
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
    dispatch!(level, simd => all_packs(simd, illumination, draw, batch));
}

#[inline(always)]
fn all_packs<S: Simd>(simd: S, illumination: &Illumination<'_>, draw: &Draw<'_>, batch: &mut Batch) {
    for i in batch.packs() {
        let [r, g, b, _] = draw.material.base_color;
        let albedo = load3(simd, &batch.tint, i).mul_elements(splat3(simd, Vec3::new(r, g, b)));
        let radiance =
            if draw.material.unlit { albedo } else { lit_pack(simd, illumination, draw.material, batch, i) };
        store3(albedo, &mut batch.albedo, i);
        store3(radiance, &mut batch.radiance, i);
    }
}

#[inline(always)]
fn lit_pack<S: Simd>(
    simd: S,
    illumination: &Illumination<'_>,
    material: &Material,
    batch: &Batch,
    i: usize,
) -> Vec3<f32x8<S>> {
    let (substance, ambient) = substance(simd, illumination.shading, material, batch, i);
    let (n, v) = (load3(simd, &batch.n, i), load3(simd, &batch.v, i));
    let position = load3(simd, &batch.position, i);
    let surround = splat3(simd, illumination.ambient) * load(simd, &batch.occlusion, i);
    let mut radiance = load3(simd, &batch.emissive, i) + ambient.mul_elements(surround);
    for (index, source) in illumination.sources.iter().enumerate() {
        let (l, irradiance) = source.incidence(simd, position);
        let angles = Angles::new(n, v, l);
        let mut reflected =
            shade::reflect(illumination.shading, &substance, &angles).mul_elements(irradiance);
        if illumination.shadows {
            reflected = reflected * load(simd, &batch.visibility[index], i);
        }
        radiance += reflected;
    }
    radiance
}

/// Whether the model multiplies k_s by a Fresnel term made from F0, so that k_s itself is 1 where not authored.
fn takes_fresnel(shading: Shading) -> bool {
    matches!(shading, Shading::CookTorrance | Shading::CookTorrancePrinted)
}

/// The surface's parameters in every model's terms, and k_a. What the material does not author follows from the
/// metallic-roughness values.
#[inline(always)]
fn substance<S: Simd>(
    simd: S,
    shading: Shading,
    material: &Material,
    batch: &Batch,
    i: usize,
) -> (Substance<f32x8<S>>, Vec3<f32x8<S>>) {
    let tint = load3(simd, &batch.tint, i);
    let (metallic, roughness) = (load(simd, &batch.metallic, i), load(simd, &batch.roughness, i));
    let one = f32x8::splat(simd, 1.0);
    let authored = |rgb: [f32; 3]| splat3(simd, Vec3::from_array(rgb));
    let [r, g, b, _] = material.base_color;
    let base_color = tint.mul_elements(authored([r, g, b]));
    let f0 = match material.f0 {
        Some(f0) => authored(f0),
        None => Vec3::splat(f32x8::splat(simd, DIELECTRIC_F0)) * (one - metallic) + base_color * metallic,
    };
    let f82_drop = match material.f82 {
        Some(f82) => fresnel::f82_drop(f0, authored(f82)),
        None => Vec3::splat(f32x8::splat(simd, 0.0)),
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
    let alpha = Lane::max(roughness * roughness, f32x8::splat(simd, 0.02));
    let shininess = material
        .classic
        .shininess
        .map_or_else(|| ndf::shininess_from_alpha(alpha), |shininess| f32x8::splat(simd, shininess));
    let slope = material.classic.slope.map_or(alpha, |slope| f32x8::splat(simd, slope));
    let ambient = match material.classic.ambient {
        Some(ambient) => authored(ambient).mul_elements(tint),
        None => diffuse + f0,
    };
    let substance =
        Substance { base_color, metallic, roughness, f0, f82_drop, diffuse, specular, shininess, slope };
    (substance, ambient)
}
