//! Welds equal positions, and those on either side of a seam, into one vertex, in an order in which neighbours in
//! space are neighbours in memory.
//!
//! Positions are sorted along a Morton curve, so that equal ones meet in one cell: this avoids a hash table, whose
//! size and order would matter at twenty million triangles.
//!
//! Seams are vertices of open edges that are meant to be one, though their coordinates differ slightly: copies of a
//! vertex differ if a surface was computed piece by piece, transformed, or written with few digits. For
//! simplification each such seam is a border to preserve, and if many meet, nothing can be collapsed.

use super::part::{FineCells, Part, UnitCube, morton};
use crate::error::Warnings;
use crate::math::Vec3;
use crate::mesh::Mesh;
use crate::parallel;
use rayon::prelude::*;

/// Marks triangles that are left out; they are sorted to the end.
const DROPPED: [u32; 3] = [u32::MAX; 3];

/// Returns the mesh on welded points. Each triangle begins with its lowest vertex, and triangles are sorted.
pub(super) fn weld(mesh: &Mesh, notes: &mut Warnings) -> (Part, UnitCube) {
    let positions = mesh.positions();
    let cube = UnitCube::of(positions);
    let (places, sources) = classes(positions, &sorted(positions, &cube));
    let points = parallel::collect(sources.len(), |i| cube.scaled(positions[sources[i] as usize]));
    let triangles = sound_triangles(mesh.triangles(), &places, notes);
    let part = Part { points, sources, triangles, labels: Vec::new() };
    let Some((becomes, joined)) = closed_seams(&part, mesh, &cube) else {
        return (part, cube);
    };
    notes.note("vertices on unwelded seams of the scan, welded before simplification", joined);
    let triangles = sound_triangles(&part.triangles, &becomes, notes);
    (Part { triangles, ..part }.compacted(), cube)
}

/// Returns the position index of each vertex: vertices with equal positions share one.
pub(in crate::bake) fn places(positions: &[Vec3]) -> Vec<u32> {
    classes(positions, &sorted(positions, &UnitCube::of(positions))).0
}

/// Returns vertex indices in the low half, sorted by cell, then position, then index.
fn sorted(positions: &[Vec3], cube: &UnitCube) -> Vec<u64> {
    let cell = |position: Vec3| u64::from(morton(cube.scaled(position)));
    let mut keys = parallel::collect(positions.len(), |v| cell(positions[v]) << 32 | v as u64);
    keys.par_sort_unstable();
    let by_position = |key: &u64| (bits(positions[*key as u32 as usize]), *key);
    keys.par_chunk_by_mut(|a, b| a >> 32 == b >> 32).for_each(|cell| {
        if cell.len() > 1 {
            cell.sort_unstable_by_key(by_position);
        }
    });
    keys
}

/// Returns the position index of each vertex, and the first vertex at each position.
fn classes(positions: &[Vec3], sorted: &[u64]) -> (Vec<u32>, Vec<u32>) {
    let (mut places, mut firsts) = (vec![0; positions.len()], Vec::new());
    let mut last = None;
    for key in sorted {
        let vertex = *key as u32;
        let here = bits(positions[vertex as usize]);
        if last != Some(here) {
            firsts.push(vertex);
            last = Some(here);
        }
        places[vertex as usize] = firsts.len() as u32 - 1;
    }
    firsts.shrink_to_fit();
    (places, firsts)
}

/// Returns the distinct triangles on position indices, without those with two equal corners.
fn sound_triangles(triangles: &[[u32; 3]], places: &[u32], notes: &mut Warnings) -> Vec<[u32; 3]> {
    let on_places = |t: usize| lowest_first(triangles[t].map(|v| places[v as usize]));
    let mut sound = parallel::collect(triangles.len(), on_places);
    sound.par_sort_unstable();
    sound.truncate(sound.partition_point(|triangle| *triangle != DROPPED));
    notes.note("triangles with two equal corners, left out", triangles.len() - sound.len());
    let with_twins = sound.len();
    sound.dedup();
    notes.note("duplicate triangles, left out", with_twins - sound.len());
    sound
}

/// Returns the triangle rotated so that its lowest vertex comes first.
fn lowest_first([a, b, c]: [u32; 3]) -> [u32; 3] {
    match () {
        () if a == b || b == c || c == a => DROPPED,
        () if a < b && a < c => [a, b, c],
        () if b < c => [b, c, a],
        () => [c, a, b],
    }
}

