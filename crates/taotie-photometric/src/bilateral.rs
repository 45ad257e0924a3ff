//! Heights from normals by bilateral integration: Cao, Santo, Shi, Okura and Matsushita 2022.
//!
//! A height differs from its neighbour's by the slope of the surface between them, unless there is an edge in between. On
//! each axis a pixel has a neighbour on both sides, and of two that contradict each other, the one with the smaller step
//! is on the same surface. Weights and heights are found in turn. Each round only has to come closer, so its system is
//! solved roughly, and heights overshoot in the direction of the last change (Polyak 1964): where parts slide along a
//! depth edge, they do so for many rounds.

use crate::cells::{Cells, over, summed};
use crate::grid::Grid;
use crate::multigrid::{Edges, Multigrid};
use taotie_engine::Progress;
use taotie_engine::error::Result;
use taotie_engine::math::{Lane, Vec3};

/// How sharply a side is preferred: the value of the publication.
const SHARPNESS: f32 = 2.0;
/// The most rounds.
const ROUNDS: usize = 120;
/// The relative change of the energy below which rounds end.
const ENOUGH: f64 = 5e-5;
/// The residual of a round's system after its solution, relative to that before.
const ROUGH: f64 = 0.1;
/// The same of the first round.
const PRECISE: f64 = 1e-3;
/// The part of the last change by which heights overshoot: what it grows by in each round, and the most. It is 0 after
/// the energy has risen.
const OVERSHOOT: [f64; 2] = [0.2, 0.8];
/// Weight of a pair that both sides reject: parts stay where their neighbours are.
const LEAST: f64 = 1e-6;
/// Normals count as having at least this z, as grazing ones are uncertain.
const LEAST_Z: f64 = 0.05;

/// Returns the height of each pixel in pixels, from its unit normal.
///
/// # Errors
/// [`taotie_engine::Error::Cancelled`].
pub fn heights(grid: &Grid, normals: &[Vec3<f64>], progress: Progress<'_>) -> Result<Vec<f64>> {
    let field = Field::new(grid, normals);
    let mut system = Multigrid::new(field.cells);
    let mut state = State::new(field.cells);
    let (mut before, mut overshoot) = (f64::INFINITY, 0.0);
    for round in 0..ROUNDS {
        progress.at(round as f64 / ROUNDS as f64)?;
        field.choose_sides(&mut state);
        system.change(|edges| field.weigh(&state.sides, edges));
        let energy = field.misfit(&mut state);
        if (before - energy).abs() <= ENOUGH * energy {
            break;
        }
        let tolerance = if round == 0 { PRECISE } else { ROUGH };
        system.add_solution(&state.residual, &mut state.heights, tolerance);
        overshoot = match round == 0 || energy > before {
            true => 0.0,
            false => OVERSHOOT[1].min(overshoot + OVERSHOOT[0]),
        };
        before = energy;
        state.overshoot(overshoot);
    }
    Ok(field.places.iter().map(|place| state.heights[*place as usize]).collect())
}

/// Returns the step to the next pixel that a normal implies, to the right or upwards.
pub fn slope(n: Vec3<f64>, axis: usize) -> f64 {
    -[n.x, n.y][axis] / n.z.max(LEAST_Z)
}

/// The normals, on the cells of the smallest rectangle around them.
struct Field {
    cells: Cells,
    /// The cell of each pixel.
    places: Vec<u32>,
    /// The z of the normal; 0 outside.
    z: Vec<f64>,
    /// n_z², which weighs a pixel's steps; 0 outside.
    weights: Vec<f64>,
    /// The steps to the right and upwards that the normal implies.
    slopes: [Vec<f64>; 2],
}

/// The numbers that change from round to round.
struct State {
    cells: Cells,
    heights: Vec<f64>,
    /// The heights that the last round solved for.
    solved: Vec<f64>,
    /// How much the neighbour on the right and that above count, in [0, 1]; those on the other side have the rest.
    sides: [Vec<f64>; 2],
    /// Half the derivative of the energy by the steps to the right and upwards.
    pulls: [Vec<f64>; 2],
    /// Half the negative derivative of the energy by the heights.
    residual: Vec<f64>,
}

impl State {
    fn new(cells: Cells) -> Self {
        let none = || vec![0.0; cells.count()];
        let pair = || [none(), none()];
        Self { cells, heights: none(), solved: none(), sides: pair(), pulls: pair(), residual: none() }
    }

    /// Moves the heights on by a part of their last change.
    fn overshoot(&mut self, part: f64) {
        let rows = self.cells.rows(&mut self.heights).zip(self.cells.rows(&mut self.solved));
        over(rows, |_, (heights, solved)| {
            for (height, solved) in heights.iter_mut().zip(solved.iter_mut()) {
                let change = *height - *solved;
                *solved = *height;
                *height += part * change;
            }
            0.0
        });
    }
}

