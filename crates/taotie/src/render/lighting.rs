//! Radiance of each fragment: lights, environment and emission.

use super::batch::{Batch, Lanes};
use super::columns::store3;
use super::draw::Draw;
use crate::math::{Pack, Vec3, dispatch_pack};
use crate::pixel::{Incidence, LightSource, Model};
use crate::scene::Material;
use crate::shade::Shading;
use fearless_simd::Level;

/// The inputs of lighting in addition to a batch.
#[derive(Clone, Copy)]
pub(super) struct Illumination<'a> {
    pub shading: Shading,
    pub sources: &'a [LightSource<f32>],
    pub ambient: Vec3,
    pub shadows: bool,
    /// `true` if `batch.environment.radiance` is filled.
    pub has_environment: bool,
}

/// The models that are compiled separately, since nearly all images use them: what the others need would cost them
/// registers.
const COOK_TORRANCE: u8 = 0;
const PLAIN_GGX: u8 = 1;
const ANY: u8 = 2;

/// Fills `batch.lit.radiance` and `batch.lit.albedo`.
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
        let at: Lanes<'_, P> = batch.lanes(token, i);
        let albedo = at.load3(&batch.material.tint).mul_elements(at.splat3(Vec3::new(r, g, b)));
        let radiance = match draw.material.unlit {
            true => albedo,
            false => lit_pack(at, illumination, model, draw.material),
        };
        store3(albedo, &mut batch.lit.albedo, i);
        store3(radiance, &mut batch.lit.radiance, i);
    }
}

#[inline(always)]
fn lit_pack<P: Pack>(
    at: Lanes<'_, P>,
    illumination: &Illumination<'_>,
    model: Model,
    material: &Material,
) -> Vec3<P> {
    let batch = at.batch;
    let surface = at.surface_point(model, material);
    let position = at.load3(&batch.geometry.position);
    let mut radiance = surface.own(at.splat3(illumination.ambient));
    if illumination.has_environment {
        radiance += surface.reflect_environment(&at.environment(), &at.dfg());
    }
    for (index, source) in illumination.sources.iter().enumerate() {
        let Incidence { l, irradiance } = source.map(|value| at.splat(value)).incidence(position);
        let mut reflected = surface.reflect(l).mul_elements(irradiance);
        if illumination.shadows {
            reflected = reflected * at.load(&batch.lit.visibility[index]);
        }
        radiance += reflected;
    }
    radiance
}
