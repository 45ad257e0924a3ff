//! The resolution of a close-up: as fine as the scan's detail.

use crate::bake::Scan;
use crate::math::Vec3;
use crate::mesh::{Mesh, Point};

/// Maximum number of pixels across the object in a close-up.
const MOST_PIXELS: f64 = 4096.0;
/// Number of triangles whose edges are measured.
const TRIANGLES: usize = 20_000;

/// The size of a close-up's pixels on a scan: a texel of its finest texture, or half its median edge, whichever is
/// finer, but no more than 4096 pixels across the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footprint {
    /// Half the median edge, in model units.
    pub half_edge: f32,
    /// The smallest pixel, in model units.
    pub least: f32,
}

impl Footprint {
    /// Measures the edges of a scan.
    pub fn of(scan: &Scan) -> Self {
        let mesh = scan.mesh();
        let lengths = Self::looked_at(mesh.triangles().len()).flat_map(|t| edges(mesh, t));
        Self::of_edges(lengths.collect(), mesh.diagonal())
    }

    /// Returns an evenly spread subset of this number of triangles, whose edges are measured.
    pub(crate) fn looked_at(triangles: usize) -> impl Iterator<Item = usize> {
        (0..triangles).step_by(triangles.div_ceil(TRIANGLES).max(1))
    }

    /// Makes a footprint from the edge lengths of a scan with this diagonal, in model units.
    pub(crate) fn of_edges(mut lengths: Vec<f32>, diagonal: f64) -> Self {
        lengths.sort_unstable_by(f32::total_cmp);
        let median = lengths.get(lengths.len() / 2).copied().unwrap_or(0.0);
        Self { half_edge: median * 0.5, least: (diagonal / MOST_PIXELS) as f32 }
    }

    /// Returns the size of a pixel at a point of the scan, in model units.
    pub fn at(&self, scan: &Scan, point: Point) -> f32 {
        self.of_texel(scan.surface().texel_size(point))
    }

    /// Returns the size of a pixel if the finest texel has this width, in model units.
    pub(crate) fn of_texel(&self, texel: Option<f32>) -> f32 {
        self.half_edge.min(texel.unwrap_or(f32::INFINITY)).max(self.least)
    }
}

/// Returns the lengths of a triangle's edges.
pub(crate) fn edges(mesh: &Mesh, triangle: usize) -> [f32; 3] {
    let [a, b, c] = mesh.corners(triangle);
    [b - a, c - b, a - c].map(Vec3::length)
}
