//! Triangles around vertices, while single triangles are changed.

use crate::groups::Groups;
use crate::math::Vec3;

/// Stands in the place of a triangle that was removed.
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

    /// Returns the height above the longest edge, as a part of that edge: 0 without an area, 0.87 at most.
    pub fn height(&self) -> f64 {
        if self.longest > 0.0 { self.vector.length() / self.longest } else { 0.0 }
    }

    /// Returns the height above the longest edge, in the units of the points.
    pub fn altitude(&self) -> f64 {
        self.height() * self.longest.sqrt()
    }

    /// Returns the cosine between its normal and a direction; 0 where either is nothing.
    pub fn cosine(&self, direction: Vec3<f64>) -> f64 {
        let length = self.vector.length() * direction.length();
        if length > 0.0 { self.vector.dot(direction) / length } else { 0.0 }
    }
}

/// Two triangles at an edge, and the two at the other diagonal.
pub(super) struct Flip {
    /// Where the triangles stand.
    places: [usize; 2],
    pub before: [[u32; 3]; 2],
    pub after: [[u32; 3]; 2],
}

fn position(points: &[[f32; 3]], v: u32) -> Vec3<f64> {
    Vec3::from_array(points[v as usize]).to_f64()
}

/// Triangles, and which of them stand around each vertex.
///
/// What stands around a vertex is known as long as none of it was changed; see [`Fans::are_untouched`].
pub(super) struct Fans<'a> {
    points: &'a [[f32; 3]],
    triangles: Vec<[u32; 3]>,
    /// The triangles around each vertex.
    around: Groups<u32>,
    /// Whether each triangle was changed.
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

    /// Returns the number of triangles, those that were removed among them.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Returns the triangles that are left, in their order.
    pub fn into_triangles(self) -> Vec<[u32; 3]> {
        self.triangles.into_iter().filter(|triangle| *triangle != REMOVED).collect()
    }

    /// Returns `true` where a triangle was changed.
    pub fn is_touched(&self, t: usize) -> bool {
        self.touched[t]
    }

    /// Returns `true` where no triangle around these vertices was changed.
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

    /// Returns the triangles that have both vertices.
    pub fn at_edge(&self, a: u32, b: u32) -> Vec<usize> {
        self.fan(a).filter(|t| self.triangles[*t].contains(&b)).collect()
    }

    /// Returns the corner of a triangle behind the edge that it runs along from `a` to `b`; `None` where it does not.
    pub fn opposite(&self, t: usize, a: u32, b: u32) -> Option<u32> {
        let corners = self.triangles[t];
        (0..3).find(|k| corners[*k] == a && corners[(k + 1) % 3] == b).map(|k| corners[(k + 2) % 3])
    }

    /// Returns the corners of a triangle, turned so that its longest edge stands first.
    pub fn longest_first(&self, t: usize) -> [u32; 3] {
        self.turned(t, |new, best| new > best)
    }

    /// Returns the corners of a triangle, turned so that its shortest edge stands first.
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

    /// Returns the square of the first edge.
    fn square(&self, [a, b, _]: [u32; 3]) -> f64 {
        let edge = position(self.points, b) - position(self.points, a);
        edge.dot(edge)
    }

    /// Returns `true` where an edge at a vertex belongs to one triangle alone.
    pub fn is_on_border(&self, v: u32) -> bool {
        let others = self.others(v);
        others.chunk_by(|a, b| a == b).any(|edge| edge.len() == 1)
    }

    /// Returns the other corners of the triangles around a vertex, sorted: each once for a triangle.
    fn others(&self, v: u32) -> Vec<u32> {
        let mut others: Vec<u32> =
            self.fan(v).flat_map(|t| self.triangles[t]).filter(|other| *other != v).collect();
        others.sort_unstable();
        others
    }

    /// Returns `true` where the vertices of an edge can become one and the surface stays what it is: all their common
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

    /// Returns `true` where a triangle around one vertex and one around the other have the same edge opposite.
    fn have_equal_sides(&self, a: u32, b: u32) -> bool {
        let of_b = self.sides(b, a);
        self.sides(a, b).iter().any(|side| of_b.contains(side))
    }

    /// Returns the edges opposite a vertex, each in order, of the triangles without another vertex.
    fn sides(&self, v: u32, without: u32) -> Vec<[u32; 2]> {
        let side = |t: [u32; 3]| {
            let at = t.iter().position(|corner| *corner == v).unwrap_or_default();
            let [one, other] = [t[(at + 1) % 3], t[(at + 2) % 3]];
            [one.min(other), one.max(other)]
        };
        self.open(v, without).into_iter().map(side).collect()
    }

    /// Returns the triangles around a vertex that do not have another one.
    fn open(&self, v: u32, without: u32) -> Vec<[u32; 3]> {
        self.fan(v).map(|t| self.triangles[t]).filter(|t| !t.contains(&without)).collect()
    }

    /// Returns the triangles that change where a vertex moves to another one: before and after.
    pub fn moved(&self, from: u32, to: u32) -> Vec<[[u32; 3]; 2]> {
        self.open(from, to).into_iter().map(|t| [t, renamed(t, from, to)]).collect()
    }

    /// Returns `true` where a vertex can move along an edge to another one and the border stays where it is.
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

    /// Returns the two triangles on the other diagonal, once the edge from `a` to `b` of a triangle was flipped; `None`
    /// where that must not be: at a border, where more triangles meet or the other diagonal is an edge already, or where
    /// something around was changed.
    pub fn flip(&self, t: usize, [a, b, c]: [u32; 3]) -> Option<Flip> {
        let [one, other] = self.at_edge(a, b).try_into().ok()?;
        let beside = if one == t { other } else { one };
        // The triangle beside runs along the edge the other way.
        let d = self.opposite(beside, b, a)?;
        let is_possible = c != d && self.are_untouched(&[a, b, c, d]) && self.at_edge(c, d).is_empty();
        is_possible.then_some(Flip {
            places: [t, beside],
            before: [[a, b, c], [b, a, d]],
            after: [[a, d, c], [d, b, c]],
        })
    }

    /// Puts the two new triangles of a flip in the place of the old ones.
    pub fn take(&mut self, flip: &Flip) {
        for (t, triangle) in flip.places.into_iter().zip(flip.after) {
            self.replace(t, triangle);
        }
    }

    /// Makes two vertices of an edge one.
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

    /// Puts other corners in the place of a triangle's.
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
