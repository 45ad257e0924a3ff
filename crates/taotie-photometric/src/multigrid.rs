//! Weighted differences between neighbouring cells, solved by conjugate gradients.
//!
//! The matrix is a graph Laplacian. Its preconditioner is one cycle over ever coarser grids, in which four cells become
//! one and the weights of edges add up (aggregation: Braess 1995). It is in single precision, since it only has to
//! point in the right direction. Sums run in the order of the rows, so that no bit depends on the number of threads.

use crate::cells::{Cells, over, summed};

/// Cells below which a grid is not made coarser.
const COARSEST: usize = 16;
/// The most steps of conjugate gradients.
const STEPS: usize = 300;
/// Two steps of damped Jacobi that reduce errors of eigenvalues from 0.5 to 2, relative to the diagonal, at least by 4.5
/// (Chebyshev's polynomial).
const DAMPING: [f32; 2] = [1.389, 0.562];
/// Piecewise constant corrections are too small by about this factor (Braess 1995).
const MORE: f32 = 1.8;

/// Weights of the edges between cells, at least 0.
#[derive(Debug, Clone)]
pub struct Edges {
    /// The rectangle.
    pub cells: Cells,
    /// The weight of the edge from each cell to the one on the right.
    pub right: Vec<f32>,
    /// The weight of the edge from each cell to the one below.
    pub below: Vec<f32>,
}

/// One grid, and memory for the solution there.
#[derive(Debug, Clone)]
struct Level {
    edges: Edges,
    /// Inverses of the diagonal; 0 for cells without edges.
    inverse: Vec<f32>,
    target: Vec<f32>,
    solution: Vec<f32>,
    spare: Vec<f32>,
}

/// Grids from fine to coarse.
#[derive(Debug, Clone)]
pub struct Multigrid {
    levels: Vec<Level>,
    residual: Vec<f32>,
    direction: Vec<f32>,
}

impl Edges {
    /// Makes a rectangle without edges.
    pub fn none(cells: Cells) -> Self {
        Self { cells, right: vec![0.0; cells.count()], below: vec![0.0; cells.count()] }
    }

    /// Calls `out` with each column of a row, the value there, and the sum of the weighted differences from its
    /// neighbours: the product of the matrix with a vector.
    #[inline(always)]
    fn times_row(&self, v: &[f32], y: usize, mut out: impl FnMut(usize, f32, f32)) {
        let (v, right, below) =
            (self.cells.row(v, y), self.cells.row(&self.right, y), self.cells.row(&self.below, y));
        let width = self.cells.width;
        let (here, west, east) = (&v.here[1..=width], &v.here[..width], &v.here[2..width + 2]);
        let (north, south) = (&v.above[1..=width], &v.below[1..=width]);
        let (to_west, to_east) = (&right.here[..width], &right.here[1..=width]);
        let (to_north, to_south) = (&below.above[1..=width], &below.here[1..=width]);
        for i in 0..width {
            let product = to_east[i] * (here[i] - east[i])
                + to_west[i] * (here[i] - west[i])
                + to_south[i] * (here[i] - south[i])
                + to_north[i] * (here[i] - north[i]);
            out(i + 1, here[i], product);
        }
    }

    /// Sets the weights to those of the squares of four cells of a finer grid.
    fn merge(&mut self, finer: &Edges) {
        let (fine, cells) = (finer.cells, self.cells);
        let rows = cells.rows(&mut self.right).zip(cells.rows(&mut self.below));
        over(rows, |y, (right, below)| {
            right.fill(0.0);
            below.fill(0.0);
            for y in 2 * y..(2 * y + 2).min(fine.height) {
                let from = fine.row(&finer.right, y).here;
                (1..cells.width).for_each(|x| right[x] += from[2 * x]);
            }
            if 2 * y + 1 < fine.height {
                let from = fine.row(&finer.below, 2 * y + 1).here;
                (0..fine.width).for_each(|x| below[x / 2 + 1] += from[x + 1]);
            }
            0.0
        });
    }
}

impl Level {
    fn new(cells: Cells) -> Self {
        let [inverse, target, solution, spare] = [0; 4].map(|_| vec![0.0; cells.count()]);
        Self { edges: Edges::none(cells), inverse, target, solution, spare }
    }

