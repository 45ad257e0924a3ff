//! Faults of a surface.

use crate::groups::Groups;
use crate::mesh::Mesh;
use crate::parallel;
use crate::surface;

/// Counts of the faults of a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Faults {
    /// Edges with only one triangle.
    pub open_edges: usize,
    /// Edges shared by more than two triangles.
    pub crowded_edges: usize,
    /// Triangles with the same corners as an earlier one, facing either way.
    pub duplicates: usize,
    /// Triangles without area.
    pub flat: usize,
}

impl Faults {
    /// Counts the faults of a mesh; vertices at the same position count as one.
    pub fn of(mesh: &Mesh) -> Self {
        let places = surface::by_position(mesh.positions());
        let whole = || whole_triangles(mesh.triangles(), &places.of);
        let count = places.firsts.len();
        let edges = || {
            let edges = || whole().flat_map(|[a, b, c]| [(a, b), (a, c), (b, c)]).map(by_place);
            runs(&Groups::new(count, edges), |tally, length| {
                tally.ones += usize::from(length == 1);
                tally.many += usize::from(length > 2);
            })
        };
        let twins = || {
            let twins = || whole().map(|[a, b, c]| (a, (b, c))).map(by_place);
            runs(&Groups::new(count, twins), |tally, length| tally.many += length - 1)
        };
        // Each group is built by one thread.
        let (edges, twins) = rayon::join(edges, twins);
        Self {
            open_edges: edges.ones,
            crowded_edges: edges.many,
            duplicates: twins.many,
            flat: mesh.degenerate_triangles(),
        }
    }
}

/// Returns the positions of each triangle, lowest first; skips triangles with two equal corners.
fn whole_triangles<'m>(triangles: &'m [[u32; 3]], places: &'m [u32]) -> impl Iterator<Item = [u32; 3]> + 'm {
    triangles.iter().filter_map(|triangle| {
        let [mut a, mut b, mut c] = triangle.map(|v| places[v as usize]);
        (a, b) = (a.min(b), a.max(b));
        (b, c) = (b.min(c), b.max(c));
        (a, b) = (a.min(b), a.max(b));
        (a != b && b != c).then_some([a, b, c])
    })
}

/// Neighbours in a file mostly have neighbouring positions, so grouping by them is faster than sorting and takes less
/// memory.
fn by_place<T>((place, value): (u32, T)) -> (usize, T) {
    (place as usize, value)
}

/// Counts of runs of equal values.
#[derive(Default)]
struct Tally<T> {
    /// Buffer for the values of a group.
    sorted: Vec<T>,
    ones: usize,
    many: usize,
}

/// Calls `count` with the length of each run of equal values of a group; returns the sums.
fn runs<T>(groups: &Groups<T>, count: impl Fn(&mut Tally<T>, usize) + Sync) -> Tally<T>
where
    T: Copy + Default + Ord + Send + Sync,
{
    let parts = parallel::fold(groups.len(), |tally: &mut Tally<T>, group| {
        let mut sorted = std::mem::take(&mut tally.sorted);
        sorted.clear();
        sorted.extend_from_slice(groups.of(group));
        sorted.sort_unstable();
        sorted.chunk_by(T::eq).for_each(|run| count(tally, run.len()));
        tally.sorted = sorted;
    });
    parts.into_iter().fold(Tally::default(), |all, part| Tally {
        sorted: Vec::new(),
        ones: all.ones + part.ones,
        many: all.many + part.many,
    })
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
            // The first vertex again: split for uvs, but at the same position.
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
