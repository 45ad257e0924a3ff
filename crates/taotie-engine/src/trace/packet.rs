//! Nearly parallel rays, in blocks of eight neighbours, traced by projecting triangles onto them.
//!
//! Neighbouring samples of a map look in the same direction, for triangles of about their own size. Finding the
//! triangles of each ray separately costs a traversal of the tree per ray. Here the tree is traversed once for all: a
//! triangle near the rays casts a shadow along their direction, and only the rays of the blocks that its shadow
//! touches are tested, eight at a time. The test is that of [`super::Ray::intersect`], in the coordinates of the
//! packet.

use super::Ray;
use super::bvh::{Bvh, Hit};
use super::by_area::WIDTH;
use super::ray::{Edges, Met, pierced};
use super::tree::{Boxes, Child, STACK, Tree};
use crate::math::{Lane, Mask, Pack, Vec3, dispatch_eight};
use arrayvec::ArrayVec;

/// The coordinates of a ray packet: a position V has column · (V − origin), row · (V − origin) and depth · (V −
/// origin). Along the rays' mean direction, column and row are constant.
#[derive(Debug, Clone, Copy)]
pub struct PacketView {
    /// The origin of the coordinates.
    pub origin: Vec3,
    /// Column, row and depth.
    pub axes: [Vec3; 3],
    /// The distance from its column and row at which a ray may hit something, as it diverges from the mean direction.
    pub slack: [f32; 2],
    /// The range of depths that the rays search.
    pub depths: [f32; 2],
}

/// Three coordinates of eight positions.
type Places = [[f32; WIDTH]; 3];

/// Nearly parallel rays; every eight consecutive ones are a block. Blocks should be narrow, so consecutive rays
/// should be neighbours.
pub struct RayPacket {
    view: PacketView,
    /// Column, row and depth of the origins of each block's rays.
    origins: Vec<Places>,
    /// The change of the rays of each block per step in depth: columns, rows, lengths of their directions. Empty if
    /// all are parallel to the depth: 0, 0 and 1.
    slopes: Vec<Places>,
    /// The bounds of the active rays of eight blocks each.
    bounds: Vec<Bounds>,
    /// The active rays of each block, one bit each.
    going: Vec<u8>,
    /// The number of active rays.
    left: usize,
    /// The minimum and maximum column, row and depth that matter.
    limits: [[f32; 2]; 3],
}

impl RayPacket {
    /// Creates a packet of rays at these columns and rows; `None` if there are no rays or the numbers of rays and
    /// positions differ, if a ray does not run in the direction of depth, or if the slack spreads each over many
    /// others, so that tracing one ray at a time is faster.
    pub fn new(rays: &[Ray], places: &[[f32; 2]], view: PacketView) -> Option<Self> {
        if rays.len() != places.len() {
            return None;
        }
        let blocks = rays.len().div_ceil(WIDTH);
        let (mut origins, mut slopes) = (vec![Places::default(); blocks], vec![Places::default(); blocks]);
        let mut going = vec![0u8; blocks];
        for (i, ray) in rays.iter().enumerate() {
            let (block, lane) = (i / WIDTH, i % WIDTH);
            let [column, row, depth] = view.axes.map(|axis| axis.dot(ray.direction()));
            if depth <= 0.0 {
                return None;
            }
            let slope = [column / depth, row / depth, 1.0 / depth];
            for axis in 0..3 {
                origins[block][axis][lane] = view.axes[axis].dot(ray.origin() - view.origin);
                slopes[block][axis][lane] = slope[axis];
            }
            going[block] |= 1 << lane;
        }
        let bounds = bounds(&going, |ray| places[ray]);
        Some(Self { origins, slopes, ..Self::within(view, bounds, going)? })
    }

    /// Creates a packet of the rays parallel to the depth, one length per step, whose bits are set in `going`.
    /// Origins and depths of the view are in its coordinates.
    fn parallel(view: PacketView, origins: Vec<Places>, going: Vec<u8>) -> Option<Self> {
        let bounds = bounds(&going, |ray| [0, 1].map(|axis| origins[ray / WIDTH][axis][ray % WIDTH]));
        Some(Self { origins, ..Self::within(view, bounds, going)? })
    }

