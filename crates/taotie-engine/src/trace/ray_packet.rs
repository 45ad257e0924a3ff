//! Nearly parallel rays, in blocks of eight neighbours.

use super::Ray;
use super::tree::WIDTH;
use crate::math::{Mask, Pack, Vec3};

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
pub(super) type Places = [[f32; WIDTH]; 3];

/// Nearly parallel rays; every eight consecutive ones are a block. Blocks should be narrow, so consecutive rays
/// should be neighbours.
pub struct RayPacket {
    pub(super) view: PacketView,
    /// Column, row and depth of the origins of each block's rays.
    pub(super) origins: Vec<Places>,
    /// The change of the rays of each block per step in depth: columns, rows, lengths of their directions. Empty if
    /// all are parallel to the depth: 0, 0 and 1.
    pub(super) slopes: Vec<Places>,
    /// The bounds of the active rays of eight blocks each.
    pub(super) bounds: Vec<Bounds>,
    /// The active rays of each block, one bit each.
    pub(super) going: Vec<u8>,
    /// The number of active rays.
    pub(super) left: usize,
    /// The minimum and maximum column, row and depth that matter.
    pub(super) limits: [[f32; 2]; 3],
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
    pub(super) fn end(&mut self, block: usize, lane: usize) {
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
pub(super) struct Bounds {
    pub low: [[f32; WIDTH]; 2],
    pub high: [[f32; WIDTH]; 2],
}

impl Bounds {
    pub const EMPTY: Self = Self { low: [[f32::INFINITY; WIDTH]; 2], high: [[f32::NEG_INFINITY; WIDTH]; 2] };

    /// Returns the items that overlap these columns and rows, one bit each.
    #[inline(always)]
    pub fn touched<P: Pack>(&self, token: P::Token, [low, high]: [[f32; 2]; 2]) -> u64 {
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
    pub fn of(&self, i: usize) -> [[f32; 2]; 2] {
        [[self.low[0][i], self.low[1][i]], [self.high[0][i], self.high[1][i]]]
    }

    pub fn set(&mut self, i: usize, [low, high]: [[f32; 2]; 2]) {
        for axis in 0..2 {
            self.low[axis][i] = low[axis];
            self.high[axis][i] = high[axis];
        }
    }

    /// Returns the bounds of all.
    #[inline(always)]
    pub fn all(&self) -> [[f32; 2]; 2] {
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
