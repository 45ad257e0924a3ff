//! The viewpoints from which a surface is seen, from all sides or from the free space of a room, and a cache of which
//! sides of its triangles can be seen from there.

use super::textured_mesh::TexturedMesh;
use crate::math::{Vec3, integration::hash, scalar};
use crate::mesh::{Mesh, Point, sample_area};
use crate::parallel;
use crate::surface::facet_normal;
use crate::trace::{Bvh, Ray};
use std::sync::atomic::{AtomicU8, Ordering};

/// Number of fixed directions in which a point may be seen from outside.
const DIRECTIONS: usize = 256;
/// Number of points at which the visible share of a surface is estimated.
const POINTS: usize = 2_000;
/// If a smaller share of the surface is visible from outside, it may be the inside of something.
const LEAST_OUTSIDE: f64 = 0.5;
/// Rays start this fraction of the diagonal above the surface, or farther if positions are rounded more coarsely.
const OFFSET: f32 = 1e-5;

/// A surface, indexed for rays.
#[derive(Clone, Copy)]
pub(super) struct Ground<'a> {
    pub surface: &'a TexturedMesh,
    pub bvh: &'a Bvh,
}

/// The viewpoints from which a surface is seen.
#[derive(Debug, Clone, Default)]
pub(super) struct Sights {
    directions: Vec<Vec3>,
    /// Viewpoints in the free space of an interior; empty if the surface is seen from outside.
    places: Vec<Vec3>,
    /// The surface's diagonal, model units.
    diagonal: f32,
    /// The height above the surface at which rays start, model units.
    offset: f32,
    /// `true` if only rendered surfaces hide anything: not the backs of materials that are not double-sided.
    is_drawn: bool,
}

/// A line of sight from a visible point to a viewer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SightLine {
    /// From the point to the viewer, unit.
    pub toward: Vec3,
    /// The distance of the viewer, in model units; beyond the whole surface if it is seen from outside.
    pub distance: f32,
}

/// The side of a point from which it is looked at.
#[derive(Debug, Clone, Copy)]
struct Facing {
    /// The normal of that side, unit.
    normal: Vec3,
    /// The cosine to it that directions exceed.
    least: f32,
    /// One in this many directions is tried.
    stride: usize,
}

impl Facing {
    /// All directions on the normal's side.
    fn any(normal: Vec3) -> Self {
        Self { normal, least: 0.0, stride: 1 }
    }

    /// A few directions, not at a slant: through openings, much of an inside is seen at a slant.
    fn plain(normal: Vec3) -> Self {
        Self { normal, least: 0.5, stride: 4 }
    }
}

impl Sights {
    /// Returns the viewpoints in the free space of an interior; none if the surface is seen from outside.
    pub fn places(&self) -> &[Vec3] {
        &self.places
    }

    /// Determines if a surface is seen from outside or from within.
    pub fn of(ground: Ground<'_>) -> Self {
        let mesh = ground.surface.mesh();
        let diagonal = mesh.diagonal() as f32;
        let offset = (diagonal * OFFSET).max(mesh.rounding());
        let outside = Self { directions: sphere_directions(DIRECTIONS), diagonal, offset, ..Self::default() };
        let share = outside.visible_share(ground);
        if share >= LEAST_OUTSIDE {
            return outside;
        }
        let within = Self { places: free_places(ground), ..outside.clone() };
        // A statue with cavities has little that is visible from outside, and even less from its largest cavity.
        if within.visible_share(ground) > share { within } else { outside }
    }

    /// Returns the same viewpoints, for an asset as a renderer draws it.
    pub fn of_asset(&self) -> Self {
        Self { is_drawn: true, ..self.clone() }
    }

    /// Returns `true` if only surfaces that can be seen through are between the ray's origin and the distance `limit`.
    fn is_free(&self, ground: Ground<'_>, ray: &Ray, limit: f32) -> bool {
        let Ground { surface, bvh } = ground;
        let is_shown = |triangle: u32| {
            let is_front = surface.mesh().faces(triangle, ray.direction());
            !self.is_drawn || is_front || surface.material(triangle).double_sided
        };
        !bvh.occluded(ray, limit, |hit| is_shown(hit.triangle) && surface.is_solid_at(hit.point()))
    }

    /// Returns the surface's diagonal, model units.
    pub fn reach(&self) -> f32 {
        self.diagonal
    }

    /// Returns the share of the area that is visible, [0, 1]; 1 without area.
    fn visible_share(&self, ground: Ground<'_>) -> f64 {
        let Ok(point) = sample_area(ground.surface.mesh(), POINTS) else { return 1.0 };
        parallel::count(POINTS, |i| self.sight_line(ground, point(i)).is_some()) as f64 / POINTS as f64
    }