    /// Computes the inverses of the diagonal.
    fn invert(&mut self) {
        let Self { edges, inverse, .. } = self;
        let cells = edges.cells;
        over(cells.rows(inverse), |y, inverse| {
            let (right, below) = (cells.row(&edges.right, y), cells.row(&edges.below, y));
            for x in 1..=cells.width {
                let sum = right.here[x] + right.here[x - 1] + below.here[x] + below.above[x];
                inverse[x] = if sum > 0.0 { 1.0 / sum } else { 0.0 };
            }
            0.0
        });
    }

    /// Sets the solution after one step of Jacobi from zero.
    fn start(&mut self) {
        let Self { edges, inverse, target, solution, .. } = self;
        over(edges.cells.rows(solution), |y, solution| {
            let (inverse, target) = (edges.cells.row(inverse, y).here, edges.cells.row(target, y).here);
            for ((v, inverse), target) in solution.iter_mut().zip(inverse).zip(target) {
                *v = DAMPING[0] * inverse * target;
            }
            0.0
        });
    }

    /// Does one step of Jacobi.
    fn smooth(&mut self, damping: f32) {
        let Self { edges, inverse, target, solution, spare } = self;
        let cells = edges.cells;
        over(cells.rows(spare), |y, out| {
            let (inverse, target) = (cells.row(inverse, y).here, cells.row(target, y).here);
            edges.times_row(solution, y, |x, here, product| {
                out[x] = here + damping * inverse[x] * (target[x] - product);
            });
            0.0
        });
        std::mem::swap(&mut self.solution, &mut self.spare);
    }

    /// Sets the coarser grid's target: sums of the residuals of four cells.
    fn restrict(&self, coarse: &mut Level) {
        let fine = self.edges.cells;
        over(coarse.edges.cells.rows(&mut coarse.target), |y, out| {
            out.fill(0.0);
            for y in 2 * y..(2 * y + 2).min(fine.height) {
                let target = fine.row(&self.target, y).here;
                self.edges
                    .times_row(&self.solution, y, |x, _, product| out[x.div_ceil(2)] += target[x] - product);
            }
            0.0
        });
    }

    /// Adds the coarser grid's solution.
    fn correct(&mut self, coarse: &Level) {
        let cells = self.edges.cells;
        over(cells.rows(&mut self.solution), |y, v| {
            let from = coarse.edges.cells.row(&coarse.solution, y / 2).here;
            (1..=cells.width).for_each(|x| v[x] += MORE * from[x.div_ceil(2)]);
            0.0
        });
    }
}

impl Multigrid {
    /// Makes grids without edges.
    pub fn new(cells: Cells) -> Self {
        let mut levels = vec![Level::new(cells)];
        let mut size = cells;
        while size.width * size.height > COARSEST {
            size = Cells { width: size.width.div_ceil(2), height: size.height.div_ceil(2) };
            levels.push(Level::new(size));
        }
        Self { levels, residual: vec![0.0; cells.count()], direction: vec![0.0; cells.count()] }
    }

    /// Changes the edges by `change`.
    pub fn change(&mut self, change: impl FnOnce(&mut Edges)) {
        change(&mut self.levels[0].edges);
        self.levels[0].invert();
        for i in 1..self.levels.len() {
            let (finer, coarser) = self.levels.split_at_mut(i);
            coarser[0].edges.merge(&finer[i - 1].edges);
            coarser[0].invert();
        }
    }

    /// Adds to `v` a solution for the target `residual`, to a residual of `tolerance` relative to it; returns the number
    /// of steps.
    pub fn add_solution(&mut self, residual: &[f64], v: &mut [f64], tolerance: f64) -> usize {
        let cells = self.levels[0].edges.cells;
        let mut square = over(cells.rows(&mut self.residual), |y, r| {
            let residual = cells.row(residual, y).here;
            r.iter_mut().zip(residual).for_each(|(r, v)| *r = *v as f32);
            squares(r)
        });
        let enough = tolerance * tolerance * square;
        let mut before = 1.0;
        for step in 0..STEPS {
            if square <= enough {
                return step;
            }
            let product = self.conditioned();
            let turn = if step == 0 { 0.0 } else { (product / before) as f32 };
            before = product;
            let Level { edges, solution, spare: applied, .. } = &mut self.levels[0];
            over(cells.rows(&mut self.direction), |y, direction| {
                let conditioned = cells.row(solution, y).here;
                direction.iter_mut().zip(conditioned).for_each(|(d, c)| *d = c + turn * *d);
                0.0
            });
            let along = over(cells.rows(applied), |y, applied| {
                edges.times_row(&self.direction, y, |x, _, product| applied[x] = product);
                dot(applied, cells.row(&self.direction, y).here)
            });
            let length = (product / along) as f32;
            if !length.is_finite() {
                return step;
            }
            let rows = cells.rows(v).zip(cells.rows(&mut self.residual));
            square = over(rows, |y, (v, residual)| {
                let (direction, applied) = (cells.row(&self.direction, y).here, cells.row(applied, y).here);
                v.iter_mut().zip(direction).for_each(|(v, d)| *v += f64::from(length * d));
                residual.iter_mut().zip(applied).for_each(|(r, a)| *r -= length * a);
                squares(residual)
            });
        }
        STEPS
    }

