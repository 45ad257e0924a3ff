//! Skew correction: projection rays on flat faces of a low-poly mesh follow the face instead of the normals averaged at
//! its edges, which would shift the relief of the scan sideways.

use crate::groups::Groups;
use crate::image::{Sampler, Texture};
use crate::math::{Vec3, scalar};
use crate::mesh::{Mesh, Point};
use crate::parallel;
use crate::surface::{Bends, facet_normal};
use crate::trace::{Bvh, farthest_distance};
use std::fmt;
use std::sync::Arc;

/// How the scan runs along a triangle of a low-poly mesh, by a few of its points.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Evidence {
    /// The largest distance of the scan, model units.
    pub gap: f32,
    /// 1 − cos of the angles of the scan's normals to the triangle's, times the area that each represents.
    pub off_face: f32,
    /// The same to the blended directions.
    pub off_directions: f32,
    /// The area that these represent.
    pub area: f32,
}

impl Evidence {
    /// Returns that of both.
    pub fn and(self, o: Self) -> Self {
        Self {
            gap: self.gap.max(o.gap),
            off_face: self.off_face + o.off_face,
            off_directions: self.off_directions + o.off_directions,
            area: self.area + o.area,
        }
    }

    /// Returns `true` if the scan clearly follows the triangles rather than the blended directions.
    pub fn is_skewed(&self) -> bool {
        /// 1 − cos of 3°: less hardly shifts relief.
        const LEAST: f32 = 0.00137;
        self.off_directions > LEAST * self.area && self.off_face < 0.5 * self.off_directions
    }
}

/// How directions of projection rays turn towards the normals of the low-poly mesh's triangles.
#[derive(Debug, Clone, Default)]
pub(super) enum Skew {
    /// Nowhere: relief may be shifted near edges.
    #[default]
    Kept,
    /// On flat faces, of a part of their mesh that begins at this triangle.
    Faces(Arc<FlatFaces>, usize),
    /// By a mask on the mesh's uvs: its red channel is the fraction of the turn, linear.
    Mask(Arc<Texture>),
}

/// The flat faces of a mesh on which rays follow the face.
pub(super) struct FlatFaces {
    /// The face of each triangle.
    of_triangle: Vec<u32>,
    /// `None` for faces that are left as they are.
    faces: Vec<Option<FlatFace>>,
    /// The borders of the others, face by face.
    borders: Groups<[Vec3; 2]>,
    /// Those of faces that have many, as a tree, and their faces.
    many: Bvh,
    of_many: Vec<u32>,
}

/// A flat face.
#[derive(Debug, Clone, Copy)]
struct FlatFace {
    /// Unit.
    normal: Vec3,
    /// The width of the band along its borders in which directions turn, model units.
    band: f32,
}

/// The maximum angle of a triangle from the mean normal of its flat face, degrees: gentle bends add up.
const FLAT_DEG: f64 = 0.5;
/// Faces whose rays deviate less than this are straight already, degrees.
const STRAIGHT_DEG: f64 = 1.0;
/// The number of a face's borders up to which measuring all of them is faster than searching a tree.
const FEW: usize = 12;
/// The largest tangent of a ray's deviation that widens the band.
const STEEPEST: f32 = 3.0;

impl Skew {
    /// Returns a ray's direction at a point, given the blend of those at the triangle's vertices.
    #[inline]
    pub fn turned(&self, low: &Mesh, point: Point, direction: Vec3) -> Vec3 {
        match self {
            Self::Kept => direction,
            Self::Faces(faces, first) => faces.turned(low, (point, *first), direction),
            Self::Mask(mask) => {
                let normal = facet_normal(low.corners(point.triangle as usize)).unwrap_or(direction);
                toward(direction, normal, Sampler::default().sample(mask, point.uv(low, 0), 0.0)[0])
            }
        }
    }