    /// Returns the best line of sight to a point; `None` if it is hidden. Half of the points of double-sided materials, chosen
    /// by their weights, are seen from the back if that is in plain view; the others only if their front is hidden.
    pub fn sight_line(&self, ground: Ground<'_>, point: Point) -> Option<SightLine> {
        let normal = facet_normal(ground.surface.mesh().corners(point.triangle as usize))?;
        let front = || self.sight_line_on(ground, point, Facing::any(normal));
        if !ground.surface.material(point.triangle).double_sided {
            return front();
        }
        let is_back = hash(point.triangle, point.weights[0].to_bits()) & 1 == 1;
        let plain = if is_back { self.sight_line_on(ground, point, Facing::plain(-normal)) } else { None };
        plain.or_else(front).or_else(|| self.sight_line_on(ground, point, Facing::any(-normal)))
    }

    /// Returns `true` if a point is visible on the side of `normal`, unit.
    pub fn is_side_visible(&self, ground: Ground<'_>, point: Point, normal: Vec3) -> bool {
        self.sight_line_on(ground, point, Facing::any(normal)).is_some()
    }

    fn far(&self) -> f32 {
        self.diagonal * 4.0
    }

    /// Returns the line closest to the normal on its side of the facet.
    fn sight_line_on(&self, ground: Ground<'_>, point: Point, facing: Facing) -> Option<SightLine> {
        let start = point.position(ground.surface.mesh()) + facing.normal * self.offset;
        match self.places.is_empty() {
            true => self.line_outward(ground, start, facing),
            false => self.line_to_place(ground, start, facing),
        }
    }

    fn line_outward(&self, ground: Ground<'_>, start: Vec3, facing: Facing) -> Option<SightLine> {
        let escapes = |toward: Vec3| self.is_free(ground, &Ray::new(start, toward), self.far());
        let line = |toward: Vec3| SightLine { toward, distance: self.far() };
        if escapes(facing.normal) {
            return Some(line(facing.normal));
        }
        let mut on_front: Vec<(f32, Vec3)> = self
            .directions
            .iter()
            .step_by(facing.stride)
            .map(|direction| (direction.dot(facing.normal), *direction))
            .filter(|(cosine, _)| *cosine > facing.least)
            .collect();
        on_front.sort_by(|a, b| b.0.total_cmp(&a.0));
        on_front.into_iter().map(|(_, toward)| toward).find(|toward| escapes(*toward)).map(line)
    }

    fn line_to_place(&self, ground: Ground<'_>, start: Vec3, facing: Facing) -> Option<SightLine> {
        let mut lines: Vec<(f32, SightLine)> = self
            .places
            .iter()
            .map(|place| {
                let (away, distance) = (*place - start, (*place - start).length());
                let toward = away * (1.0 / distance.max(f32::MIN_POSITIVE));
                (toward.dot(facing.normal), SightLine { toward, distance })
            })
            .filter(|(cosine, _)| *cosine > facing.least)
            .collect();
        lines.sort_by(|a, b| b.0.total_cmp(&a.0));
        let is_free = |line: &SightLine| self.is_free(ground, &Ray::new(start, line.toward), line.distance);
        lines.into_iter().map(|(_, line)| line).find(is_free)
    }
}

/// Returns `count` unit vectors spread evenly over the sphere, the same for every surface.
///
/// Source: Keinert et al. 2015, "Spherical Fibonacci Mapping", eq. 1.
pub fn sphere_directions(count: usize) -> Vec<Vec3> {
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    let direction = |i: usize| {
        let z = 1.0 - (2 * i + 1) as f64 / count as f64;
        let (r, turn) = ((1.0 - z * z).max(0.0).sqrt(), i as f64 * golden);
        let angle = 2.0 * std::f64::consts::PI * (turn - turn.floor());
        Vec3::new(scalar::cos(angle) * r, scalar::sin(angle) * r, z).to_f32()
    };
    (0..count).map(direction).collect()
}

/// Maximum number of viewpoints for an interior.
const MOST_PLACES: usize = 64;
/// Cells along the longest side of the grid used to search for free space.
const CELLS: usize = 24;

