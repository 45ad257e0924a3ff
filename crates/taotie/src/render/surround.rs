//! What the environment sends to each fragment.

use super::albedos::lobe_roughness;
use super::batch::{Batch, Column, Column3, Quads, get3, load, load3, store3};
use super::prepare::Draw;
use super::settings::EnvironmentLight;
use crate::math::{Lane, Pack, Vec3, dispatch_pack};
use crate::scene::Material;
use crate::shade::Shading;
use crate::shade::environment::Environment;
use fearless_simd::Level;
use std::f32::consts::{FRAC_1_PI, PI};

/// Where the filtered maps are read, and for how rough a highlight.
struct Gathering {
    /// Of the environment.
    direction: Column3,
    place: [Column; 2],
    roughness: Column,
}

/// Fills `batch.surround`.
pub(super) fn look_up(
    level: Level,
    light: &EnvironmentLight,
    shading: Shading,
    draw: &Draw<'_>,
    batch: &mut Batch,
) {
    let zero = Column::ZERO;
    let mut at = Gathering { direction: [zero; 3], place: [zero; 2], roughness: zero };
    dispatch_pack!(level, P, token => at.normals::<P>(token, light, batch));
    // The irradiance is π times what the map holds.
    let factor = PI * (light.intensity * FRAC_1_PI);
    for (i, mean) in batch.surround.mean[..batch.len].iter_mut().enumerate() {
        *mean = scaled(light.environment.mean_at(at.place_of(i)), factor);
    }
    dispatch_pack!(level, P, token => at.mirrored::<P>(token, (light, shading), draw.material, batch));
    at.gather(light, batch.len, &mut batch.surround.specular);
    if draw.material.clearcoat.is_some() {
        dispatch_pack!(level, P, token => at.coat::<P>(token, light, batch));
        at.gather(light, batch.len, &mut batch.surround.coat);
    }
}

impl Gathering {
    fn place_of(&self, i: usize) -> [f32; 2] {
        [self.place[0][i], self.place[1][i]]
    }

    fn gather(&self, light: &EnvironmentLight, len: usize, out: &mut Quads) {
        for (i, out) in out[..len].iter_mut().enumerate() {
            let direction = get3(&self.direction, i);
            let radiance = light.environment.specular_at(self.place_of(i), direction, self.roughness[i]);
            *out = scaled(radiance, light.intensity);
        }
    }

    #[inline(always)]
    fn normals<P: Pack>(&mut self, token: P::Token, light: &EnvironmentLight, batch: &Batch) {
        for i in batch.packs::<P>() {
            let n: Vec3<P> = load3(token, &batch.n, i);
            let [u, v] = Environment::place_of(light.turn().to_environment(n));
            u.store(&mut self.place[0][i..]);
            v.store(&mut self.place[1][i..]);
        }
    }

    #[inline(always)]
    fn mirrored<P: Pack>(
        &mut self,
        token: P::Token,
        (light, shading): (&EnvironmentLight, Shading),
        material: &Material,
        batch: &Batch,
    ) {
        for i in batch.packs::<P>() {
            let (n, v): (Vec3<P>, Vec3<P>) = (load3(token, &batch.n, i), load3(token, &batch.v, i));
            let roughness: P = lobe_roughness(token, shading, material, batch, i);
            let lobe_normal = match material.anisotropy {
                Some(_) => stretched_normal(token, (n, v), batch, i),
                None => n,
            };
            let direction = towards_normal(mirror(lobe_normal, v), n, roughness);
            self.set(light, i, direction, roughness);
        }
    }

    #[inline(always)]
    fn coat<P: Pack>(&mut self, token: P::Token, light: &EnvironmentLight, batch: &Batch) {
        for i in batch.packs::<P>() {
            let n: Vec3<P> = load3(token, &batch.layers.coat_n, i);
            let direction = mirror(n, load3(token, &batch.v, i));
            self.set(light, i, direction, load(token, &batch.layers.coat_roughness, i));
        }
    }

    #[inline(always)]
    fn set<P: Pack>(&mut self, light: &EnvironmentLight, i: usize, direction: Vec3<P>, roughness: P) {
        let direction = light.turn().to_environment(direction);
        let [u, v] = Environment::place_of(direction);
        store3(direction, &mut self.direction, i);
        u.store(&mut self.place[0][i..]);
        v.store(&mut self.place[1][i..]);
        roughness.store(&mut self.roughness[i..]);
    }
}

fn scaled(mut color: [f32; 4], factor: f32) -> [f32; 4] {
    for channel in &mut color {
        *channel *= factor;
    }
    color
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
