//! Triangles on welded points in the unit cube, as passed to meshoptimizer, and their connected components: triangles
//! that share a vertex belong to the same one; and the cube's cells along a Morton curve, on which neighbours in
//! space are mostly neighbours in order.

use crate::groups::DisjointSets;
use crate::math::Vec3;
use meshopt::VertexDataAdapter;

/// Triangles on points that are vertices of a mesh.
pub(super) struct Part {
    /// Points in the unit cube.
    pub points: Vec<[f32; 3]>,
    /// The mesh vertex of each point.
    pub sources: Vec<u32>,
    pub triangles: Vec<[u32; 3]>,
    /// The component of each point; empty if there is only one.
    pub labels: Vec<u32>,
}

impl Part {
    /// Returns the part without the points that no triangle uses.
    pub fn compacted(self) -> Self {
        let (triangles, used) = compact(self.triangles, self.points.len());
        Self {
            points: used.iter().map(|v| self.points[*v as usize]).collect(),
            sources: used.iter().map(|v| self.sources[*v as usize]).collect(),
            labels: used.iter().filter_map(|v| self.labels.get(*v as usize).copied()).collect(),
            triangles,
        }
    }

    /// Returns some of its triangles as a separate part, whose sources are points of this one.
    pub fn extract(&self, triangles: &[[u32; 3]]) -> Self {
        let mut sources = triangles.as_flattened().to_vec();
        sources.sort_unstable();
        sources.dedup();
        let number = |v: u32| sources.partition_point(|source| *source < v) as u32;
        Self {
            points: sources.iter().map(|v| self.points[*v as usize]).collect(),
            triangles: triangles.iter().map(|triangle| triangle.map(number)).collect(),
            labels: Vec::new(),
            sources,
        }
    }

    /// Returns the component of a triangle on its points.
    pub fn component(&self, triangle: &[u32; 3]) -> usize {
        self.labels.get(triangle[0] as usize).map_or(0, |label| *label as usize)
    }
}

/// Returns the points in the form that meshoptimizer reads.
pub(super) fn adapter(points: &[[f32; 3]]) -> VertexDataAdapter<'_> {
    VertexDataAdapter::new(meshopt::typed_to_bytes(points), size_of::<[f32; 3]>(), 0)
        .expect("the stride divides the length, and the offset is zero")
}

/// Triangles from a list of corners.
pub(super) fn triples(corners: Vec<u32>) -> Vec<[u32; 3]> {
    corners.as_chunks::<3>().0.to_vec()
}

/// Returns the triangles on only the vertices they use, renumbered in order, and the original vertices.
pub(super) fn compact(mut triangles: Vec<[u32; 3]>, count: usize) -> (Vec<[u32; 3]>, Vec<u32>) {
    const UNUSED: u32 = u32::MAX;
    let mut numbers = vec![UNUSED; count];
    triangles.iter().flatten().for_each(|v| numbers[*v as usize] = 0);
    let mut used = Vec::new();
    for (v, number) in numbers.iter_mut().enumerate().filter(|(_, number)| **number != UNUSED) {
        *number = used.len() as u32;
        used.push(v as u32);
    }
    triangles.iter_mut().flatten().for_each(|v| *v = numbers[*v as usize]);
    (triangles, used)
}

/// Marks points without triangles.
const NONE: u32 = u32::MAX;
/// A component is large if it has at least this fraction of the area, or of the diagonal.
const LARGE_AREA: f64 = 0.005;
const LARGE_DIAGONAL: f64 = 0.02;
/// A component with fewer triangles cannot lose any without collapsing.
const LEAST: usize = 8;

/// The components of a surface, by index.
pub(super) struct Components {
    /// `true` for each component too large to lose; at least one.
    pub large: Vec<bool>,
    /// `true` if most triangles belong to components that cannot lose any.
    pub is_soup: bool,
}

