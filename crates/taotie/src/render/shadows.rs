//! Finds the lights visible from a fragment.

use super::batch::{BATCH, Batch};
use super::columns::get3;
use super::tree::Casters;
use crate::math::Vec3;
use crate::pixel::LightSource;

/// Fills `batch.lit.visibility`. `origins` are the origins of the rays.
pub(super) fn trace_shadows(
    casters: Casters<'_>,
    sources: &[LightSource<f32>],
    origins: &[Vec3; BATCH],
    batch: &mut Batch,
) {
    for (light, source) in sources.iter().enumerate() {
        for (i, origin) in origins.iter().enumerate().take(batch.len) {
            let to_light = source.ray_from(*origin);
            let faces = get3(&batch.frame.n, i).dot(to_light) > 0.0;
            let seen = faces && casters.sees(*origin, to_light, source.ray_limit());
            batch.lit.visibility[light][i] = f32::from(u8::from(seen));
        }
    }
}

/// A flat triangle of a smooth surface.
pub(super) struct SmoothTriangle {
    pub corners: [Vec3; 3],
    /// The normals at the corners: unit, on the visible side.
    pub normals: [Vec3; 3],
}

impl SmoothTriangle {
    /// The origin of shadow rays: the point of the smooth surface above the triangle's `point`, so that a low-poly
    /// mesh does not shade itself in facets (Hanika 2021, "Hacking the Shadow Terminator"), moved by `offset`, a
    /// small distance along the geometric normal, against rounding errors.
    pub(super) fn shadow_origin(&self, point: Vec3, weights: [f32; 3], offset: Vec3) -> Vec3 {
        let mut shift = Vec3::default();
        for ((corner, normal), weight) in self.corners.into_iter().zip(self.normals).zip(weights) {
            let height = (point - corner).dot(normal).min(0.0);
            shift += normal * (-height * weight);
        }
        // A surface seen from behind bulges away from the viewer: no shift.
        let shift = if shift.dot(offset) > 0.0 { shift } else { Vec3::default() };
        point + shift + offset
    }
}
