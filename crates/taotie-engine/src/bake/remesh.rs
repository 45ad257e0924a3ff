//! A watertight outer surface of a scan: of generated meshes and polygon soups with many shells, holes,
//! self-intersections and inner parts.
//!
//! A grid of voxels is divided into those outside and the rest. Voxels near a triangle are walls. The outside first
//! floods everything farther from all triangles than half the width of the holes to close. It then grows back to the
//! walls, and so does each cavity that the flood did not reach: in a hole they meet halfway. A plain morphological
//! closing would also round every corner off.
//!
//! The outside is made well-composed (Latecki 1997, "3D Well-Composed Pictures"), so that the faces between it and
//! the rest are a closed manifold, whatever the scan. Their corners are smoothed and moved towards the scan's closest
//! point, each along lines that cross no triangle. This needs no case table, and has a quarter of the triangles of
//! marching tetrahedra with six in each cube.

use super::faults::{by_place, whole_triangles};
use super::scan::Scan;
use crate::error::{Error, Result};
use crate::groups::{DisjointSets, Groups};
use crate::math::Vec3;
use crate::mesh::{Mesh, MeshData};
use crate::parallel;
use crate::progress::Progress;
use crate::surface;
use crate::trace::{Bvh, Ray};

/// The side of a voxel as a fraction of the scan's diagonal: a grid has at most 15 million voxels.
const SIDE: f64 = 0.0025;
/// The distance from all triangles beyond which the outside is flooded, voxels: holes up to twice as wide are closed.
const REACH: f64 = 4.0;
/// The number of voxels by which the outside grows back, along the axes. A right-angled corner needs three times
/// [`REACH`]; narrower gaps are kept to this depth.
const DEPTH: usize = 16;
/// The distance from a triangle up to which a voxel is a wall, in voxels: slightly more than half its diagonal, so that
/// every triangle is covered by walls, and a voxel that is none sees its eight corners.
const WALL: f64 = 0.867;
/// Empty voxels around the scan.
const MARGIN: usize = 6;
/// The distance from the scan at which the surface is smoothed, and its final distance, which keeps the two sides of
/// a sheet apart; voxels.
const AROUND: f32 = 0.9;
const ABOVE: f32 = 0.05;
/// Rounds of smoothing: of the surface, and of the parts that close holes.
const ROUNDS: usize = 4;
const CAP_ROUNDS: usize = 40;
/// A smaller ratio of the voxels' side to the largest coordinate is close to the rounding of coordinates.
const LEAST_RATIO: f64 = 1.0 / (1 << 20) as f64;

/// The number of bytes that [`remesh`] needs in addition to the scan.
pub const REMESH_BYTES: u64 = 512 << 20;

/// The maximum number of vertices, for which [`REMESH_BYTES`] suffice: ten times those of a ball.
const MOST_VERTICES: usize = 3_000_000;

/// A watertight outer surface.
#[derive(Debug, Clone)]
pub struct Remeshed {
    /// A closed manifold of positions and triangles that faces outward.
    pub mesh: Mesh,
    /// The changes.
    pub facts: Remesh,
}

/// The changes that a remesh made.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Remesh {
    /// Connected parts of the scan, joined at shared positions.
    pub scan_shells: usize,
    /// Borders of the scan: connected edges that only one triangle has.
    pub open_borders: usize,
    /// Connected parts of the closed surface.
    pub shells: usize,
    /// Triangles of the closed surface.
    pub triangles: usize,
    /// The enclosed volume, cubic model units.
    pub volume: f64,
    /// The width up to which holes and gaps are closed, model units.
    pub closing: f64,
}