    /// Finds the flat faces on which the scan follows the face rather than the averaged directions of its vertices,
    /// given with their ray distances.
    ///
    /// The band along a border is as wide as the largest ray distance of the face times the tangent of the largest
    /// deviation. The turn follows a smoothstep, whose slope is at most 1.5, so that rays of neighbouring texels do not
    /// cross within two thirds of the ray distance; by default, the scan is within half of it.
    pub fn of_flat_faces(low: &Mesh, rays: (&[Vec3], &[f32]), evidence: &[Evidence]) -> Self {
        if !evidence.iter().any(Evidence::is_skewed) {
            return Self::Kept;
        }
        let bends = Bends::of(low);
        let of_triangle = bends.flat_faces();
        let count = of_triangle.len();
        let triangles = Groups::new(count, || of_triangle.iter().map(|face| *face as usize).zip(0u32..));
        let faces = parallel::collect(count, |face| {
            let own = triangles.of(face);
            let sum = own.iter().fold(Evidence::default(), |sum, t| sum.and(evidence[*t as usize]));
            if sum.is_skewed() { straightened(low, own, rays) } else { None }
        });
        let mut borders = bends.borders(&of_triangle);
        borders.retain(|(face, _)| faces[*face].is_some());
        let groups = Groups::new(count, || borders.iter().copied());
        borders.retain(|(face, _)| groups.of(*face).len() > FEW);
        let of_many = borders.iter().map(|(face, _)| *face as u32).collect();
        let many = Bvh::of(borders.len(), |i| as_triangle(borders[i].1));
        Self::Faces(Arc::new(FlatFaces { of_triangle, faces, borders: groups, many, of_many }), 0)
    }

    /// Returns the same for a part of the mesh that begins at this triangle.
    pub fn beginning_at(&self, first: usize) -> Self {
        match self {
            Self::Faces(faces, before) => Self::Faces(Arc::clone(faces), before + first),
            other => other.clone(),
        }
    }
}

impl fmt::Debug for FlatFaces {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FlatFaces")
            .field("faces", &self.faces.iter().flatten().count())
            .finish_non_exhaustive()
    }
}

impl FlatFaces {
    /// Returns the direction at a point of a mesh, turned from `direction` by a fraction that is 0 at a border of the
    /// face and 1 beyond the band.
    fn turned(&self, low: &Mesh, (point, first): (Point, usize), direction: Vec3) -> Vec3 {
        let own = self.of_triangle.get(first + point.triangle as usize);
        let Some((own, face)) = own.and_then(|own| Some((*own, self.faces[*own as usize]?))) else {
            return direction;
        };
        let x = (self.distance_to_border(own, point.position(low), face.band) / face.band).min(1.0);
        toward(direction, face.normal, x * x * (3.0 - 2.0 * x))
    }

    /// Returns the distance of a point to the border of a face, model units; any that is larger than `most` if it is
    /// farther.
    fn distance_to_border(&self, face: u32, point: Vec3, most: f32) -> f32 {
        let own = self.borders.of(face as usize);
        if own.len() <= FEW {
            let level = self.many.level();
            let distances = own.iter().map(|border| farthest_distance(level, as_triangle(*border), &[point]));
            return distances.fold(f32::INFINITY, f32::min);
        }
        let is_own = |border: u32| self.of_many[border as usize] == face;
        self.many.closest_of(point, most, is_own).map_or(f32::INFINITY, |nearest| nearest.distance)
    }
}

/// Returns a border as a triangle without area.
fn as_triangle([a, b]: [Vec3; 2]) -> [Vec3; 3] {
    [a, b, b]
}

/// Returns `direction` turned towards `normal` by a fraction.
fn toward(direction: Vec3, normal: Vec3, fraction: f32) -> Vec3 {
    (direction * (1.0 - fraction) + normal * fraction).normalize_or(direction)
}

/// Returns a face of these triangles, given the directions and distances of the mesh's rays; `None` if it is not flat
/// after all, or its rays are straight.
fn straightened(
    low: &Mesh,
    triangles: &[u32],
    (directions, distances): (&[Vec3], &[f32]),
) -> Option<FlatFace> {
    let corners = |t: &u32| low.corners(*t as usize);
    let sum =
        triangles.iter().map(corners).fold(Vec3::default(), |sum, [a, b, c]| sum + (b - a).cross(c - a));
    let normal = sum.normalize_or(Vec3::default());
    let least = scalar::cos(FLAT_DEG.to_radians()) as f32;
    let is_flat = |t: &u32| facet_normal(corners(t)).is_none_or(|facet| facet.dot(normal) >= least);
    if !triangles.iter().all(is_flat) {
        return None;
    }
    let vertices = || triangles.iter().flat_map(|t| low.triangles()[*t as usize]);
    let cosine = vertices().map(|v| directions[v as usize].dot(normal)).fold(1.0, f32::min);
    let distance = vertices().map(|v| distances[v as usize]).fold(0.0, f32::max);
    let tangent = (1.0 - cosine * cosine).max(0.0).sqrt() / cosine.max(f32::MIN_POSITIVE);
    let is_skewed = cosine < scalar::cos(STRAIGHT_DEG.to_radians()) as f32;
    is_skewed.then_some(FlatFace { normal, band: distance * tangent.min(STEEPEST) })
}
