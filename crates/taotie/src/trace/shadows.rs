//! The triangles of a leaf against the rays of a packet.

use super::bounds::Bounds;
use super::ray_packet::{Places, RayPacket};
use super::tree::{Tree, WIDTH};
use super::triangle::{Edges, pierced};
use super::walk::Met;
use crate::math::{Lane, Mask, Pack};

/// The projections of the triangles of a leaf along the rays' depth.
pub(super) struct Shadows {
    /// The corners in the packet's coordinates, `corners[corner][axis][triangle]`.
    corners: [Places; 3],
    /// The columns and rows of rays that may hit the triangle.
    bounds: Bounds,
    /// The leaf, and its triangles, one bit each.
    leaf: usize,
    present: u64,
}

impl Shadows {
    /// Returns the shadows of a leaf's triangles; those that no ray can hit have empty bounds.
    #[inline(always)]
    pub fn new<P: Pack>(token: P::Token, tree: &Tree, leaf: usize, packet: &RayPacket) -> Self {
        let present = (1 << tree.triangles(leaf)) - 1;
        let mut shadows = Self { corners: Default::default(), bounds: Bounds::EMPTY, leaf, present };
        let origin = packet.view.origin.to_array();
        for k in (0..WIDTH).step_by(P::LANES) {
            let zero = P::splat(token, 0.0);
            let mut within = zero.le(zero);
            let mut extents = [[zero; 2]; 3];
            for (axis, extent) in extents.iter_mut().enumerate() {
                let direction = packet.view.axes[axis].to_array();
                let mut at = [zero; 3];
                for (n, corner) in tree.leaves[leaf].corners.iter().enumerate() {
                    for i in 0..3 {
                        let local = P::load(token, &corner[i][k..]) - P::splat(token, origin[i]);
                        at[n] = at[n] + local * P::splat(token, direction[i]);
                    }
                    at[n].store(&mut shadows.corners[n][axis][k..]);
                }
                let (least, most) = (at[0].min(at[1]).min(at[2]), at[0].max(at[1]).max(at[2]));
                let [low, high] = packet.limits[axis];
                within = within.and(least.le(P::splat(token, high)));
                within = within.and(P::splat(token, low).le(most));
                *extent = [least, most];
            }
            let (no_low, no_high) = (P::splat(token, f32::INFINITY), P::splat(token, f32::NEG_INFINITY));
            for (axis, [least, most]) in extents.into_iter().take(2).enumerate() {
                let slack = P::splat(token, packet.view.slack[axis]);
                Lane::select(within, least - slack, no_low).store(&mut shadows.bounds.low[axis][k..]);
                Lane::select(within, most + slack, no_high).store(&mut shadows.bounds.high[axis][k..]);
            }
        }
        shadows
    }

    /// Calls `meet` with each ray of a packet that hits a triangle, and with the triangle.
    #[inline(always)]
    pub fn meet<P: Pack>(
        &self,
        token: P::Token,
        packet: &mut RayPacket,
        mut meet: impl FnMut(usize, Met) -> bool,
    ) {
        let all = self.bounds.all();
        for eight in 0..packet.bounds.len() {
            let mut near = packet.bounds[eight].touched::<P>(token, all);
            // A byte per block, a bit per triangle.
            let mut pairs = 0u64;
            while near != 0 {
                let block = near.trailing_zeros() as usize;
                near &= near - 1;
                let bounds = packet.bounds[eight].of(block);
                pairs |= (self.bounds.touched::<P>(token, bounds) & self.present) << (8 * block);
            }
            while pairs != 0 {
                let (block, triangle) =
                    (pairs.trailing_zeros() as usize / 8, pairs.trailing_zeros() as usize % 8);
                pairs &= pairs - 1;
                meet_block::<P>(
                    token,
                    packet,
                    &Pair { block: eight * WIDTH + block, shadows: self, triangle },
                    &mut meet,
                );
            }
        }
    }
}

