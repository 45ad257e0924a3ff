//! Weighted differences along the edges of a grid, solved by conjugate gradients.
//!
//! The matrix is a graph Laplacian. Its preconditioner is one V-cycle over ever coarser grids, in which four cells become
//! one and the weights of edges add up (aggregation: Braess 1995), with one Gauss-Seidel sweep before and after.
//! Everything runs in one order, so that no bit depends on the number of threads.

use crate::grid::Grid;

/// Keeps separate parts from drifting, relative to the diagonal.
const REGULAR: f64 = 1e-9;
/// Cells below which a grid is not made coarser.
const COARSEST: usize = 24;
/// The most steps of conjugate gradients.
const STEPS: usize = 300;

/// An edge from one element to another, with its weight.
#[derive(Debug, Clone, Copy)]
pub struct Edge {
    /// The two elements.
    pub ends: [u32; 2],
    /// Its weight, at least 0.
    pub weight: f64,
}

/// One grid.
#[derive(Debug, Clone, Default)]
struct Level {
    /// Where the neighbours of each element start, and the end.
    starts: Vec<u32>,
    /// The neighbours and the weights of the edges to them.
    neighbours: Vec<(u32, f64)>,
    diagonal: Vec<f64>,
    /// The element of the coarser grid that holds each element; empty for the coarsest.
    parents: Vec<u32>,
}

impl Level {
    fn new(count: usize, edges: &[Edge]) -> Self {
        let mut starts = vec![0_u32; count + 1];
        edges.iter().flat_map(|edge| edge.ends).for_each(|end| starts[end as usize + 1] += 1);
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut neighbours = vec![(0, 0.0); 2 * edges.len()];
        let mut diagonal = vec![0.0; count];
        for Edge { ends: [a, b], weight } in edges {
            for (from, to) in [(*a, *b), (*b, *a)] {
                neighbours[next[from as usize] as usize] = (to, *weight);
                next[from as usize] += 1;
                diagonal[from as usize] += weight;
            }
        }
        diagonal.iter_mut().for_each(|d| *d = *d * (1.0 + REGULAR) + f64::MIN_POSITIVE.sqrt());
        Self { starts, neighbours, diagonal, parents: Vec::new() }
    }

    #[inline]
    fn around(&self, i: usize, v: &[f64]) -> f64 {
        let range = self.starts[i] as usize..self.starts[i + 1] as usize;
        self.neighbours[range].iter().fold(0.0, |sum, (to, weight)| sum + weight * v[*to as usize])
    }

    fn sweep(&self, v: &mut [f64], right: &[f64], i: usize) {
        v[i] = (right[i] + self.around(i, v)) / self.diagonal[i];
    }

    /// Returns the product with a vector.
    fn times(&self, v: &[f64]) -> Vec<f64> {
        (0..v.len()).map(|i| self.diagonal[i] * v[i] - self.around(i, v)).collect()
    }
}

/// Grids from fine to coarse.
#[derive(Debug, Clone)]
pub struct Multigrid {
    levels: Vec<Level>,
}

impl Multigrid {
    /// Makes the coarser grids.
    pub fn new(grid: &Grid, edges: Vec<Edge>) -> Self {
        let mut levels = vec![Level::new(grid.pixels.len(), &edges)];
        let mut places: Vec<[u32; 2]> =
            (0..grid.pixels.len()).map(|i| grid.position(i).map(|v| v as u32)).collect();
        let mut edges = edges;
        while places.len() > COARSEST {
            let (parents, coarse) = parents(&places);
            edges = merged(&edges, &parents);
            let stuck = coarse.len() == places.len();
            if let Some(level) = levels.last_mut().filter(|_| !stuck) {
                level.parents = parents;
                levels.push(Level::new(coarse.len(), &edges));
            }
            // Separate parts do not merge until they are next to each other.
            if places.iter().all(|place| *place == [0, 0]) {
                break;
            }
            places = if stuck { places.iter().map(|place| place.map(|v| v / 2)).collect() } else { coarse };
        }
        Self { levels }
    }

