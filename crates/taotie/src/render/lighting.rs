//! Radiance of each fragment: lights, surroundings and emission.

use super::batch::{Batch, load, load3, splat3, store3};
use super::point::{Model, SurfacePoint};
use super::prepare::Draw;
use crate::math::{Pack, Vec3, dispatch_pack, scalar};
use crate::scene::{Falloff, Light, LightKind, Material};
use crate::shade::{Shading, lights};
use fearless_simd::Level;

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
                // In the 32 bits that files hold, so that an angle and its decimals are one light.
                let cos = |angle: f64| scalar::cos(f64::from(angle as f32)) as f32;
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
    pub(super) fn incidence<P: Pack>(&self, token: P::Token, position: Vec3<P>) -> (Vec3<P>, Vec3<P>) {
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
    /// Whether `batch.surround` is filled.
    pub surrounded: bool,
}

/// The models that are compiled by themselves, since nearly all pictures show them: what the others need would cost
/// them registers.
const COOK_TORRANCE: u8 = 0;
const PLAIN_GGX: u8 = 1;
const ANY: u8 = 2;

/// Fills `batch.radiance` and `batch.albedo`.
pub(super) fn light(level: Level, illumination: &Illumination<'_>, draw: &Draw<'_>, batch: &mut Batch) {
    match Model::new(illumination.shading, draw.material) {
        Model { shading: Shading::CookTorrance, .. } => {
            dispatch_pack!(level, P, token => all_packs::<P, COOK_TORRANCE>(token, illumination, draw, batch));
        }
        Model { shading: Shading::Ggx, layered: false } => {
            dispatch_pack!(level, P, token => all_packs::<P, PLAIN_GGX>(token, illumination, draw, batch));
        }
        _ => dispatch_pack!(level, P, token => all_packs::<P, ANY>(token, illumination, draw, batch)),
    }
}

#[inline(always)]
fn all_packs<P: Pack, const MODEL: u8>(
    token: P::Token,
    illumination: &Illumination<'_>,
    draw: &Draw<'_>,
    batch: &mut Batch,
) {
    let model = match MODEL {
        COOK_TORRANCE => Model { shading: Shading::CookTorrance, layered: false },
        PLAIN_GGX => Model { shading: Shading::Ggx, layered: false },
        _ => Model::new(illumination.shading, draw.material),
    };
    for i in batch.packs::<P>() {
        let [r, g, b, _] = draw.material.base_color;
        let tint: Vec3<P> = load3(token, &batch.tint, i);
        let albedo = tint.mul_elements(splat3(token, Vec3::new(r, g, b)));
        let radiance = match draw.material.unlit {
            true => albedo,
            false => lit_pack(token, (illumination, model), draw.material, batch, i),
        };
        store3(albedo, &mut batch.albedo, i);
        store3(radiance, &mut batch.radiance, i);
    }
}

#[inline(always)]
fn lit_pack<P: Pack>(
    token: P::Token,
    (illumination, model): (&Illumination<'_>, Model),
    material: &Material,
    batch: &Batch,
    i: usize,
) -> Vec3<P> {
    let surface: SurfacePoint<P> = SurfacePoint::new(token, model, material, batch, i);
    let position = load3(token, &batch.position, i);
    let ambient = splat3(token, illumination.ambient) * load(token, &batch.occlusion, i);
    let mut radiance = surface.emitted + surface.ambient.mul_elements(ambient);
    if illumination.surrounded {
        radiance += surface.surrounded(token, batch, i);
    }
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
