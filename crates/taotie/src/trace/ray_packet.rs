//! Rays that run side by side, met by triangles instead of meeting them.
//!
//! Neighbouring samples of a map look the same way, for triangles of about their own size. To ask for each ray which
//! triangles it meets costs a walk through the tree a ray. Here the tree is walked once for all: a triangle near the
//! rays casts a shadow along their direction, and only the rays in its shadow are tested.

use super::bvh::{Bvh, Hit};
use super::tree::{Boxes, Leaf, WIDTH};
use super::{Ray, triangle::RayColumns};
use crate::groups::Groups;
use crate::math::{Mask, Pack, Vec3, dispatch_eight};

/// The coordinates in which a ray packet is seen: a place V has column · (V − origin), row · (V − origin) and
/// depth · (V − origin). Along the rays' mean direction column and row do not change.
#[derive(Debug, Clone, Copy)]
pub struct PacketView {
    /// The place where coordinates are zero.
    pub origin: Vec3,
    /// Column, row and depth.
    pub axes: [Vec3; 3],
    /// The distance beside its column and row at which a ray may meet something, as it parts from the mean direction.
    pub slack: [f32; 2],
    /// The range of depths in which the rays look.
    pub depths: [f32; 2],
}

/// Rays that run side by side.
pub struct RayPacket<'a> {
    rays: &'a [Ray],
    view: PacketView,
    /// The least column and row, and cells per unit of each.
    corner: [f32; 2],
    scale: [f32; 2],
    cells: [usize; 2],
    /// The rays of each cell, row by row.
    order: Groups<u32>,
    columns: RayColumns,
}

impl<'a> RayPacket<'a> {
    /// Makes a packet of rays that lie at these columns and rows; `None` where there is no ray, where they run along
    /// different axes, or where the slack spreads each over many others, so that one ray at a time is faster.
    pub fn new(rays: &'a [Ray], places: &[[f32; 2]], view: PacketView) -> Option<Self> {
        /// Cells that a ray may be spread over by the slack, along each side.
        const WIDEST: f32 = 16.0;
        if rays.is_empty() {
            return None;
        }
        let side = (rays.len() as f32).sqrt().ceil();
        let mut corner = [f32::INFINITY; 2];
        let mut end = [f32::NEG_INFINITY; 2];
        for place in places {
            for k in 0..2 {
                corner[k] = corner[k].min(place[k]);
                end[k] = end[k].max(place[k]);
            }
        }
        let scale = [0, 1].map(|k| side / (end[k] - corner[k]).max(1e-30));
        if !(0..2).all(|k| scale[k].is_finite() && view.slack[k] * scale[k] < WIDEST) {
            return None;
        }
        let cells = [side as usize + 1; 2];
        let cell = |place: &[f32; 2]| {
            let [x, y] = [0, 1].map(|k| (((place[k] - corner[k]) * scale[k]) as usize).min(cells[k] - 1));
            y * cells[0] + x
        };
        let cell_of: Vec<usize> = places.iter().map(cell).collect();
        let order = Groups::new(cells[0] * cells[1], || cell_of.iter().copied().zip(0u32..));
        let columns = RayColumns::new(rays, order.values())?;
        Some(Self { rays, view, corner, scale, cells, order, columns })
    }

    /// Returns the columns (0) or rows (1) of cells in which places up to these coordinates lie, not yet rounded down.
    #[inline(always)]
    fn in_cells<P: Pack>(&self, token: P::Token, axis: usize, places: P) -> P {
        let [corner, scale] = [self.corner, self.scale].map(|v| P::splat(token, v[axis]));
        let last = P::splat(token, (self.cells[axis] - 1) as f32);
        ((places - corner) * scale).max(P::splat(token, 0.0)).min(last)
    }

    /// The least and the largest coordinate that matter.
    fn limits(&self, axis: usize) -> [f32; 2] {
        match axis {
            2 => self.view.depths,
            _ => {
                let end = self.corner[axis] + self.cells[axis] as f32 / self.scale[axis];
                [self.corner[axis] - self.view.slack[axis], end + self.view.slack[axis]]
            }
        }
    }
}