    /// Creates a packet of rays within these bounds, whose origins and slopes the caller adds.
    fn within(view: PacketView, bounds: Vec<Bounds>, going: Vec<u8>) -> Option<Self> {
        /// The maximum number of rays over which the slack may spread one, along each side.
        const WIDEST: f32 = 16.0;
        let left: usize = going.iter().map(|going| going.count_ones() as usize).sum();
        let [least, most] = bounds.iter().fold(Bounds::EMPTY.of(0), |all, bounds| joined(all, bounds.all()));
        let narrow = |axis: usize| {
            let spacing = (most[axis] - least[axis]).max(1e-30) / (left as f32).sqrt();
            spacing.is_finite() && view.slack[axis] < WIDEST * spacing
        };
        let limit = |axis: usize| [least[axis] - view.slack[axis], most[axis] + view.slack[axis]];
        let limits = [limit(0), limit(1), view.depths];
        let (origins, slopes) = (Vec::new(), Vec::new());
        (narrow(0) && narrow(1)).then_some(Self { view, origins, slopes, bounds, going, left, limits })
    }

    /// Returns the active rays, one bit each, eight in a byte.
    pub fn into_going(self) -> Vec<u8> {
        self.going
    }

    /// Deactivates a ray.
    fn end(&mut self, block: usize, lane: usize) {
        self.left -= 1;
        self.going[block] &= !(1 << lane);
        if self.going[block] == 0 {
            self.bounds[block / WIDTH].set(block % WIDTH, Bounds::EMPTY.of(0));
        }
    }
}

/// Returns the bounds of the active rays of each block; their columns and rows are returned by `place`.
fn bounds(going: &[u8], place: impl Fn(usize) -> [f32; 2]) -> Vec<Bounds> {
    let mut bounds = vec![Bounds::EMPTY; going.len().div_ceil(WIDTH)];
    for (block, going) in going.iter().enumerate() {
        let rays = (0..WIDTH).filter(|lane| going & 1 << lane != 0).map(|lane| place(block * WIDTH + lane));
        bounds[block / WIDTH]
            .set(block % WIDTH, rays.fold(Bounds::EMPTY.of(0), |all, place| joined(all, [place, place])));
    }
    bounds
}

/// The origins of parallel rays, in the order of the packet's rays: neighbours one after the other.
pub struct PacketOrigins {
    blocks: Vec<Places>,
}

/// The direction and reach of the rays of a packet.
#[derive(Debug, Clone, Copy)]
pub struct ParallelRays {
    /// Unit.
    pub direction: Vec3,
    /// The distance within which they search.
    pub reach: f32,
    /// The distance to its side at which a ray may hit something, apart from rounding.
    pub margin: f32,
}

impl PacketOrigins {
    /// Stores origins.
    pub fn new(origins: impl ExactSizeIterator<Item = Vec3>) -> Self {
        let mut blocks = vec![Places::default(); origins.len().div_ceil(WIDTH)];
        for (ray, origin) in origins.enumerate() {
            let block = &mut blocks[ray / WIDTH];
            block.iter_mut().zip(origin.to_array()).for_each(|(axis, v)| axis[ray % WIDTH] = v);
        }
        Self { blocks }
    }

    /// Returns an origin.
    pub fn at(&self, ray: usize) -> Vec3 {
        let [x, y, z] = &self.blocks[ray / WIDTH];
        Vec3::new(x[ray % WIDTH], y[ray % WIDTH], z[ray % WIDTH])
    }

    /// Creates a packet of rays from these origins. `going` has one bit per ray, eight in a byte: those whose bit is
    /// 0 are excluded. Returns `None` if tracing one ray at a time is faster, like [`RayPacket::new`].
    pub fn packet(&self, mut going: Vec<u8>, rays: ParallelRays) -> Option<RayPacket> {
        let ParallelRays { direction, reach, margin } = rays;
        going.resize(self.blocks.len(), 0);
        let first = going.iter().position(|going| *going != 0)?;
        let origin = self.at(first * WIDTH);
        let x = direction.any_perpendicular();
        let axes = [x, direction.cross(x), direction];
        let along = |axis: Vec3, [x, y, z]: &Places| -> [f32; WIDTH] {
            std::array::from_fn(|lane| axis.dot(Vec3::new(x[lane], y[lane], z[lane]) - origin))
        };
        let places: Vec<Places> =
            self.blocks.iter().map(|block| axes.map(|axis| along(axis, block))).collect();
        let (mut nearest, mut farthest) = (f32::INFINITY, f32::NEG_INFINITY);
        for (places, going) in places.iter().zip(&going) {
            for depth in (0..WIDTH).filter(|lane| going & 1 << lane != 0).map(|lane| places[2][lane]) {
                (nearest, farthest) = (nearest.min(depth), farthest.max(depth));
            }
        }
        // Rounding of coordinates and of their shadows, which grows with their distance from zero.
        let slack = (origin.length() + farthest - nearest) * 2e-6 + margin;
        let depths = [nearest - slack, farthest + reach];
        RayPacket::parallel(PacketView { origin, axes, slack: [slack; 2], depths }, places, going)
    }
}

