//! How far the shapes of two surfaces are apart: the largest distance with proven bounds, and the root mean square.

use super::close_up::{CloseUp, SurfaceSample};
use super::{Pair, Side};
use crate::bake::Scan;
use crate::math::Vec3;
use crate::mesh::{Mesh, Point, blend};
use crate::parallel;
use crate::trace::farthest_distance;
use fearless_simd::Level;

/// If less of a surface is hidden than this, visibility is not searched: noise and folds hide as much.
const HARDLY_HIDDEN: f64 = 1e-3;
/// The width of the bounds of distances, as a fraction of the diagonal, and as a fraction of the distance.
const WIDTH: [f32; 2] = [5e-4, 0.05];
/// Number of triangles of both surfaces above which the bounds widen in proportion, and the maximum factor.
const MANY: usize = 350_000;
const WIDEST: f32 = 3.0;
/// The bounds narrow in proportion if more points than these are examined.
const POINTS: f32 = 20_000.0;
/// Maximum number of triangles of the other surface with which a cluster of triangles is compared.
const MOST_NEAR: usize = 768;
/// Maximum number of times a triangle is subdivided before its pieces are bounded in order of distance.
const MOST_CUTS: u32 = 3;
/// Maximum number of pieces of triangles examined; beyond it the upper bound is wider than requested.
const MOST_PIECES: usize = 4_000_000;
/// Hidden pieces no larger than this fraction of the surface's diagonal are skipped as a whole.
const HIDDEN_PIECE: f32 = 0.01;

/// Bounds the largest (Hausdorff) distance between the visible parts of two surfaces, in both directions, in model
/// units. `close_ups` are those of the scan and of the asset; the bounds narrow in proportion to `points` above
/// 20,000.
pub fn hausdorff(pair: &Pair<'_>, close_ups: [&CloseUp; 2], points: usize) -> DistanceBounds {
    let samples = || close_ups.into_iter().flat_map(|close_up| &close_up.samples);
    let farthest = samples().max_by(|a, b| a.distance.total_cmp(&b.distance));
    let known = farthest.map_or(0.0, |sample| sample.distance);
    let triangles: usize =
        [pair.scan, pair.asset].map(|side| side.surface.mesh().triangles().len()).iter().sum();
    let wider = (triangles as f32 / MANY as f32).clamp(1.0, WIDEST);
    // Narrower if more points have to decide a requirement.
    let width =
        (pair.diagonal * WIDTH[0]).max(known * WIDTH[1]) * wider * (POINTS / points.max(1) as f32).min(1.0);
    let sides = [(pair.scan, pair.asset), (pair.asset, pair.scan)];
    let at = farthest.map(|sample| sample.position.to_f64().to_array());
    let start = DistanceBounds { at, ..DistanceBounds::exactly(f64::from(known)) };
    sides.into_iter().zip(close_ups).fold(start, |bounds, ((side, to), close_up)| {
        // Only a distance larger than that of the other direction matters.
        let known = bounds.lower as f32;
        let source =
            Source { side, is_partly_hidden: close_up.hidden + close_up.transparent > HARDLY_HIDDEN, known };
        bounds.larger(distance_bounds(source, to.surface, width))
    })
}

/// Returns the largest distance between the visible parts of two surfaces if it may exceed `limit`, in model units; `None`
/// if it does not. Much faster than [`hausdorff`], since only pieces beyond the limit are followed.
pub fn stray(pair: &Pair<'_>, limit: f32) -> Option<f32> {
    let width = pair.diagonal * WIDTH[0];
    let beyond = |(side, to): (&Side<'_>, &Side<'_>)| {
        let source = Source { side, is_partly_hidden: true, known: limit };
        distance_bounds(source, to.surface, width).lower as f32
    };
    let farthest = [(pair.scan, pair.asset), (pair.asset, pair.scan)].map(beyond);
    farthest.into_iter().filter(|distance| *distance > limit).reduce(f32::max)
}

