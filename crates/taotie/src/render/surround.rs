//! What the environment sends to each fragment.

use super::albedos::lobe_roughness;
use super::batch::{Batch, get3, set3};
use super::prepare::Draw;
use super::settings::EnvironmentLight;
use crate::math::Vec3;
use crate::shade::Shading;
use std::f32::consts::FRAC_1_PI;

/// Fills `batch.surround`.
pub(super) fn look_up(light: &EnvironmentLight, shading: Shading, draw: &Draw<'_>, batch: &mut Batch) {
    let turn = light.turn();
    let gathered = |direction: Vec3, roughness: f32| {
        light.environment.specular(turn.to_environment(direction), roughness) * light.intensity
    };
    for i in batch.entries() {
        let (n, v) = (get3(&batch.n, i), get3(&batch.v, i));
        let irradiance = light.environment.irradiance(turn.to_environment(n));
        set3(&mut batch.surround.mean, i, irradiance * (light.intensity * FRAC_1_PI));
        let roughness = lobe_roughness(shading, draw.material, batch, i);
        let lobe_normal = stretched_normal(draw, batch, i);
        let mirrored = mirror(lobe_normal, v);
        let radiance = gathered(towards_normal(mirrored, n, roughness), roughness);
        set3(&mut batch.surround.specular, i, radiance);
        if draw.material.clearcoat.is_some() {
            let direction = mirror(get3(&batch.layers.coat_n, i), v);
            let radiance = gathered(direction, batch.layers.coat_roughness[i]);
            set3(&mut batch.surround.coat, i, radiance);
        }
    }
}

fn mirror(n: Vec3, v: Vec3) -> Vec3 {
    n * (2.0 * n.dot(v)) - v
}

/// The direction in which a rough highlight gathers its light: rough surfaces seen at a grazing angle mirror less
/// than their mirror direction says, since half of their lobe lies below the horizon. From the mirror direction of a
/// smooth surface it goes to the normal of the roughest with roughness⁴, which lowers the error of the split sum
/// threefold at roughness 1 and leaves it alone below 0.5 (docs/errors.md).
fn towards_normal(mirrored: Vec3, n: Vec3, roughness: f32) -> Vec3 {
    let share = roughness * roughness * roughness * roughness;
    (mirrored * (1.0 - share) + n * share).normalize_or(n)
}

/// The normal that a stretched highlight mirrors by: bent towards the viewer, across the stretch.
/// Source: McAuley 2015, "Rendering the World of Far Cry 4"; the blend of KHR_materials_anisotropy.
fn stretched_normal(draw: &Draw<'_>, batch: &Batch, i: usize) -> Vec3 {
    let n = get3(&batch.n, i);
    if draw.material.anisotropy.is_none() {
        return n;
    }
    let v = get3(&batch.v, i);
    let bitangent = n.cross(get3(&batch.layers.stretch_tangent, i));
    let bent = bitangent.cross(v).cross(bitangent).normalize_or(n);
    let round = 1.0 - batch.layers.stretch[i] * (1.0 - batch.roughness[i]);
    let share = round * round * round * round;
    (bent * (1.0 - share) + n * share).normalize_or(n)
}
