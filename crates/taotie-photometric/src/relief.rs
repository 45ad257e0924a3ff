//! A coarse relief with the estimated normals, and the surfaces that each of its points sees.
//!
//! Heights follow from the normals by least squares over neighbouring cells, by conjugate gradients. They need not be
//! exact: they only decide which parts of the surface face each other.

use crate::grid::Grid;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::parallel;

/// Rays from each cell.
pub const RAYS: usize = 64;

/// Marks a ray that leaves the relief.
pub const SKY: u32 = u32::MAX;

/// The steepest slope between two cells; normals seen at a grazing angle are unreliable.
const STEEPEST: f64 = 4.0;

/// Steps of conjugate gradients: a few times the side of the grid.
const STEPS: usize = 600;

/// Returns the height of each cell in cells, from its unit normal.
pub fn heights(grid: &Grid, normals: &[Vec3<f64>]) -> Vec<f64> {
    let slope = |along: f64, z: f64| (-along / z.max(0.15)).clamp(-STEEPEST, STEEPEST);
    let slopes: Vec<[f64; 2]> = normals.iter().map(|n| [slope(n.x, n.z), slope(n.y, n.z)]).collect();
    // Each edge is from a cell to its neighbour on the right, or above.
    let mut edges = Vec::new();
    for from in 0..grid.pixels.len() {
        let [x, y] = grid.position(from).map(|v| v as i64);
        for (axis, to) in [grid.at(x + 1, y), grid.at(x, y - 1)].into_iter().enumerate() {
            if let Some(to) = to {
                edges.push(([from, to], 0.5 * (slopes[from][axis] + slopes[to][axis])));
            }
        }
    }
    conjugate_gradients(grid.pixels.len(), &edges)
}

/// Returns the heights whose differences along the edges are closest to those given.
fn conjugate_gradients(count: usize, edges: &[([usize; 2], f64)]) -> Vec<f64> {
    /// Keeps separate parts from drifting.
    const REGULAR: f64 = 1e-6;
    let apply = |v: &[f64]| {
        let mut product: Vec<f64> = v.iter().map(|v| REGULAR * v).collect();
        for ([from, to], _) in edges {
            let difference = v[*to] - v[*from];
            product[*to] += difference;
            product[*from] -= difference;
        }
        product
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b);
    let mut residual = vec![0.0; count];
    for ([from, to], difference) in edges {
        residual[*to] += difference;
        residual[*from] -= difference;
    }
    let (mut heights, mut direction) = (vec![0.0; count], residual.clone());
    let start = dot(&residual, &residual);
    let mut norm = start;
    for _ in 0..STEPS {
        if norm <= 1e-8 * start {
            break;
        }
        let applied = apply(&direction);
        let step = norm / dot(&direction, &applied);
        for i in 0..count {
            heights[i] += step * direction[i];
            residual[i] -= step * applied[i];
        }
        let next = dot(&residual, &residual);
        let turn = next / norm;
        norm = next;
        direction.iter_mut().zip(&residual).for_each(|(d, r)| *d = r + turn * *d);
    }
    heights
}

/// Returns for each cell the cells that [`RAYS`] cosine-distributed rays meet, or [`SKY`].
pub fn visible(grid: &Grid, heights: &[f64], normals: &[Vec3<f64>]) -> Vec<u32> {
    let top = heights.iter().fold(f64::NEG_INFINITY, |top, v| v.max(top));
    let relief = Relief { grid, heights, top };
    let local: Vec<[f64; 3]> = (0..RAYS).map(cosine_direction).collect();
    let mut hits = vec![SKY; grid.pixels.len() * RAYS];
    parallel::pieces(&mut hits, RAYS, &|cell, hits| {
        let n = normals[cell];
        let t = n.any_perpendicular();
        let b = n.cross(t);
        for (hit, [x, y, z]) in hits.iter_mut().zip(&local) {
            let ray = t * *x + b * *y + n * *z;
            *hit = relief.first_hit(cell, ray).map_or(SKY, |cell| cell as u32);
        }
    });
    hits
}

/// Returns direction `i` of [`RAYS`], relative to the normal, distributed as its cosine.
fn cosine_direction(i: usize) -> [f64; 3] {
    /// The golden angle: a spiral that fills the disc evenly (Vogel 1979).
    const GOLDEN: f64 = 2.399_963_229_728_653;
    let u = (i as f64 + 0.5) / RAYS as f64;
    let angle = GOLDEN * i as f64;
    let r = u.sqrt();
    [r * scalar::cos(angle), r * scalar::sin(angle), (1.0 - u).sqrt()]
}

/// Heights over a grid.
struct Relief<'a> {
    grid: &'a Grid,
    heights: &'a [f64],
    /// The greatest height.
    top: f64,
}

impl Relief<'_> {
    /// Returns the cell that a ray from `cell` meets.
    fn first_hit(&self, cell: usize, ray: Vec3<f64>) -> Option<usize> {
        /// The distance within which a cell does not see its surroundings, cells.
        const NEAR: f64 = 2.0;
        let across = (ray.x * ray.x + ray.y * ray.y).sqrt();
        if across < 1e-6 {
            return None;
        }
        let [x, y] = self.grid.position(cell).map(|v| v as f64);
        let (dx, dy, dz) = (ray.x / across, -ray.y / across, ray.z / across);
        let most = (self.grid.width + self.grid.height) as f64;
        let mut distance = NEAR;
        while distance < most {
            let height = self.heights[cell] + dz * distance;
            let [column, row] = [x + dx * distance, y + dy * distance].map(|v| (v + 0.5).floor() as i64);
            let outside =
                column < 0 || row < 0 || column >= self.grid.width as i64 || row >= self.grid.height as i64;
            if outside || height > self.top {
                return None;
            }
            if let Some(other) = self.grid.at(column, row)
                && self.heights[other] > height
            {
                return Some(other);
            }
            distance += (0.06 * distance).max(1.0);
        }
        None
    }
}
