//! Triangles around vertices, while individual triangles are being changed.

use crate::groups::Groups;
use crate::math::Vec3;

/// Replaces a triangle that was removed.
const REMOVED: [u32; 3] = [u32::MAX; 3];

/// The shape of a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    /// Twice the area, along the normal.
    pub vector: Vec3<f64>,
    /// The square of the longest edge.
    longest: f64,
}

impl Shape {
    pub fn of(points: &[[f32; 3]], triangle: [u32; 3]) -> Self {
        let [a, b, c] = triangle.map(|v| position(points, v));
        let squares = [b - a, c - b, a - c].map(|edge| edge.dot(edge));
        Self { vector: (b - a).cross(c - a), longest: squares.into_iter().fold(0.0, f64::max) }
    }

    /// Returns the height above the longest edge, as a fraction of that edge: 0 without an area, 0.87 at most.
    pub fn height(&self) -> f64 {
        if self.longest > 0.0 { self.vector.length() / self.longest } else { 0.0 }
    }

    /// Returns the height above the longest edge, in the units of the points.
    pub fn altitude(&self) -> f64 {
        self.height() * self.longest.sqrt()
    }

    /// Returns the cosine between its normal and a direction; 0 if either is zero.
    pub fn cosine(&self, direction: Vec3<f64>) -> f64 {
        let length = self.vector.length() * direction.length();
        if length > 0.0 { self.vector.dot(direction) / length } else { 0.0 }
    }
}

/// Two triangles sharing an edge, and the two sharing the other diagonal.
pub(super) struct Flip {
    /// The indices of the triangles.
    places: [usize; 2],
    pub before: [[u32; 3]; 2],
    pub after: [[u32; 3]; 2],
}

fn position(points: &[[f32; 3]], v: u32) -> Vec3<f64> {
    Vec3::from_array(points[v as usize]).to_f64()
}

/// Triangles, indexed by the vertices around which they lie.
///
/// The index of a vertex is valid as long as no triangle around it was changed; see [`Fans::are_untouched`].
pub(super) struct Fans<'a> {
    points: &'a [[f32; 3]],
    triangles: Vec<[u32; 3]>,
    /// The triangles around each vertex.
    around: Groups<u32>,
    /// `true` for each triangle that was changed.
    touched: Vec<bool>,
}

impl<'a> Fans<'a> {
    pub fn new(points: &'a [[f32; 3]], triangles: Vec<[u32; 3]>) -> Self {
        let around = Groups::new(points.len(), || {
            let numbered = (0u32..).zip(&triangles);
            numbered.flat_map(|(t, triangle)| triangle.iter().map(move |v| (*v as usize, t)))
        });
        let touched = vec![false; triangles.len()];
        Self { points, triangles, around, touched }
    }

    /// Returns the number of triangles, including removed ones.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Returns the remaining triangles, in their order.
    pub fn into_triangles(self) -> Vec<[u32; 3]> {
        self.triangles.into_iter().filter(|triangle| *triangle != REMOVED).collect()
    }

    /// Returns `true` if a triangle was changed.
    pub fn is_touched(&self, t: usize) -> bool {
        self.touched[t]
    }

    /// Returns `true` if no triangle around these vertices was changed.
    pub fn are_untouched(&self, vertices: &[u32]) -> bool {
        vertices.iter().all(|v| self.fan(*v).all(|t| !self.touched[t]))
    }

    /// Returns the triangles around a vertex.
    pub fn around(&self, v: u32) -> &[u32] {
        self.around.of(v as usize)
    }

    fn fan(&self, v: u32) -> impl Iterator<Item = usize> {
        self.around(v).iter().map(|t| *t as usize)
    }

    /// Returns the triangles that contain both vertices.
    pub fn at_edge(&self, a: u32, b: u32) -> Vec<usize> {
        self.fan(a).filter(|t| self.triangles[*t].contains(&b)).collect()
    }

    /// Returns the corner of a triangle opposite its directed edge from `a` to `b`; `None` if it has no such edge.
    pub fn opposite(&self, t: usize, a: u32, b: u32) -> Option<u32> {
        let corners = self.triangles[t];
        (0..3).find(|k| corners[*k] == a && corners[(k + 1) % 3] == b).map(|k| corners[(k + 2) % 3])
    }

    /// Returns the corners of a triangle, rotated so that its longest edge comes first.
    pub fn longest_first(&self, t: usize) -> [u32; 3] {
        self.turned(t, |new, best| new > best)
    }

    /// Returns the corners of a triangle, rotated so that its shortest edge comes first.
    pub fn shortest_first(&self, t: usize) -> [u32; 3] {
        self.turned(t, |new, best| new < best)
    }

    fn turned(&self, t: usize, is_better: impl Fn(f64, f64) -> bool) -> [u32; 3] {
        let [a, b, c] = self.triangles[t];
        let [first, rest @ ..] = [[a, b, c], [b, c, a], [c, a, b]];
        rest.into_iter().fold(
            first,
            |best, new| {
                if is_better(self.square(new), self.square(best)) { new } else { best }
            },
        )
    }

    /// Returns the squared length of the first edge.
    fn square(&self, [a, b, _]: [u32; 3]) -> f64 {
        let edge = position(self.points, b) - position(self.points, a);
        edge.dot(edge)
    }