/// Returns the root mean square distance over the points of both surfaces, in model units.
pub fn root_mean_square(close_ups: [&CloseUp; 2]) -> f64 {
    let samples = || close_ups.into_iter().flat_map(|close_up| &close_up.samples);
    let squared = |sample: &SurfaceSample| f64::from(sample.distance) * f64::from(sample.distance);
    let sum = samples().map(squared).fold(0.0, |sum, one| sum + one);
    (sum / samples().count().max(1) as f64).sqrt()
}

/// Bounds of the largest distance of a surface from another.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct DistanceBounds {
    /// The distance of a point that was found, in model units.
    pub lower: f64,
    /// The distance that no point exceeds, in model units. If parts of the surface are hidden, pieces of up to 1 % of its
    /// diagonal count as a whole: as hidden if their middle is.
    pub upper: f64,
    /// The point at the lower bound, in model units; `None` if unknown.
    #[serde(skip)]
    pub at: Option<[f64; 3]>,
}

impl DistanceBounds {
    /// Bounds a known distance.
    pub fn exactly(distance: f64) -> Self {
        Self { lower: distance, upper: distance, at: None }
    }

    /// Returns the bounds of the larger of two distances.
    pub fn larger(self, other: Self) -> Self {
        let at = if other.lower > self.lower { other.at } else { self.at };
        Self { lower: self.lower.max(other.lower), upper: self.upper.max(other.upper), at }
    }

    /// Returns both bounds times a factor.
    pub fn scaled(self, factor: f64) -> Self {
        Self { lower: self.lower * factor, upper: self.upper * factor, ..self }
    }
}

/// Bounds the largest distance of a surface from `to`, to within `width` model units if the search ends in time.
///
/// The distance of a point changes by no more than the point moves, and the distance from one triangle is convex. So
/// over a piece of a triangle it is at most that of its centroid plus the piece's radius, and at most the largest of
/// its corners from any one triangle. Pieces that may have a larger distance than found so far are split into four.
pub fn distance_bounds(from: Source<'_>, to: &Scan, width: f32) -> DistanceBounds {
    let slack = from.side.surface.mesh().rounding().max(to.mesh().rounding());
    let width = width.max(slack);
    let hidden_piece = HIDDEN_PIECE * from.side.surface.mesh().diagonal() as f32;
    let (lower, upper) = (from.known, from.known);
    let mut search = Search { from, to, width, slack, hidden_piece, lower, upper, at: None };
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
    let at = search.at.map(|at| at.to_f64().to_array());
    DistanceBounds { lower: f64::from((search.lower - slack).max(0.0)), upper, at }
}

/// The surface whose distance is measured.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    /// The surface and its visibility.
    pub side: &'a Side<'a>,
    /// `true` if only the visible part counts.
    pub is_partly_hidden: bool,
    /// The known distance of a visible point, in model units.
    pub known: f32,
}

/// A part of a triangle.
#[derive(Debug, Clone, Copy, Default)]
struct Piece {
    triangle: u32,
    /// The weights of the triangle's corners at its own corners.
    corners: [[f32; 3]; 3],
    /// The distance of its centroid.
    middle: f32,
    /// The distance that no point of it exceeds.
    most: f32,
    /// `true` if its centroid is visible.
    is_seen: bool,
}

impl Piece {
    fn whole(triangle: u32) -> Self {
        let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        Self { triangle, corners, most: f32::INFINITY, is_seen: true, ..Self::default() }
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
    /// Rounding of distances, in model units.
    slack: f32,
    /// Hidden pieces no larger than this are skipped, in model units.
    hidden_piece: f32,
    lower: f32,
    upper: f32,
    /// The position of the lower bound, if the search found it.
    at: Option<Vec3>,
}

impl Search<'_> {
    fn mesh(&self) -> &Mesh {
        self.from.side.surface.mesh()
    }

