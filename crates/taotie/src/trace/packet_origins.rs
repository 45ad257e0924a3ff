//! Packets of parallel rays, which differ only in their origins.

use super::ray_packet::{PacketView, Places, RayPacket};
use super::tree::WIDTH;
use crate::math::Vec3;

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
