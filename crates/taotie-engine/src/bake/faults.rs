//! Faults of a scan: edges and triangles that no closed surface has, and connected parts that cannot be seen: walls
//! within walls, ghost layers, filled cavities.

use super::scan::Scan;
use crate::error::Result;
use crate::groups::Groups;
use crate::mesh::{Mesh, MeshData, Triangles, doubled_area, sample_triangles};
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

/// Returns the number of triangles at the same corners as another one that faces the opposite way, as the two sides of a
/// card do.
pub fn coinciding_sides(mesh: &Mesh) -> usize {
    let places = surface::by_position(mesh.positions());
    let sides = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| places.of[v as usize]);
        let mut sorted = [a, b, c];
        sorted.sort_unstable();
        let is_even = [[a, b, c], [b, c, a], [c, a, b]].contains(&sorted);
        (a != b && b != c && a != c).then_some((sorted, is_even))
    };
    let mut found: Vec<([u32; 3], bool)> = mesh.triangles().iter().filter_map(sides).collect();
    found.sort_unstable();
    let both = |run: &[([u32; 3], bool)]| {
        let even = run.iter().filter(|side| side.1).count();
        2 * even.min(run.len() - even)
    };
    found.chunk_by(|a, b| a.0 == b.0).map(both).sum()
}

