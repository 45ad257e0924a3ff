//! The light of the environment at each fragment.

use super::batch::{Batch, EnvironmentColumns, Lanes};
use super::columns::store3;
use super::draw::Draw;
use super::settings::EnvironmentLight;
use crate::math::{Pack, dispatch_pack};
use crate::pixel::{Highlight, Turn, coat_highlight, highlight, lobe_roughness};
use crate::scene::Material;
use crate::shade::Shading;
use crate::shade::environment::{Environment, LookupDirections, LookupRequest};
use fearless_simd::Level;

/// The environment as needed by a reflectance model.
#[derive(Clone, Copy)]
pub(super) struct EnvironmentQuery<'l> {
    pub light: &'l EnvironmentLight,
    pub shading: Shading,
}

/// Fills `batch.environment.radiance`.
pub(super) fn look_up(level: Level, query: EnvironmentQuery<'_>, draw: &Draw<'_>, batch: &mut Batch) {
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