    /// Returns the solution closest to `start`, to a residual of `tolerance` relative to the right side.
    pub fn solve(&self, right: &[f64], start: Vec<f64>, tolerance: f64) -> Vec<f64> {
        let fine = &self.levels[0];
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b);
        let mut v = start;
        let mut residual: Vec<f64> = right.iter().zip(fine.times(&v)).map(|(r, p)| r - p).collect();
        let enough = tolerance * tolerance * dot(right, right);
        let (mut direction, mut before) = (vec![0.0; v.len()], 1.0);
        for step in 0..STEPS {
            if dot(&residual, &residual) <= enough {
                break;
            }
            let conditioned = self.cycle(0, &residual);
            let product = dot(&residual, &conditioned);
            let turn = if step == 0 { 0.0 } else { product / before };
            before = product;
            direction.iter_mut().zip(&conditioned).for_each(|(d, c)| *d = c + turn * *d);
            let applied = fine.times(&direction);
            let length = product / dot(&direction, &applied);
            if !length.is_finite() {
                break;
            }
            v.iter_mut().zip(&direction).for_each(|(v, d)| *v += length * d);
            residual.iter_mut().zip(&applied).for_each(|(r, a)| *r -= length * a);
        }
        v
    }

    /// Returns an approximate solution by one V-cycle from `level` on.
    fn cycle(&self, level: usize, right: &[f64]) -> Vec<f64> {
        /// Sweeps on the coarsest grid.
        const SWEEPS: usize = 8;
        /// Piecewise constant corrections are too small by about this factor (Braess 1995).
        const MORE: f64 = 1.8;
        let here = &self.levels[level];
        let mut v = vec![0.0; right.len()];
        let sweeps = if here.parents.is_empty() { SWEEPS } else { 1 };
        for _ in 0..sweeps {
            (0..v.len()).for_each(|i| here.sweep(&mut v, right, i));
        }
        if !here.parents.is_empty() {
            let product = here.times(&v);
            let mut coarse = vec![0.0; self.levels[level + 1].diagonal.len()];
            for (i, parent) in here.parents.iter().enumerate() {
                coarse[*parent as usize] += right[i] - product[i];
            }
            let correction = self.cycle(level + 1, &coarse);
            for (v, parent) in v.iter_mut().zip(&here.parents) {
                *v += MORE * correction[*parent as usize];
            }
        }
        for _ in 0..sweeps {
            (0..v.len()).rev().for_each(|i| here.sweep(&mut v, right, i));
        }
        v
    }
}

/// Returns the parent of each element, and the places of the parents: squares of four cells.
fn parents(places: &[[u32; 2]]) -> (Vec<u32>, Vec<[u32; 2]>) {
    let mut order: Vec<u32> = (0..places.len() as u32).collect();
    let half = |i: u32| places[i as usize].map(|v| v / 2);
    order.sort_by_key(|i| (half(*i)[1], half(*i)[0]));
    let (mut parents, mut coarse) = (vec![0; places.len()], Vec::<[u32; 2]>::new());
    for i in order {
        if coarse.last() != Some(&half(i)) {
            coarse.push(half(i));
        }
        parents[i as usize] = coarse.len() as u32 - 1;
    }
    (parents, coarse)
}

/// Returns the edges between parents; weights add up.
fn merged(edges: &[Edge], parents: &[u32]) -> Vec<Edge> {
    let parent = |end: u32| parents[end as usize];
    let mut all: Vec<Edge> = edges
        .iter()
        .map(|edge| Edge { ends: edge.ends.map(parent), ..*edge })
        .filter(|edge| edge.ends[0] != edge.ends[1])
        .map(|edge| Edge { ends: [edge.ends[0].min(edge.ends[1]), edge.ends[0].max(edge.ends[1])], ..edge })
        .collect();
    all.sort_by_key(|edge| edge.ends);
    all.dedup_by(|next, kept| {
        let same = next.ends == kept.ends;
        kept.weight += if same { next.weight } else { 0.0 };
        same
    });
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solutions_have_the_residual_asked_for_on_any_grid() {
        // A square with a hole and a separate part, with weights that differ by a factor of 10,000.
        let side = 40;
        let inside = |x: usize, y: usize| !((10..18).contains(&x) && (8..30).contains(&y)) && x != 33;
        let pixels = (0..side * side).filter(|i| inside(i % side, i / side)).map(|i| i as u32).collect();
        let grid = Grid::new(side, side, pixels);
        let mut edges = Vec::new();
        for from in 0..grid.pixels.len() {
            let [x, y] = grid.position(from).map(|v| v as i64);
            for to in [grid.at(x + 1, y), grid.at(x, y + 1)].into_iter().flatten() {
                let weight = if (x + 2 * y) % 7 == 0 { 1e-4 } else { 1.0 };
                edges.push(Edge { ends: [from as u32, to as u32], weight });
            }
        }
        let truth: Vec<f64> = (0..grid.pixels.len()).map(|i| ((i * 37) % 101) as f64).collect();
        let system = Multigrid::new(&grid, edges);
        let right = system.levels[0].times(&truth);
        let found = system.solve(&right, vec![0.0; truth.len()], 1e-10);
        let size = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let left: Vec<f64> = system.levels[0].times(&found).iter().zip(&right).map(|(a, b)| a - b).collect();
        assert!(size(&left) <= 1e-10 * size(&right), "{}", size(&left) / size(&right));
        assert!(system.levels.len() > 3);
    }
}