/// Builds a watertight outer surface of a scan, with at most a few million triangles.
///
/// Nearly every vertex is 0.0125 % of the scan's diagonal outside a triangle that the outside reaches, except in the
/// parts that close a hole, up to half its width away. Holes narrower than 2 % of the diagonal are closed if they lead
/// to a wider cavity, and gaps narrower than that are filled beyond a depth of about 4 %; openings wider than 2.5 %
/// are kept. Sheets become thin closed shells. Parts that the outside does not reach are left out. The result does not
/// depend on the number of threads.
///
/// # Errors
/// [`Error::Cancelled`]; [`Error::Invalid`] if the mesh has no extent, or is so far from the origin that its
/// coordinates are too coarse.
pub fn remesh(scan: &Scan, progress: Progress<'_>) -> Result<Remeshed> {
    let bvh = scan.bvh();
    let grid = Grid::around(scan.mesh())?;
    let states = grid.classified(bvh, progress.part(0.0, 0.5))?;
    let voxels = Voxels { states, strides: grid.strides() }.divided();
    progress.at(0.6)?;
    let mut shell = Shell::of(&voxels, &grid)?;
    drop(voxels);
    for round in 0..ROUNDS {
        shell.smooth(scan);
        progress.at(0.6 + 0.3 * (round + 1) as f64 / ROUNDS as f64)?;
    }
    shell.lower(scan);
    shell.flatten_caps(bvh);
    progress.at(0.95)?;
    shell.separate(&grid);
    let mesh = shell.into_mesh()?;
    let facts = Remesh {
        scan_shells: shell_count(scan.mesh()),
        open_borders: open_borders(scan.mesh()),
        shells: shell_count(&mesh),
        triangles: mesh.triangles().len(),
        volume: volume(&mesh),
        closing: 2.0 * REACH * grid.side,
    };
    progress.at(1.0)?;
    Ok(Remeshed { mesh, facts })
}

/// A grid of cubes around a mesh. Points of the grid have the index of the voxel whose lowest corner they are.
struct Grid {
    origin: Vec3<f64>,
    /// Model units.
    side: f64,
    counts: [usize; 3],
}

/// A cube of voxels.
struct Cube {
    low: [usize; 3],
    /// Voxels along a side, a power of two.
    size: usize,
    /// An upper bound of the distance of its centre from the mesh, model units.
    bound: f32,
}

/// Some layers of a grid.
struct Slab {
    first: usize,
    states: Vec<u8>,
}

/// The states of voxels: farther than [`REACH`] from all triangles, at most that far, a wall, and outside.
const FAR: u8 = 0;
const BAND: u8 = 1;
const SOLID: u8 = 2;
const OUT: u8 = 3;

/// Layers of a slab, and voxels along the side of the cubes that are classified first.
const BLOCK: usize = 8;

impl Grid {
    fn around(mesh: &Mesh) -> Result<Self> {
        let side = mesh.diagonal() * SIDE;
        let pick = |of: fn(f64, f64) -> f64, start: f64| {
            let positions = mesh.positions().iter().map(|p| p.to_f64().to_array());
            positions.fold([start; 3], |all, p| std::array::from_fn(|i| of(all[i], p[i])))
        };
        let (low, high) = (pick(f64::min, f64::INFINITY), pick(f64::max, f64::NEG_INFINITY));
        let largest = low.iter().chain(&high).fold(0.0, |most: f64, v| most.max(v.abs()));
        if !(side > 0.0 && side > largest * LEAST_RATIO) {
            let why = "its coordinates are too coarse for its size: move it to the origin";
            return Err(Error::invalid("the scan to remesh", why));
        }
        let margin = side * MARGIN as f64;
        let count = |i: usize| ((high[i] - low[i]) / side).ceil() as usize + 2 * MARGIN;
        let origin = Vec3::from_array(low.map(|v| v - margin));
        Ok(Self { origin, side, counts: std::array::from_fn(count) })
    }

    fn strides(&self) -> [usize; 3] {
        let [x, y, _] = self.counts;
        [1, x, x * y]
    }

    /// Returns a place given in voxels, model units.
    fn place(&self, at: [f64; 3]) -> Vec3 {
        (self.origin + Vec3::from_array(at) * self.side).to_f32()
    }

    /// Returns a point of the grid.
    fn point(&self, index: usize) -> Vec3 {
        let [x, y, _] = self.counts;
        self.place([index % x, index / x % y, index / (x * y)].map(|i| i as f64))
    }

    /// Returns the states of all voxels by their distance from the mesh.
    fn classified(&self, bvh: &Bvh, progress: Progress<'_>) -> Result<Vec<u8>> {
        let [columns, rows, layers] = self.counts;
        let slabs = layers.div_ceil(BLOCK);
        let states = parallel::try_tasks(slabs, &|i| {
            progress.at(i as f64 / slabs as f64)?;
            let first = i * BLOCK;
            let count = BLOCK.min(layers - first);
            let mut slab = Slab { first, states: vec![FAR; columns * rows * count] };
            for y in (0..rows).step_by(BLOCK) {
                for x in (0..columns).step_by(BLOCK) {
                    let cube = Cube { low: [x, y, first], size: BLOCK, bound: f32::INFINITY };
                    self.classify(bvh, &cube, &mut slab);
                }
            }
            Ok(slab.states)
        })?;
        Ok(states.concat())
    }

