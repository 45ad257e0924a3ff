//! Skew correction: projection rays on flat faces of a low-poly mesh follow the face instead of the normals averaged at
//! its edges, which would shift the relief of the scan sideways.

use crate::groups::Groups;
use crate::image::{Sampler, Texture};
use crate::math::{Vec3, scalar};
use crate::mesh::{Mesh, Point};
use crate::parallel;
use crate::surface::{Bends, facet_normal};
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
    /// On flat faces; one entry for each triangle, `None` for the others.
    Faces(Arc<[Option<FlatFace>]>),
    /// By a mask on the mesh's uvs: its red channel is the fraction of the turn, linear.
    Mask(Arc<Texture>),
}

/// A triangle of a flat face.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FlatFace {
    /// Of the face, unit.
    normal: Vec3,
    /// The width of the band along the face's borders in which directions turn, model units.
    band: f32,
    /// The face's borders within the band's width of the triangle.
    borders: Vec<[Vec3; 2]>,
}

/// The maximum angle of a triangle from the mean normal of its flat face, degrees: gentle bends add up.
const FLAT_DEG: f64 = 0.5;
/// Faces whose rays deviate less than this are straight already, degrees.
const STRAIGHT_DEG: f64 = 1.0;
/// The largest tangent of a ray's deviation that widens the band.
const STEEPEST: f32 = 3.0;
/// Faces with more pairs of triangles and borders than this are left as they are: pairs are tested one by one.
const MOST_PAIRS: usize = 1 << 26;

impl Skew {
    /// Returns a ray's direction at a point, given the blend of those at the triangle's vertices.
    #[inline]
    pub fn turned(&self, low: &Mesh, point: Point, direction: Vec3) -> Vec3 {
        match self {
            Self::Kept => direction,
            Self::Faces(faces) => match faces.get(point.triangle as usize) {
                Some(Some(face)) => toward(direction, face.normal, face.fraction(point.position(low))),
                _ => direction,
            },
            Self::Mask(mask) => {
                let normal = facet_normal(low.corners(point.triangle as usize)).unwrap_or(direction);
                toward(direction, normal, Sampler::default().sample(mask, point.uv(low, 0), 0.0)[0])
            }
        }
    }

    /// Finds the flat faces on which the scan follows the face rather than the averaged directions of its vertices,
    /// `directions`, each with the ray distance of the other slice.
    ///
    /// The band along a border is as wide as the ray distance times the tangent of the largest deviation. The turn
    /// follows a smoothstep, whose slope is at most 1.5, so that rays of neighbouring texels do not cross within
    /// two thirds of the ray distance; by default, the scan is within half of it.
    pub fn of_flat_faces(low: &Mesh, rays: (&[Vec3], &[f32]), evidence: &[Evidence]) -> Self {
        if !evidence.iter().any(Evidence::is_skewed) {
            return Self::Kept;
        }
        let bends = Bends::of(low);
        let of_triangle = bends.flat_faces();
        let count = of_triangle.len();
        let triangles = Groups::new(count, || of_triangle.iter().map(|face| *face as usize).zip(0u32..));
        let borders: Vec<(usize, [Vec3; 2])> = bends
            .edges()
            .filter(|edge| of_triangle[edge.triangle] != of_triangle[edge.other])
            .flat_map(|edge| {
                let ends = bends.ends(edge).map(Vec3::to_f32);
                [edge.triangle, edge.other].map(|t| (of_triangle[t] as usize, ends))
            })
            .collect();
        let borders = Groups::new(count, || borders.iter().copied());
        let faces = parallel::collect(count, |face| {
            let shape = FaceShape { low, triangles: triangles.of(face), borders: borders.of(face) };
            let sum =
                shape.triangles.iter().fold(Evidence::default(), |sum, t| sum.and(evidence[*t as usize]));
            if sum.is_skewed() { shape.straightened(rays) } else { None }
        });
        let of_triangle = parallel::collect(count, |t| {
            let face = of_triangle[t] as usize;
            let (normal, band) = faces[face]?;
            Some(FlatFace { normal, band, borders: near(low.corners(t), band, borders.of(face)) })
        });
        Self::Faces(of_triangle.into())
    }
}

/// Returns `direction` turned towards `normal` by a fraction.
fn toward(direction: Vec3, normal: Vec3, fraction: f32) -> Vec3 {
    (direction * (1.0 - fraction) + normal * fraction).normalize_or(direction)
}

impl FlatFace {
    /// Returns the fraction of the turn at a point: 0 at a border, 1 beyond the band.
    fn fraction(&self, at: Vec3) -> f32 {
        let squared = self.borders.iter().map(|border| squared_distance(*border, at));
        let nearest = squared.fold(self.band * self.band, f32::min).sqrt();
        let x = nearest / self.band;
        x * x * (3.0 - 2.0 * x)
    }
}

/// A set of coplanar, connected triangles of a mesh.
struct FaceShape<'a> {
    low: &'a Mesh,
    triangles: &'a [u32],
    /// Edges to triangles of other faces.
    borders: &'a [[Vec3; 2]],
}

impl FaceShape<'_> {
    /// Returns the normal and the width of the band, given the directions and distances of the mesh's rays; `None` if
    /// the face is not flat after all, or its rays are straight.
    fn straightened(&self, (directions, distances): (&[Vec3], &[f32])) -> Option<(Vec3, f32)> {
        if self.triangles.len().saturating_mul(self.borders.len()) > MOST_PAIRS {
            return None;
        }
        let corners = |t: &u32| self.low.corners(*t as usize);
        let sum = self
            .triangles
            .iter()
            .map(corners)
            .fold(Vec3::default(), |sum, [a, b, c]| sum + (b - a).cross(c - a));
        let normal = sum.normalize_or(Vec3::default());
        let least = scalar::cos(FLAT_DEG.to_radians()) as f32;
        let is_flat = |t: &u32| facet_normal(corners(t)).is_none_or(|facet| facet.dot(normal) >= least);
        if !self.triangles.iter().all(is_flat) {
            return None;
        }
        let vertices = || self.triangles.iter().flat_map(|t| self.low.triangles()[*t as usize]);
        let cosine = vertices().map(|v| directions[v as usize].dot(normal)).fold(1.0, f32::min);
        let distance = vertices().map(|v| distances[v as usize]).fold(0.0, f32::max);
        let tangent = (1.0 - cosine * cosine).max(0.0).sqrt() / cosine.max(f32::MIN_POSITIVE);
        let is_skewed = cosine < scalar::cos(STRAIGHT_DEG.to_radians()) as f32;
        is_skewed.then_some((normal, distance * tangent.min(STEEPEST)))
    }
}

/// Returns the borders whose bounding boxes are within a distance of a triangle's.
fn near(corners: [Vec3; 3], distance: f32, borders: &[[Vec3; 2]]) -> Vec<[Vec3; 2]> {
    let bounds = |points: &[Vec3], axis: usize| {
        let values = points.iter().map(|p| p.to_array()[axis]);
        values.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
    };
    let own: [(f32, f32); 3] = std::array::from_fn(|axis| bounds(&corners, axis));
    let is_near = |border: &&[Vec3; 2]| {
        own.into_iter().enumerate().all(|(axis, (low, high))| {
            let (from, to) = bounds(*border, axis);
            from <= high + distance && to >= low - distance
        })
    };
    borders.iter().filter(is_near).copied().collect()
}

fn squared_distance([a, b]: [Vec3; 2], point: Vec3) -> f32 {
    let (way, from) = (b - a, point - a);
    let along = (from.dot(way) / way.dot(way).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    let off = from - way * along;
    off.dot(off)
}
