//! Triangles wound in the opposite direction to their neighbours.

use super::connectivity::Edges;
use super::weld::{self, Classes};
use crate::mesh::{Mesh, doubled_area};
use crate::parallel;

/// The maximum fraction of a connected surface that counts as wrong because it opposes the rest.
const MINORITY: f64 = 0.2;

/// The triangles of a mesh that face the opposite way to the rest of the surface they are connected to, in the order
/// in which they were found.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Opposed {
    /// A small part of an otherwise consistent surface: these are certainly reversed.
    pub reversed: Vec<u32>,
    /// The smaller part of a surface on which it is unclear which part is right.
    pub doubtful: Vec<u32>,
}

impl Opposed {
    /// Finds such triangles. Surfaces are connected only by edges shared by exactly two triangles; vertices at equal
    /// positions count as one.
    pub fn of(mesh: &Mesh) -> Self {
        let places = weld::by_position(mesh.positions());
        if !has_opposed_edge(mesh, &places) {
            return Self::default();
        }
        let edges = Edges::with_places(mesh, places);
        let starts: Vec<usize> =
            edges.iter().filter(|edge| edges.is_reversed(mesh, *edge)).map(|edge| edge.triangle).collect();
        let mut opposed = Self::default();
        let mut sides = vec![UNKNOWN; mesh.triangles().len()];
        for start in starts {
            if sides[start] == UNKNOWN {
                opposed.add(Component::around(start, mesh, &edges, &mut sides));
            }
        }
        opposed
    }

    fn add(&mut self, component: Component) {
        let Component { members, areas, is_sound } = component;
        let smaller = usize::from(areas[1] < areas[0]);
        let share = areas[smaller] / (areas[0] + areas[1]).max(f64::MIN_POSITIVE);
        let part = if is_sound && share <= MINORITY { &mut self.reversed } else { &mut self.doubtful };
        part.extend(members.into_iter().filter(|(_, side)| usize::from(*side) == smaller).map(|(t, _)| t));
    }
}

/// Marks a triangle that was not reached yet; others have side 0 or 1.
const UNKNOWN: u8 = u8::MAX;

/// A connected surface, its triangles sorted by the side that they face.
struct Component {
    /// Each triangle with its side.
    members: Vec<(u32, u8)>,
    /// Twice the area on each side.
    areas: [f64; 2],
    /// `false` if no choice of sides is consistent, as on a Möbius strip.
    is_sound: bool,
}

impl Component {
    fn around(start: usize, mesh: &Mesh, edges: &Edges, sides: &mut [u8]) -> Self {
        let mut found = Self { members: Vec::new(), areas: [0.0; 2], is_sound: true };
        let mut queue = vec![start];
        sides[start] = 0;
        while let Some(t) = queue.pop() {
            let own = sides[t];
            found.members.push((t as u32, own));
            found.areas[usize::from(own)] += doubled_area(mesh, t);
            for edge in edges.around(t) {
                let side = own ^ u8::from(edges.is_reversed(mesh, edge));
                match sides[edge.other] {
                    UNKNOWN => {
                        sides[edge.other] = side;
                        queue.push(edge.other);
                    }
                    known => found.is_sound &= known == side,
                }
            }
        }
        found
    }
}