    /// Sets the states of a cube whose voxels are all far.
    fn classify(&self, bvh: &Bvh, cube: &Cube, slab: &mut Slab) {
        let Cube { low, size, bound } = *cube;
        if (0..3).any(|i| low[i] >= self.counts[i]) {
            return;
        }
        let centre = self.place(low.map(|i| i as f64 + 0.5 * size as f64));
        let diagonal = |voxels: f64| voxels * 3f64.sqrt() * self.side;
        let around = diagonal(0.5 * (size - 1) as f64);
        let [wall, reach] = [WALL, REACH].map(|voxels| voxels * self.side);
        let Some(closest) = bvh.closest(centre, bound.min((reach + around) as f32)) else { return };
        let away = f64::from(closest.distance);
        if size == 1 {
            self.fill(cube, if away <= wall { SOLID } else { BAND }, slab);
        } else if away - around > wall && away + around < reach {
            self.fill(cube, BAND, slab);
        } else {
            let half = size / 2;
            let bound = ((away + diagonal(0.5 * half as f64)) * 1.001) as f32;
            for part in 0..8 {
                let low = std::array::from_fn(|i| low[i] + (part >> i & 1) * half);
                self.classify(bvh, &Cube { low, size: half, bound }, slab);
            }
        }
    }

    /// Sets the state of all voxels of a cube.
    fn fill(&self, &Cube { low, size, .. }: &Cube, state: u8, slab: &mut Slab) {
        let [x, y, z] = std::array::from_fn(|i| low[i]..(low[i] + size).min(self.counts[i]));
        for layer in z {
            for row in y.clone() {
                let start = self.counts[0] * (row + self.counts[1] * (layer - slab.first));
                slab.states[start + x.start..start + x.end].fill(state);
            }
        }
    }
}

/// The voxels of a grid. Those at its border are far and, once divided, outside: they have neighbours in the next row
/// or layer, which does no harm.
struct Voxels {
    states: Vec<u8>,
    strides: [usize; 3],
}

impl Voxels {
    /// Divides voxels into those outside and the rest, so that the faces between are a manifold.
    fn divided(mut self) -> Self {
        self.flood();
        self.grow();
        self.compose();
        // Filled voxels may have cut off some of the outside.
        let turned = |state| match state {
            OUT => FAR,
            SOLID => SOLID,
            _ => BAND,
        };
        parallel::change(&mut self.states, |_, state| *state = turned(*state));
        self.flood();
        self
    }

    /// Returns the six neighbours of a voxel.
    fn neighbours(&self, voxel: usize) -> impl Iterator<Item = usize> + use<> {
        let count = self.states.len();
        let both = self
            .strides
            .into_iter()
            .flat_map(move |stride| [voxel.checked_sub(stride), Some(voxel + stride)]);
        both.flatten().filter(move |next| *next < count)
    }

    /// Marks the far voxels that are connected with the first one as outside.
    fn flood(&mut self) {
        let mut waiting = vec![0];
        self.states[0] = OUT;
        while let Some(voxel) = waiting.pop() {
            for next in self.neighbours(voxel) {
                if self.states[next] == FAR {
                    self.states[next] = OUT;
                    waiting.push(next);
                }
            }
        }
    }

    /// Grows the outside and the cavities that it does not reach into the voxels between them and the walls, layer by
    /// layer.
    fn grow(&mut self) {
        let mut fronts = [OUT, FAR].map(|own| {
            let is_front = |voxel: usize| {
                self.states[voxel] == own && self.neighbours(voxel).any(|next| self.states[next] == BAND)
            };
            (own, parallel::filter(self.states.len(), is_front))
        });
        for _ in 0..DEPTH {
            for (own, front) in &mut fronts {
                let mut grown = Vec::new();
                for voxel in std::mem::take(front) {
                    for next in self.neighbours(voxel) {
                        if self.states[next] == BAND {
                            self.states[next] = *own;
                            grown.push(next);
                        }
                    }
                }
                *front = grown;
            }
        }
    }

