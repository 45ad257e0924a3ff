//! Finds the surface hit by a ray.

use super::super::draw::{Draw, Draws};
use super::super::footprint::Footprint;
use super::super::tree::SceneTree;
use crate::math::sequence::{hash, unit};
use crate::scene::AlphaMode;
use crate::trace::{Hit, Ray};

/// The point where a ray hit a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Intersection {
    pub draw: u32,
    /// The triangle's index over all draws.
    pub triangle: u32,
    /// The weights of its corners.
    pub weights: [f32; 3],
    /// `true` if it was hit from its front.
    pub front: bool,
}

/// Rays through a scene. A mask exists if its alpha reaches the cutoff; a blended surface exists with the probability
/// alpha.
pub(super) struct Sight<'t> {
    pub draws: &'t Draws<'t>,
    pub tree: &'t SceneTree,
}

/// A blended surface hit by a ray, and a number in [0, 1) that decides whether it exists.
struct Blended {
    hit: Hit,
    chance: f32,
}

impl Sight<'_> {
    /// The nearest surface at a distance below `limit`. A `camera` sees single-sided surfaces only from their front.
    /// `chance` is a number in [0, 1), requested once, that decides which of the blended surfaces on the way exists.
    pub(super) fn nearest(
        &self,
        ray: &Ray,
        limit: f32,
        camera: bool,
        chance: impl FnOnce() -> f32,
    ) -> Option<Intersection> {
        let seen = |hit: &Hit| {
            let draw = self.draw(hit);
            let culled = camera && !draw.material.double_sided && !from_front(draw, hit, ray);
            !culled && self.is_masked_in(draw, hit)
        };
        let mut hit = self.tree.0.nearest_of(ray, limit, seen)?;
        if self.draw(&hit).material.alpha == AlphaMode::Blend {
            hit = self.nearest_by_chance(ray, limit, seen, Blended { hit, chance: chance() })?;
        }
        let draw = self.draws.number_of(hit.triangle);
        let front = from_front(&self.draws.all[draw], &hit, ray);
        Some(Intersection { draw: draw as u32, triangle: hit.triangle, weights: hit.weights, front })
    }

    /// Steps through surfaces, accepting each with probability α. The remainder of the chance is as evenly
    /// distributed as before.
    fn nearest_by_chance(
        &self,
        ray: &Ray,
        limit: f32,
        seen: impl Fn(&Hit) -> bool,
        Blended { mut hit, mut chance }: Blended,
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
                .tree
                .0
                .nearest_of(ray, limit, |hit| (hit.distance, hit.triangle) > passed && seen(hit))?;
        }
    }

    /// Returns true if nothing blocks the ray up to `limit` lengths. `chance` is the ray's number: with the
    /// triangle's, it decides whether a blended surface exists.
    pub(super) fn is_free(&self, ray: &Ray, limit: f32, chance: u32) -> bool {
        !self.tree.0.occluded(ray, limit, |hit| {
            let draw = self.draw(hit);
            match draw.material.alpha {
                AlphaMode::Blend => unit(hash(chance, hit.triangle)) < self.alpha(draw, hit),
                _ => self.is_masked_in(draw, hit),
            }
        })
    }

    fn draw(&self, hit: &Hit) -> &Draw<'_> {
        self.draws.of(hit.triangle)
    }

    /// Returns true if the surface is not cut out by a mask.
    fn is_masked_in(&self, draw: &Draw<'_>, hit: &Hit) -> bool {
        match draw.material.alpha {
            AlphaMode::Mask(cutoff) => self.alpha(draw, hit) >= cutoff,
            _ => true,
        }
    }

    fn alpha(&self, draw: &Draw<'_>, hit: &Hit) -> f32 {
        Footprint::of(draw, hit).alpha(self.draws.scene, draw)
    }
}

/// Returns true if the ray comes from the triangle's front.
fn from_front(draw: &Draw<'_>, hit: &Hit, ray: &Ray) -> bool {
    let [a, b, c] = draw.vertices(hit.triangle).map(|v| draw.positions[v as usize]);
    let along = (b - a).cross(c - a).dot(ray.direction());
    if draw.mirrored { along > 0.0 } else { along < 0.0 }
}
