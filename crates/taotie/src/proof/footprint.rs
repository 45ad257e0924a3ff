//! How finely a close-up looks: as finely as the scan has detail.

use crate::bake::Scan;
use crate::math::Vec3;
use crate::mesh::{Mesh, Point};

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
        let lengths = Self::looked_at(mesh.triangles().len()).flat_map(|t| edges(mesh, t));
        Self::of_edges(lengths.collect(), mesh.diagonal())
    }

    /// Returns some triangles of so many, spread evenly, whose edges are looked at.
    pub(crate) fn looked_at(triangles: usize) -> impl Iterator<Item = usize> {
        (0..triangles).step_by(triangles.div_ceil(TRIANGLES).max(1))
    }

    /// Takes the lengths of edges of a scan with this diagonal, model units.
    pub(crate) fn of_edges(mut lengths: Vec<f32>, diagonal: f64) -> Self {
        lengths.sort_unstable_by(f32::total_cmp);
        let median = lengths.get(lengths.len() / 2).copied().unwrap_or(0.0);
        Self { half_edge: median * 0.5, least: (diagonal / MOST_PIXELS) as f32 }
    }

    /// Returns the size of a pixel at a point of the scan, model units.
    pub fn at(&self, scan: &Scan, point: Point) -> f32 {
        self.of_texel(scan.surface().texel_size(point))
    }

    /// Returns the size of a pixel where the finest texel has this width, model units.
    pub(crate) fn of_texel(&self, texel: Option<f32>) -> f32 {
        self.half_edge.min(texel.unwrap_or(f32::INFINITY)).max(self.least)
    }
}

/// Returns the lengths of a triangle's edges.
pub(crate) fn edges(mesh: &Mesh, triangle: usize) -> [f32; 3] {
    let [a, b, c] = mesh.corners(triangle);
    [b - a, c - b, a - c].map(Vec3::length)
}
