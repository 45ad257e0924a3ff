//! The viewpoints from which a surface is seen: from all sides, or from the free space of a room.

use super::area_samples::sample_area;
use super::textured_mesh::TexturedMesh;
use crate::math::{Vec3, scalar};
use crate::mesh::{Mesh, Point};
use crate::parallel;
use crate::surface::facet_normal;
use crate::trace::{Bvh, Ray};

/// Number of fixed directions in which a point may be seen from outside.
const DIRECTIONS: usize = 256;
/// Number of points at which the visible share of a surface is estimated.
const POINTS: usize = 2_000;
/// If a smaller share of the surface is visible from outside, it may be the inside of something.
const LEAST_OUTSIDE: f64 = 0.5;
/// Rays start this fraction of the diagonal above the surface.
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

impl Sights {
    /// Returns the viewpoints in the free space of an interior; none if the surface is seen from outside.
    pub fn places(&self) -> &[Vec3] {
        &self.places
    }

    /// Determines if a surface is seen from outside or from within.
    pub fn of(ground: Ground<'_>) -> Self {
        let diagonal = ground.surface.mesh().diagonal() as f32;
        let outside = Self { directions: sphere_directions(DIRECTIONS), diagonal, ..Self::default() };
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

    /// Returns `true` if only surfaces made transparent by alpha are between the ray's origin and the distance
    /// `limit`.
    fn is_free(&self, ground: Ground<'_>, ray: &Ray, limit: f32) -> bool {
        let Ground { surface, bvh } = ground;
        let is_shown = |triangle: u32| {
            let is_front = surface.mesh().faces(triangle, ray.direction());
            !self.is_drawn || is_front || surface.material(triangle).double_sided
        };
        !bvh.occluded(ray, limit, |hit| is_shown(hit.triangle) && surface.is_opaque_at(hit.point()))
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

    /// Returns the best line of sight to a point; `None` if it is hidden.
    pub fn sight_line(&self, ground: Ground<'_>, point: Point) -> Option<SightLine> {
        let normal = facet_normal(ground.surface.mesh().corners(point.triangle as usize))?;
        let front = self.sight_line_on(ground, point, normal);
        let is_double = ground.surface.material(point.triangle).double_sided;
        if is_double { front.or_else(|| self.sight_line_on(ground, point, -normal)) } else { front }
    }

    /// Returns `true` if the side of a point that faces `direction` is visible.
    pub fn is_side_visible(&self, ground: Ground<'_>, point: Point, direction: Vec3) -> bool {
        let Some(normal) = facet_normal(ground.surface.mesh().corners(point.triangle as usize)) else {
            return false;
        };
        let side = if normal.dot(direction) < 0.0 { -normal } else { normal };
        self.sight_line_on(ground, point, side).is_some()
    }

    fn far(&self) -> f32 {
        self.diagonal * 4.0
    }

    /// Returns the line closest to `normal` on the normal's side of the facet.
    fn sight_line_on(&self, ground: Ground<'_>, point: Point, normal: Vec3) -> Option<SightLine> {
        let start = point.position(ground.surface.mesh()) + normal * (self.diagonal * OFFSET);
        match self.places.is_empty() {
            true => self.line_outward(ground, start, normal),
            false => self.line_to_place(ground, start, normal),
        }
    }

    fn line_outward(&self, ground: Ground<'_>, start: Vec3, normal: Vec3) -> Option<SightLine> {
        let escapes = |toward: Vec3| self.is_free(ground, &Ray::new(start, toward), self.far());
        let line = |toward: Vec3| SightLine { toward, distance: self.far() };
        if escapes(normal) {
            return Some(line(normal));
        }
        let mut on_front: Vec<(f32, Vec3)> = self
            .directions
            .iter()
            .map(|direction| (direction.dot(normal), *direction))
            .filter(|(cosine, _)| *cosine > 0.0)
            .collect();
        on_front.sort_by(|a, b| b.0.total_cmp(&a.0));
        on_front.into_iter().map(|(_, toward)| toward).find(|toward| escapes(*toward)).map(line)
    }

    fn line_to_place(&self, ground: Ground<'_>, start: Vec3, normal: Vec3) -> Option<SightLine> {
        let mut lines: Vec<(f32, SightLine)> = self
            .places
            .iter()
            .map(|place| {
                let (away, distance) = (*place - start, (*place - start).length());
                let toward = away * (1.0 / distance.max(f32::MIN_POSITIVE));
                (toward.dot(normal), SightLine { toward, distance })
            })
            .filter(|(cosine, _)| *cosine > 0.0)
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