    /// Returns `true` if a vertex has an edge that belongs to only one triangle.
    pub fn is_on_border(&self, v: u32) -> bool {
        let others = self.others(v);
        others.chunk_by(|a, b| a == b).any(|edge| edge.len() == 1)
    }

    /// Returns the other corners of the triangles around a vertex, sorted: each once per triangle.
    fn others(&self, v: u32) -> Vec<u32> {
        let mut others: Vec<u32> =
            self.fan(v).flat_map(|t| self.triangles[t]).filter(|other| *other != v).collect();
        others.sort_unstable();
        others
    }

    /// Returns `true` if the vertices of an edge can be merged without changing the topology: all their common
    /// neighbours are corners of triangles at the edge, both have other triangles, and none of those become equal.
    pub fn can_collapse(&self, a: u32, b: u32) -> bool {
        let at_edge = self.at_edge(a, b).len();
        let [mut of_a, mut of_b] = [self.others(a), self.others(b)];
        of_a.dedup();
        of_b.dedup();
        let common = of_a.iter().filter(|v| of_b.binary_search(v).is_ok()).count();
        let both_stay = [a, b].iter().all(|v| self.fan(*v).count() > at_edge);
        (1..=2).contains(&at_edge) && common == at_edge && both_stay && !self.have_equal_sides(a, b)
    }

    /// Returns `true` if a triangle around one vertex and one around the other have the same opposite edge.
    fn have_equal_sides(&self, a: u32, b: u32) -> bool {
        let of_b = self.sides(b, a);
        self.sides(a, b).iter().any(|side| of_b.contains(side))
    }

    /// Returns the edges opposite a vertex, each sorted, of its triangles that do not contain another vertex.
    fn sides(&self, v: u32, without: u32) -> Vec<[u32; 2]> {
        let side = |t: [u32; 3]| {
            let at = t.iter().position(|corner| *corner == v).unwrap_or_default();
            let [one, other] = [t[(at + 1) % 3], t[(at + 2) % 3]];
            [one.min(other), one.max(other)]
        };
        self.open(v, without).into_iter().map(side).collect()
    }

    /// Returns the triangles around a vertex that do not contain another one.
    fn open(&self, v: u32, without: u32) -> Vec<[u32; 3]> {
        self.fan(v).map(|t| self.triangles[t]).filter(|t| !t.contains(&without)).collect()
    }

    /// Returns the triangles that change if a vertex moves to another one: before and after.
    pub fn moved(&self, from: u32, to: u32) -> Vec<[[u32; 3]; 2]> {
        self.open(from, to).into_iter().map(|t| [t, renamed(t, from, to)]).collect()
    }

    /// Returns `true` if a vertex can move along an edge to another one without changing the border.
    pub fn keeps_border(&self, from: u32, to: u32) -> bool {
        !self.is_on_border(from) || self.at_edge(from, to).len() == 1
    }

    /// Returns the shape of a triangle.
    pub fn shape(&self, triangle: [u32; 3]) -> Shape {
        Shape::of(self.points, triangle)
    }

    /// Returns the corners of a triangle.
    pub fn corners(&self, t: usize) -> [u32; 3] {
        self.triangles[t]
    }

    /// Returns the two triangles on the other diagonal after flipping a triangle's edge from `a` to `b`; `None` if
    /// the flip is not allowed: at a border, if more than two triangles share the edge, if the other diagonal is
    /// already an edge, or if something around was changed.
    pub fn flip(&self, t: usize, [a, b, c]: [u32; 3]) -> Option<Flip> {
        let [one, other] = self.at_edge(a, b).try_into().ok()?;
        let neighbour = if one == t { other } else { one };
        // The neighbouring triangle runs along the edge in the other direction.
        let d = self.opposite(neighbour, b, a)?;
        let is_possible = c != d && self.are_untouched(&[a, b, c, d]) && self.at_edge(c, d).is_empty();
        is_possible.then_some(Flip {
            places: [t, neighbour],
            before: [[a, b, c], [b, a, d]],
            after: [[a, d, c], [d, b, c]],
        })
    }

    /// Replaces the two old triangles of a flip with the new ones.
    pub fn take(&mut self, flip: &Flip) {
        for (t, triangle) in flip.places.into_iter().zip(flip.after) {
            self.replace(t, triangle);
        }
    }

    /// Merges the two vertices of an edge.
    pub fn collapse(&mut self, from: u32, to: u32) {
        let fans: Vec<usize> = self.fan(from).chain(self.fan(to)).collect();
        for t in fans {
            let triangle = self.triangles[t];
            match triangle.contains(&from) && triangle.contains(&to) {
                true => self.remove(t),
                false => self.replace(t, renamed(triangle, from, to)),
            }
        }
    }

    /// Replaces the corners of a triangle.
    pub fn replace(&mut self, t: usize, triangle: [u32; 3]) {
        self.triangles[t] = triangle;
        self.touched[t] = true;
    }

    /// Removes a triangle.
    pub fn remove(&mut self, t: usize) {
        self.replace(t, REMOVED);
    }
}

fn renamed(triangle: [u32; 3], from: u32, to: u32) -> [u32; 3] {
    triangle.map(|v| if v == from { to } else { v })
}
