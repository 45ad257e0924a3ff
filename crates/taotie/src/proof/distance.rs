//! The largest distance of a surface from another, between two bounds that are proven.

use super::pair::Side;
use crate::bake::Scan;
use crate::math::Vec3;
use crate::mesh::{Mesh, Point, blend};
use crate::parallel;
use crate::trace::distance_to_triangle;

/// Triangles that are looked at together before any of them is looked at alone.
const BLOCK: usize = 32;
/// Pieces of triangles that are looked at, at most; the upper bound is then wider than was asked for.
const MOST_PIECES: usize = 4_000_000;
/// Rounding of distances in single precision, as a part of the largest coordinate.
const ROUNDING: f32 = 1e-6;
/// Hidden pieces that are no larger than this part of the surface's diagonal are passed over as a whole.
const HIDDEN_PIECE: f32 = 0.01;

/// Two numbers between which the largest distance of a surface from another lies.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct DistanceBounds {
    /// The distance of a point that was found, model units.
    pub lower: f64,
    /// No point is farther away, model units.
    pub upper: f64,
}

impl DistanceBounds {
    /// Bounds a distance that is known.
    pub fn exactly(distance: f64) -> Self {
        Self { lower: distance, upper: distance }
    }

    /// Returns the bounds of the larger of two distances.
    pub fn larger(self, other: Self) -> Self {
        Self { lower: self.lower.max(other.lower), upper: self.upper.max(other.upper) }
    }

    /// Returns both bounds times a factor.
    pub fn scaled(self, factor: f64) -> Self {
        Self { lower: self.lower * factor, upper: self.upper * factor }
    }
}

/// Bounds the largest distance of a surface from `to`, up to `width` model units apart where the search ends in time. Of a
/// surface with hidden parts `visible` holds what is seen; `None` takes all of it. `known` is the distance of a point that was
/// found already.
///
/// The distance of a point changes by no more than the point moves, and the distance from one triangle is convex. So over a
/// piece of a triangle it is at most that of its middle plus the piece's radius, and at most the largest of its corners from
/// the triangle closest to its middle. Pieces that may hold a larger distance than was found are cut in four.
pub fn distance_bounds(from: Source<'_>, to: &Scan, width: f32) -> DistanceBounds {
    let mesh = from.mesh;
    let slack = ROUNDING * largest_coordinate([mesh, to.mesh()]);
    let mut search = Search { from, to, width: width.max(slack), lower: from.known, upper: from.known };
    let mut pieces = search.all_pieces();
    let mut looked_at = 0;
    while !pieces.is_empty() {
        looked_at += pieces.len();
        let bounded = search.bounded(pieces);
        pieces = search.promising(bounded);
        if looked_at + pieces.len() * 4 > MOST_PIECES {
            search.upper = pieces.iter().fold(search.upper, |upper, piece| upper.max(piece.most));
            break;
        }
        pieces = pieces.iter().flat_map(Piece::quarters).collect();
    }
    let upper = f64::from(search.upper.max(search.lower) + slack);
    DistanceBounds { lower: f64::from((search.lower - slack).max(0.0)), upper }
}

/// The surface whose distance is measured.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    /// Its triangles.
    pub mesh: &'a Mesh,
    /// What can be seen of it, if only that counts.
    pub visible: Option<&'a Side<'a>>,
    /// The distance of one of its points that counts, model units.
    pub known: f32,
}

/// A part of a triangle.
#[derive(Debug, Clone, Copy, Default)]
struct Piece {
    triangle: u32,
    /// The weights of the triangle's corners at its own corners.
    corners: [[f32; 3]; 3],
    /// The distance of its middle.
    middle: f32,
    /// No point of it is farther away.
    most: f32,
}

impl Piece {
    fn whole(triangle: usize) -> Self {
        let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        Self { triangle: triangle as u32, corners, ..Self::default() }
    }

    fn places(&self, mesh: &Mesh) -> [Vec3; 3] {
        let corners = mesh.corners(self.triangle as usize);
        self.corners.map(|weights| blend(corners, weights))
    }

    fn middle_weights(&self) -> [f32; 3] {
        std::array::from_fn(|k| self.corners.iter().map(|weights| weights[k]).sum::<f32>() / 3.0)
    }

    fn quarters(&self) -> [Self; 4] {
        let [a, b, c] = self.corners;
        let between = |p: [f32; 3], q: [f32; 3]| std::array::from_fn(|k| (p[k] + q[k]) * 0.5);
        let (ab, bc, ca) = (between(a, b), between(b, c), between(c, a));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].map(|corners| Self { corners, ..*self })
    }
}

