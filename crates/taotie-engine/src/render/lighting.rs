//! The light on each fragment: lookups of the environment, and the radiance from lights, environment and emission.

use super::batch::{Batch, EnvironmentColumns, Lanes, store3};
use super::draw::Draw;
use super::settings::EnvironmentLight;
use crate::math::{Pack, Vec3, dispatch_pack};
use crate::pixel::{
    Highlight, Incidence, LightSource, Model, Turn, coat_highlight, highlight, lobe_roughness,
};
use crate::scene::Material;
use crate::shade::Shading;
use crate::shade::environment::{Environment, LookupDirections, LookupRequest};
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

/// The environment as needed by a reflectance model.
#[derive(Clone, Copy)]
pub(super) struct EnvironmentQuery<'l> {
    pub light: &'l EnvironmentLight,
    pub shading: Shading,
}

/// Fills `batch.environment.radiance`.
pub(super) fn look_up_environment(
    level: Level,
    query: EnvironmentQuery<'_>,
    draw: &Draw<'_>,
    batch: &mut Batch,
) {
    let light = query.light;
    let (environment, len) = (&light.environment, batch.len);
    dispatch_pack!(level, P, token => normals::<P>(token, light, batch));
    let EnvironmentColumns { lookup, directions, radiance } = &mut batch.environment;
    let request = LookupRequest { directions, len, factor: light.intensity };
    environment.look_up_mean(level, lookup, request, &mut radiance.mean);
    dispatch_pack!(level, P, token => mirrored::<P>(token, query, draw.material, batch));
    let EnvironmentColumns { lookup, directions, radiance } = &mut batch.environment;
    environment.look_up(
        level,
        lookup,
        LookupRequest { directions, len, factor: light.intensity },
        &mut radiance.specular,
    );
    if draw.material.clearcoat.is_some() {
        dispatch_pack!(level, P, token => coat::<P>(token, light, batch));
        let EnvironmentColumns { lookup, directions, radiance } = &mut batch.environment;
        environment.look_up(
            level,
            lookup,
            LookupRequest { directions, len, factor: light.intensity },
            &mut radiance.coat,
        );
    }
}

#[inline(always)]
fn normals<P: Pack>(token: P::Token, light: &EnvironmentLight, batch: &mut Batch) {
    let turn = light.turn().map(|value| P::splat(token, value));
    for i in batch.packs::<P>() {
        let n = batch.lanes::<P>(token, i).load3(&batch.frame.n);
        let [u, v] = Environment::place_of(turn.to_environment(n));
        u.store(&mut batch.environment.directions.place[0][i..]);
        v.store(&mut batch.environment.directions.place[1][i..]);
    }
}

#[inline(always)]
fn mirrored<P: Pack>(token: P::Token, query: EnvironmentQuery<'_>, material: &Material, batch: &mut Batch) {
    let turn = query.light.turn().map(|value| P::splat(token, value));
    for i in batch.packs::<P>() {
        let at: Lanes<'_, P> = batch.lanes(token, i);
        let roughness = lobe_roughness(query.shading, &at.uniforms(material), &at.values());
        let anisotropic = material.anisotropy.is_some().then(|| at.anisotropic());
        let highlight = highlight(&at.frame(), roughness, anisotropic.as_ref());
        set(highlight, turn, i, &mut batch.environment.directions);
    }
}

#[inline(always)]
fn coat<P: Pack>(token: P::Token, light: &EnvironmentLight, batch: &mut Batch) {
    let turn = light.turn().map(|value| P::splat(token, value));
    for i in batch.packs::<P>() {
        let at: Lanes<'_, P> = batch.lanes(token, i);
        let n = at.load3(&batch.layers.coat_n);
        let highlight = coat_highlight(n, at.load3(&batch.geometry.v), at.load(&batch.layers.coat_roughness));
        set(highlight, turn, i, &mut batch.environment.directions);
    }
}

/// Writes entries from `i` onwards.
#[inline(always)]
fn set<P: Pack>(highlight: Highlight<P>, turn: Turn<P>, i: usize, directions: &mut LookupDirections) {
    let direction = turn.to_environment(highlight.direction);
    let [u, v] = Environment::place_of(direction);
    store3(direction, &mut directions.direction, i);
    u.store(&mut directions.place[0][i..]);
    v.store(&mut directions.place[1][i..]);
    highlight.roughness.store(&mut directions.roughness[i..]);
}
