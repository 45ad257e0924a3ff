//! Computes tangents for a mesh by three methods that end the same way: a tangent per corner, then a weld.
//!
//! MikkTSpace follows its contract, and its weak points are guarded against hostile meshes.

use super::face_tangents::{
    CornerTangents, Corners, face_tangent, tangent_at, uv_determinant, with_handedness,
};
use super::normals::{corner_angles, with_normals_at};
use super::weld::{Classes, bits, by_position};
use crate::error::Result;
use crate::math::{SimdLevel, Vec3};
use crate::mesh::{Mesh, MeshData};
use crate::names::Named;
use crate::parallel;
use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};
use fearless_simd::Level;
use std::borrow::Cow;

/// The method for computing tangents.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TangentMethod {
    /// Each triangle's own solution of the two edge equations.
    Face,
    /// The angle-weighted mean of the triangles at a vertex.
    Averaged,
    /// Mikkelsen's tangent space (2008), which bakers and glTF agree on.
    #[default]
    MikkTSpace,
}

impl Named for TangentMethod {
    const WHAT: &'static str = "tangent method";
    const NAMES: &'static [(&'static str, Self)] =
        &[("face", Self::Face), ("averaged", Self::Averaged), ("mikktspace", Self::MikkTSpace)];
}

/// A mesh with tangents.
#[derive(Debug, Clone)]
pub struct Tangented {
    /// Triangle i is triangle i of the original mesh; vertices are split if their tangents differ and welded if all
    /// attributes are equal. Unused vertices are removed.
    pub mesh: Mesh,
    /// Triangles whose uvs span no area. They have a frame around the normal, but an arbitrary one.
    pub degenerate_uvs: usize,
}

/// The warning for [`Tangented::degenerate_uvs`].
pub(crate) const NO_UV_AREA: &str = "triangles without uv area, given a tangent frame around their normal";

/// The mesh with the normals and tangents that a renderer needs, and the number of its triangles that span no area in
/// `uv_set` if tangents were computed. Existing ones are kept; missing normals are [`super::vertex_normals`], and
/// tangents are computed by `method` if there is one, or by MikkTSpace if the mesh has none.
///
/// # Errors
/// As for [`with_tangents`].
pub fn with_frames(
    mesh: &Mesh,
    uv_set: usize,
    method: Option<TangentMethod>,
) -> Result<(Cow<'_, Mesh>, usize)> {
    with_frames_at(SimdLevel::fastest(), mesh, uv_set, method)
}

/// [`with_frames`], with normals computed at a SIMD level.
pub(crate) fn with_frames_at(
    level: Level,
    mesh: &Mesh,
    uv_set: usize,
    method: Option<TangentMethod>,
) -> Result<(Cow<'_, Mesh>, usize)> {
    let mesh = with_normals_at(level, mesh)?;
    if method.is_none() && !mesh.tangents().is_empty() {
        return Ok((mesh, 0));
    }
    let made = with_tangents(&mesh, uv_set, method.unwrap_or_default())?;
    Ok((Cow::Owned(made.mesh), made.degenerate_uvs))
}

/// Gives `mesh` tangents that follow its uv set `uv_set` (origin top left); existing ones are replaced.
///
/// Each tangent is a unit vector perpendicular to its vertex normal, with the handedness w = ±1 of glTF 2.0: the
/// bitangent w · cross(n, t) points up the image. The three corners of a triangle whose uvs span an area share w.
/// Normals that are not unit are normalised for this; a normal that is zero or NaN counts as (0, 0, 1).
///
/// - `face`: ∂p/∂u of the triangle, made perpendicular to each corner's normal.
/// - `averaged`: the mean of the triangles at a vertex (equal position, normal and uv) weighted by their angle there,
///   separately for each handedness.
/// - `mikktspace`: those of the [reference](http://www.mikktspace.com), bit for bit: fed one corner at a time with v
///   flipped, and welded afterwards. This includes triangles without uv area, which it leaves with the handedness of
///   their neighbours corner by corner, or with (1, 0, 0) and w = −1 if they have none.
///
/// # Errors
/// [`crate::Error::Invalid`] if the mesh has no normals or lacks the uv set, [`crate::Error::Limit`] above 2³² / 3
/// triangles.
pub fn with_tangents(mesh: &Mesh, uv_set: usize, method: TangentMethod) -> Result<Tangented> {
    let corners = Corners::new(mesh, uv_set)?;
    let (mut tangents, settle): (_, fn(_, _) -> _) = match method {
        TangentMethod::Face => (face_tangents(&corners), of_one_hand),
        TangentMethod::Averaged => (averaged_tangents(&corners), of_one_hand),
        TangentMethod::MikkTSpace => (mikktspace_tangents(&corners), as_the_reference),
    };
    let degenerate_uvs = parallel::count(corners.len(), |t| uv_determinant(corners.uvs(t)).is_none());
    parallel::change(&mut tangents, |t, found| *found = settle(*found, corners.normals(t)));
    Ok(Tangented { mesh: welded(mesh, &tangents)?, degenerate_uvs })
}

fn face_tangents(corners: &Corners) -> Vec<CornerTangents> {
    parallel::collect(corners.len(), |t| face_tangent(corners, t))
}

