//! Which lights a fragment sees.

use super::batch::{BATCH, Batch, get3};
use super::footprint::Footprint;
use super::lighting::Source;
use super::prepare::{Draw, Prepared};
use crate::math::Vec3;
use crate::scene::AlphaMode;
use crate::trace::{Bvh, Hit, Ray};

/// Triangles that cast shadows. Blended surfaces cast none.
pub(super) struct ShadowCasters {
    bvh: Bvh,
    /// Draw and local triangle of each of the BVH's.
    origins: Vec<(u32, u32)>,
}

impl ShadowCasters {
    pub(super) fn new(draws: &[Draw<'_>]) -> Self {
        let mut corners = Vec::new();
        let mut origins = Vec::new();
        for (d, draw) in draws.iter().enumerate() {
            if draw.material.alpha == AlphaMode::Blend {
                continue;
            }
            for (t, triangle) in draw.mesh.triangles().iter().enumerate() {
                corners.push(triangle.map(|v| draw.positions[v as usize]));
                origins.push((d as u32, t as u32));
            }
        }
        Self { bvh: Bvh::build(&corners), origins }
    }

    /// Whether nothing stands on the way from `origin` along `direction` up to `limit` of its lengths.
    pub(super) fn sees(&self, prepared: &Prepared<'_>, origin: Vec3, direction: Vec3, limit: f32) -> bool {
        !self.bvh.occluded(&Ray::new(origin, direction), limit, |hit| self.blocks(prepared, hit))
    }

    /// Whether the surface is there at the point hit.
    fn blocks(&self, prepared: &Prepared<'_>, hit: &Hit) -> bool {
        let (draw, triangle) = self.origins[hit.triangle as usize];
        let draw = &prepared.draws[draw as usize];
        let AlphaMode::Mask(cutoff) = draw.material.alpha else { return true };
        let footprint =
            Footprint { vertices: draw.mesh.triangles()[triangle as usize], weights: hit.weights };
        footprint.alpha(prepared.scene, draw) >= cutoff
    }
}

/// Fills `batch.visibility`. `origins` are the points that rays leave from.
pub(super) fn trace_shadows(
    prepared: &Prepared<'_>,
    sources: &[Source],
    origins: &[Vec3; BATCH],
    batch: &mut Batch,
) {
    let casters = prepared.casters();
    for (light, source) in sources.iter().enumerate() {
        for (i, origin) in origins.iter().enumerate().take(batch.len) {
            let to_light = source.ray_from(*origin);
            let faces = get3(&batch.n, i).dot(to_light) > 0.0;
            let seen = faces && casters.sees(prepared, *origin, to_light, source.ray_limit());
            batch.visibility[light][i] = f32::from(u8::from(seen));
        }
    }
}

/// Where shadow rays leave from: the point of the smooth surface that the flat triangle stands for, so that a low
/// mesh does not shade itself in facets (Hanika 2021, "Hacking the Shadow Terminator"), lifted by a little along
/// the geometric normal against rounding.
pub(super) fn shadow_origin(
    point: Vec3,
    corners: [Vec3; 3],
    normals: [Vec3; 3],
    weights: [f32; 3],
    lift: Vec3,
) -> Vec3 {
    let mut shift = Vec3::default();
    for i in 0..3 {
        let height = (point - corners[i]).dot(normals[i]).min(0.0);
        shift += normals[i] * (-height * weights[i]);
    }
    // A surface seen from behind bulges away from the viewer: no shift.
    let shift = if shift.dot(lift) > 0.0 { shift } else { Vec3::default() };
    point + shift + lift
}