/// Returns the bits of a position, with a single sign for zero.
fn bits(position: Vec3) -> [u32; 3] {
    position.to_array().map(|v| (v + 0.0).to_bits())
}

/// Two vertices are the same if they are closer to each other than this fraction of the shortest edge at either...
const GAP: f64 = 1e-3;
/// ... or than this fraction of their largest coordinate, the last of six decimal digits...
const ROUNDING: f64 = 1e-5;
/// ... but then also closer than this fraction of the shortest edge. Anything below a half keeps the corners of a
/// triangle apart: two of them can be near one vertex only if the edge between them is shorter than the shortest
/// edge.
const MOST: f64 = 0.1;
/// An edge shorter than this fraction of its largest coordinate is itself a rounding error: two units in the last
/// place.
const DEGENERATE: f64 = 2.5e-7;
/// Normals whose cosine is below this, 150°, face opposite ways: those of the two sides of a thin wall are 180° apart
/// except for the relief on them, those of a blade's edge seldom more than this.
const OPPOSITE: f64 = -0.87;
/// Blocks of cells are this many times as large as the search radius for neighbours, so that most searches look into
/// a single one.
const ROOM: f64 = 8.0;
/// Marks a point that is not on an open edge.
const CLOSED: u32 = u32::MAX;

/// A point on an open edge.
#[derive(Clone, Copy, Default)]
struct RimPoint {
    /// Its index in the part.
    point: u32,
    /// The distance up to which others may be the same point, as a fraction of the unit cube.
    reach: f32,
    /// The sum of the doubled area vectors of its triangles.
    normal: Vec3,
}

/// The points on open edges, and their positions.
struct Rim<'a> {
    part: &'a Part,
    positions: &'a [Vec3],
    cube: &'a UnitCube,
    points: Vec<RimPoint>,
    /// Codes of the points' cells, followed by their indices; sorted.
    codes: Vec<[u32; 4]>,
}

/// Returns the point that each point of a part becomes when seams are closed, and the number of points removed;
/// `None` if there is none.
///
/// Only points on open edges are joined, so a surface without them takes one pass over its triangles. The corners of
/// a triangle are never joined unless they are a rounding error apart, and points that face opposite ways never are.
fn closed_seams(part: &Part, mesh: &Mesh, cube: &UnitCube) -> Option<(Vec<u32>, usize)> {
    let open = open_points(part);
    if open.is_empty() {
        return None;
    }
    let positions = mesh.positions();
    let mut rim = Rim { part, positions, cube, points: Vec::new(), codes: Vec::new() };
    rim.points = rim.measured(&open);
    rim.codes = rim.sorted();
    let mut becomes: Vec<u32> = (0..part.points.len() as u32).collect();
    let joined = rim.join(&mut becomes);
    (joined > 0).then_some((becomes, joined))
}

/// Returns the points whose triangles do not form a closed fan.
///
/// Each triangle adds, at each of its corners, a number for the next corner and subtracts one for the previous
/// corner. Around a closed point every neighbour is next as often as it is previous, so that the sum is 0.
fn open_points(part: &Part) -> Vec<u32> {
    let mut sums = vec![0u64; part.points.len()];
    for [a, b, c] in &part.triangles {
        let [of_a, of_b, of_c] = [*a, *b, *c].map(mixed);
        let mut add = |v: u32, next: u64, previous: u64| {
            let sum = &mut sums[v as usize];
            *sum = sum.wrapping_add(next).wrapping_sub(previous);
        };
        add(*a, of_b, of_c);
        add(*b, of_c, of_a);
        add(*c, of_a, of_b);
    }
    (0..part.points.len() as u32).filter(|v| sums[*v as usize] != 0).collect()
}

