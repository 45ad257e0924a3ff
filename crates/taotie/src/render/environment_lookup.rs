//! The light of the environment at each fragment.

use super::albedos::lobe_roughness;
use super::batch::{Batch, Lanes};
use super::columns::store3;
use super::draw::Draw;
use super::settings::EnvironmentLight;
use crate::math::{Lane, Pack, Vec3, dispatch_pack};
use crate::scene::Material;
use crate::shade::Shading;
use crate::shade::environment::{Environment, LookupDirections, LookupRequest};
use fearless_simd::Level;

/// An environment as a model of reflectance asks for it.
#[derive(Clone, Copy)]
pub(super) struct EnvironmentQuery<'l> {
    pub light: &'l EnvironmentLight,
    pub shading: Shading,
}

/// Fills `batch.environment_radiance`.
pub(super) fn look_up(level: Level, query: EnvironmentQuery<'_>, draw: &Draw<'_>, batch: &mut Batch) {
    let light = query.light;
    let (environment, len) = (&light.environment, batch.len);
    dispatch_pack!(level, P, token => normals::<P>(token, light, batch));
    let Batch { environment_lookup, lookup_directions, environment_radiance, .. } = batch;
    let request = LookupRequest { directions: lookup_directions, len, factor: light.intensity };
    environment.look_up_mean(level, environment_lookup, request, &mut environment_radiance.mean);
    dispatch_pack!(level, P, token => mirrored::<P>(token, query, draw.material, batch));
    let Batch { environment_lookup, lookup_directions, environment_radiance, .. } = batch;
    environment.look_up(
        level,
        environment_lookup,
        LookupRequest { directions: lookup_directions, len, factor: light.intensity },
        &mut environment_radiance.specular,
    );
    if draw.material.clearcoat.is_some() {
        dispatch_pack!(level, P, token => coat::<P>(token, light, batch));
        let Batch { environment_lookup, lookup_directions, environment_radiance, .. } = batch;
        environment.look_up(
            level,
            environment_lookup,
            LookupRequest { directions: lookup_directions, len, factor: light.intensity },
            &mut environment_radiance.coat,
        );
    }
}

#[inline(always)]
fn normals<P: Pack>(token: P::Token, light: &EnvironmentLight, batch: &mut Batch) {
    for i in batch.packs::<P>() {
        let n = batch.lanes::<P>(token, i).load3(&batch.n);
        let [u, v] = Environment::place_of(light.turn().to_environment(n));
        u.store(&mut batch.lookup_directions.place[0][i..]);
        v.store(&mut batch.lookup_directions.place[1][i..]);
    }
}

#[inline(always)]
fn mirrored<P: Pack>(token: P::Token, query: EnvironmentQuery<'_>, material: &Material, batch: &mut Batch) {
    for i in batch.packs::<P>() {
        let at: Lanes<'_, P> = batch.lanes(token, i);
        let (n, v) = (at.load3(&batch.n), at.load3(&batch.v));
        let roughness = lobe_roughness(at, query.shading, material);
        let lobe_normal = match material.anisotropy {
            Some(_) => anisotropic_normal(at, n, v),
            None => n,
        };
        let direction = towards_normal(mirror(lobe_normal, v), n, roughness);
        LobeDirection { direction, roughness }.set(query.light, i, &mut batch.lookup_directions);
    }
}

#[inline(always)]
fn coat<P: Pack>(token: P::Token, light: &EnvironmentLight, batch: &mut Batch) {
    for i in batch.packs::<P>() {
        let at: Lanes<'_, P> = batch.lanes(token, i);
        let direction = mirror(at.load3(&batch.layers.coat_n), at.load3(&batch.v));
        let roughness = at.load(&batch.layers.coat_roughness);
        LobeDirection { direction, roughness }.set(light, i, &mut batch.lookup_directions);
    }
}

/// The direction and width from which a highlight gathers its light.
struct LobeDirection<P> {
    /// The direction: unit, world space.
    direction: Vec3<P>,
    roughness: P,
}

impl<P: Pack> LobeDirection<P> {
    /// Writes entries from `i` on.
    #[inline(always)]
    fn set(self, light: &EnvironmentLight, i: usize, directions: &mut LookupDirections) {
        let direction = light.turn().to_environment(self.direction);
        let [u, v] = Environment::place_of(direction);
        store3(direction, &mut directions.direction, i);
        u.store(&mut directions.place[0][i..]);
        v.store(&mut directions.place[1][i..]);
        self.roughness.store(&mut directions.roughness[i..]);
    }
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

/// The normal that an anisotropic highlight mirrors by: turned towards the viewer, across the direction of anisotropy.
/// Source: McAuley 2015, "Rendering the World of Far Cry 4"; the blend of KHR_materials_anisotropy.
#[inline(always)]
fn anisotropic_normal<P: Pack>(at: Lanes<'_, P>, n: Vec3<P>, v: Vec3<P>) -> Vec3<P> {
    let one = at.splat(1.0);
    let bitangent = n.cross(at.load3(&at.batch.layers.anisotropy_direction));
    let bent = bitangent.cross(v).cross(bitangent).normalize_or(n);
    let strength = at.load(&at.batch.layers.anisotropy);
    let round = one - strength * (one - at.load(&at.batch.roughness));
    let share = round.squared().squared();
    (bent * (one - share) + n * share).normalize_or(n)
}