/// Counts of what happened to components; each is counted once.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Fate {
    /// Components without any triangles left.
    pub lost: usize,
    /// Large components among them.
    pub lost_large: usize,
    /// Large components that came apart.
    pub torn: usize,
}

impl Components {
    /// Finds the components of a part, and labels its points.
    pub fn of(part: &mut Part) -> Self {
        let (labels, count) = labels(&part.triangles, part.points.len());
        if count < 2 {
            return Self { large: vec![true], is_soup: part.triangles.len() < LEAST };
        }
        part.labels = labels;
        let mut found = Self { large: large(part, count), is_soup: false };
        let counts = found.counts(part, &part.triangles);
        let small: usize = counts.iter().filter(|count| **count < LEAST).sum();
        found.is_soup = small * 2 > part.triangles.len();
        found
    }

    /// Returns the number of components.
    pub fn len(&self) -> usize {
        self.large.len()
    }

    /// Returns the number of triangles in each component, out of some triangles on the points of a part.
    pub fn counts(&self, part: &Part, triangles: &[[u32; 3]]) -> Vec<usize> {
        let mut counts = vec![0; self.len()];
        triangles.iter().for_each(|triangle| counts[part.component(triangle)] += 1);
        counts
    }

    /// Returns the fate of the components, given some triangles on the points of a part.
    pub fn fate(&self, part: &Part, triangles: &[[u32; 3]]) -> Fate {
        let (pieces, count) = labels(triangles, part.points.len());
        let mut seen = vec![false; count];
        let mut counts = vec![0; self.len()];
        for triangle in triangles {
            let piece = pieces[triangle[0] as usize] as usize;
            counts[part.component(triangle)] += usize::from(!seen[piece]);
            seen[piece] = true;
        }
        let mut fate = Fate::default();
        for (count, large) in counts.into_iter().zip(&self.large) {
            fate.lost += usize::from(count == 0);
            fate.lost_large += usize::from(count == 0 && *large);
            fate.torn += usize::from(count > 1 && *large);
        }
        fate
    }
}

/// Returns `true` if triangles are connected.
pub(super) fn is_connected(triangles: &[[u32; 3]], points: usize) -> bool {
    labels(triangles, points).1 == 1
}

/// Returns the component of each point, numbered by first point, [`NONE`] without triangles, and their count.
fn labels(triangles: &[[u32; 3]], points: usize) -> (Vec<u32>, usize) {
    let mut sets = DisjointSets::new(points);
    let mut used = vec![false; points];
    for [a, b, c] in triangles {
        sets.join(*a, *b);
        sets.join(*b, *c);
    }
    triangles.as_flattened().iter().for_each(|v| used[*v as usize] = true);
    let mut labels = sets.into_lowest();
    let mut count = 0;
    for (v, used) in used.into_iter().enumerate() {
        if labels[v] != v as u32 {
            // A component's first point comes before all others, so it is already labelled.
            labels[v] = labels[labels[v] as usize];
        } else if used {
            labels[v] = count;
            count += 1;
        } else {
            labels[v] = NONE;
        }
    }
    (labels, count as usize)
}

/// The size of a component.
#[derive(Clone, Copy)]
struct Size {
    area: f64,
    least: [f32; 3],
    most: [f32; 3],
}

impl Size {
    const NOTHING: Self = Self { area: 0.0, least: [f32::INFINITY; 3], most: [f32::NEG_INFINITY; 3] };

    fn add(&mut self, corners: [[f32; 3]; 3]) {
        let [a, b, c] = corners.map(|p| Vec3::from_array(p).to_f64());
        self.area += (b - a).cross(c - a).length() * 0.5;
        for corner in corners {
            for (k, v) in corner.into_iter().enumerate() {
                self.least[k] = self.least[k].min(v);
                self.most[k] = self.most[k].max(v);
            }
        }
    }

    fn diagonal(&self) -> f64 {
        (Vec3::from_array(self.most).to_f64() - Vec3::from_array(self.least).to_f64()).length()
    }
}