    /// Returns the triangles, or pieces of them, that may exceed the known distance.
    fn all_pieces(&mut self) -> Vec<Piece> {
        let clusters: Vec<Vec<u32>> = self.from.side.surface.bvh().clusters().collect();
        let settled = parallel::collect(clusters.len(), |i| self.settled(&clusters[i]));
        let most = settled.iter().map(|(most, _)| *most);
        self.upper = most.fold(self.upper, f32::max);
        settled.into_iter().flat_map(|(_, rest)| rest).collect()
    }

    /// Compares a cluster of triangles with nearby ones of the other surface: returns the largest bound of those that
    /// do not exceed the known distance, and the pieces that may.
    fn settled(&self, triangles: &[u32]) -> (f32, Vec<Piece>) {
        let corners = |t: u32| self.mesh().corners(t as usize);
        let Some(near) = Near::of(triangles.iter().flat_map(|t| corners(*t)), self) else {
            return match triangles {
                [only] => (0.0, vec![Piece::whole(*only)]),
                several => {
                    let mut all = (0f32, Vec::new());
                    for one in several {
                        let (most, rest) = self.settled(&[*one]);
                        all.0 = all.0.max(most);
                        all.1.extend(rest);
                    }
                    all
                }
            };
        };
        let (mut most, mut rest) = (0f32, Vec::new());
        for triangle in triangles {
            let whole = Piece::whole(*triangle);
            match near.bound(whole.places(self.mesh())) {
                bound if bound <= near.enough => most = most.max(bound),
                _ => most = most.max(self.settle_quarters(&whole, &near, &mut rest)),
            }
        }
        (most, rest)
    }

    /// Splits a piece until all pieces are bounded by one triangle each, up to a limit; adds those that are not to
    /// `rest`.
    fn settle_quarters(&self, piece: &Piece, near: &Near, rest: &mut Vec<Piece>) -> f32 {
        let mut most = 0f32;
        let mut waiting = piece.quarters().map(|quarter| (quarter, 1)).to_vec();
        while let Some((piece, cuts)) = waiting.pop() {
            match near.quick_bound(piece.places(self.mesh())) {
                bound if bound <= near.enough => most = most.max(bound),
                _ if cuts < MOST_CUTS => {
                    waiting.extend(piece.quarters().map(|quarter| (quarter, cuts + 1)));
                }
                _ => rest.push(piece),
            }
        }
        most
    }

    /// Bounds the distances of pieces.
    fn bounded(&self, mut pieces: Vec<Piece>) -> Vec<Piece> {
        parallel::change(&mut pieces, |_, piece| {
            let places = piece.places(self.mesh());
            let middle = (places[0] + places[1] + places[2]) * (1.0 / 3.0);
            // The distance that no point of the parent piece exceeds.
            let reach = piece.most + self.slack;
            let Some(closest) = self.to.bvh().closest(middle, reach) else { return };
            let radius = places.into_iter().map(|place| (place - middle).length()).fold(0.0, f32::max);
            let triangle = self.to.mesh().corners(closest.triangle as usize);
            let from_one = farthest_distance(self.to.bvh().level(), triangle, &places);
            piece.middle = closest.distance;
            piece.most = (closest.distance + radius).min(from_one).max(closest.distance);
        });
        pieces
    }

    /// Raises the lower bound, and returns the pieces that may exceed it.
    fn promising(&mut self, mut pieces: Vec<Piece>) -> Vec<Piece> {
        if self.from.is_partly_hidden {
            pieces.retain(|piece| piece.most > self.lower);
            parallel::change(&mut pieces, |_, piece| piece.is_seen = self.is_seen(piece));
        }
        for piece in pieces.iter().filter(|piece| piece.is_seen) {
            if piece.middle > self.lower {
                self.lower = piece.middle;
                self.at = Some(blend(self.mesh().corners(piece.triangle as usize), piece.middle_weights()));
            }
        }
        let enough = self.lower + self.width;
        pieces.retain(|piece| piece.is_seen || self.size(piece) > self.hidden_piece);
        let dropped = pieces.iter().map(|piece| piece.most).filter(|most| *most <= enough);
        self.upper = dropped.fold(self.upper, f32::max);
        pieces.retain(|piece| piece.most > enough);
        pieces
    }