/// Returns viewpoints spread over the largest enclosed free space of a surface; none if no space is enclosed.
fn free_places(ground: Ground<'_>) -> Vec<Vec3> {
    let grid = Grid::around(ground.surface.mesh());
    let directions = sphere_directions(32);
    let far = (ground.surface.mesh().diagonal() * 4.0) as f32;
    // Enclosed: all but a few directions hit the surface, as with a door or the mouth of a cave.
    let is_enclosed = |place: Vec3| {
        let met = directions.iter().filter(|d| ground.bvh.occluded(&Ray::new(place, **d), far, |_| true));
        met.count() * 4 >= directions.len() * 3
    };
    let clearance = |cell: usize| {
        let place = grid.center(cell);
        let free = ground.bvh.closest(place, f32::INFINITY).map_or(0.0, |closest| closest.distance);
        if free > grid.side && is_enclosed(place) { free } else { 0.0 }
    };
    let free = parallel::collect(grid.cell_count(), clearance);
    let widest = (0..free.len()).fold(0, |best, i| if free[i] > free[best] { i } else { best });
    if free.get(widest).is_none_or(|clearance| *clearance <= 0.0) {
        return Vec::new();
    }
    let connected = grid.connected(widest, &free);
    let count = connected.len().min(MOST_PLACES);
    (0..count).map(|i| grid.center(connected[i * connected.len() / count])).collect()
}

/// A grid of cubes around a mesh.
struct Grid {
    origin: Vec3,
    side: f32,
    counts: [usize; 3],
}

impl Grid {
    fn around(mesh: &Mesh) -> Self {
        let none = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
        let [low, high] = mesh.positions().iter().fold(none, |[low, high], position| {
            let p = position.to_array();
            [std::array::from_fn(|i| low[i].min(p[i])), std::array::from_fn(|i| high[i].max(p[i]))]
        });
        let longest = (0..3).fold(f32::MIN_POSITIVE, |most, i| most.max(high[i] - low[i]));
        let side = longest / CELLS as f32;
        let counts = std::array::from_fn(|i| (((high[i] - low[i]) / side).ceil() as usize).clamp(1, CELLS));
        Self { origin: Vec3::from_array(low), side, counts }
    }

    fn cell_count(&self) -> usize {
        self.counts.iter().product()
    }

    fn center(&self, cell: usize) -> Vec3 {
        let [x, y, _] = self.counts;
        let at = [cell % x, cell / x % y, cell / (x * y)];
        self.origin + Vec3::from_array(at.map(|i| (i as f32 + 0.5) * self.side))
    }

    /// Returns the free cells that can be reached from `first` through the faces of free cells, in order.
    fn connected(&self, first: usize, free: &[f32]) -> Vec<usize> {
        let [x, y, z] = self.counts;
        let mut is_reached = vec![false; free.len()];
        let mut waiting = vec![first];
        is_reached[first] = true;
        while let Some(cell) = waiting.pop() {
            let at = [cell % x, cell / x % y, cell / (x * y)];
            let steps = [1, x, x * y].into_iter().zip(at).zip([x, y, z]);
            for ((step, i), count) in steps {
                let below = (i > 0).then(|| cell - step);
                let above = (i + 1 < count).then(|| cell + step);
                for next in below.into_iter().chain(above) {
                    if free[next] > 0.0 && !is_reached[next] {
                        is_reached[next] = true;
                        waiting.push(next);
                    }
                }
            }
        }
        (0..free.len()).filter(|cell| is_reached[*cell]).collect()
    }
}

/// Triangles with an edge longer than this fraction of the diagonal have cells of about this size.
const LARGE: f32 = 0.01;
/// Maximum number of cells along a side of a triangle.
const MOST_CUTS: u32 = 64;
/// Maximum number of cells of all large triangles; they have none if they need more.
const MOST_CELLS: usize = 1 << 24;

/// A cache of the visible sides of triangles. Small triangles are one cell, large ones have several: a cell that is visible
/// at all corners, or hidden there and at its centroid, is so as a whole; others are tested point by point. Small triangles
/// share what is known of their vertices.
pub(super) struct SeenCells {
    /// The known state of small triangles, two bits per side, front first.
    small: Box<[AtomicU8]>,
    /// The known state of vertices, on the side of their normals and on the other.
    vertices: Box<[AtomicU8]>,
    /// The large triangles, in order.
    large: Vec<Large>,
    /// The known state of their cells, likewise.
    cells: Box<[AtomicU8]>,
    /// The mesh's diagonal, model units.
    diagonal: f32,
}