/// Returns a number for a point such that sums and differences of a few of them do not cancel by chance.
fn mixed(v: u32) -> u64 {
    let v = (u64::from(v) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    (v ^ v >> 32).wrapping_mul(0xD6E8_FEB8_6659_FD93)
}

impl Rim<'_> {
    fn position(&self, point: u32) -> Vec3 {
        self.positions[self.part.sources[point as usize] as usize]
    }

    /// Returns the points with their search radii and normals.
    fn measured(&self, open: &[u32]) -> Vec<RimPoint> {
        let mut numbers = vec![CLOSED; self.part.points.len()];
        let mut points: Vec<RimPoint> = Vec::with_capacity(open.len());
        for (i, point) in open.iter().enumerate() {
            numbers[*point as usize] = i as u32;
            points.push(RimPoint { point: *point, reach: f32::INFINITY, normal: Vec3::default() });
        }
        for triangle in &self.part.triangles {
            let own = triangle.map(|v| numbers[v as usize]);
            if own != [CLOSED; 3] {
                self.add(*triangle, own, &mut points);
            }
        }
        for point in &mut points {
            let shortest = f64::from(point.reach);
            let rounding = ROUNDING * largest(self.position(point.point).to_f64()) / self.cube.extent;
            // Triangles whose edges are all rounding errors carry no information about gaps.
            let reach = (GAP * shortest).max(rounding.min(MOST * shortest)) as f32;
            point.reach = if shortest.is_finite() { reach } else { 0.0 };
        }
        points
    }

    /// Adds a triangle to those of its corners that are on open edges; their reach is the shortest edge until all are
    /// known.
    fn add(&self, triangle: [u32; 3], own: [u32; 3], points: &mut [RimPoint]) {
        let places = triangle.map(|v| self.position(v).to_f64());
        let normal = (places[1] - places[0]).cross(places[2] - places[0]).to_f32();
        for k in 0..3 {
            let [from, to] = [k, (k + 1) % 3];
            let length = (places[to] - places[from]).length();
            let is_edge = length > DEGENERATE * largest(places[from]).max(largest(places[to]));
            for number in [own[from], own[to]].into_iter().filter(|number| *number != CLOSED && is_edge) {
                let shortest = &mut points[number as usize].reach;
                *shortest = shortest.min((length / self.cube.extent) as f32);
            }
            if own[k] != CLOSED {
                points[own[k] as usize].normal += normal;
            }
        }
    }

    fn sorted(&self) -> Vec<[u32; 4]> {
        let code = |i: usize| {
            let cell = FineCells::FINEST.block(self.place(i).to_array());
            let [[a, b, c], _] = FineCells::FINEST.codes(cell);
            [a, b, c, i as u32]
        };
        let mut codes = parallel::collect(self.points.len(), code);
        codes.par_sort_unstable();
        codes
    }

    /// Returns the position of a rim point in the unit cube.
    fn place(&self, i: usize) -> Vec3<f64> {
        self.cube.unit(self.position(self.points[i].point))
    }

    /// Joins each free point to the first equal point along the curve that is kept. Returns the number of points
    /// removed.
    fn join(&self, becomes: &mut [u32]) -> usize {
        let mut is_taken = vec![false; self.points.len()];
        let mut joined = 0;
        for (at, key) in self.codes.iter().enumerate() {
            let leader = key[3] as usize;
            if is_taken[leader] {
                continue;
            }
            self.for_near(at, |i| {
                if !is_taken[i] && self.is_same(leader, i) {
                    is_taken[i] = true;
                    becomes[self.points[i].point as usize] = self.points[leader].point;
                    joined += 1;
                }
            });
        }
        joined
    }

    /// Calls `visit` with the points further along the curve that may be near the point at an index of it.
    fn for_near(&self, at: usize, mut visit: impl FnMut(usize)) {
        let own = self.codes[at][3] as usize;
        let (place, reach) = (self.place(own), f64::from(self.points[own].reach));
        let cells = FineCells::at_least(ROOM * reach);
        let [low, high] = [-reach, reach].map(|reach| cells.block((place + Vec3::splat(reach)).to_array()));
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let [first, last] = cells.codes([x, y, z]);
                    let start = (at + 1).max(self.first_from(at, first));
                    let inside = self.codes[start..].iter().take_while(|key| key[..3] <= last[..]);
                    inside.for_each(|key| visit(key[3] as usize));
                }
            }
        }
    }

    /// Returns the first index along the curve with at least this code, searching in growing steps from `near`.
    fn first_from(&self, near: usize, code: [u32; 3]) -> usize {
        let is_before = |at: usize| self.codes[at][..3] < code[..];
        if !is_before(near) {
            return near;
        }
        let (mut low, mut step) = (near, 1);
        while low + step < self.codes.len() && is_before(low + step) {
            low += step;
            step *= 2;
        }
        let high = (low + step).min(self.codes.len());
        low + 1 + self.codes[low + 1..high].partition_point(|key| key[..3] < code[..])
    }

    /// Returns `true` if two points are near each other and do not face opposite ways.
    fn is_same(&self, i: usize, j: usize) -> bool {
        let [a, b] = [i, j].map(|k| self.points[k]);
        let near = f64::from(a.reach.min(b.reach));
        let [m, n] = [a, b].map(|point| point.normal.to_f64());
        (self.place(i) - self.place(j)).length() <= near && m.dot(n) >= OPPOSITE * m.length() * n.length()
    }
}