    /// Returns which of the eight voxels around a point of the grid are not outside: bit x + 2 · y + 4 · z, in which 1 is
    /// the upper one along each axis.
    fn around(&self, point: usize) -> u8 {
        let lowest = point - self.strides.iter().sum::<usize>();
        (0..8).fold(0, |bits, i| bits | u8::from(self.states[self.voxel(lowest, i)] != OUT) << i)
    }

    /// Returns a voxel around a point, given the lowest and its bit.
    fn voxel(&self, lowest: usize, bit: usize) -> usize {
        lowest + (0..3).map(|axis| (bit >> axis & 1) * self.strides[axis]).sum::<usize>()
    }

    /// Returns the points of the grid between the outside and the rest.
    fn boundary(&self) -> Vec<usize> {
        let first = self.strides.iter().sum::<usize>();
        let is_mixed = |point: usize| !matches!(self.around(point), 0 | u8::MAX);
        let mut points = parallel::filter(self.states.len() - first, |i| is_mixed(first + i));
        points.iter_mut().for_each(|point| *point += first);
        points
    }

    /// Fills outside voxels until no two voxels on the same side of the surface touch only at an edge or a corner.
    fn compose(&mut self) {
        let first = self.strides.iter().sum::<usize>();
        let fills: [Option<usize>; 256] = std::array::from_fn(|around| filled(around as u8));
        let mut waiting = self.boundary();
        while let Some(point) = waiting.pop() {
            let Some(bit) = fills[usize::from(self.around(point))] else { continue };
            let voxel = self.voxel(point - first, bit);
            self.states[voxel] = BAND;
            waiting.extend((0..8).map(|i| self.voxel(voxel, i)));
        }
    }
}

/// Returns the voxel to fill if two of the voxels around a point touch only at an edge or a corner.
fn filled(around: u8) -> Option<usize> {
    let is_in = |bit: usize| around >> bit & 1 == 1;
    let face = |axis: usize, side: usize| {
        let (b, c) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        let low = side << axis;
        [low, low + b, low + b + c, low + c]
    };
    let faces = (0..3).flat_map(|axis| [face(axis, 0), face(axis, 1)]);
    let crossed = faces.into_iter().find(|face| {
        let [a, b, c, d] = face.map(is_in);
        a == c && b == d && a != b
    });
    let is_pair = |bits: u8| (0..4).any(|bit| bits == 1 << bit | 1 << (7 - bit));
    match crossed {
        Some(face) => face.into_iter().find(|bit| !is_in(*bit)),
        None if is_pair(around) || is_pair(!around) => (0..8).find(|bit| !is_in(*bit)),
        None => None,
    }
}

/// The faces between the outside and the rest.
struct Shell {
    /// The point of the grid of each vertex, ascending.
    points: Vec<usize>,
    positions: Vec<Vec3>,
    /// The neighbours of each vertex below and above along each axis; its own number if there is none.
    neighbours: Vec<[u32; 6]>,
    /// `true` if a vertex is at a wall; others close holes.
    is_near: Vec<bool>,
    /// Squares that face outward, counter-clockwise.
    quads: Vec<[u32; 4]>,
    /// The side of a voxel, model units.
    side: f32,
}

impl Shell {
    fn of(voxels: &Voxels, grid: &Grid) -> Result<Self> {
        let points = voxels.boundary();
        if points.len() > MOST_VERTICES {
            let why = format!(
                "its closed surface would have {} vertices, and {MOST_VERTICES} are allowed; remesh its parts separately",
                points.len()
            );
            return Err(Error::limit("the scan to remesh", why));
        }
        let first = voxels.strides.iter().sum::<usize>();
        let around = parallel::collect(points.len(), |v| voxels.around(points[v]));
        let neighbours = parallel::collect(points.len(), |v| {
            std::array::from_fn(|i| {
                let (axis, is_up) = (i / 2, i % 2 == 1);
                let along = (0..8).filter(|bit| (bit >> axis & 1 == 1) == is_up);
                let mask = along.fold(0, |mask, bit| mask | 1 << bit);
                if matches!(around[v] & mask, 0) || around[v] & mask == mask {
                    return v as u32;
                }
                let stride = voxels.strides[axis];
                let other = if is_up { points[v] + stride } else { points[v] - stride };
                points.binary_search(&other).unwrap_or(v) as u32
            })
        });
        let is_near = parallel::collect(points.len(), |v| {
            (0..8).any(|bit| voxels.states[voxels.voxel(points[v] - first, bit)] == SOLID)
        });
        let positions = parallel::collect(points.len(), |v| grid.point(points[v]));
        let quads = quads(&around, &neighbours);
        Ok(Self { points, positions, neighbours, is_near, quads, side: grid.side as f32 })
    }