/// The corners of a triangle.
const WHOLE: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

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
    /// Creates an empty cache for a mesh with this diagonal, model units.
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
        let vertices = unknown(mesh.normals().len());
        Self { small: unknown(mesh.triangles().len()), vertices, large, cells: unknown(count), diagonal }
    }

    /// Returns `true` if the front, or the back, of a point can be seen, by the answers of `look` for points and the unit
    /// normals of their sides.
    pub fn is_seen(
        &self,
        mesh: &Mesh,
        (point, is_front): (Point, bool),
        look: impl Fn(Point, Vec3) -> bool,
    ) -> bool {
        let triangle = point.triangle;
        let side = || facet_normal(mesh.corners(triangle as usize)).map(|n| if is_front { n } else { -n });
        let is_small = longest_edge(mesh, triangle) <= self.diagonal * LARGE;
        let whole = || Cell { state: &self.small[triangle as usize], corners: WHOLE };
        let cell = if is_small { Some(whole()) } else { self.cell(point) };
        let Some(Cell { state, corners }) = cell else { return side().is_some_and(|side| look(point, side)) };
        let all = || {
            let Some(side) = side() else { return HIDDEN };
            let at = |weights: [f32; 3]| Point { triangle, weights };
            let answer = |weights: [f32; 3]| if look(at(weights), side) { SEEN } else { HIDDEN };
            let vertices = mesh.triangles()[triangle as usize];
            let corner = |k: usize| match mesh.normals().get(vertices[k] as usize).filter(|_| is_small) {
                Some(normal) => {
                    self.at_vertex((vertices[k], *normal), side, |side| look(at(corners[k]), side))
                }
                None => answer(corners[k]),
            };
            let middle = std::array::from_fn(|k| corners.iter().map(|weights| weights[k]).sum::<f32>() / 3.0);
            match corner(0) | corner(1) | corner(2) {
                SEEN => SEEN,
                all => all | answer(middle),
            }
        };
        match remembered(state, if is_front { 0 } else { 2 }, all) {
            MIXED => side().is_some_and(|side| look(point, side)),
            known => known == SEEN,
        }
    }

    /// Returns the state of a triangle's corner on a side, by the answers of `look` for sides there: that of its vertex
    /// along the vertex's normal, which all triangles around share, unless that is steep.
    fn at_vertex(&self, (vertex, normal): (u32, Vec3), side: Vec3, look: impl Fn(Vec3) -> bool) -> u8 {
        /// The cosine of 60°.
        const STEEP: f32 = 0.5;
        let state = |side: Vec3| if look(side) { SEEN } else { HIDDEN };
        let known = &self.vertices[vertex as usize];
        match normal.dot(side) {
            cosine if cosine >= STEEP => remembered(known, 0, || state(normal)),
            cosine if cosine <= -STEEP => remembered(known, 2, || state(-normal)),
            _ => state(side),
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
        let look = |point: Point, _: Vec3| {
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
            memory.is_seen(&mesh, (points(60).next().unwrap(), false), |_, _| true),
            "the back is another side"
        );
    }

    #[test]
    fn small_triangles_are_one_cell() {
        let mesh = triangle(0.1);
        let memory = SeenCells::new(&mesh, 20.0);
        let corner = Point { triangle: 0, weights: [1.0, 0.0, 0.0] };
        assert!(memory.is_seen(&mesh, (corner, true), |_, _| true));
        assert!(memory.is_seen(&mesh, (corner, true), |_, _| false), "it is known");
        let memory = SeenCells::new(&mesh, 20.0);
        for point in points(20) {
            let look = |point: Point, _: Vec3| point.weights[0] < 0.3;
            assert_eq!(memory.is_seen(&mesh, (point, true), look), point.weights[0] < 0.3, "half covered");
        }
    }

    #[test]
    fn small_triangles_share_their_vertices() {
        let ball = Mesh::sphere(1.0, 64, 32);
        let memory = SeenCells::new(&ball, 200.0);
        let asked = std::cell::Cell::new(0);
        let look = |point: Point, normal: Vec3| {
            asked.set(asked.get() + 1);
            assert!((normal - point.position(&ball)).length() < 0.1);
            true
        };
        let third = [1.0 / 3.0; 3];
        let middles = (0..ball.triangles().len() as u32).map(|triangle| Point { triangle, weights: third });
        middles.for_each(|middle| assert!(memory.is_seen(&ball, (middle, true), look)));
        assert!(asked.get() <= ball.positions().len(), "{} looks", asked.get());
        let hidden = |_: Point, _: Vec3| false;
        let back = Point { triangle: 9, weights: third };
        assert!(!memory.is_seen(&ball, (back, false), hidden), "the back is another side");
    }

    #[test]
    fn a_triangle_whose_corners_are_hidden_may_be_seen_between() {
        let mesh = triangle(0.1);
        let memory = SeenCells::new(&mesh, 20.0);
        for point in points(20) {
            let look = |point: Point, _: Vec3| point.weights.iter().all(|weight| *weight > 0.2);
            assert_eq!(memory.is_seen(&mesh, (point, true), look), look(point, Vec3::default()), "{point:?}");
        }
    }
}
