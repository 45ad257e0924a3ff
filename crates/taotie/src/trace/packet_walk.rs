//! Traces the rays of a packet by projecting triangles onto the rays.
//!
//! Neighbouring samples of a map look in the same direction, for triangles of about their own size. Finding the
//! triangles of each ray separately costs a traversal of the tree per ray. Here the tree is traversed once for all: a
//! triangle near the rays casts a shadow along their direction, and only the rays of the blocks that its shadow
//! touches are tested, eight at a time. The test is that of [`super::Ray::intersect`], in the coordinates of the
//! packet.

use super::bvh::{Bvh, Hit};
use super::ray_packet::RayPacket;
use super::shadows::Shadows;
use super::tree::{Boxes, WIDTH};
use crate::math::{Mask, Pack, dispatch_eight};

impl Bvh {
    /// Calls `meet` with each active ray of a packet, by its index, and each triangle that it hits at a distance of
    /// at least 0, in no particular order; the ray stays active if it returns true.
    pub fn meet_all(&self, packet: &mut RayPacket, meet: impl FnMut(usize, Hit) -> bool) {
        dispatch_eight!(self.level, P, token => walk_packet::<P>(token, self, packet, meet));
    }
}

#[inline(always)]
fn walk_packet<P: Pack>(
    token: P::Token,
    bvh: &Bvh,
    packet: &mut RayPacket,
    mut meet: impl FnMut(usize, Hit) -> bool,
) {
    /// The size of the stack, as for one ray: seven siblings wait on each level.
    const STACK: usize = 96;
    let mut waiting = [(0u32, 0u32); STACK];
    let mut count = usize::from(!bvh.tree.leaves.is_empty());
    waiting[0] = (bvh.tree.levels.len() as u32, 0);
    while count > 0 && packet.left > 0 {
        count -= 1;
        let (level, node) = waiting[count];
        if level == 0 {
            let shadows = Shadows::new::<P>(token, &bvh.tree, node as usize, packet);
            shadows.meet::<P>(token, packet, |ray, hit| meet(ray, bvh.hit(&hit)));
            continue;
        }
        let mut touched = touched::<P>(token, &bvh.tree.levels[level as usize - 1][node as usize], packet);
        touched &= (1 << bvh.tree.children(level as usize, node as usize)) - 1;
        while touched != 0 {
            waiting[count] = (level - 1, node * WIDTH as u32 + touched.trailing_zeros());
            touched &= touched - 1;
            count += 1;
        }
    }
}

/// Returns the boxes that the rays may cross, one bit each.
#[inline(always)]
fn touched<P: Pack>(token: P::Token, boxes: &Boxes, packet: &RayPacket) -> u64 {
    let mut touched = 0;
    for k in (0..WIDTH).step_by(P::LANES) {
        let zero = P::splat(token, 0.0);
        let (mut within, half) = (zero.le(zero), P::splat(token, 0.5));
        for axis in 0..3 {
            let direction = packet.view.axes[axis].to_array();
            let origin = packet.view.origin.to_array();
            let [low, high] = packet.limits[axis];
            let (mut middle, mut reach) = (zero, zero);
            for i in 0..3 {
                let (min, max) = (P::load(token, &boxes.min[i][k..]), P::load(token, &boxes.max[i][k..]));
                let along = P::splat(token, direction[i]);
                middle = middle + ((min + max) * half - P::splat(token, origin[i])) * along;
                reach = reach + (max - min) * half * along.abs();
            }
            // A generous bound of the rounding error of a box.
            let reach = reach + (reach + middle.abs()) * P::splat(token, 1e-5);
            within = within.and((middle - reach).le(P::splat(token, high)));
            within = within.and(P::splat(token, low).le(middle + reach));
        }
        touched |= P::bits(within) << k;
    }
    touched
}

#[cfg(test)]
mod tests {
    use super::super::numbers::numbers;
    use super::super::{PacketView, Ray};
    use super::*;
    use crate::math::Vec3;

    /// A ray, the triangle that it hits, distance and weights.
    type Met = (usize, u32, f32, [f32; 3]);

    /// The maximum difference of distances of about 2 that are computed in other coordinates; measured: 2.4e-6.
    const APART: f32 = 4e-6;

    #[test]
    fn a_packet_meets_what_its_rays_meet() {
        let mut next = numbers(7);
        let mut point = || Vec3::new(next(), next(), next());
        let triangles: Vec<[Vec3; 3]> = (0..3000)
            .map(|_| {
                let p = point() * 4.0;
                [p, p + point() * 0.2, p + point() * 0.2]
            })
            .collect();
        let bvh = Bvh::build(&triangles);
        let mut met = 0;
        for (spread, depths) in [(0.0, [0.0, 10.0]), (0.02, [0.0, 10.0]), (0.0, [0.0, 1.0])] {
            for _ in 0..10 {
                let corner = point() * 3.0;
                let direction = (point() + Vec3::new(0.2, 0.3, 2.0)).normalize();
                let x = direction.any_perpendicular();
                let y = direction.cross(x);
                let mut rays = Vec::new();
                let mut places = Vec::new();
                for _ in 0..200 {
                    let at = point();
                    let part = (point() - Vec3::splat(0.5)) * spread;
                    rays.push(Ray::new(corner + x * at.x + y * at.y, direction + part));
                    places.push([at.x, at.y]);
                }
                let slack = spread * depths[1] + 1e-4;
                let view = PacketView { origin: corner, axes: [x, y, direction], slack: [slack; 2], depths };
                let mut packet = RayPacket::new(&rays, &places, view).unwrap();
                let mut found = Vec::new();
                bvh.meet_all(&mut packet, |ray, hit| {
                    found.push((ray, hit.triangle, hit.distance, hit.weights));
                    true
                });
                let mut expected = Vec::new();
                for (i, ray) in rays.iter().enumerate() {
                    for (t, corners) in triangles.iter().enumerate() {
                        let Some((distance, weights)) = ray.intersect(*corners) else { continue };
                        expected.push((i, t as u32, distance, weights));
                    }
                }
                // Hits found by only one of them are at an edge, or outside the depths, where no hit is required.
                let lacks = |hits: &[Met], hit: &Met| {
                    let same = |other: &&Met| (other.0, other.1) == (hit.0, hit.1);
                    let inside = hit.3.iter().all(|weight| *weight > 1e-4) && hit.2 < depths[1] * 0.9;
                    hits.iter().find(same).map_or(inside, |other| (other.2 - hit.2).abs() > APART)
                };
                assert!(!expected.iter().any(|hit| lacks(&found, hit)));
                assert!(!found.iter().any(|hit| lacks(&expected, hit)));
                met += found.len();
            }
        }
        assert!(met > 500, "{met}");
    }
}