/// Returns true if two triangles run along their common edge in the same direction.
///
/// Around a vertex on a consistent, closed surface, every neighbour follows one triangle and precedes another, so the
/// hashes of those that follow, minus those that precede, sum to zero. If they do not, edges are compared one by one:
/// only at borders and faults, which takes a fraction of the time of comparing all.
fn has_opposed_edge(mesh: &Mesh, places: &Classes) -> bool {
    let mut sums = vec![0u32; places.firsts.len()];
    let corners = |t: &[u32; 3]| t.map(|v| places.of[v as usize]);
    for triangle in mesh.triangles() {
        let corners = corners(triangle);
        let hashes = corners.map(mixed);
        for (k, place) in corners.iter().enumerate() {
            let change = hashes[(k + 1) % 3].wrapping_sub(hashes[(k + 2) % 3]);
            let sum = &mut sums[*place as usize];
            *sum = sum.wrapping_add(change);
        }
    }
    let is_odd = |place: u32| sums[place as usize] != 0;
    let near = parallel::filter(mesh.triangles().len(), |t| {
        corners(&mesh.triangles()[t]).into_iter().filter(|place| is_odd(*place)).count() > 1
    });
    let mut sides: Vec<[u32; 3]> = Vec::new();
    for t in near {
        let [a, b, c] = corners(&mesh.triangles()[t]);
        let whole = a != b && b != c && c != a;
        let odd =
            [(a, b), (b, c), (c, a)].into_iter().filter(|(from, to)| whole && is_odd(*from) && is_odd(*to));
        sides.extend(odd.map(|(from, to)| [from.min(to), from.max(to), u32::from(from < to)]));
    }
    sides.sort_unstable();
    let mut edges = sides.chunk_by(|a, b| a[..2] == b[..2]);
    edges.any(|edge| matches!(edge, [one, other] if one[2] == other[2]))
}

/// A pseudo-random number, so that sums of several cancel only by chance.
fn mixed(place: u32) -> u32 {
    let x = (place ^ (place >> 16)).wrapping_mul(0x21f0_aaad);
    let x = (x ^ (x >> 15)).wrapping_mul(0x735a_2d97);
    x ^ (x >> 15)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::mesh::MeshData;

    /// A ball with these triangles reversed.
    fn ball(reversed: impl Fn(usize) -> bool) -> Mesh {
        let data = Mesh::sphere(1.0, 40, 20).into_data();
        let round = |v: f32| (v * 65536.0).round() / 65536.0;
        let positions: Vec<Vec3> = data.positions.iter().map(|p| p.map(round)).collect();
        let turned =
            |(i, [a, b, c]): (usize, &[u32; 3])| if reversed(i) { [*a, *c, *b] } else { [*a, *b, *c] };
        let triangles = data.triangles.iter().enumerate().map(turned).collect();
        Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap()
    }

    #[test]
    fn a_few_reversed_triangles_are_found_and_a_sound_ball_has_none() {
        assert_eq!(Opposed::of(&ball(|_| false)), Opposed::default());
        assert_eq!(Opposed::of(&ball(|_| true)), Opposed::default(), "inside out, yet consistent");
        let mut found = Opposed::of(&ball(|t| (700..717).contains(&t) || t == 40));
        found.reversed.sort_unstable();
        let expected: Vec<u32> = std::iter::once(40).chain(700..717).collect();
        assert_eq!(found, Opposed { reversed: expected, doubtful: Vec::new() });
    }

    #[test]
    fn halves_that_face_different_ways_are_in_doubt() {
        let found = Opposed::of(&ball(|t| t < 700));
        assert!(found.reversed.is_empty());
        assert_eq!(found.doubtful.len(), 700);
    }

    /// A band with half a twist: no choice is consistent.
    #[test]
    fn a_moebius_strip_is_in_doubt() {
        use crate::math::scalar::{cos, sin};
        let count = 30u32;
        let at = |i: u32| {
            let angle = std::f64::consts::TAU * f64::from(i / 2) / f64::from(count);
            let across = if i.is_multiple_of(2) { 0.3 } else { -0.3 };
            let radius = 1.0 + across * cos(angle / 2.0);
            Vec3::new(radius * cos(angle), radius * sin(angle), across * sin(angle / 2.0)).to_f32()
        };
        let positions = (0..2 * count).map(at).collect();
        let ends = |i: u32| if i < count { [2 * i, 2 * i + 1] } else { [1, 0] };
        let quad = |i: u32| {
            let ([a, b], [c, d]) = (ends(i), ends(i + 1));
            [[a, b, d], [a, d, c]]
        };
        let triangles = (0..count).flat_map(quad).collect();
        let band = Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap();
        let found = Opposed::of(&band);
        assert!(found.reversed.is_empty() && !found.doubtful.is_empty());
    }
}