    /// Moves each vertex to the mean of its neighbours, and those near the scan down to the distance [`AROUND`].
    fn smooth(&mut self, scan: &Scan) {
        self.positions = parallel::collect(self.positions.len(), |v| {
            let moved = self.averaged(scan.bvh(), v);
            if self.is_near[v] { self.lowered(scan, moved, AROUND) } else { moved }
        });
    }

    /// Moves the vertices near the scan down to the distance [`ABOVE`].
    fn lower(&mut self, scan: &Scan) {
        self.positions = parallel::collect(self.positions.len(), |v| {
            let own = self.positions[v];
            if self.is_near[v] { self.lowered(scan, own, ABOVE) } else { own }
        });
    }

    /// Smooths the parts that close holes.
    fn flatten_caps(&mut self, bvh: &Bvh) {
        let caps = parallel::filter(self.is_near.len(), |v| !self.is_near[v]);
        for _ in 0..CAP_ROUNDS {
            let moved = parallel::collect(caps.len(), |i| self.averaged(bvh, caps[i]));
            caps.iter().zip(moved).for_each(|(v, position)| self.positions[*v] = position);
        }
    }

    /// Returns the mean of a vertex's neighbours; its own position if a triangle is between.
    fn averaged(&self, bvh: &Bvh, v: usize) -> Vec3 {
        let own = self.positions[v];
        let others = self.neighbours[v].into_iter().filter(|other| *other as usize != v);
        let (sum, count) = others.fold((Vec3::splat(0.0), 0.0), |(sum, count), other| {
            (sum + (self.positions[other as usize] - own), count + 1.0)
        });
        let step = sum * (1.0 / f32::max(count, 1.0));
        let is_free = step != Vec3::splat(0.0) && !bvh.occluded(&Ray::new(own, step), 1.0, |_| true);
        if is_free { own + step } else { own }
    }

    /// Returns a place moved straight to the scan's closest point, up to a distance from it in voxels. No triangle is
    /// in between, since none is closer.
    fn lowered(&self, scan: &Scan, from: Vec3, distance: f32) -> Vec3 {
        /// Vertices at a wall are closer than this, in voxels.
        const MOST: f32 = 3.0;
        let Some(closest) = scan.bvh().closest(from, MOST * self.side) else { return from };
        let part = 1.0 - distance * self.side / closest.distance.max(f32::MIN_POSITIVE);
        if part > 0.0 { from + (closest.point().position(scan.mesh()) - from) * part } else { from }
    }

    /// Returns vertices with equal positions to their points of the grid, which all differ, until none are left.
    fn separate(&mut self, grid: &Grid) {
        let mut is_back = vec![false; self.points.len()];
        loop {
            let places = surface::by_position(&self.positions);
            let is_alone = |v: usize| places.firsts[places.of[v] as usize] as usize == v;
            let shared = parallel::filter(self.points.len(), |v| !is_alone(v));
            let both = shared.iter().flat_map(|v| [*v, places.firsts[places.of[*v] as usize] as usize]);
            let moved: Vec<usize> = both.filter(|v| !is_back[*v]).collect();
            if moved.is_empty() {
                return;
            }
            for v in moved {
                is_back[v] = true;
                self.positions[v] = grid.point(self.points[v]);
            }
        }
    }

    /// Returns the triangles: each square split along its shorter diagonal.
    fn into_mesh(self) -> Result<Mesh> {
        let at = |v: u32| self.positions[v as usize];
        let split = |[a, b, c, d]: &[u32; 4]| match (at(*c) - at(*a)).length() <= (at(*d) - at(*b)).length() {
            true => [[*a, *b, *c], [*a, *c, *d]],
            false => [[*a, *b, *d], [*b, *c, *d]],
        };
        let triangles = self.quads.iter().flat_map(split).collect();
        Mesh::new(MeshData { positions: self.positions, triangles, ..MeshData::default() })
    }
}

