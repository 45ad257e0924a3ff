//! What the environment sends to each fragment.

use super::albedos::lobe_roughness;
use super::batch::{Batch, load, load3, store3};
use super::prepare::Draw;
use super::settings::EnvironmentLight;
use crate::math::{Lane, Pack, Vec3, dispatch_pack};
use crate::scene::Material;
use crate::shade::Shading;
use crate::shade::environment::{Environment, Mirrors, Wanted};
use fearless_simd::Level;

/// Fills `batch.surround`.
pub(super) fn look_up(
    level: Level,
    light: &EnvironmentLight,
    shading: Shading,
    draw: &Draw<'_>,
    batch: &mut Batch,
) {
    let (environment, len) = (&light.environment, batch.len);
    dispatch_pack!(level, P, token => normals::<P>(token, light, batch));
    let Batch { gatherer, mirrors, surround, .. } = batch;
    environment.gather_mean(
        level,
        gatherer,
        Wanted { mirrors, len, factor: light.intensity },
        &mut surround.mean,
    );
    dispatch_pack!(level, P, token => mirrored::<P>(token, (light, shading), draw.material, batch));
    let Batch { gatherer, mirrors, surround, .. } = batch;
    environment.gather(
        level,
        gatherer,
        Wanted { mirrors, len, factor: light.intensity },
        &mut surround.specular,
    );
    if draw.material.clearcoat.is_some() {
        dispatch_pack!(level, P, token => coat::<P>(token, light, batch));
        let Batch { gatherer, mirrors, surround, .. } = batch;
        environment.gather(
            level,
            gatherer,
            Wanted { mirrors, len, factor: light.intensity },
            &mut surround.coat,
        );
    }
}

#[inline(always)]
fn normals<P: Pack>(token: P::Token, light: &EnvironmentLight, batch: &mut Batch) {
    for i in batch.packs::<P>() {
        let n: Vec3<P> = load3(token, &batch.n, i);
        let [u, v] = Environment::place_of(light.turn().to_environment(n));
        u.store(&mut batch.mirrors.place[0][i..]);
        v.store(&mut batch.mirrors.place[1][i..]);
    }
}

#[inline(always)]
fn mirrored<P: Pack>(
    token: P::Token,
    (light, shading): (&EnvironmentLight, Shading),
    material: &Material,
    batch: &mut Batch,
) {
    for i in batch.packs::<P>() {
        let (n, v): (Vec3<P>, Vec3<P>) = (load3(token, &batch.n, i), load3(token, &batch.v, i));
        let roughness: P = lobe_roughness(token, shading, material, batch, i);
        let lobe_normal = match material.anisotropy {
            Some(_) => stretched_normal(token, (n, v), batch, i),
            None => n,
        };
        let direction = towards_normal(mirror(lobe_normal, v), n, roughness);
        set(light, i, (direction, roughness), &mut batch.mirrors);
    }
}

#[inline(always)]
fn coat<P: Pack>(token: P::Token, light: &EnvironmentLight, batch: &mut Batch) {
    for i in batch.packs::<P>() {
        let n: Vec3<P> = load3(token, &batch.layers.coat_n, i);
        let direction = mirror(n, load3(token, &batch.v, i));
        let roughness = load(token, &batch.layers.coat_roughness, i);
        set(light, i, (direction, roughness), &mut batch.mirrors);
    }
}

#[inline(always)]
fn set<P: Pack>(
    light: &EnvironmentLight,
    i: usize,
    (direction, roughness): (Vec3<P>, P),
    mirrors: &mut Mirrors,
) {
    let direction = light.turn().to_environment(direction);
    let [u, v] = Environment::place_of(direction);
    store3(direction, &mut mirrors.direction, i);
    u.store(&mut mirrors.place[0][i..]);
    v.store(&mut mirrors.place[1][i..]);
    roughness.store(&mut mirrors.roughness[i..]);
}

#[inline(always)]
fn mirror<L: Lane>(n: Vec3<L>, v: Vec3<L>) -> Vec3<L> {
    let cosine = n.dot(v);
    n * (cosine + cosine) - v
}

/// The direction in which a rough highlight gathers its light: rough surfaces seen at a grazing angle mirror less
/// than their mirror direction says, since half of their lobe lies below the horizon. From the mirror direction of a
/// smooth surface it goes to the normal of the roughest with roughness⁴, which lowers the error of the split sum
/// threefold at roughness 1 and leaves it alone below 0.5 (docs/errors.md).
#[inline(always)]
fn towards_normal<L: Lane>(mirrored: Vec3<L>, n: Vec3<L>, roughness: L) -> Vec3<L> {
    let share = roughness.squared().squared();
    (mirrored * (roughness.lit(1.0) - share) + n * share).normalize_or(n)
}

/// The normal that a stretched highlight mirrors by: bent towards the viewer, across the stretch.
/// Source: McAuley 2015, "Rendering the World of Far Cry 4"; the blend of KHR_materials_anisotropy.
#[inline(always)]
fn stretched_normal<P: Pack>(
    token: P::Token,
    (n, v): (Vec3<P>, Vec3<P>),
    batch: &Batch,
    i: usize,
) -> Vec3<P> {
    let one = P::splat(token, 1.0);
    let bitangent = n.cross(load3(token, &batch.layers.stretch_tangent, i));
    let bent = bitangent.cross(v).cross(bitangent).normalize_or(n);
    let stretch: P = load(token, &batch.layers.stretch, i);
    let round = one - stretch * (one - load::<P>(token, &batch.roughness, i));
    let share = round.squared().squared();
    (bent * (one - share) + n * share).normalize_or(n)
}
