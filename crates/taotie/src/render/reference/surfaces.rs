//! Which surface a ray meets.

use super::super::footprint::Footprint;
use super::super::prepare::{Draw, Prepared};
use crate::math::Vec3;
use crate::math::sequence::{hash, unit};
use crate::scene::AlphaMode;
use crate::trace::{Bvh, Hit, Ray};

/// All triangles of a scene, sorted for rays.
pub(in crate::render) struct Surfaces {
    bvh: Bvh,
}

impl Surfaces {
    pub(in crate::render) fn new(draws: &[Draw<'_>]) -> Self {
        let triangles = |draw: &Draw<'_>| -> Vec<[Vec3; 3]> {
            draw.mesh.triangles().iter().map(|t| t.map(|v| draw.positions[v as usize])).collect()
        };
        Self { bvh: Bvh::build(&draws.iter().flat_map(triangles).collect::<Vec<_>>()) }
    }
}

/// Where a ray met a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Meeting {
    pub draw: u32,
    /// The triangle's number over all draws.
    pub triangle: u32,
    /// Of its corners.
    pub weights: [f32; 3],
    /// Whether it was met from its front.
    pub front: bool,
}

/// Rays through a scene. A mask is there where its alpha reaches the cutoff; a blended surface is there as often as its
/// alpha says.
pub(super) struct Sight<'t, 'a> {
    prepared: &'t Prepared<'a>,
    surfaces: &'t Surfaces,
}

impl<'t, 'a> Sight<'t, 'a> {
    pub(super) fn new(prepared: &'t Prepared<'a>) -> Self {
        Self { prepared, surfaces: prepared.surfaces() }
    }

    /// The nearest surface at a distance below `limit`. A `camera` sees single-sided surfaces from their front alone.
    /// `chance` is a number in [0, 1), asked for once, that decides which of the blended surfaces on the way is there.
    pub(super) fn nearest(
        &self,
        ray: &Ray,
        limit: f32,
        camera: bool,
        chance: impl FnOnce() -> f32,
    ) -> Option<Meeting> {
        let seen = |hit: &Hit| {
            let draw = self.draw(hit);
            let culled = camera && !draw.material.double_sided && !from_front(draw, hit, ray);
            !culled && self.is_masked_in(draw, hit)
        };
        let mut hit = self.surfaces.bvh.nearest_of(ray, limit, seen)?;
        if self.draw(&hit).material.alpha == AlphaMode::Blend {
            hit = self.nearest_by_chance(ray, limit, seen, (hit, chance()))?;
        }
        let draw = self.prepared.draw_of(hit.triangle);
        let front = from_front(&self.prepared.draws[draw], &hit, ray);
        Some(Meeting { draw: draw as u32, triangle: hit.triangle, weights: hit.weights, front })
    }

    /// Goes from one surface to the next until one is there. What remains of the chance is as evenly distributed as it
    /// was.
    fn nearest_by_chance(
        &self,
        ray: &Ray,
        limit: f32,
        seen: impl Fn(&Hit) -> bool,
        (mut hit, mut chance): (Hit, f32),
    ) -> Option<Hit> {
        loop {
            let draw = self.draw(&hit);
            if draw.material.alpha != AlphaMode::Blend {
                return Some(hit);
            }
            let alpha = self.alpha(draw, &hit);
            if chance < alpha {
                return Some(hit);
            }
            chance = (chance - alpha.max(0.0)) / (1.0 - alpha.max(0.0));
            let passed = (hit.distance, hit.triangle);
            hit = self
                .surfaces
                .bvh
                .nearest_of(ray, limit, |hit| (hit.distance, hit.triangle) > passed && seen(hit))?;
        }
    }

    /// Whether nothing stands in the way up to `limit` lengths of the ray. `chance` is the ray's own number: with the
    /// triangle's, it decides whether a blended surface is there.
    pub(super) fn is_free(&self, ray: &Ray, limit: f32, chance: u32) -> bool {
        !self.surfaces.bvh.occluded(ray, limit, |hit| {
            let draw = self.draw(hit);
            match draw.material.alpha {
                AlphaMode::Blend => unit(hash(chance, hit.triangle)) < self.alpha(draw, hit),
                _ => self.is_masked_in(draw, hit),
            }
        })
    }

    fn draw(&self, hit: &Hit) -> &Draw<'a> {
        &self.prepared.draws[self.prepared.draw_of(hit.triangle)]
    }

    /// Whether no mask leaves the surface out.
    fn is_masked_in(&self, draw: &Draw<'_>, hit: &Hit) -> bool {
        match draw.material.alpha {
            AlphaMode::Mask(cutoff) => self.alpha(draw, hit) >= cutoff,
            _ => true,
        }
    }

    fn alpha(&self, draw: &Draw<'_>, hit: &Hit) -> f32 {
        let vertices = draw.mesh.triangles()[(hit.triangle - draw.first_triangle) as usize];
        Footprint { vertices, weights: hit.weights }.alpha(self.prepared.scene, draw)
    }
}

/// Whether the ray comes from the triangle's front.
fn from_front(draw: &Draw<'_>, hit: &Hit, ray: &Ray) -> bool {
    let vertices = draw.mesh.triangles()[(hit.triangle - draw.first_triangle) as usize];
    let [a, b, c] = vertices.map(|v| draw.positions[v as usize]);
    let along = (b - a).cross(c - a).dot(ray.direction());
    if draw.mirrored { along > 0.0 } else { along < 0.0 }
}
