//! Faults of a surface itself.

use crate::mesh::Mesh;
use crate::parallel;
use crate::surface;

/// The faults of a surface itself, counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Faults {
    /// Edges with one triangle.
    pub open_edges: usize,
    /// Edges where more than two triangles meet.
    pub crowded_edges: usize,
    /// Triangles that have the same corners as an earlier one, whichever way they face.
    pub duplicates: usize,
    /// Triangles without area.
    pub flat: usize,
}

impl Faults {
    /// Counts the faults of a mesh, vertices at one position counted as one.
    pub fn of(mesh: &Mesh) -> Self {
        let places = surface::by_position(mesh.positions());
        let whole = Whole { triangles: mesh.triangles(), places: &places.of };
        let count = places.firsts.len();
        let edges = Groups::of(&whole, count, |[a, b, c]| [(a, b), (a, c), (b, c)]);
        let found = edges.runs(|tally, length| {
            tally.ones += usize::from(length == 1);
            tally.many += usize::from(length > 2);
        });
        drop(edges);
        let twins = Groups::of(&whole, count, |[a, b, c]| [(a, (b, c))]);
        let twins = twins.runs(|tally, length| tally.many += length - 1);
        Self {
            open_edges: found.ones,
            crowded_edges: found.many,
            duplicates: twins.many,
            flat: mesh.degenerate_triangles(),
        }
    }
}

/// Triangles on places, those with two equal corners left out.
struct Whole<'m> {
    triangles: &'m [[u32; 3]],
    places: &'m [u32],
}

impl Whole<'_> {
    /// Calls `with` for each triangle with its places, the lowest first.
    #[inline]
    fn each(&self, mut with: impl FnMut([u32; 3])) {
        for triangle in self.triangles {
            let [mut a, mut b, mut c] = triangle.map(|v| self.places[v as usize]);
            (a, b) = (a.min(b), a.max(b));
            (b, c) = (b.min(c), b.max(c));
            (a, b) = (a.min(b), a.max(b));
            if a != b && b != c {
                with([a, b, c]);
            }
        }
    }
}

/// Values by the place that they belong to. Neighbours in a file mostly have neighbouring places, so that filling is
/// faster than sorting, and takes less memory.
struct Groups<T> {
    /// The start of each place's values; one more at the end.
    starts: Vec<usize>,
    values: Vec<T>,
}

/// Runs of equal values, counted.
#[derive(Default)]
struct Tally<T> {
    /// Room for the values of a place.
    sorted: Vec<T>,
    ones: usize,
    many: usize,
}

impl<T: Copy + Default + Ord + Send + Sync> Groups<T> {
    /// Takes the values that each triangle has, with the places below `count` that they belong to.
    fn of<const N: usize>(
        triangles: &Whole<'_>,
        count: usize,
        values_of: impl Fn([u32; 3]) -> [(u32, T); N],
    ) -> Self {
        let mut starts = vec![0; count + 2];
        triangles.each(|corners| {
            values_of(corners).iter().for_each(|(place, _)| starts[*place as usize + 2] += 1);
        });
        for place in 2..starts.len() {
            starts[place] += starts[place - 1];
        }
        // What is one further than a place's start moves from its start to its end.
        let mut values = vec![T::default(); starts[count + 1]];
        triangles.each(|corners| {
            for (place, value) in values_of(corners) {
                let next = &mut starts[place as usize + 1];
                values[*next] = value;
                *next += 1;
            }
        });
        starts.pop();
        Self { starts, values }
    }

    /// Calls `count` with the length of each run of equal values of a place; returns the sums.
    fn runs(&self, count: impl Fn(&mut Tally<T>, usize) + Sync) -> Tally<T> {
        let parts = parallel::fold(self.starts.len() - 1, |tally: &mut Tally<T>, place| {
            let mut sorted = std::mem::take(&mut tally.sorted);
            sorted.clear();
            sorted.extend_from_slice(&self.values[self.starts[place]..self.starts[place + 1]]);
            sorted.sort_unstable();
            sorted.chunk_by(T::eq).for_each(|run| count(tally, run.len()));
            tally.sorted = sorted;
        });
        let sum = |all: Tally<T>, part: Tally<T>| Tally {
            sorted: Vec::new(),
            ones: all.ones + part.ones,
            many: all.many + part.many,
        };
        parts.into_iter().fold(Tally { sorted: Vec::new(), ones: 0, many: 0 }, sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::mesh::MeshData;

    #[test]
    fn each_fault_is_counted() {
        let corner = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let positions = vec![
            corner(0.0, 0.0, 0.0),
            corner(1.0, 0.0, 0.0),
            corner(0.0, 1.0, 0.0),
            corner(0.0, 0.0, 1.0),
            // The first once more: cut for uvs, but one place.
            corner(0.0, 0.0, 0.0),
            corner(0.0, -1.0, 0.0),
        ];
        let faults = |triangles: &[[u32; 3]]| {
            let data = MeshData {
                positions: positions.clone(),
                triangles: triangles.to_vec(),
                ..MeshData::default()
            };
            Faults::of(&Mesh::new(data).unwrap())
        };
        let closed = [[0, 2, 1], [4, 1, 3], [1, 2, 3], [0, 3, 2]];
        assert_eq!(faults(&closed), Faults::default());
        assert_eq!(faults(&closed[..3]), Faults { open_edges: 3, ..Faults::default() });
        let fin = [closed.as_slice(), &[[0, 1, 5]]].concat();
        assert_eq!(faults(&fin), Faults { open_edges: 2, crowded_edges: 1, ..Faults::default() });
        let twice = [closed.as_slice(), &[[1, 0, 2], [0, 0, 1]]].concat();
        assert_eq!(faults(&twice), Faults { crowded_edges: 3, duplicates: 1, flat: 1, ..Faults::default() });
    }
}
