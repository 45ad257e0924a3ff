//! A cache of which sides of a surface's triangles can be seen.

use crate::mesh::{Mesh, Point};
use std::sync::atomic::{AtomicU8, Ordering};

/// Triangles with an edge longer than this fraction of the diagonal have cells of about this size.
const LARGE: f32 = 0.01;
/// Maximum number of cells along a side of a triangle.
const MOST_CUTS: u32 = 64;
/// Maximum number of cells of all large triangles; they have none if they need more.
const MOST_CELLS: usize = 1 << 24;

/// A cache of the visible sides of triangles. Small triangles are visible or hidden as a whole, by their centroid.
/// Large ones have cells: a cell whose centroid and corners are all visible or all hidden is so as a whole, others
/// are tested point by point.
pub(super) struct SeenCells {
    /// The known state of small triangles, two bits per side, front first.
    small: Box<[AtomicU8]>,
    /// The large triangles, in order.
    large: Vec<Large>,
    /// The known state of their cells, likewise.
    cells: Box<[AtomicU8]>,
    /// The mesh's diagonal, model units.
    diagonal: f32,
}

/// The known state of a side.
const UNKNOWN: u8 = 0;
const HIDDEN: u8 = 1;
const SEEN: u8 = 2;
const MIXED: u8 = HIDDEN | SEEN;

/// A triangle with cells.
struct Large {
    triangle: u32,
    /// Its first cell.
    first: u32,
    /// Cells along a side.
    cuts: u32,
}

/// A cell of a large triangle.
struct Cell<'a> {
    state: &'a AtomicU8,
    /// The corners of the cell, by the weights of the triangle's corners.
    corners: [[f32; 3]; 3],
}

impl SeenCells {
    /// Makes an empty memory for a mesh with this diagonal, model units.
    pub fn new(mesh: &Mesh, diagonal: f32) -> Self {
        let unknown = |count: usize| (0..count).map(|_| AtomicU8::new(0)).collect();
        let (mut large, mut count) = (Vec::new(), 0);
        for triangle in 0..mesh.triangles().len() as u32 {
            let edge = longest_edge(mesh, triangle);
            if edge <= diagonal * LARGE {
                continue;
            }
            let cuts = ((edge / (diagonal * LARGE)).ceil() as u32).clamp(1, MOST_CUTS);
            large.push(Large { triangle, first: count as u32, cuts });
            count += (cuts * cuts) as usize;
            if count > MOST_CELLS {
                (large, count) = (Vec::new(), 0);
                break;
            }
        }
        Self { small: unknown(mesh.triangles().len()), large, cells: unknown(count), diagonal }
    }

    /// Returns `true` if the front, or the back, of a point can be seen, by the answers of `look`.
    pub fn is_seen(
        &self,
        mesh: &Mesh,
        (point, is_front): (Point, bool),
        look: impl Fn(Point) -> bool,
    ) -> bool {
        let shift = if is_front { 0 } else { 2 };
        let triangle = point.triangle;
        let at = |weights: [f32; 3]| Point { triangle, weights };
        let answer = |weights: [f32; 3]| if look(at(weights)) { SEEN } else { HIDDEN };
        if longest_edge(mesh, triangle) <= self.diagonal * LARGE {
            let state = &self.small[triangle as usize];
            return remembered(state, shift, || answer([1.0 / 3.0; 3])) == SEEN;
        }
        let Some(Cell { state, corners }) = self.cell(point) else { return look(point) };
        let middle = std::array::from_fn(|k| corners.iter().map(|weights| weights[k]).sum::<f32>() / 3.0);
        let all = || corners.into_iter().fold(answer(middle), |all, weights| all | answer(weights));
        match remembered(state, shift, all) {
            MIXED => look(point),
            known => known == SEEN,
        }
    }

    /// Returns the cell that holds a point of a large triangle.
    fn cell(&self, point: Point) -> Option<Cell<'_>> {
        let found = self.large.binary_search_by_key(&point.triangle, |large| large.triangle).ok()?;
        let Large { first, cuts, .. } = self.large[found];
        let [_, u, v] = point.weights.map(|weight| (weight * cuts as f32).clamp(0.0, cuts as f32));
        let column = (u as u32).min(cuts - 1);
        let row = (v as u32).min(cuts - 1 - column);
        let (u, v) = (u - column as f32, v - row as f32);
        // Between the cells of a column that point the way of the triangle there are others that point the other way.
        let is_upper = u + v > 1.0 && column + row + 1 < cuts;
        let place = |u: u32, v: u32| {
            let [u, v] = [column + u, row + v].map(|i| i as f32 / cuts as f32);
            [1.0 - u - v, u, v]
        };
        let corners = match is_upper {
            true => [place(1, 0), place(1, 1), place(0, 1)],
            false => [place(0, 0), place(1, 0), place(0, 1)],
        };
        // All columns before have column · (2 · cuts − column) cells.
        let index = first + column * (2 * cuts - column) + 2 * row + u32::from(is_upper);
        Some(Cell { state: &self.cells[index as usize], corners })
    }
}

