//! Triangles on welded points, as passed to meshoptimizer.

use crate::math::Vec3;
use meshopt::VertexDataAdapter;

/// Triangles on points that are vertices of a mesh.
pub(in crate::bake) struct Part {
    /// Points in the unit cube.
    pub points: Vec<[f32; 3]>,
    /// The mesh vertex of each point.
    pub sources: Vec<u32>,
    pub triangles: Vec<[u32; 3]>,
    /// The component of each point; empty if there is only one.
    pub labels: Vec<u32>,
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

/// Returns the points in the form that meshoptimizer reads.
pub(in crate::bake) fn adapter(points: &[[f32; 3]]) -> VertexDataAdapter<'_> {
    VertexDataAdapter::new(meshopt::typed_to_bytes(points), size_of::<[f32; 3]>(), 0)
        .expect("the stride divides the length, and the offset is zero")
}

/// Triangles from a list of corners.
pub(in crate::bake) fn triples(corners: Vec<u32>) -> Vec<[u32; 3]> {
    corners.as_chunks::<3>().0.to_vec()
}

/// Returns the triangles on only the vertices they use, renumbered in order, and the original vertices.
pub(in crate::bake) fn compact(mut triangles: Vec<[u32; 3]>, count: usize) -> (Vec<[u32; 3]>, Vec<u32>) {
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