struct Search<'a> {
    from: Source<'a>,
    to: &'a Scan,
    width: f32,
    lower: f32,
    upper: f32,
}

impl Search<'_> {
    /// Returns the triangles, but for blocks of them that hold no larger distance than is known.
    fn all_pieces(&mut self) -> Vec<Piece> {
        let mesh = self.from.mesh;
        let count = mesh.triangles().len();
        let block = |i: usize| i * BLOCK..((i + 1) * BLOCK).min(count);
        let enough = self.lower + self.width;
        let most: Vec<f32> = parallel::collect(count.div_ceil(BLOCK), |i| self.most_of_block(block(i)));
        for most in most.iter().filter(|most| **most <= enough) {
            self.upper = self.upper.max(*most);
        }
        let kept = (0..most.len()).filter(|i| most[*i] > enough);
        kept.flat_map(block).map(Piece::whole).collect()
    }

    /// Returns a distance that no point of some triangles exceeds.
    fn most_of_block(&self, triangles: std::ops::Range<usize>) -> f32 {
        let mesh = self.from.mesh;
        let corners = || triangles.clone().flat_map(|t| mesh.corners(t));
        let count = corners().count().max(1) as f32;
        let center = corners().fold(Vec3::splat(0.0), |sum, corner| sum + corner) * (1.0 / count);
        let radius = corners().map(|corner| (corner - center).length()).fold(0.0, f32::max);
        let reach = self.lower + self.width;
        // Farther than that the block is not passed over anyway.
        let closest = if radius < reach { self.to.bvh().closest(center, reach) } else { None };
        closest.map_or(f32::INFINITY, |closest| closest.distance + radius)
    }

    /// Bounds the distances of pieces.
    fn bounded(&self, mut pieces: Vec<Piece>) -> Vec<Piece> {
        parallel::change(&mut pieces, |_, piece| {
            let places = piece.places(self.from.mesh);
            let middle = (places[0] + places[1] + places[2]) * (1.0 / 3.0);
            let Some(closest) = self.to.bvh().closest(middle, f32::INFINITY) else { return };
            let radius = places.into_iter().map(|place| (place - middle).length()).fold(0.0, f32::max);
            let triangle = self.to.mesh().corners(closest.triangle as usize);
            let from_one =
                places.map(|place| distance_to_triangle(triangle, place)).into_iter().fold(0.0, f32::max);
            piece.middle = closest.distance;
            piece.most = (closest.distance + radius).min(from_one).max(closest.distance);
        });
        pieces
    }

    /// Raises the lower bound, and returns the pieces that may hold a larger distance.
    fn promising(&mut self, mut pieces: Vec<Piece>) -> Vec<Piece> {
        pieces.sort_by(|a, b| b.middle.total_cmp(&a.middle).then(a.triangle.cmp(&b.triangle)));
        let farthest =
            pieces.iter().take_while(|piece| piece.middle > self.lower).find(|piece| self.is_seen(piece));
        if let Some(farthest) = farthest {
            self.lower = farthest.middle;
        }
        let enough = self.lower + self.width;
        let dropped = pieces.iter().map(|piece| piece.most).filter(|most| *most <= enough);
        self.upper = dropped.fold(self.upper, f32::max);
        pieces.retain(|piece| piece.most > enough);
        if self.from.visible.is_some() {
            let is_hidden: Vec<bool> = parallel::collect(pieces.len(), |i| self.is_hidden(&pieces[i]));
            let mut hidden = is_hidden.into_iter();
            pieces.retain(|_| hidden.next() != Some(true));
        }
        pieces
    }

    /// Returns `true` if the middle of a piece counts.
    fn is_seen(&self, piece: &Piece) -> bool {
        let Some(side) = self.from.visible else { return true };
        side.surface.is_seen(Point { triangle: piece.triangle, weights: piece.middle_weights() })
    }

    /// Returns `true` for a small piece whose middle cannot be seen.
    fn is_hidden(&self, piece: &Piece) -> bool {
        let [a, b, c] = piece.places(self.from.mesh);
        let size = (b - a).length().max((c - b).length()).max((a - c).length());
        size <= HIDDEN_PIECE * self.from.mesh.diagonal() as f32 && !self.is_seen(piece)
    }
}

fn largest_coordinate(meshes: [&Mesh; 2]) -> f32 {
    let coordinates = meshes.into_iter().flat_map(|mesh| mesh.positions()).flat_map(|p| p.to_array());
    coordinates.fold(0.0, |most, v| most.max(v.abs()))
}