/// Returns the cached state of a side, or computes and caches it.
fn remembered(state: &AtomicU8, shift: u32, find: impl FnOnce() -> u8) -> u8 {
    let known = state.load(Ordering::Relaxed) >> shift & MIXED;
    if known != UNKNOWN {
        return known;
    }
    let found = find();
    state.fetch_or(found << shift, Ordering::Relaxed);
    found
}

/// Returns the length of a triangle's longest edge, model units.
fn longest_edge(mesh: &Mesh, triangle: u32) -> f32 {
    let [a, b, c] = mesh.corners(triangle as usize);
    (b - a).length().max((c - b).length()).max((a - c).length())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::mesh::MeshData;
    use std::collections::HashSet;

    fn triangle(side: f32) -> Mesh {
        let positions = [(0.0, 0.0), (side, 0.0), (0.0, side)].map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec();
        Mesh::new(MeshData { positions, triangles: vec![[0, 1, 2]], ..MeshData::default() }).unwrap()
    }

    /// Weights of points all over a triangle.
    fn points(steps: u32) -> impl Iterator<Item = Point> {
        let place = move |u: u32, v: u32| {
            let [u, v] = [u, v].map(|i| (i as f32 + 0.31) / (steps as f32 + 1.0));
            Point { triangle: 0, weights: [1.0 - u - v, u, v] }
        };
        (0..steps).flat_map(move |u| (0..steps - u).map(move |v| place(u, v)))
    }

    #[test]
    fn every_point_lies_in_the_cell_that_holds_it() {
        let mesh = triangle(1.0);
        let memory = SeenCells::new(&mesh, 20.0);
        let cuts = memory.large[0].cuts;
        assert_eq!((cuts, memory.cells.len()), (8, 64), "of 1.41 by 0.2");
        let mut met = HashSet::new();
        for point in points(60) {
            let Cell { state, corners } = memory.cell(point).unwrap();
            met.insert(std::ptr::from_ref(state));
            let p = |weights: [f32; 3]| Point { triangle: 0, weights }.position(&mesh);
            let [a, b, c] = corners.map(p);
            let at = p(point.weights);
            let side = |a: Vec3, b: Vec3| (b - a).cross(at - a).z;
            assert!([side(a, b), side(b, c), side(c, a)].iter().all(|s| *s > -1e-6), "{point:?} {corners:?}");
        }
        assert_eq!(met.len(), 64, "all cells");
    }

    #[test]
    fn only_cells_that_are_partly_seen_are_asked_about_point_by_point() {
        let mesh = triangle(1.0);
        let memory = SeenCells::new(&mesh, 20.0);
        let asked = std::cell::Cell::new(0);
        // The border runs through the middle of a row of cells.
        let border = 0.56;
        let look = |point: Point| {
            asked.set(asked.get() + 1);
            point.weights[1] > border
        };
        for point in points(60) {
            assert_eq!(memory.is_seen(&mesh, (point, true), look), point.weights[1] > border, "{point:?}");
        }
        asked.set(0);
        points(60).filter(|point| (point.weights[1] - border).abs() > 0.13).for_each(|point| {
            memory.is_seen(&mesh, (point, true), look);
        });
        assert_eq!(asked.get(), 0, "what is seen or hidden as a whole is known");
        assert!(
            memory.is_seen(&mesh, (points(60).next().unwrap(), false), |_| true),
            "the back is another side"
        );
    }

    #[test]
    fn small_triangles_are_seen_or_hidden_as_a_whole() {
        let mesh = triangle(0.1);
        let memory = SeenCells::new(&mesh, 20.0);
        let corner = Point { triangle: 0, weights: [1.0, 0.0, 0.0] };
        assert!(memory.is_seen(&mesh, (corner, true), |point| point.weights[0] < 0.5));
        assert!(memory.is_seen(&mesh, (corner, true), |_| false), "it is known");
    }
}