    /// Returns `true` if the centroid of a piece is visible.
    fn is_seen(&self, piece: &Piece) -> bool {
        let point = Point { triangle: piece.triangle, weights: piece.middle_weights() };
        let surface = self.from.side.surface;
        surface.is_seen(point) && surface.surface().is_shown_at(point)
    }

    /// Returns the longest edge of a piece.
    fn size(&self, piece: &Piece) -> f32 {
        let [a, b, c] = piece.places(self.mesh());
        (b - a).length().max((c - b).length()).max((a - c).length())
    }
}

/// The triangles of the other surface near some points.
struct Near {
    triangles: Vec<[Vec3; 3]>,
    /// The centroids of the triangles, in groups of eight, coordinate by coordinate; infinite beyond the last.
    middles: Vec<[[f32; LANES]; 3]>,
    /// A distance small enough not to need further refinement.
    enough: f32,
    level: Level,
}

/// Number of centroids compared in parallel.
const LANES: usize = 8;

impl Near {
    /// Returns all triangles that may be within the known distance of some points; `None` if there are too many or
    /// none.
    fn of(points: impl Iterator<Item = Vec3> + Clone, search: &Search<'_>) -> Option<Self> {
        let count = points.clone().count() as f32;
        let center = points.clone().fold(Vec3::splat(0.0), |sum, point| sum + point) * (1.0 / count);
        let radius = points.map(|point| (point - center).length()).fold(0.0, f32::max);
        let enough = search.lower + search.width;
        let found = search.to.bvh().within(center, radius + enough + search.slack, MOST_NEAR)?;
        if found.is_empty() {
            return None;
        }
        let triangles: Vec<[Vec3; 3]> = found.iter().map(|t| search.to.mesh().corners(*t as usize)).collect();
        let mut middles = vec![[[f32::INFINITY; LANES]; 3]; triangles.len().div_ceil(LANES)];
        for (i, [a, b, c]) in triangles.iter().enumerate() {
            let middle = (*a + *b + *c) * (1.0 / 3.0);
            for (axis, v) in middle.to_array().into_iter().enumerate() {
                middles[i / LANES][axis][i % LANES] = v;
            }
        }
        Some(Self { triangles, middles, enough, level: search.to.bvh().level() })
    }

    /// Bounds the distances of a triangle's points by one of the triangles: the first that is near enough, else the
    /// best.
    fn bound(&self, places: [Vec3; 3]) -> f32 {
        let mut least = self.quick_bound(places);
        for triangle in &self.triangles {
            if least <= self.enough {
                break;
            }
            least = least.min(farthest_distance(self.level, *triangle, &places));
        }
        least
    }

    /// Bounds them by the triangle with the closest centroid.
    fn quick_bound(&self, places: [Vec3; 3]) -> f32 {
        let middle = (places[0] + places[1] + places[2]) * (1.0 / 3.0);
        farthest_distance(self.level, self.triangles[self.closest_middle(middle)], &places)
    }

    /// Returns the triangle whose centroid is closest to a point, the first in a tie.
    fn closest_middle(&self, point: Vec3) -> usize {
        let (mut least, mut found) = ([f32::INFINITY; LANES], [0u32; LANES]);
        for (group, [x, y, z]) in self.middles.iter().enumerate() {
            for i in 0..LANES {
                let away = [x[i] - point.x, y[i] - point.y, z[i] - point.z];
                let squared = away[0] * away[0] + away[1] * away[1] + away[2] * away[2];
                let is_closer = squared < least[i];
                least[i] = if is_closer { squared } else { least[i] };
                found[i] = if is_closer { group as u32 } else { found[i] };
            }
        }
        let index = |i: usize| found[i] as usize * LANES + i;
        let best = (0..LANES).min_by(|a, b| least[*a].total_cmp(&least[*b]).then(index(*a).cmp(&index(*b))));
        best.map_or(0, index).min(self.triangles.len() - 1)
    }
}
