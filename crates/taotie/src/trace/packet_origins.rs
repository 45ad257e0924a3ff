//! Packets of rays that are the same but for their origins.

use super::ray_packet::{PacketView, Places, RayPacket};
use super::tree::WIDTH;
use crate::math::Vec3;

/// The origins of rays that run the same way, in the order of the packet's rays: neighbours one after the other.
pub struct PacketOrigins {
    /// Component by component, up to a whole number of blocks: the last is there more than once.
    columns: [Vec<f32>; 3],
}

/// The way that the rays of a packet run.
#[derive(Debug, Clone, Copy)]
pub struct ParallelRays {
    /// Unit.
    pub direction: Vec3,
    /// The distance within which they look.
    pub reach: f32,
    /// The distance beside it at which a ray may meet something, apart from rounding.
    pub margin: f32,
}

impl PacketOrigins {
    /// Takes origins.
    pub fn new(origins: impl ExactSizeIterator<Item = Vec3>) -> Self {
        let height = origins.len().next_multiple_of(WIDTH);
        let mut columns = [0; 3].map(|_| Vec::with_capacity(height));
        for origin in origins {
            columns.iter_mut().zip(origin.to_array()).for_each(|(column, v)| column.push(v));
        }
        columns
            .iter_mut()
            .for_each(|column| column.resize(height, column.last().copied().unwrap_or_default()));
        Self { columns }
    }

    /// Returns an origin.
    pub fn at(&self, ray: usize) -> Vec3 {
        let [x, y, z] = &self.columns;
        Vec3::new(x[ray], y[ray], z[ray])
    }

    /// Makes a packet of rays from these origins. `going` has a bit of each ray, eight in a byte: those whose bit is 0
    /// are left out. Returns `None` where one ray at a time is faster, as [`RayPacket::new`] does.
    pub fn packet(&self, mut going: Vec<u8>, rays: ParallelRays) -> Option<RayPacket> {
        let ParallelRays { direction, reach, margin } = rays;
        going.resize(self.columns[0].len() / WIDTH, 0);
        let first = going.iter().position(|going| *going != 0)?;
        let origin = self.at(first * WIDTH);
        let x = direction.any_perpendicular();
        let axes = [x, direction.cross(x), direction];
        let [columns, rows, depths] = axes.map(|axis| self.along(axis, origin));
        let mut places = vec![Places::default(); going.len()];
        let (mut nearest, mut farthest) = (f32::INFINITY, f32::NEG_INFINITY);
        for (i, (places, going)) in places.iter_mut().zip(&going).enumerate() {
            for (to, from) in places.iter_mut().zip([&columns, &rows, &depths]) {
                to.copy_from_slice(&from[i * WIDTH..][..WIDTH]);
            }
            for depth in (0..WIDTH).filter(|lane| going & 1 << lane != 0).map(|lane| places[2][lane]) {
                (nearest, farthest) = (nearest.min(depth), farthest.max(depth));
            }
        }
        // Rounding of places and of their shadows, which grows with how far away they are from zero.
        let slack = (origin.length() + farthest - nearest) * 2e-6 + margin;
        let depths = [nearest - slack, farthest + reach];
        RayPacket::parallel(PacketView { origin, axes, slack: [slack; 2], depths }, places, going)
    }

    /// Returns the coordinates along an axis that is 0 at `zero`.
    fn along(&self, axis: Vec3, zero: Vec3) -> Vec<f32> {
        let [x, y, z] = &self.columns;
        let places = x.iter().zip(y).zip(z);
        places.map(|((x, y), z)| axis.dot(Vec3::new(*x, *y, *z) - zero)).collect()
    }
}
