//! A coarse relief with the estimated normals, and the surfaces that each of its points sees.
//!
//! Heights follow from the normals by least squares over neighbouring cells. They need not be exact: they only decide
//! which parts of the surface face each other.

use crate::cells::Cells;
use crate::grid::Grid;
use crate::multigrid::Multigrid;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::parallel;

/// Rays from each cell.
pub const RAYS: usize = 64;

/// Marks a ray that leaves the relief.
pub const SKY: u32 = u32::MAX;

/// The steepest slope between two cells; normals seen at a grazing angle are unreliable.
const STEEPEST: f64 = 4.0;

/// The residual to which heights are solved, relative to the right side.
const PRECISE: f64 = 1e-4;

/// Returns the height of each cell in cells, from its unit normal.
pub fn heights(grid: &Grid, normals: &[Vec3<f64>]) -> Vec<f64> {
    let (cells, places) = Cells::around(grid);
    let slope = |along: f64, z: f64| (-along / z.max(0.15)).clamp(-STEEPEST, STEEPEST);
    let mut target = vec![0.0; cells.count()];
    let mut system = Multigrid::new(cells);
    system.change(|edges| {
        for (from, n) in normals.iter().enumerate() {
            let [x, y] = grid.position(from).map(|v| v as i64);
            let here = places[from] as usize;
            let mut add = |to: usize, step: f64| {
                target[places[to] as usize] += step;
                target[here] -= step;
            };
            if let Some(to) = grid.at(x + 1, y) {
                edges.right[here] = 1.0;
                add(to, 0.5 * (slope(n.x, n.z) + slope(normals[to].x, normals[to].z)));
            }
            if let Some(to) = grid.at(x, y + 1) {
                edges.below[here] = 1.0;
                add(to, -0.5 * (slope(n.y, n.z) + slope(normals[to].y, normals[to].z)));
            }
        }
    });
    let mut heights = vec![0.0; cells.count()];
    system.add_solution(&target, &mut heights, PRECISE);
    let mut heights: Vec<f64> = places.iter().map(|place| heights[*place as usize]).collect();
    grid.centre_parts(&mut heights);
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
