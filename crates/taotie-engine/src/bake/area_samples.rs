//! Points spread evenly over the area of a mesh.

use crate::error::{Error, Result};
use crate::math::{Vec3, sequence::Sequence};
use crate::mesh::{Mesh, Point};
use crate::parallel;

/// Returns a function from an index to one of `count` points spread evenly over a mesh's area; deterministic.
pub(crate) fn sample_area(mesh: &Mesh, count: usize) -> Result<impl Fn(usize) -> Point + Sync + '_> {
    sample_triangles(mesh, Triangles::Every(1), count)
}

/// The triangles of a mesh to sample.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Triangles<'a> {
    /// The triangles 0, `step`, 2 · `step` and so on; `step` at least 1.
    Every(usize),
    /// The triangles with these indices.
    These(&'a [u32]),
}

/// Like [`sample_area`], but on selected triangles only.
pub(crate) fn sample_triangles<'a>(
    mesh: &'a Mesh,
    some: Triangles<'a>,
    count: usize,
) -> Result<impl Fn(usize) -> Point + Sync + 'a> {
    /// Number of triangles that share one area sum, to save memory.
    const BLOCK: usize = 32;
    let triangles = match some {
        Triangles::Every(step) => mesh.triangles().len().div_ceil(step),
        Triangles::These(numbers) => numbers.len(),
    };
    let numbered = move |i: usize| match some {
        Triangles::Every(step) => i * step,
        Triangles::These(numbers) => numbers[i] as usize,
    };
    let areas = move |block: usize| {
        let block = block * BLOCK..((block + 1) * BLOCK).min(triangles);
        let area = move |i: usize| doubled_area(mesh, numbered(i));
        block.map(area).map(|area| if area.is_finite() { area } else { 0.0 })
    };
    // The cumulative area up to the end of each block.
    let mut sums: Vec<f64> = parallel::collect(triangles.div_ceil(BLOCK), |block| areas(block).sum());
    let mut sum = 0.0;
    for to_end in &mut sums {
        sum += *to_end;
        *to_end = sum;
    }
    if sum <= 0.0 {
        return Err(Error::invalid("the mesh", "its triangles have no area"));
    }
    let points = Sequence::new(0);
    Ok(move |i: usize| {
        // One point in each of `count` equal areas.
        let [jitter, u, v, _] = points.four(i as u32 % Sequence::MOST, (i as u32 / Sequence::MOST) * 2);
        let target = (i as f64 + f64::from(jitter)) / count as f64 * sum;
        let block = sums.partition_point(|s| *s <= target).min(sums.len() - 1);
        let mut before = if block == 0 { 0.0 } else { sums[block - 1] };
        let is_before = |area: &f64| {
            before += area;
            before <= target
        };
        let place = (block * BLOCK + areas(block).take_while(is_before).count()).min(triangles - 1);
        Point { triangle: numbered(place) as u32, weights: triangle_weights(u, v) }
    })
}

/// Barycentric weights in a triangle, uniform if (u, v) is uniform over [0, 1)².
///
/// Source: Osada et al. 2002, "Shape distributions", §4.2.
pub(super) fn triangle_weights(u: f32, v: f32) -> [f32; 3] {
    let root = u.sqrt();
    [1.0 - root, root * (1.0 - v), root * v]
}

pub(super) fn doubled_area(mesh: &Mesh, triangle: usize) -> f64 {
    let [a, b, c] = mesh.corners(triangle).map(Vec3::to_f64);
    (b - a).cross(c - a).length()
}
