//! How finely a close-up looks: as finely as the scan has detail.

use crate::bake::Scan;
use crate::math::Vec3;
use crate::mesh::Point;

/// Pixels across the object in a close-up, at most.
const MOST_PIXELS: f64 = 4096.0;
/// Triangles whose edges are looked at.
const TRIANGLES: usize = 20_000;

/// The size of a close-up's pixels on a scan: a texel of its finest texture, or half its median edge, whichever is finer,
/// but no more than 4096 pixels across the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footprint {
    /// Half the median edge, model units.
    pub half_edge: f32,
    /// The smallest pixel, model units.
    pub least: f32,
}

impl Footprint {
    /// Measures the edges of a scan.
    pub fn of(scan: &Scan) -> Self {
        let mesh = scan.mesh();
        let stride = mesh.triangles().len().div_ceil(TRIANGLES).max(1);
        let edges = |t: usize| {
            let [a, b, c] = mesh.corners(t);
            [b - a, c - b, a - c].map(Vec3::length)
        };
        let mut lengths: Vec<f32> = (0..mesh.triangles().len()).step_by(stride).flat_map(edges).collect();
        lengths.sort_unstable_by(f32::total_cmp);
        let median = lengths.get(lengths.len() / 2).copied().unwrap_or(0.0);
        Self { half_edge: median * 0.5, least: (mesh.diagonal() / MOST_PIXELS) as f32 }
    }

    /// Returns the size of a pixel at a point of the scan, model units.
    pub fn at(&self, scan: &Scan, point: Point) -> f32 {
        let texel = scan.surface().texel_size(point).unwrap_or(f32::INFINITY);
        self.half_edge.min(texel).max(self.least)
    }
}