fn large(part: &Part, count: usize) -> Vec<bool> {
    let mut sizes = vec![Size::NOTHING; count];
    let mut whole = Size::NOTHING;
    for triangle in &part.triangles {
        let corners = triangle.map(|v| part.points[v as usize]);
        sizes[part.component(triangle)].add(corners);
        whole.add(corners);
    }
    let (area, diagonal) = (whole.area * LARGE_AREA, whole.diagonal() * LARGE_DIAGONAL);
    sizes.into_iter().map(|size| size.area > area || size.diagonal() > diagonal).collect()
}

/// The cube that points are scaled from.
#[derive(Debug, Clone, Copy)]
pub(in crate::bake) struct UnitCube {
    least: Vec3<f64>,
    /// The longest side, model units; above 0.
    pub extent: f64,
}

impl UnitCube {
    pub fn of(positions: &[Vec3]) -> Self {
        let (mut least, mut most) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for position in positions {
            for (k, v) in position.to_array().into_iter().enumerate() {
                least[k] = least[k].min(v);
                most[k] = most[k].max(v);
            }
        }
        let side = |k: usize| f64::from(most[k]) - f64::from(least[k]);
        let extent = side(0).max(side(1)).max(side(2));
        Self {
            least: Vec3::from_array(least).to_f64(),
            extent: if extent > 0.0 && extent.is_finite() { extent } else { 1.0 },
        }
    }

    /// Returns the point in the unit cube.
    pub fn scaled(&self, position: Vec3) -> [f32; 3] {
        self.unit(position).to_f32().to_array()
    }

    /// Returns the position of a point of the unit cube.
    pub fn placed(&self, point: [f32; 3]) -> Vec3 {
        (self.least + Vec3::from_array(point).to_f64() * self.extent).to_f32()
    }

    /// Like [`Self::scaled`], in double precision.
    pub fn unit(&self, position: Vec3) -> Vec3<f64> {
        (position.to_f64() - self.least) / self.extent
    }
}

/// Cells along a side of the cube: 2 to this power.
const CELL_BITS: u32 = 10;
/// The same for fine cells, whose codes have three words of [`CELL_BITS`] per axis.
const FINE_BITS: u32 = 3 * CELL_BITS;

/// Returns the index of a point's cell along the Morton curve; the point must be in the unit cube.
pub(in crate::bake) fn morton(point: [f32; 3]) -> u32 {
    let cells = 1 << CELL_BITS;
    interleaved(point.map(|v| ((v * cells as f32) as u32).min(cells - 1)))
}

/// Fine cells of the cube merged into blocks of 2^`shift` along a side.
#[derive(Debug, Clone, Copy)]
pub(super) struct FineCells {
    shift: u32,
}

impl FineCells {
    /// The finest cells: 2^30 along a side.
    pub const FINEST: Self = Self { shift: 0 };

    /// Returns the smallest blocks with a side of at least `length`, or the whole cube if that is shorter.
    pub fn at_least(length: f64) -> Self {
        let cells = (length * f64::from(1u32 << FINE_BITS)) as u32;
        Self { shift: (u32::BITS - cells.leading_zeros()).min(FINE_BITS) }
    }

    /// Returns the coordinates of the block containing a point; points outside the cube are clamped.
    pub fn block(self, point: [f64; 3]) -> [u32; 3] {
        let cells = 1u32 << FINE_BITS;
        point.map(|v| ((v * f64::from(cells)) as u32).min(cells - 1) >> self.shift)
    }

    /// Returns the first and the last code of a block's cells along the curve. No other block has codes between them.
    pub fn codes(self, block: [u32; 3]) -> [[u32; 3]; 2] {
        let low = block.map(|v| v << self.shift);
        let high = low.map(|v| v | ((1 << self.shift) - 1));
        [low, high].map(|cell| {
            [2, 1, 0].map(|word| interleaved(cell.map(|v| v >> (word * CELL_BITS) & ((1 << CELL_BITS) - 1))))
        })
    }
}