impl Field {
    fn new(grid: &Grid, normals: &[Vec3<f64>]) -> Self {
        let (cells, places) = Cells::around(grid);
        let spread = |value: &dyn Fn(Vec3<f64>) -> f64| {
            let mut all = vec![0.0; cells.count()];
            places.iter().zip(normals).for_each(|(place, n)| all[*place as usize] = value(*n));
            all
        };
        let z = spread(&|n| n.z);
        let weights = spread(&|n| n.z.max(LEAST_Z) * n.z.max(LEAST_Z));
        let slopes = [spread(&|n| slope(n, 0)), spread(&|n| slope(n, 1))];
        Self { cells, places, z, weights, slopes }
    }

    /// Of two neighbours, the one with the smaller step counts more.
    fn choose_sides(&self, state: &mut State) {
        let cells = self.cells;
        let heights = &state.heights;
        let [across, up] = &mut state.sides;
        over(cells.rows(across).zip(cells.rows(up)), |y, (across, up)| {
            let [h, z, is] = [heights, &self.z, &self.weights].map(|all| cells.row(all, y));
            for x in 1..=cells.width {
                let side = |forward: [f64; 2], backward: [f64; 2]| {
                    let [a, b] =
                        [forward, backward].map(|[height, _]| (z.here[x] * (height - h.here[x])) as f32);
                    let preference = SHARPNESS * (b * b - a * a);
                    let side = f64::from(1.0 / (1.0 + Lane::exp(-preference.clamp(-60.0, 60.0))));
                    match (forward[1] > 0.0, backward[1] > 0.0) {
                        (true, true) => side,
                        (is_forward, _) => f64::from(u8::from(is_forward)),
                    }
                };
                across[x] = side([h.here[x + 1], is.here[x + 1]], [h.here[x - 1], is.here[x - 1]]);
                up[x] = side([h.above[x], is.above[x]], [h.below[x], is.below[x]]);
            }
            0.0
        });
    }

    /// Sets the weights of the least squares n_z · step = −n_x or −n_y, over both ends of each edge.
    fn weigh(&self, sides: &[Vec<f64>; 2], edges: &mut Edges) {
        let cells = self.cells;
        let rows = cells.rows(&mut edges.right).zip(cells.rows(&mut edges.below));
        over(rows, |y, (right, below)| {
            let [weight, across, up] = [&self.weights, &sides[0], &sides[1]].map(|all| cells.row(all, y));
            for x in 1..=cells.width {
                let sum = |[a, b]: [f64; 2], [of_a, of_b]: [f64; 2]| match a > 0.0 && b > 0.0 {
                    true => (of_a * a + of_b * b + LEAST) as f32,
                    false => 0.0,
                };
                let [here, next, beneath] = [weight.here[x], weight.here[x + 1], weight.below[x]];
                right[x] = sum([here, next], [across.here[x], 1.0 - across.here[x + 1]]);
                // The cell below looks up.
                below[x] = sum([here, beneath], [1.0 - up.here[x], up.below[x]]);
            }
            0.0
        });
    }

    /// Computes the residual of the least squares, and returns the energy: the sum of the weighted squares.
    fn misfit(&self, state: &mut State) -> f64 {
        let cells = self.cells;
        let State { heights, sides, pulls: [right, up], residual, .. } = state;
        let energy = over(cells.rows(right).zip(cells.rows(up)), |y, (right, up)| {
            let [h, weight] = [heights, &self.weights].map(|all| cells.row(all, y));
            let [across, along] = sides.each_ref().map(|all| cells.row(all, y));
            let [p, q] = self.slopes.each_ref().map(|all| cells.row(all, y));
            summed((1..=cells.width).map(|x| {
                let step = h.here[x + 1] - h.here[x];
                let weights = [weight.here[x], weight.here[x + 1]];
                let sides = [across.here[x], 1.0 - across.here[x + 1]];
                let of_right = pull(step, weights, sides, [p.here[x], p.here[x + 1]]);
                let step = h.above[x] - h.here[x];
                let sides = [along.here[x], 1.0 - along.above[x]];
                let of_up = pull(step, [weight.here[x], weight.above[x]], sides, [q.here[x], q.above[x]]);
                (right[x], up[x]) = (of_right[0], of_up[0]);
                of_right[1] + of_up[1]
            }))
        });
        over(cells.rows(residual), |y, residual| {
            let [right, up] = [&*right, &*up].map(|all| cells.row(all, y));
            for x in 1..=cells.width {
                residual[x] = right.here[x] - right.here[x - 1] + up.here[x] - up.below[x];
            }
            0.0
        });
        energy
    }
}

/// Returns half the derivative of an edge's energy by its step, and the energy; zeros without an edge. The weights, shares
/// and slopes are those of its two ends.
#[inline(always)]
fn pull(step: f64, weights: [f64; 2], sides: [f64; 2], slopes: [f64; 2]) -> [f64; 2] {
    let [a, b] = [weights[0] * sides[0], weights[1] * sides[1]];
    let [off_a, off_b] = slopes.map(|slope| step - slope);
    match weights[0] > 0.0 && weights[1] > 0.0 {
        true => [a * off_a + b * off_b + LEAST * step, a * off_a * off_a + b * off_b * off_b],
        false => [0.0; 2],
    }
}