fn averaged_tangents(corners: &Corners) -> Vec<CornerTangents> {
    let shared = corners.shared(&corners.places());
    let faces = face_tangents(corners);
    let sums = tangent_sums(corners, &shared, &faces);
    let at_corner = |t: usize, i: usize, n: Vec3| {
        let [mirrored, upright] = sums[shared.of[corners.triangle(t)[i]] as usize];
        match faces[t][i] {
            Some([.., w]) => tangent_at(n, if w > 0.0 { upright } else { mirrored }, w).or(faces[t][i]),
            // Without uv area, a triangle borrows from its neighbours.
            None => tangent_at(n, upright, 1.0).or_else(|| tangent_at(n, mirrored, -1.0)),
        }
    };
    let at_triangle = |t: usize| {
        let normals = corners.normals(t);
        std::array::from_fn(|i| at_corner(t, i, normals[i]))
    };
    parallel::collect(corners.len(), at_triangle)
}

/// The angle-weighted sums of tangents at each shared vertex: of mirrored and of upright triangles.
fn tangent_sums(corners: &Corners, shared: &Classes, faces: &[CornerTangents]) -> Vec<[Vec3<f64>; 2]> {
    let mut sums = vec![[Vec3::splat(0.0); 2]; shared.firsts.len()];
    for (t, tangents) in faces.iter().enumerate() {
        let angles = corner_angles(corners.positions(t).map(Vec3::to_f64));
        for i in 0..3 {
            if let Some([x, y, z, w]) = tangents[i] {
                let side = usize::from(w > 0.0);
                let class = shared.of[corners.triangle(t)[i]] as usize;
                sums[class][side] += Vec3::new(x, y, z).to_f64() * angles[i];
            }
        }
    }
    sums
}

/// A tangent at every corner, all with one handedness: that of most corners.
fn of_one_hand(found: CornerTangents, normals: [Vec3; 3]) -> CornerTangents {
    let balance: f32 = found.iter().flatten().map(|t| t[3]).sum();
    let handedness = if balance < 0.0 { -1.0 } else { 1.0 };
    std::array::from_fn(|i| {
        Some(match found[i] {
            Some([x, y, z, _]) => [x, y, z, handedness],
            None => with_handedness(normals[i].to_f64().any_perpendicular(), handedness),
        })
    })
}

/// A tangent at every corner; the reference's (1, 0, 0) and w = −1 if it finds none, unless that is the normal.
fn as_the_reference(found: CornerTangents, normals: [Vec3; 3]) -> CornerTangents {
    const PARALLEL: f32 = 0.999;
    std::array::from_fn(|i| {
        let x_is_normal = normals[i].x.abs() > PARALLEL;
        let t = if x_is_normal { normals[i].to_f64().any_perpendicular() } else { Vec3::new(1.0, 0.0, 0.0) };
        found[i].or(Some(with_handedness(t, -1.0)))
    })
}

/// The mesh with these tangents; equal corners become one vertex.
fn welded(mesh: &Mesh, tangents: &[CornerTangents]) -> Result<Mesh> {
    let vertices = by_attributes(mesh);
    let tangent = |c: usize| tangents[c / 3][c % 3].unwrap_or([1.0, 0.0, 0.0, 1.0]);
    let vertex = |c: usize| mesh.triangles()[c / 3][c % 3] as usize;
    let corners = Classes::by(3 * tangents.len(), |c| (vertices.of[vertex(c)], bits(tangent(c))));
    let old: Vec<usize> = corners.firsts.iter().map(|c| vertex(*c as usize)).collect();
    Mesh::new(MeshData {
        tangents: corners.firsts.iter().map(|c| tangent(*c as usize)).collect(),
        triangles: corners.of.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
        ..mesh.gathered(&old)
    })
}

/// The classes of vertices that are equal in everything but the tangent.
fn by_attributes(mesh: &Mesh) -> Classes {
    let mut classes = by_position(mesh.positions());
    if !mesh.normals().is_empty() {
        classes = classes.split_by(|v| bits(mesh.normals()[v].to_array()));
    }
    for set in mesh.uvs() {
        classes = classes.split_by(|v| bits([set[v].x, set[v].y]));
    }
    if !mesh.colors().is_empty() {
        classes = classes.split_by(|v| bits(mesh.colors()[v]));
    }
    classes
}

/// Returns the bytes needed for computing tangents of a mesh, in addition to the mesh.
pub fn tangent_bytes(triangles: u64, vertices: u64) -> u64 {
    /// MikkTSpace's triangles, their corners and the tangents of these; the tangents that are copied.
    const TRIANGLE: u64 = 152 + 24 + 108 + 68;
    /// Usable normals and uvs, classes of equal vertices, MikkTSpace's groups of triangles around one.
    const VERTEX: u64 = 20 + 24 + 128;
    triangles * TRIANGLE + vertices * VERTEX
}

/// The maximum number of corners at one shared vertex, and at one position, that are passed on. The algorithm
/// recurses around a vertex and compares the triangles there pairwise; beyond this, each triangle gets its own
/// tangents.
const MOST_SHARED: u32 = 1024;
const MOST_PLACED: u32 = 4096;

/// The tangents of Mikkelsen's reference; `None` where it finds none.
fn mikktspace_tangents(corners: &Corners) -> Vec<CornerTangents> {
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