/// Returns the positions of each triangle, lowest first; skips triangles with two equal corners.
pub(super) fn whole_triangles<'m>(
    triangles: &'m [[u32; 3]],
    places: &'m [u32],
) -> impl Iterator<Item = [u32; 3]> + 'm {
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
pub(super) fn by_place<T>((place, value): (u32, T)) -> (usize, T) {
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
    let parts = parallel::fold(groups.count(), |tally: &mut Tally<T>, group| {
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

/// Shells with a smaller share of the area are not examined.
const LEAST_SHARE: f64 = 0.001;
/// Hidden shells with a smaller combined share of the area are kept.
const WORTH_LEAVING: f64 = 0.01;
/// Maximum number of points of a shell to examine before it counts as hidden; fewer if it has fewer triangles.
const POINTS: usize = 4_096;
/// Number of points examined per batch: nearly all visible shells are seen at one of the first.
const BATCH: usize = 64;

/// The connected parts of a surface, joined at shared positions, that are large enough to examine.
#[derive(Debug)]
pub struct Shells {
    /// The triangles of each part.
    triangles: Vec<Vec<u32>>,
    /// The share of the area of each part, [0, 1].
    shares: Vec<f64>,
}

impl Shells {
    /// Finds the parts of a mesh; `None` unless there are at least two, since at least one is visible.
    pub fn of(mesh: &Mesh) -> Option<Self> {
        let labels = surface::shell_labels(mesh);
        let label = |t: usize| labels[t] as usize;
        let mut areas = vec![0.0; labels.iter().max().map_or(0, |most| *most as usize + 1)];
        (0..mesh.triangles().len()).for_each(|t| areas[label(t)] += doubled_area(mesh, t));
        let all: f64 = areas.iter().sum();
        let large: Vec<usize> = (0..areas.len()).filter(|l| areas[*l] > all * LEAST_SHARE).collect();
        if large.len() < 2 {
            return None;
        }
        let mut triangles = vec![Vec::new(); large.len()];
        for t in 0..mesh.triangles().len() {
            if let Ok(shell) = large.binary_search(&label(t)) {
                triangles[shell].push(t as u32);
            }
        }
        Some(Self { triangles, shares: large.into_iter().map(|l| areas[l] / all).collect() })
    }

    /// Returns the scan's mesh without the shells that cannot be seen from either side, and their share of the area;
    /// `None` if that share is below one per cent or the scan is an interior.
    ///
    /// # Errors
    /// Only those of [`Mesh::new`], which validates the mesh again.
    pub fn without_hidden(&self, scan: &Scan) -> Result<Option<(Mesh, f64)>> {
        if !scan.sights().places().is_empty() {
            return Ok(None);
        }
        let (mut is_hidden, mut share) = (vec![false; scan.mesh().triangles().len()], 0.0);
        for (triangles, own) in self.triangles.iter().zip(&self.shares) {
            if !is_seen(scan, triangles)? {
                share += own;
                triangles.iter().for_each(|t| is_hidden[*t as usize] = true);
            }
        }
        if !(WORTH_LEAVING..1.0).contains(&share) {
            return Ok(None);
        }
        let mesh = scan.mesh();
        let numbered = mesh.triangles().iter().zip(is_hidden);
        let triangles = numbered.filter(|(_, is_hidden)| !is_hidden).map(|(t, _)| *t).collect();
        let data = MeshData { positions: mesh.positions().to_vec(), triangles, ..MeshData::default() };
        Ok(Some((Mesh::new(data)?, share)))
    }
}

/// Returns `true` if a point of some triangles can be seen from either side.
fn is_seen(scan: &Scan, triangles: &[u32]) -> Result<bool> {
    let count = triangles.len().min(POINTS);
    let point = sample_triangles(scan.mesh(), Triangles::These(triangles), count)?;
    // The points are in triangle order: a stride spreads each batch over all of them.
    let batches = count.div_ceil(BATCH);
    let numbers = |batch: usize| (0..BATCH).map(move |i| i * batches + batch).take_while(move |i| *i < count);
    Ok((0..batches).any(|batch| {
        let numbers: Vec<usize> = numbers(batch).collect();
        parallel::count(numbers.len(), |i| scan.is_seen_from_anywhere(point(numbers[i]))) > 0
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::scene::{Material, Scene};

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

    #[test]
    fn the_sides_of_cards_are_counted() {
        let count = |triangles: &[[u32; 3]]| {
            let positions = [[0, 0], [1, 0], [0, 1], [1, 1], [0, 0]];
            let positions = positions.map(|[x, y]| Vec3::new(x as f32, y as f32, 0.0)).to_vec();
            let triangles = triangles.to_vec();
            coinciding_sides(&Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap())
        };
        assert_eq!(
            count(&[[0, 1, 2], [1, 3, 2], [2, 1, 4], [1, 2, 3]]),
            4,
            "vertex 4 is at the position of 0"
        );
        assert_eq!(count(&[[0, 1, 2], [1, 2, 0], [1, 3, 2]]), 0, "a duplicate faces the same way");
        assert_eq!(count(&[[0, 1, 4], [4, 1, 0]]), 0, "no area");
    }

    fn moved(mesh: &Mesh, by: f32) -> Mesh {
        let positions = mesh.positions().iter().map(|p| *p + Vec3::new(by, 0.0, 0.0)).collect();
        Mesh::new(MeshData { positions, triangles: mesh.triangles().to_vec(), ..MeshData::default() })
            .unwrap()
    }

    fn without(parts: &[Mesh]) -> Option<(Mesh, f64)> {
        let mesh = Mesh::joined(parts).unwrap();
        let shells = Shells::of(&mesh)?;
        shells
            .without_hidden(&Scan::new(Scene::of_mesh(mesh, Material::default()).unwrap()).unwrap())
            .unwrap()
    }

    #[test]
    fn a_ball_within_a_ball_is_left_out() {
        let (outer, inner) = (Mesh::sphere(1.0, 32, 16), Mesh::sphere(0.5, 32, 16));
        let (mesh, share) = without(&[outer.clone(), inner.clone()]).unwrap();
        assert!((share - 0.2).abs() < 0.001, "{share}");
        let radius = |t: &[u32; 3]| mesh.positions()[t[0] as usize].length();
        assert!(mesh.triangles().len() == outer.triangles().len());
        assert!(mesh.triangles().iter().all(|t| radius(t) > 0.9));
        assert!(without(std::slice::from_ref(&outer)).is_none(), "there is only one");
        assert!(without(&[outer.clone(), moved(&inner, 3.0)]).is_none(), "both can be seen");
    }

    #[test]
    fn what_a_small_hole_shows_is_kept() {
        let (inner, outer) = (Mesh::sphere(0.9, 64, 32), Mesh::sphere(1.0, 64, 32));
        let data = outer.into_data();
        let is_hole = |t: &[u32; 3]| t.iter().all(|v| data.positions[*v as usize].x > 0.97);
        let triangles = data.triangles.iter().copied().filter(|t| !is_hole(t)).collect();
        let outer =
            Mesh::new(MeshData { positions: data.positions, triangles, ..MeshData::default() }).unwrap();
        assert!(without(&[outer, inner]).is_none());
    }
}