impl Bvh {
    /// Calls `meet` with each ray of a packet, by its number, and each triangle that it meets at any distance from 0
    /// on, in no particular order, until it says that nothing more is wanted.
    pub fn meet_all(&self, packet: &RayPacket<'_>, meet: impl FnMut(usize, Hit) -> bool) {
        dispatch_eight!(self.level, P, token => walk_packet::<P>(token, self, packet, meet));
    }
}

#[inline(always)]
fn walk_packet<P: Pack>(
    token: P::Token,
    bvh: &Bvh,
    packet: &RayPacket<'_>,
    mut meet: impl FnMut(usize, Hit) -> bool,
) {
    /// The size of the stack, as for one ray: seven siblings wait on each level.
    const STACK: usize = 96;
    let mut waiting = [(0u32, 0u32); STACK];
    let mut count = usize::from(!bvh.tree.leaves.is_empty());
    waiting[0] = (bvh.tree.levels.len() as u32, 0);
    while count > 0 {
        count -= 1;
        let (level, node) = waiting[count];
        if level == 0 {
            let mut shadows = Shadows::default();
            let leaf = &bvh.tree.leaves[node as usize];
            let mut cast = shadows.cast::<P>(token, leaf, packet);
            while cast != 0 {
                let i = cast.trailing_zeros() as usize;
                cast &= cast - 1;
                let slot = node as usize * WIDTH + i;
                let Some(triangle) = bvh.tree.order.get(slot) else { continue };
                let caster = Caster { packet, shadows: &shadows, leaf, i };
                let going = in_shadow::<P>(token, &caster, |ray, distance, weights| {
                    meet(ray, Hit { triangle: *triangle, weights, distance })
                });
                if !going {
                    return;
                }
            }
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

/// Returns the boxes that the rays may run through, a bit each.
#[inline(always)]
fn touched<P: Pack>(token: P::Token, boxes: &Boxes, packet: &RayPacket<'_>) -> u64 {
    let mut touched = 0;
    for k in (0..WIDTH).step_by(P::LANES) {
        let zero = P::splat(token, 0.0);
        let (mut within, half) = (zero.le(zero), P::splat(token, 0.5));
        for axis in 0..3 {
            let direction = packet.view.axes[axis].to_array();
            let origin = packet.view.origin.to_array();
            let [low, high] = packet.limits(axis);
            let (mut middle, mut reach) = (zero, zero);
            for i in 0..3 {
                let (min, max) = (P::load(token, &boxes.min[i][k..]), P::load(token, &boxes.max[i][k..]));
                let along = P::splat(token, direction[i]);
                middle = middle + ((min + max) * half - P::splat(token, origin[i])) * along;
                reach = reach + (max - min) * half * along.abs();
            }
            // What rounding takes from a box, generously.
            let reach = reach + (reach + middle.abs()) * P::splat(token, 1e-5);
            within = within.and((middle - reach).le(P::splat(token, high)));
            within = within.and(P::splat(token, low).le(middle + reach));
        }
        touched |= P::bits(within) << k;
    }
    touched
}

/// The first and last column and row of cells that the shadow of each of a leaf's triangles touches, not yet rounded
/// down.
#[derive(Default)]
struct Shadows {
    low: [[f32; WIDTH]; 2],
    high: [[f32; WIDTH]; 2],
}

impl Shadows {
    /// Returns the first and last column (0) or row (1) of cells of a triangle.
    #[inline(always)]
    fn cells(&self, axis: usize, triangle: usize) -> [usize; 2] {
        [self.low[axis][triangle] as u32 as usize, self.high[axis][triangle] as u32 as usize]
    }

    /// Returns the triangles that may be met, a bit each.
    #[inline(always)]
    fn cast<P: Pack>(&mut self, token: P::Token, leaf: &Leaf, packet: &RayPacket<'_>) -> u64 {
        let mut cast = 0;
        let origin = packet.view.origin.to_array();
        for k in (0..WIDTH).step_by(P::LANES) {
            let zero = P::splat(token, 0.0);
            let mut within = zero.le(zero);
            for axis in 0..3 {
                let direction = packet.view.axes[axis].to_array();
                let mut at = [zero; 3];
                for (at, corner) in at.iter_mut().zip(&leaf.corners) {
                    for i in 0..3 {
                        let local = P::load(token, &corner[i][k..]) - P::splat(token, origin[i]);
                        *at = *at + local * P::splat(token, direction[i]);
                    }
                }
                let (least, most) = (at[0].min(at[1]).min(at[2]), at[0].max(at[1]).max(at[2]));
                let [low, high] = packet.limits(axis);
                within = within.and(least.le(P::splat(token, high)));
                within = within.and(P::splat(token, low).le(most));
                if axis < 2 {
                    let slack = P::splat(token, packet.view.slack[axis]);
                    packet.in_cells(token, axis, least - slack).store(&mut self.low[axis][k..]);
                    packet.in_cells(token, axis, most + slack).store(&mut self.high[axis][k..]);
                }
            }
            cast |= P::bits(within) << k;
        }
        cast
    }
}

/// The triangle `i` of a leaf, and the rays that may lie in its shadow.
struct Caster<'a> {
    packet: &'a RayPacket<'a>,
    shadows: &'a Shadows,
    leaf: &'a Leaf,
    i: usize,
}

/// Tests the rays in the shadow of a triangle.
#[inline(always)]
fn in_shadow<P: Pack>(
    token: P::Token,
    caster: &Caster<'_>,
    mut meet: impl FnMut(usize, f32, [f32; 3]) -> bool,
) -> bool {
    let Caster { packet, shadows, leaf, i } = *caster;
    let [left, right] = shadows.cells(0, i);
    let [top, bottom] = shadows.cells(1, i);
    for row in top..=bottom {
        let first_of_row = row * packet.cells[0];
        let places = packet.order.places(first_of_row + left, first_of_row + right);
        let end = places.end;
        for from in places.step_by(P::LANES) {
            let Some(edges) = packet.columns.edges::<P>(token, from, &leaf.corners, i) else { continue };
            let met = edges.meet();
            let unsure = P::bits(edges.unsure);
            let lanes = (end - from).min(P::LANES);
            let mut any = (P::bits(met.hit) | unsure) & ((1 << lanes) - 1);
            if any == 0 {
                continue;
            }
            let (mut distances, mut weights) = ([0.0; WIDTH], [[0.0; WIDTH]; 3]);
            met.distance.store(&mut distances);
            for (weight, to) in met.weights.into_iter().zip(&mut weights) {
                weight.store(to);
            }
            while any != 0 {
                let lane = any.trailing_zeros() as usize;
                any &= any - 1;
                let ray = packet.order.values()[from + lane] as usize;
                let met = match unsure & 1 << lane {
                    0 => Some((distances[lane], [weights[0][lane], weights[1][lane], weights[2][lane]])),
                    _ => packet.rays[ray].intersect(leaf.triangle(i)),
                };
                if let Some((distance, weights)) = met
                    && !meet(ray, distance, weights)
                {
                    return false;
                }
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in [0, 1) from a linear congruence.
    fn numbers() -> impl FnMut() -> f32 {
        let mut state = 7u32;
        move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        }
    }

    #[test]
    fn a_sheaf_meets_what_its_rays_meet() {
        let mut next = numbers();
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
                let packet = RayPacket::new(&rays, &places, view).unwrap();
                let mut found = Vec::new();
                bvh.meet_all(&packet, |ray, hit| {
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
                let key = |hit: &(usize, u32, f32, [f32; 3])| (hit.0, hit.1);
                found.sort_by_key(key);
                expected.sort_by_key(key);
                // Beyond the depths nothing need be met, but may.
                let needed = |hit: &&(usize, u32, f32, [f32; 3])| hit.2 < depths[1] * 0.9;
                assert!(expected.iter().filter(needed).all(|hit| found.contains(hit)));
                assert!(found.iter().all(|hit| expected.contains(hit)));
                met += found.len();
            }
        }
        assert!(met > 500, "{met}");
    }
}