fn interleaved(cell: [u32; 3]) -> u32 {
    let [x, y, z] = cell.map(spread_bits);
    x << 2 | y << 1 | z
}

/// Spreads ten bits, leaving two free bits before each.
fn spread_bits(v: u32) -> u32 {
    let v = (v | v << 16) & 0x0300_00FF;
    let v = (v | v << 8) & 0x0300_F00F;
    let v = (v | v << 4) & 0x030C_30C3;
    (v | v << 2) & 0x0924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two squares of two triangles, a speck, and a point without triangles.
    fn part() -> Part {
        let square = |x: f32| [[x, 0.0, 0.0], [x + 0.4, 0.0, 0.0], [x + 0.4, 0.4, 0.0], [x, 0.4, 0.0]];
        let mut points = vec![[0.9, 0.9, 0.9]];
        points.extend(square(0.0).into_iter().chain(square(0.6)));
        points.extend([[0.5, 0.5, 0.0], [0.501, 0.5, 0.0], [0.5, 0.501, 0.0]]);
        let triangles = vec![[5, 6, 7], [5, 7, 8], [1, 2, 3], [1, 3, 4], [9, 10, 11]];
        Part { sources: (0..points.len() as u32).collect(), points, triangles, labels: Vec::new() }
    }

    #[test]
    fn components_are_numbered_and_weighed() {
        let mut part = part();
        let components = Components::of(&mut part);
        assert_eq!(part.labels, [NONE, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2]);
        assert_eq!(components.large, [true, true, false]);
        assert_eq!(components.counts(&part, &part.triangles), [2, 2, 1]);
        assert!(components.is_soup);
    }

    #[test]
    fn what_is_lost_or_torn_is_counted() {
        let mut part = part();
        let components = Components::of(&mut part);
        let fate = |triangles: &[[u32; 3]]| components.fate(&part, triangles);
        assert_eq!(fate(&part.triangles), Fate::default());
        assert_eq!(fate(&[[1, 2, 3], [5, 6, 7]]), Fate { lost: 1, ..Fate::default() });
        assert_eq!(fate(&[[1, 2, 3]]), Fate { lost: 2, lost_large: 1, torn: 0 });
        assert_eq!(fate(&[]), Fate { lost: 3, lost_large: 2, torn: 0 });
    }

    #[test]
    fn one_component_is_not_marked() {
        let mut part = Part { triangles: vec![[5, 6, 7], [5, 7, 8]], ..part() };
        assert_eq!(Components::of(&mut part).large, [true]);
        assert!(part.labels.is_empty());
        assert!(is_connected(&part.triangles, part.points.len()));
        assert!(!is_connected(&[[1, 2, 3], [5, 6, 7]], part.points.len()) && !is_connected(&[], 3));
    }

    #[test]
    fn bits_are_spread_by_three() {
        assert_eq!(spread_bits(0b11_1111_1111), 0x0924_9249);
        assert_eq!(morton([0.0, 0.0, 1.0]), 0x0924_9249);
        assert_eq!(morton([0.5, 0.0, 0.0]), 1 << 29);
    }

    #[test]
    fn a_point_has_a_code_of_its_block() {
        let point = [0.3, 0.999_999_9, 1e-8];
        let [code, same] = FineCells::FINEST.codes(FineCells::FINEST.block(point));
        assert_eq!(code, same);
        for length in [0.0, 1e-9, 1e-4, 0.3, 7.0] {
            let cells = FineCells::at_least(length);
            let [first, last] = cells.codes(cells.block(point));
            assert!(first <= code && code <= last, "{length}");
            let [x, y, z] = cells.block(point);
            let [after, _] = cells.codes([x, y, z + 1]);
            let side = f64::from(1u32 << cells.shift) / f64::from(1u32 << FINE_BITS);
            assert!(side == 1.0 || after != first && side >= length, "{length}");
        }
    }
}
