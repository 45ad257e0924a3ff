//! All triangles of a scene, sorted for rays.

use super::draw::{Draw, Draws};
use super::footprint::Footprint;
use crate::math::Vec3;
use crate::scene::AlphaMode;
use crate::trace::{Bvh, Hit, Ray};
use fearless_simd::Level;

/// All triangles of a scene, sorted for rays. Hits refer to them by their indices over all draws.
pub(super) struct SceneTree(pub Bvh);

impl SceneTree {
    /// Sorts all triangles for at least `rays` rays, which are traced at a SIMD level.
    pub(super) fn new(draws: &Draws<'_>, rays: u64, level: Level) -> Self {
        /// The number of rays per triangle from which sorting for many rays pays off.
        const MANY: u64 = 4;
        let triangles = |draw: &Draw<'_>| -> Vec<[Vec3; 3]> {
            draw.mesh.triangles().iter().map(|t| t.map(|v| draw.positions[v as usize])).collect()
        };
        let corners: Vec<_> = draws.all.iter().flat_map(triangles).collect();
        let many = rays / MANY > corners.len() as u64;
        let bvh = if many { Bvh::for_many_rays(&corners) } else { Bvh::build(&corners) };
        Self(bvh.at(level))
    }
}

/// The surfaces that cast shadows. Blended ones cast none.
#[derive(Clone, Copy)]
pub(super) struct Casters<'t> {
    pub tree: &'t SceneTree,
    pub draws: &'t Draws<'t>,
}

impl Casters<'_> {
    /// Returns true if nothing blocks the ray from `origin` along `direction` up to `limit` of its lengths.
    pub(super) fn sees(&self, origin: Vec3, direction: Vec3, limit: f32) -> bool {
        !self.tree.0.occluded(&Ray::new(origin, direction), limit, |hit| self.blocks(hit))
    }

    /// Returns true if the surface exists at the point hit.
    fn blocks(&self, hit: &Hit) -> bool {
        let draw = self.draws.of(hit.triangle);
        match draw.material.alpha {
            AlphaMode::Opaque => true,
            AlphaMode::Mask(cutoff) => Footprint::of(draw, hit).alpha(self.draws.scene, draw) >= cutoff,
            AlphaMode::Blend => false,
        }
    }
}