/// Tests the rays of a block against a triangle.
#[inline(always)]
fn meet_block<P: Pack>(
    token: P::Token,
    packet: &mut RayPacket,
    pair: &Pair<'_>,
    meet: &mut impl FnMut(usize, Met) -> bool,
) {
    let slot = pair.shadows.leaf * WIDTH + pair.triangle;
    for k in (0..WIDTH).step_by(P::LANES) {
        let Some(edges) = pair.edges::<P>(token, packet, k) else { continue };
        let mut any = P::bits(edges.ahead()) & u64::from(packet.going[pair.block] >> k);
        if any == 0 {
            continue;
        }
        let met = edges.meet();
        let (hit, unsure) = (P::bits(met.hit), P::bits(edges.unsure));
        let (mut distances, mut weights) = ([0.0; WIDTH], [[0.0; WIDTH]; 3]);
        met.distance.store(&mut distances);
        for (weight, to) in met.weights.into_iter().zip(&mut weights) {
            weight.store(to);
        }
        while any != 0 {
            let lane = any.trailing_zeros() as usize;
            any &= any - 1;
            let met = match (unsure >> lane & 1, hit >> lane & 1) {
                (1, _) => pair.intersect(packet, k + lane),
                (_, 1) => Some((distances[lane], [weights[0][lane], weights[1][lane], weights[2][lane]])),
                _ => None,
            };
            if let Some((distance, weights)) = met
                && !meet(pair.block * WIDTH + k + lane, Met { slot, distance, weights })
            {
                packet.end(pair.block, k + lane);
            }
        }
    }
}

/// A block of rays, and a triangle whose shadow touches it.
struct Pair<'a> {
    block: usize,
    shadows: &'a Shadows,
    triangle: usize,
}

impl Pair<'_> {
    /// Returns a coordinate of a corner of the triangle.
    #[inline(always)]
    fn corner(&self, corner: usize, axis: usize) -> f32 {
        self.shadows.corners[corner][axis][self.triangle]
    }

    /// Returns the edges of the triangle along the block's rays, for a pack starting at lane `k`.
    #[inline(always)]
    fn edges<P: Pack>(&self, token: P::Token, packet: &RayPacket, k: usize) -> Option<Edges<P>> {
        let origins = &packet.origins[self.block];
        let (column, row) = (P::load(token, &origins[0][k..]), P::load(token, &origins[1][k..]));
        let depth = P::load(token, &origins[2][k..]);
        let (mut along, mut seen) = ([depth; 3], [[column, row]; 3]);
        for n in 0..3 {
            along[n] = P::splat(token, self.corner(n, 2)) - depth;
            seen[n] = [P::splat(token, self.corner(n, 0)) - column, P::splat(token, self.corner(n, 1)) - row];
        }
        let Some(slopes) = packet.slopes.get(self.block) else {
            return Edges::new(seen, along, P::splat(token, 1.0));
        };
        let (columns, rows) = (P::load(token, &slopes[0][k..]), P::load(token, &slopes[1][k..]));
        for n in 0..3 {
            seen[n] = [seen[n][0] - columns * along[n], seen[n][1] - rows * along[n]];
        }
        Edges::new(seen, along, P::load(token, &slopes[2][k..]))
    }

    /// Returns the distance and the weights at which a ray of the block hits the triangle.
    fn intersect(&self, packet: &RayPacket, lane: usize) -> Option<(f32, [f32; 3])> {
        let origin = packet.origins[self.block].map(|axis| axis[lane]);
        let slope =
            packet.slopes.get(self.block).map_or([0.0, 0.0, 1.0], |slopes| slopes.map(|axis| axis[lane]));
        let along = [0, 1, 2].map(|n| self.corner(n, 2) - origin[2]);
        let seen = [0, 1, 2]
            .map(|n| [0, 1].map(|axis| self.corner(n, axis) - origin[axis] - slope[axis] * along[n]));
        let (along, weights) = pierced(seen, along)?;
        let distance = slope[2] * along;
        (distance >= 0.0).then_some((distance, weights))
    }
}