/// The columns and rows of eight items: minimum and maximum, `low[axis][i]`; ∞ and −∞ for none.
#[derive(Clone, Copy)]
struct Bounds {
    low: [[f32; WIDTH]; 2],
    high: [[f32; WIDTH]; 2],
}

impl Bounds {
    const EMPTY: Self = Self { low: [[f32::INFINITY; WIDTH]; 2], high: [[f32::NEG_INFINITY; WIDTH]; 2] };

    /// Returns the items that overlap these columns and rows, one bit each.
    #[inline(always)]
    fn touched<P: Pack>(&self, token: P::Token, [low, high]: [[f32; 2]; 2]) -> u64 {
        let mut touched = 0;
        for k in (0..WIDTH).step_by(P::LANES) {
            let zero = P::splat(token, 0.0);
            let mut within = zero.le(zero);
            for axis in 0..2 {
                within = within.and(P::load(token, &self.low[axis][k..]).le(P::splat(token, high[axis])));
                within = within.and(P::splat(token, low[axis]).le(P::load(token, &self.high[axis][k..])));
            }
            touched |= P::bits(within) << k;
        }
        touched
    }

    /// Returns the bounds of one.
    #[inline(always)]
    fn of(&self, i: usize) -> [[f32; 2]; 2] {
        [[self.low[0][i], self.low[1][i]], [self.high[0][i], self.high[1][i]]]
    }

    fn set(&mut self, i: usize, [low, high]: [[f32; 2]; 2]) {
        for axis in 0..2 {
            self.low[axis][i] = low[axis];
            self.high[axis][i] = high[axis];
        }
    }

    /// Returns the bounds of all.
    #[inline(always)]
    fn all(&self) -> [[f32; 2]; 2] {
        let mut all = Self::EMPTY.of(0);
        for i in 0..WIDTH {
            all = joined(all, self.of(i));
        }
        all
    }
}

/// Returns the bounds of both, ignoring NaN.
#[inline(always)]
fn joined(all: [[f32; 2]; 2], [low, high]: [[f32; 2]; 2]) -> [[f32; 2]; 2] {
    let least = |axis: usize| if low[axis] < all[0][axis] { low[axis] } else { all[0][axis] };
    let most = |axis: usize| if high[axis] > all[1][axis] { high[axis] } else { all[1][axis] };
    [[least(0), least(1)], [most(0), most(1)]]
}

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
    let mut waiting: ArrayVec<Child, STACK> = ArrayVec::from_iter(bvh.tree.root());
    while let Some(child) = waiting.pop().filter(|_| packet.left > 0) {
        if let Some(leaf) = child.as_leaf() {
            let shadows = Shadows::new::<P>(token, &bvh.tree, leaf, packet);
            shadows.meet::<P>(token, packet, |ray, met| bvh.hit(&met).is_none_or(|hit| meet(ray, hit)));
            continue;
        }
        let node = bvh.tree.node(child);
        let mut touched = touched::<P>(token, &node.boxes, packet) & node.present();
        while touched != 0 {
            waiting.push(node.child(touched.trailing_zeros() as usize));
            touched &= touched - 1;
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

/// The projections of the triangles of a leaf along the rays' depth.
struct Shadows {
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
    fn new<P: Pack>(token: P::Token, tree: &Tree, leaf: usize, packet: &RayPacket) -> Self {
        let present = (1 << tree.triangles(leaf).len()) - 1;
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
    fn meet<P: Pack>(
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

#[cfg(test)]
mod tests {
    use super::super::numbers::numbers;
    use super::*;

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