/// Returns the largest absolute coordinate.
fn largest(position: Vec3<f64>) -> f64 {
    position.to_array().into_iter().fold(0.0, |most: f64, v| most.max(v.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshData;

    #[test]
    fn equal_positions_are_one_and_bad_triangles_are_counted() {
        let p = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let data = MeshData {
            positions: vec![p(0.0, 0.0), p(1.0, 0.0), p(0.0, 1.0), p(-0.0, 0.0), p(1.0, 0.0), p(1.0, 1.0)],
            triangles: vec![[0, 1, 2], [2, 3, 4], [0, 3, 1], [2, 1, 5], [0, 2, 1], [1, 1, 1]],
            ..MeshData::default()
        };
        let mut notes = Warnings::default();
        let (part, cube) = weld(&Mesh::new(data).unwrap(), &mut notes);
        assert_eq!((part.points.len(), cube.extent), (4, 1.0));
        assert_eq!(part.triangles.len(), 3, "the triangle seen from behind stays: {:?}", part.triangles);
        let found: Vec<(&str, usize)> = notes.iter().collect();
        assert_eq!(
            found,
            [("triangles with two equal corners, left out", 2), ("duplicate triangles, left out", 1)]
        );
        assert!(
            part.sources.iter().all(|v| [0, 1, 2, 5].contains(v)),
            "the first of equal ones represents them"
        );
    }

    /// Columns and rows of the sheets below, whose squares have sides of 1.
    const COLUMNS: usize = 6;
    const POINTS: usize = (COLUMNS + 1) * (COLUMNS + 1);

    fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
        Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap()
    }

    /// Makes a square sheet, facing up, with its first corner here.
    fn sheet(x: f32, y: f32, z: f32) -> Mesh {
        let at = |i: usize| Vec3::new(x + (i % (COLUMNS + 1)) as f32, y + (i / (COLUMNS + 1)) as f32, z);
        let square = |i: usize| {
            let a = (i / COLUMNS * (COLUMNS + 1) + i % COLUMNS) as u32;
            let (b, c, d) = (a + 1, a + COLUMNS as u32 + 2, a + COLUMNS as u32 + 1);
            [[a, b, c], [a, c, d]]
        };
        mesh((0..POINTS).map(at).collect(), (0..COLUMNS * COLUMNS).flat_map(square).collect())
    }

    fn both(one: &Mesh, other: &Mesh) -> Mesh {
        let first = one.positions().len() as u32;
        let shifted = other.triangles().iter().map(|t| t.map(|v| v + first));
        let triangles = one.triangles().iter().copied().chain(shifted).collect();
        mesh([one.positions(), other.positions()].concat(), triangles)
    }

    fn turned(one: &Mesh) -> Mesh {
        mesh(one.positions().to_vec(), one.triangles().iter().map(|[a, b, c]| [*a, *c, *b]).collect())
    }

    /// Separates the triangles, each corner moved by a small step.
    fn loose(one: &Mesh, step: f32) -> Mesh {
        let moved = |(i, p): (usize, Vec3)| {
            p + Vec3::new((i % 3) as f32 - 1.0, (i % 5) as f32 * 0.5 - 1.0, (i % 7) as f32 / 3.0 - 1.0) * step
        };
        let corners = (0..one.triangles().len()).flat_map(|t| one.corners(t)).enumerate();
        let triangles = (0..one.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
        mesh(corners.map(moved).collect(), triangles.collect())
    }

    /// Returns the number of points and triangles after welding.
    fn welded(one: &Mesh) -> (usize, usize) {
        let part = weld(one, &mut Warnings::default()).0;
        (part.points.len(), part.triangles.len())
    }

    #[test]
    fn seams_are_closed_and_gaps_are_not() {
        let triangles = 4 * COLUMNS * COLUMNS;
        let adjacent = |gap: f32| both(&sheet(0.0, 0.0, 0.0), &sheet(COLUMNS as f32 + gap, 0.0, 0.0));
        assert_eq!(welded(&adjacent(2e-4)), (2 * POINTS - COLUMNS - 1, triangles));
        assert_eq!(
            welded(&adjacent(5e-3)),
            (2 * POINTS, triangles),
            "a slot of a two-hundredth of its edges"
        );
        // The last of six digits of a coordinate of 1000 is worth 0.01, but a slot of a fifth of the edges is a real
        // slot.
        let far = |x: f32, gap: f32| both(&sheet(x, 0.0, 0.0), &sheet(x + COLUMNS as f32 + gap, 0.0, 0.0));
        assert_eq!(welded(&far(1e3, 5e-3)).0, 2 * POINTS - COLUMNS - 1);
        assert_eq!(welded(&far(1e5, 0.2)).0, 2 * POINTS);
    }

    #[test]
    fn sheets_that_face_opposite_ways_stay_apart() {
        let (one, other) = (sheet(0.0, 0.0, 0.0), sheet(0.0, 0.0, -1e-4));
        let wall = both(&one, &turned(&other));
        assert_eq!(welded(&wall).0, 2 * POINTS, "their rims");
        assert_eq!(welded(&loose(&wall, 1e-5)).0, 2 * POINTS, "all of their vertices, which are loose");
        let slope = one.positions().iter().map(|p| Vec3::new(1e-4 - p.x, p.y, 2.0 * p.x)).collect();
        let slope = mesh(slope, turned(&one).triangles().to_vec());
        assert_eq!(welded(&both(&one, &slope)).0, 2 * POINTS - COLUMNS - 1, "a ridge is a seam");
    }

    #[test]
    fn closed_surfaces_do_not_touch() {
        let solid = |d: f32| {
            let corners = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)];
            let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
            mesh(corners.map(|(x, y, z)| Vec3::new(x, y, z) + Vec3::splat(d)).to_vec(), faces)
        };
        assert_eq!(welded(&both(&solid(0.0), &solid(0.0))), (4, 4), "equal positions are one");
        assert_eq!(welded(&both(&solid(0.0), &solid(1e-5))), (8, 8));
        assert_eq!(welded(&loose(&solid(0.0), 1e-5)), (4, 4));
    }

    #[test]
    fn corners_of_a_triangle_are_joined_only_where_it_is_none() {
        // A fan of needles around a pole, each with its own copy of it, and triangles between the copies.
        let count = 40u32;
        let ring = |i: u32, radius: f32| {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(count);
            let [x, y] = [crate::math::scalar::cos(angle), crate::math::scalar::sin(angle)];
            Vec3::new(x as f32 * radius, y as f32 * radius, 2.0 - radius)
        };
        let fan = |radius: f32| {
            let poles = (0..count).map(|i| ring(i, radius));
            let positions = poles.chain((0..count).map(|i| ring(i, 1.0))).collect();
            let next = |i: u32| (i + 1) % count;
            let triangles =
                (0..count).flat_map(|i| [[i, count + i, count + next(i)], [i, count + next(i), next(i)]]);
            mesh(positions, triangles.collect())
        };
        assert_eq!(welded(&fan(1e-7)), (count as usize + 1, count as usize), "a point");
        assert_eq!(welded(&fan(1e-3)), (2 * count as usize, 2 * count as usize), "a hole");
    }

    #[test]
    fn a_stray_vertex_far_away_changes_nothing() {
        let loose = loose(&sheet(0.0, 0.0, 0.0), 1e-5);
        let all = [loose.positions(), &[Vec3::new(3e6, -1e6, 7.0)]].concat();
        let strayed = mesh(all, loose.triangles().to_vec());
        let part = weld(&strayed, &mut Warnings::default()).0;
        assert_eq!(part.points.len(), POINTS);
        assert_eq!(welded(&loose), (POINTS, 2 * COLUMNS * COLUMNS));
    }
}
