//! MikkTSpace: follows its contract, and guards its weak points against hostile meshes.

use super::face_tangents::{CornerTangents, Corners, face_tangent};
use super::weld::Classes;
use crate::math::Vec3;
use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};

/// The maximum number of corners at one shared vertex, and at one position, that are passed on. The algorithm
/// recurses around a vertex and compares the triangles there pairwise; beyond this, each triangle gets its own
/// tangents.
const MOST_SHARED: u32 = 1024;
const MOST_PLACED: u32 = 4096;

/// The tangents of Mikkelsen's reference; `None` where it finds none.
pub(super) fn tangents(corners: &Corners) -> Vec<CornerTangents> {
    let places = corners.places();
    let shared = corners.shared(&places);
    let kept = Sieve::new(corners, &places, &shared);
    let mut soup = Soup {
        corners,
        scale: tame_scale(corners),
        fed: (0..corners.len()).filter(|t| kept.takes(*t)).collect(),
        found: vec![[None; 3]; corners.len()],
    };
    // The error type has no values.
    let _ = generate_tangents::<_, Libm>(&mut soup);
    let mut found = soup.found;
    kept.fill_crowded(&mut found);
    kept.fill_points_and_lines(&mut found);
    found
}

/// Selects the triangles that are passed on.
struct Sieve<'a> {
    corners: &'a Corners<'a>,
    places: &'a Classes,
    shared: &'a Classes,
    placed: Vec<u32>,
    sharing: Vec<u32>,
}

impl<'a> Sieve<'a> {
    fn new(corners: &'a Corners, places: &'a Classes, shared: &'a Classes) -> Self {
        let mut placed = vec![0; places.firsts.len()];
        let mut sharing = vec![0; shared.firsts.len()];
        for v in (0..corners.len()).flat_map(|t| corners.triangle(t)) {
            placed[places.of[v] as usize] += 1;
            sharing[shared.of[v] as usize] += 1;
        }
        Self { corners, places, shared, placed, sharing }
    }

    fn takes(&self, t: usize) -> bool {
        !self.collapsed(t) && !self.crowded(t)
    }

    /// Returns true if two corners of triangle `t` are at one position.
    fn collapsed(&self, t: usize) -> bool {
        let [a, b, c] = self.corners.triangle(t).map(|v| self.places.of[v]);
        a == b || b == c || c == a
    }

    fn crowded(&self, t: usize) -> bool {
        self.corners.triangle(t).iter().any(|v| {
            self.placed[self.places.of[*v] as usize] > MOST_PLACED
                || self.sharing[self.shared.of[*v] as usize] > MOST_SHARED
        })
    }

    fn fill_crowded(&self, found: &mut [CornerTangents]) {
        for t in (0..found.len()).filter(|t| !self.collapsed(*t) && self.crowded(*t)) {
            found[t] = face_tangent(self.corners, t);
        }
    }

    /// Collapsed triangles take, corner by corner, the tangent of the first valid triangle at that vertex. The
    /// reference does the same by comparing each with all others.
    fn fill_points_and_lines(&self, found: &mut [CornerTangents]) {
        let class = |t: usize, i: usize| self.shared.of[self.corners.triangle(t)[i]] as usize;
        let mut first = vec![None; self.shared.firsts.len()];
        for t in (0..found.len()).filter(|t| !self.collapsed(*t)) {
            for i in 0..3 {
                let known: &mut Option<[f32; 4]> = &mut first[class(t, i)];
                *known = known.or(found[t][i]);
            }
        }
        for t in (0..found.len()).filter(|t| self.collapsed(*t)) {
            found[t] = std::array::from_fn(|i| first[class(t, i)]);
        }
    }
}

/// The mesh in the form the algorithm expects: triangles that share nothing, v pointing up.
struct Soup<'a> {
    corners: &'a Corners<'a>,
    scale: f32,
    fed: Vec<usize>,
    found: Vec<CornerTangents>,
}

impl Geometry<Libm> for Soup<'_> {
    fn num_faces(&self) -> usize {
        self.fed.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, vert: usize) -> [f32; 3] {
        (self.corners.positions(self.fed[face])[vert] * self.scale).to_array()
    }

    fn normal(&self, face: usize, vert: usize) -> [f32; 3] {
        self.corners.normals(self.fed[face])[vert].to_array()
    }

    fn tex_coord(&self, face: usize, vert: usize) -> [f32; 2] {
        let uv = self.corners.uvs(self.fed[face])[vert];
        [uv.x, 1.0 - uv.y]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, vert: usize) {
        let tangent = space.map(|space| space.tangent_encoded());
        self.found[self.fed[face]][vert] = tangent.filter(|[x, y, z, _]| {
            let squared = Vec3::new(*x, *y, *z).dot(Vec3::new(*x, *y, *z));
            (0.5..2.0).contains(&squared)
        });
    }
}

/// A power of two that keeps the squares of coordinates within single precision; 1 for any ordinary mesh, and exact
/// for all, so that equal positions stay equal.
fn tame_scale(corners: &Corners) -> f32 {
    let largest = (0..corners.len())
        .flat_map(|t| corners.positions(t))
        .flat_map(Vec3::to_array)
        .fold(0.0f32, |largest, v| largest.max(v.abs()));
    if largest == 0.0 || (1e-6..1e6).contains(&largest) {
        return 1.0;
    }
    let exponent = libm::frexpf(largest).1;
    libm::ldexpf(1.0, -exponent.clamp(-120, 120))
}

/// Pure Rust mathematics, so that tangents have the same bits everywhere.
struct Libm;

impl Ops for Libm {
    fn sqrt(x: f32) -> f32 {
        x.sqrt()
    }

    fn acos(x: f32) -> f32 {
        libm::acos(f64::from(x)) as f32
    }
}