    /// Computes an approximate solution for the residual on the finest grid, and returns their dot product.
    fn conditioned(&mut self) -> f64 {
        let cells = self.levels[0].edges.cells;
        self.levels[0].target.copy_from_slice(&self.residual);
        cycle(&mut self.levels, true);
        let solution = &mut self.levels[0].solution;
        over(cells.rows(solution), |y, solution| dot(solution, cells.row(&self.residual, y).here))
    }
}

fn dot(a: &[f32], b: &[f32]) -> f64 {
    summed(a.iter().zip(b).map(|(a, b)| f64::from(*a) * f64::from(*b)))
}

fn squares(a: &[f32]) -> f64 {
    dot(a, a)
}

/// Solves approximately on the first grid, from zero or from its solution.
fn cycle(levels: &mut [Level], from_zero: bool) {
    /// Pairs of steps on the coarsest grid.
    const SWEEPS: usize = 4;
    /// Cycles on the coarser grid.
    const CYCLES: usize = 2;
    let Some((here, coarser)) = levels.split_first_mut() else { return };
    match from_zero {
        true => here.start(),
        false => here.smooth(DAMPING[0]),
    }
    here.smooth(DAMPING[1]);
    match coarser.first_mut() {
        Some(coarse) => {
            here.restrict(coarse);
            (0..CYCLES).for_each(|i| cycle(coarser, i == 0));
            here.correct(&coarser[0]);
            DAMPING.iter().for_each(|damping| here.smooth(*damping));
        }
        None => (0..SWEEPS).for_each(|_| DAMPING.iter().for_each(|damping| here.smooth(*damping))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solutions_have_the_residual_asked_for_on_any_grid() {
        // A rectangle with a hole and a separate part, with weights that differ by a factor of 10,000.
        let cells = Cells { width: 43, height: 37 };
        let inside = |x: usize, y: usize| {
            x < 43 && y < 37 && !((10..18).contains(&x) && (8..30).contains(&y)) && x != 33
        };
        let mut edges = Edges::none(cells);
        let mut truth = vec![0.0; cells.count()];
        for (x, y) in (0..37).flat_map(|y| (0..43).map(move |x| (x, y))).filter(|(x, y)| inside(*x, *y)) {
            let at = cells.at([x, y]);
            let weight = if (x + 2 * y) % 7 == 0 { 1e-4 } else { 1.0 };
            edges.right[at] = if inside(x + 1, y) { weight } else { 0.0 };
            edges.below[at] = if inside(x, y + 1) { weight } else { 0.0 };
            truth[at] = ((x * 37 + y * 61) % 101) as f64;
        }
        let mut system = Multigrid::new(cells);
        system.change(|all| *all = edges.clone());
        let times = |v: &[f64]| {
            let mut product = vec![0.0; cells.count()];
            let step = |a: usize, b: usize, weight: f32, product: &mut [f64]| {
                let difference = f64::from(weight) * (v[a] - v[b]);
                product[a] += difference;
                product[b] -= difference;
            };
            for at in 0..cells.count() - cells.stride() {
                step(at, at + 1, edges.right[at], &mut product);
                step(at, at + cells.stride(), edges.below[at], &mut product);
            }
            product
        };
        let target = times(&truth);
        let size = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let mut found = vec![0.0; cells.count()];
        // Each pass gains what single precision allows.
        for pass in 0..3 {
            let left: Vec<f64> = times(&found).iter().zip(&target).map(|(a, b)| b - a).collect();
            let steps = system.add_solution(&left, &mut found, 1e-3);
            assert!((1..30).contains(&steps), "{pass}: {steps}");
        }
        let left: Vec<f64> = times(&found).iter().zip(&target).map(|(a, b)| b - a).collect();
        assert!(size(&left) <= 1e-8 * size(&target), "{}", size(&left) / size(&target));
        assert!(system.levels.len() > 3);
    }
}