/// Returns the squares between the outside and the rest, given the voxels around each vertex. Each is found at its
/// lowest corner.
fn quads(around: &[u8], neighbours: &[[u32; 6]]) -> Vec<[u32; 4]> {
    let above = |v: usize, axis: usize| neighbours[v][2 * axis + 1];
    let mut quads = Vec::with_capacity(around.len());
    for (v, bits) in around.iter().enumerate() {
        for axis in 0..3 {
            let [upper, lower] = [7, 7 - (1 << axis)].map(|bit| bits >> bit & 1 == 1);
            if upper != lower {
                let [b, c] = [above(v, (axis + 1) % 3), above(v, (axis + 2) % 3)];
                let [own, opposite] = [v as u32, above(b as usize, (axis + 2) % 3)];
                quads.push(if lower { [own, b, opposite, c] } else { [own, c, opposite, b] });
            }
        }
    }
    quads
}

/// Returns the number of connected parts of a mesh, joined at shared positions.
fn shell_count(mesh: &Mesh) -> usize {
    let places = surface::by_position(mesh.positions());
    let mut sets = DisjointSets::new(places.firsts.len());
    let mut is_used = vec![false; places.firsts.len()];
    for corners in mesh.triangles().iter().map(|t| t.map(|v| places.of[v as usize])) {
        corners.iter().for_each(|place| is_used[*place as usize] = true);
        sets.join(corners[0], corners[1]);
        sets.join(corners[1], corners[2]);
    }
    let lowest = sets.into_lowest();
    (0..lowest.len()).filter(|i| is_used[*i] && lowest[*i] as usize == *i).count()
}

/// Returns the number of connected groups of edges with only one triangle; vertices at the same position count as one.
fn open_borders(mesh: &Mesh) -> usize {
    let places = surface::by_position(mesh.positions());
    let count = places.firsts.len();
    let edges = || {
        let whole = whole_triangles(mesh.triangles(), &places.of);
        whole.flat_map(|[a, b, c]| [(a, b), (a, c), (b, c)]).map(by_place)
    };
    let groups = Groups::new(count, edges);
    let (mut sets, mut is_open) = (DisjointSets::new(count), vec![false; count]);
    for place in 0..count {
        let mut others = groups.of(place).to_vec();
        others.sort_unstable();
        for run in others.chunk_by(u32::eq).filter(|run| run.len() == 1) {
            sets.join(place as u32, run[0]);
            [place, run[0] as usize].into_iter().for_each(|end| is_open[end] = true);
        }
    }
    let lowest = sets.into_lowest();
    (0..count).filter(|i| is_open[*i] && lowest[*i] as usize == *i).count()
}

/// Returns the volume that a closed mesh encloses, cubic model units.
fn volume(mesh: &Mesh) -> f64 {
    let Some(origin) = mesh.positions().first().map(|p| p.to_f64()) else { return 0.0 };
    let of = |t: usize| {
        let [a, b, c] = mesh.corners(t).map(|p| p.to_f64() - origin);
        a.dot(b.cross(c)) / 6.0
    };
    (0..mesh.triangles().len()).map(of).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filling_ends_with_two_connected_sides() {
        let connected = |bits: u8| {
            let Some(first) = (0..8).find(|bit| bits >> bit & 1 == 1) else { return true };
            let mut reached = 1u8 << first;
            for _ in 0..8 {
                let next = |bit: u8| (0..3).fold(0, |all, axis| all | 1 << (bit ^ 1 << axis));
                let grown =
                    (0..8u8).filter(|bit| reached >> bit & 1 == 1).fold(0, |all, bit| all | next(bit));
                reached |= grown & bits;
            }
            reached == bits
        };
        for mut around in 0..=u8::MAX {
            let before = around;
            while let Some(bit) = filled(around) {
                assert_eq!(around >> bit & 1, 0);
                around |= 1 << bit;
            }
            assert!(connected(around) && connected(!around), "{before:08b} {around:08b}");
            let is_sound = connected(before) && connected(!before);
            assert!(is_sound || around != before, "{before:08b}");
        }
        assert_eq!(filled(0b0000_1001), Some(1), "two voxels that share an edge");
        assert_eq!((filled(0b0000_0111), filled(0b1111_0000)), (None, None));
    }
}
